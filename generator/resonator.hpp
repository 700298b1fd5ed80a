// SPDX-License-Identifier: MIT
// Resonators from physical parameters to modes: stiff string, free-free bar, circular membrane, table of modes.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "contactspline/modal.hpp"
#include "contactspline/stiff_string.hpp"

namespace contactspline {

/// Free-free Euler-Bernoulli bar: w0^2 = EI beta^4/mu, cosh(beta L) cos(beta L) = 1. Shapes are 1 at the
/// ends, modal mass M/4. Place: x [m] from one end. The two rigid-body modes are left out.
struct FreeBar {
  double length_m;
  double mass_kg;
  double bending_stiffness_n_m2;
  Losses losses;
};

/// Circular membrane held at its rim: w0 = beta sqrt(T/sigma), beta R a zero of J_m. Shapes J_m(beta r) cos(m angle)
/// about the strike's angle, modal mass sigma times the integral of the shape squared; the sine modes are not struck.
/// Place: radius [m] and angle [rad].
struct Membrane {
  double radius_m;
  double mass_per_area_kg_m2;
  double tension_n_per_m;
  Losses losses;
};

/// Modes as measured or computed elsewhere, with their shapes at the place of the strike and of the pickup.
struct ModeTable {
  struct Row {
    Mode mode;
    double strike_shape, pickup_shape;
  };
  std::vector<Row> rows;
};

/// Where on the resonator; `angle_rad` matters on a membrane only.
struct Place {
  double position_m;
  double angle_rad = 0;
};

struct Resonator {
  std::string name;         ///< lower-case identifier
  std::string description;  ///< one line, may be empty
  std::variant<StiffString, FreeBar, Membrane, ModeTable> body;
  Place strike, pickup;  ///< not used by a ModeTable
  int max_modes;         ///< at most this many are kept, lowest frequencies first
};

/// One mode with what a contact and a listener need to know of it.
struct ResonatorMode {
  Mode mode;
  double wavenumber_per_m;  ///< on a string sin(wavenumber x) is the shape anywhere; 0 in a table of modes
  double strike_shape, pickup_shape;
};

/// Modes below `max_frequency_hz`, rising in frequency, at most resonator.max_modes of them; overdamped ones (decay
/// above the undamped frequency) do not count. `cut` tells whether max_modes left out others.
struct ModeSet {
  std::vector<ResonatorMode> modes;
  bool cut;
};
[[nodiscard]] ModeSet modes_of(const Resonator& resonator, double max_frequency_hz);

/// Parses the text of a resonator file: JSON with comments, SI units in the key names (docs/resonators.md). `file`
/// stands in messages only. Throws BadInput.
[[nodiscard]] Resonator parse_resonator(std::string_view text, std::string_view file);

}  // namespace contactspline
