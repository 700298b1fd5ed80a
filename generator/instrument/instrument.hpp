// SPDX-License-Identifier: MIT
// An instrument as its file describes it, and the arrays that the runtime plays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/step/contact.hpp"
#include "generator/resonator/plate_stretching.hpp"
#include "generator/resonator/radiation.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/resonator/string_stretching.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

struct ModelModule;

/// A resonator, or a free mass as a table of one mode with the shape 1.
struct InstrumentBody {
  std::string name;
  Resonator resonator;
  bool is_mass;
  double stretch_j = 0;          ///< of a membrane: stiffness of its form (StretchForm); 0: it does not stretch
  double axial_stiffness_n = 0;  ///< of a string that stretches
  std::size_t longitudinal = 0;  ///< of such a string: number of modes along itself
  Losses longitudinal_losses = {};
  std::size_t airy_functions = 0;        ///< of a plate: number of its forms
  PlateEdges edges = PlateEdges::kFree;  ///< of a rectangular plate that stretches
  double tuning_cents = 0;               ///< of all frequencies of a body that is no string

  [[nodiscard]] bool stretches() const { return stretch_j > 0 || axial_stiffness_n > 0 || airy_functions > 0; }
  /// Precondition: a string.
  [[nodiscard]] StretchingString as_stretching_string() const {
    return {std::get<StiffString>(resonator.body), axial_stiffness_n, longitudinal, longitudinal_losses};
  }
};

/// One or more points of a body. On a table of modes it is one point, with its shapes.
struct InstrumentPlace {
  std::string name;
  std::size_t body;
  std::vector<Place> points;
  std::vector<double> shapes = {};  ///< one for each row of a table of modes

  /// Of points along a string: the mean of their positions, which a control sets [m].
  [[nodiscard]] double middle_m() const {
    double sum = 0;
    for (const Place& point : points) sum += point.position_m;
    return sum / static_cast<double>(points.size());
  }
};

struct ContactTable {
  std::string material;
  std::vector<Segment<double>> segments;  ///< entry 0 is "out of contact"
  std::vector<Memory> memories = {};
};

/// Connections between two lists of points, one of which may be a single point or the ground.
struct ConnectionGroup {
  std::string name;
  InstrumentConnection each;                 ///< first, second: places of the model, or kGround
  std::vector<double> gaps_m, weights = {};  ///< one for each connection; weights of contacts only
};

/// What a control sets.
struct ControlTargets {
  ControlQuantity quantity;
  std::vector<std::size_t> targets;  ///< places, bodies or groups of connections
};

using ModelParameter = BasicParameter<std::string>;
using ModelEvent = BasicEvent<std::string>;

struct ModelOutput {
  std::string name;  ///< with its quantity and unit, such as bridge_force_n
  OutputQuantity quantity;
  std::vector<std::size_t>
      targets;                ///< places, groups of connections, strings whose end force it is, a body that radiates
  bool is_end_force = false;  ///< force of a string on its far support
  double full_scale = 1;      ///< the value that plug-ins play as 1
  ListeningPlace listening = {};  ///< of a pressure
};

/// What an input of audio pushes.
struct ModelInput {
  std::vector<std::size_t> places;  ///< none: there is no input
  double full_scale_n = 0;          ///< the force that plug-ins play as 1
};

struct ModelPreset {
  std::string name;
  std::vector<double> values;  ///< one for each parameter
};

/// A group of connections, a friction.
struct ModelBow {
  std::size_t group;
  BowLimits limits = {};
};

/// What keys play, and on how many copies of the instrument.
struct ModelKeys {
  std::vector<KeyRange> ranges;  ///< by rising key; none: the instrument has no keys of its own
  std::size_t voices = 1;
  std::vector<std::size_t> damped;  ///< bodies
  double damper_per_s = 0;
  std::size_t sustain = kNoParameter, bend = kNoParameter;
  std::vector<std::vector<std::size_t>> tuned;  ///< bodies that rows name, to tune together

  [[nodiscard]] bool tune() const {
    return std::ranges::any_of(ranges, [](const KeyRange& range) { return range.tuned_key >= 0; });
  }
};

struct InstrumentModel {
  /// Does a control move any place?
  [[nodiscard]] bool has_movers() const {
    return std::ranges::any_of(
        controls, [](const ControlTargets& control) { return control.quantity == ControlQuantity::kPlace; });
  }
  /// The first body that stretches; none: nullptr.
  [[nodiscard]] const InstrumentBody* stretching_body() const {
    const auto found = std::ranges::find_if(bodies, &InstrumentBody::stretches);
    return found == bodies.end() ? nullptr : &*found;
  }

