// SPDX-License-Identifier: MIT
// An instrument as its file describes it, and the arrays that the runtime plays.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/contact.hpp"
#include "contactspline/instrument.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// A resonator, or a free mass as a table of one mode with the shape 1.
struct InstrumentBody {
  std::string name;
  Resonator resonator;
  bool is_mass;
};

/// One or more points of a body. On a table of modes it is one point, with its shapes.
struct InstrumentPlace {
  std::string name;
  std::size_t body;
  std::vector<Place> points;
  std::vector<double> shapes = {};  ///< one for each row of a table of modes
};

struct ContactTable {
  std::string material;
  std::vector<Segment<double>> segments;  ///< entry 0 is "out of contact"
};

/// Connections between two lists of points, one of which may be a single point or the ground.
struct ConnectionGroup {
  std::string name;
  InstrumentConnection each;                 ///< first, second: places of the model, or kGround
  std::vector<double> gaps_m, weights = {};  ///< of each connection; weights: of contacts
};

struct ModelControl {
  std::string name;  ///< with its quantity and unit, such as pluck_force_n
  ControlQuantity quantity;
  std::vector<std::size_t> targets;  ///< places, bodies or groups of connections
  double initial;
  Range range;           ///< of its values, within that of its quantity
  double release_n = 0;  ///< of a force that plucks: what it rises to; else 0
};

struct ModelOutput {
  std::string name;  ///< with its quantity and unit, such as bridge_force_n
  OutputQuantity quantity;
  std::vector<std::size_t> targets;  ///< places, groups of connections, or strings whose end force it is
  bool is_end_force = false;         ///< force of a string on its far support
  double full_scale = 1;             ///< the value that plug-ins play as 1
};

struct InstrumentModel {
  std::string name;         ///< lower-case identifier
  std::string description;  ///< one line, may be empty
  std::vector<InstrumentBody> bodies;
  std::vector<InstrumentPlace> places;  ///< those of the masses have the names of the masses
  std::vector<ContactTable> tables;
  std::vector<ConnectionGroup> connections;
  std::vector<ModelControl> controls;
  std::vector<std::size_t> strikes;  ///< bodies, free masses
  std::vector<ModelOutput> outputs;
};

/// "contact", "spring" or "link".
[[nodiscard]] std::string_view name_of(ConnectionKind kind);

/// The name of a strike's speed: BODY_speed_m_per_s.
[[nodiscard]] std::string strike_name(const InstrumentModel& model, std::size_t strike);

/// The values that a control may take, and the key of its quantity: force_n, damping_per_s, ...
[[nodiscard]] Range range_of(ControlQuantity quantity);
[[nodiscard]] const char* key_of(ControlQuantity quantity);

/// Unit of an output: m, m/s or N.
[[nodiscard]] std::string_view unit_of(const ModelOutput& output);

/// The arrays of an instrument, with its modes below a frequency. Their numbers are rounded to 13 digits, so that
/// every machine finds the same.
struct InstrumentArrays {
  std::vector<double> angular_frequencies, decays, masses;
  std::vector<std::size_t> body_ends, place_bodies;
  std::vector<double> shapes;
  std::vector<double> knots, energies, forces, half_curvatures;
  std::vector<std::size_t> table_ends;
  std::vector<InstrumentConnection> connections;
  std::vector<InstrumentControl> controls;
  std::vector<std::size_t> targets, strikes;
  std::vector<InstrumentOutput> outputs;

  [[nodiscard]] InstrumentData view() const;
};

/// The arrays with the modes below max_frequency_hz; a body may have none of them.
[[nodiscard]] InstrumentArrays arrays_of(const InstrumentModel& model, double max_frequency_hz);

/// Tunes all strings by a change of tension, -1200 to 1200 cents; they add to what the file says.
void tune(InstrumentModel& model, double cents);

/// The first body without a mode below max_frequency_hz.
[[nodiscard]] std::optional<std::string> silent_body(const InstrumentModel& model, double max_frequency_hz);

}  // namespace contactspline
