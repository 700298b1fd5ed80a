// SPDX-License-Identifier: MIT
// The modes of a resonator from its physical parameters: stiff string, bar, circular membrane,
// rectangular plate, circular plate, table of modes.
#pragma once

#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "contactspline/data/mode.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "generator/resonator/bar.hpp"
#include "generator/resonator/plate.hpp"
#include "generator/resonator/round_plate.hpp"

namespace contactspline {

/// Circular membrane with a fixed rim: w0 = beta sqrt(T/sigma), beta R a zero of J_m. The shapes are J_m(beta r)
/// cos(m angle), with the angle counted from the strike; the modal mass is sigma times the integral of the squared
/// shape. A strike does not excite the sine modes. Place: radius [m] and angle [rad].
struct Membrane {
  double radius_m;
  double mass_per_area_kg_m2;
  double tension_n_per_m;
  Losses losses;
};

/// pi R^2 [m^2].
[[nodiscard]] inline double area_of(const Membrane& membrane) {
  return std::numbers::pi * membrane.radius_m * membrane.radius_m;
}

/// Modes that were measured or computed elsewhere, with the values of their shapes at the strike, at the pickup and,
/// as the body of a keyboard, at the right ear and at the places of its bridges.
struct ModeTable {
  struct Row {
    Mode mode;
    double strike_shape, pickup_shape, right_shape = pickup_shape;
    std::vector<double> bridge_shapes = {};  ///< as many in each row
  };
  std::vector<Row> rows;
};

/// A place on the resonator; `angle_rad` is used for what is round only, `across_m` for a rectangular plate only. On
/// a membrane `mean_radius_m` > 0 stands for the mean displacement over the disc of this radius about the middle.
struct Place {
  double position_m;
  double angle_rad = 0;
  double across_m = 0;
  double mean_radius_m = 0;
};

struct Resonator {
  std::string name;         ///< lower-case identifier
  std::string description;  ///< one line, may be empty
  std::variant<StiffString, Bar, Membrane, Plate, RoundPlate, ModeTable> body;
  Place strike, pickup;  ///< not used by a ModeTable
  int max_modes;         ///< the modes with the lowest frequencies are kept, at most this number
};

/// Is it a membrane or a circular plate, where places have an angle?
[[nodiscard]] inline bool is_round(const decltype(Resonator::body)& body) {
  return std::holds_alternative<Membrane>(body) || std::holds_alternative<RoundPlate>(body);
}

/// Radius of such a body [m], and the part of a mode's shape that depends on the radius.
[[nodiscard]] double radius_of(const decltype(Resonator::body)& round_body);
[[nodiscard]] double radial_shape(const decltype(Resonator::body)& round_body, int order, double wavenumber_per_m,
                                  double radius_m);

/// "string", "bar", "membrane", "plate", "round_plate" or "modes".
[[nodiscard]] std::string_view name_of(const decltype(Resonator::body)& body);

/// A mode of a body without a place: number 1, 2, ... in a row m of modes, for what is round cos(m angle), for a
/// plate sin(m pi x/length); 0 and the place in the table for a table of modes, and in its modes for a plate with
/// ribs.
struct NumberedMode {
  Mode mode;
  double wavenumber_per_m;  ///< for a string the shape is sin(wavenumber x); 0 in a table of modes
  int row, number;
  bool is_sine = false;  ///< of a circular plate: sin(m angle)
};

/// The part of a round mode's shape that depends on the angle.
[[nodiscard]] double angular_shape(const NumberedMode& mode, double angle_rad);

/// A mode with its shape at the strike and at the pickup.
struct ResonatorMode {
  Mode mode;
  double wavenumber_per_m;  ///< for a string the shape is sin(wavenumber x); 0 in a table of modes
  double strike_shape, pickup_shape;
};

/// Sets of modes by rising frequency. `cut` is true if max_modes excluded some modes below the frequency limit.
struct NumberedModeSet {
  std::vector<NumberedMode> modes;
  bool cut;
};
struct ModeSet {
  std::vector<ResonatorMode> modes;
  bool cut;
};

/// The modes below `max_frequency_hz`, at most resonator.max_modes of them, without overdamped ones (decay above the
/// undamped angular frequency).
[[nodiscard]] ModeSet modes_of(const Resonator& resonator, double max_frequency_hz);

/// The same modes without their shapes: enough for many places on one body.
[[nodiscard]] NumberedModeSet numbered_modes_of(const Resonator& resonator, double max_frequency_hz);

/// The shape of a mode of this resonator under its hammer, and at its pickup.
[[nodiscard]] double strike_shape(const Resonator& resonator, const NumberedMode& mode);
[[nodiscard]] double pickup_shape(const Resonator& resonator, const NumberedMode& mode);

}  // namespace contactspline