  std::string name;         ///< lower-case identifier
  std::string description;  ///< one line, may be empty
  std::string license;      ///< SPDX identifier
  std::vector<InstrumentBody> bodies;
  std::vector<InstrumentPlace> places;  ///< those of the masses have the names of the masses
  std::vector<ContactTable> tables;
  std::vector<ConnectionGroup> connections;
  std::vector<ControlTargets> controls;
  std::vector<std::size_t> strikes;  ///< bodies, free masses
  std::vector<std::size_t> plucks;   ///< controls of forces
  std::vector<ModelBow> bows;
  std::size_t assistance = kNoParameter;
  std::vector<ModelParameter> parameters;  ///< as in InstrumentData
  std::vector<ModelEvent> events;          ///< strikes, plucks, bows
  std::vector<ModelOutput> outputs;
  ModelInput input = {};
  ModelKeys keys = {};
  std::vector<ModelPreset> presets = {};
  const ModelModule* module = nullptr;  ///< a class of the user's that plays; then bodies and controls are empty
};

/// The kind of a body: of a resonator, or "mass".
[[nodiscard]] std::string_view kind_of(const InstrumentBody& body);

/// Distance from the middle of a membrane, negative on its other side, or from an end of another body [m].
[[nodiscard]] double position_of(const Place& point);

/// "contact", "spring", "link" or "friction".
[[nodiscard]] std::string_view name_of(ConnectionKind kind);

/// The values that a control may take.
[[nodiscard]] Range range_of(ControlQuantity quantity);

/// The arrays of an instrument, with its modes below a frequency. Their numbers are rounded to 13 digits, so that
/// every machine finds the same.
struct InstrumentArrays {
  std::vector<double> angular_frequencies, decays, masses;
  std::vector<std::size_t> body_ends, place_bodies;
  std::vector<double> shapes;
  std::vector<double> wavenumbers;  ///< of the modes; empty unless places move
  std::vector<double> knots, energies, forces, half_curvatures;
  std::vector<std::size_t> table_ends;
  std::vector<Memory> memories;
  std::vector<std::size_t> memory_ends;  ///< empty if no table has a memory
  std::vector<InstrumentConnection> connections;
  std::vector<InstrumentControl> controls;
  std::vector<std::size_t> targets, strikes, plucks;
  std::vector<InstrumentOutput> sources;
  std::vector<Parameter> parameters;
  std::vector<Event> events;
  std::vector<Output> outputs;
  std::vector<double> tension_squares;  ///< of the modes; empty unless keys tune them
  std::vector<std::size_t> tuned_with;  ///< as in KeyedData
  std::size_t far_ends = 0;             ///< the last places are far ends of strings
  std::vector<const char*> preset_names;
  std::vector<double> preset_values;
  double pressure_rate_hz = 0;
  std::vector<PressurePath> pressure_paths;
  std::vector<double> pressure_taps;
  std::vector<HoldingForce> holds;
  std::vector<InstrumentForm> stretch_forms;
  std::vector<double> stretch_squares;
  std::vector<StretchForm::Product> stretch_products;
  std::vector<InstrumentBow> bows;
  std::vector<std::size_t> input_places;
  std::vector<double> offsets_m;                 ///< empty unless a control moves several points together
  std::shared_ptr<const InstrumentModel> model;  ///< with the text of all names

  [[nodiscard]] InstrumentData view() const;
};

/// Mass that a force at a point of a place moves at first [kg]: 1/(sum of shape^2/mass), over all rows of a table of
/// modes or the lowest 64 modes of another body, up to 384 kHz. Infinite where no mode moves. moves: the least mass
/// anywhere on a string, where all shapes are at most 1.
[[nodiscard]] double effective_mass(const InstrumentModel& model, std::size_t place, std::size_t point,
                                    bool moves = false);

/// The arrays with the modes below max_frequency_hz; a body may have none of them.
[[nodiscard]] InstrumentArrays arrays_of(const InstrumentModel& model, double max_frequency_hz);

/// Tunes all strings by a change of tension, -1200 to 1200 cents; they add to what the file says.
void tune(InstrumentModel& model, double cents);

/// One copy of the instrument without keys: its parameters lack the pedal and the bend, which are the last ones.
[[nodiscard]] InstrumentModel without_keys(InstrumentModel model);

/// The first body without a mode below max_frequency_hz.
[[nodiscard]] std::optional<std::string> silent_body(const InstrumentModel& model, double max_frequency_hz);

}  // namespace contactspline
