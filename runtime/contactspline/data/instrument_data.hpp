// SPDX-License-Identifier: MIT
// The arrays that an instrument file becomes: bodies, connections, controls, events, outputs, keys and presets.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "contactspline/data/friction_materials.hpp"
#include "contactspline/data/mode.hpp"
#include "contactspline/data/parameter.hpp"
#include "contactspline/data/stretch_form.hpp"
#include "contactspline/data/stroke.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"
#include "contactspline/step/roughness.hpp"

namespace contactspline {

/// Stands for a place that does not move.
inline constexpr std::size_t kGround = (std::numeric_limits<std::size_t>::max)();

/// Stands for no connection.
inline constexpr std::size_t kNoConnection = (std::numeric_limits<std::size_t>::max)();

enum class ConnectionKind { kContact, kSpring, kLink, kFriction };

/// What rubs, how wide it is across the motion, what presses it, how fast the surface of the first place moves by
/// itself, and the contact whose force presses it, too.
struct InstrumentFriction {
  FrictionMaterial material = {};
  double width_m = 1, normal_force_n = 0, surface_speed_m_per_s = 0;
  std::size_t pressed_by = kNoConnection;
};

/// A connection between two places, kGround for one that does not move.
struct InstrumentConnection {
  ConnectionKind kind;
  std::size_t first, second;
  std::size_t table = 0;  ///< of a contact
  double gap_m = 0;
  double weight = 1, loss_s_per_m = 0;                     ///< of a contact; of friction the part of the normal force
  double stiffness_n_per_m = 0, resistance_n_s_per_m = 0;  ///< of a spring
  InstrumentFriction friction = {};                        ///< of friction; of a rough contact its speed
  double moved_m = 0;                                      ///< gap_m, as it is at rest, less the gap of the file
  Roughness roughness = {};                                ///< of a contact
};

/// The values of a gap with its shift: it and, with the same shift, the gap of the file stay within -0.1 to 0.1.
template <std::floating_point T>
[[nodiscard]] constexpr ControlRange<T> gap_range(const InstrumentConnection& connection) {
  const auto [min, max] = ControlRanges<T>::gap_m;
  const T moved = static_cast<T>(connection.moved_m), least = (std::max)(min, min + moved);
  return {least, (std::max)(least, (std::min)(max, max + moved))};
}

/// What a control sets, with the objects it is for.
enum class ControlQuantity {
  kForce,           ///< on places [N]
  kDamping,         ///< extra decay of bodies [1/s]
  kStiffnessRatio,  ///< of contacts
  kLoss,            ///< of contacts [s/m]
  kGapShift,        ///< of connections: is added to their gaps [m]; the sum is moved into gap_range()
  kStiffness,       ///< of springs [N/m]
  kResistance,      ///< of springs [N s/m]
  kPlace,           ///< where places are on their strings, less their offsets_m [m]
  kMass,            ///< of free masses, from their next throw on [kg]
  kNormalForce,     ///< of friction, of all its points together [N]
  kSurfaceSpeed     ///< of friction and rough contacts [m/s]
};

/// What is known of a quantity that controls set.
template <std::floating_point T>
struct ControlQuantityRow {
  ControlQuantity quantity;
  const char* name;       ///< of its enumerator
  const char* key;        ///< in instrument files
  ControlRange<T> range;  ///< the values that a control may take
  double glide_s;         ///< time constant with which hosts move it; 0: at once. A force and a damping would click
};

/// All quantities, in the order of ControlQuantity.
template <std::floating_point T>
inline constexpr ControlQuantityRow<T> kControlQuantities[] = {
    {ControlQuantity::kForce, "kForce", "force_n", ControlRanges<T>::force_n, 0.005},
    {ControlQuantity::kDamping, "kDamping", "damping_per_s", ControlRanges<T>::damping_per_s, 0.005},
    {ControlQuantity::kStiffnessRatio, "kStiffnessRatio", "stiffness_ratio", ControlRanges<T>::stiffness_ratio, 0},
    {ControlQuantity::kLoss, "kLoss", "loss_s_per_m", ControlRanges<T>::loss_s_per_m, 0},
    {ControlQuantity::kGapShift, "kGapShift", "gap_shift_m", ControlRanges<T>::gap_m, 0},
    {ControlQuantity::kStiffness, "kStiffness", "stiffness_n_per_m", ControlRanges<T>::hand_stiffness_n_per_m, 0},
    {ControlQuantity::kResistance, "kResistance", "resistance_n_s_per_m", ControlRanges<T>::resistance_n_s_per_m, 0},
    {ControlQuantity::kPlace, "kPlace", "place_m", ControlRanges<T>::place_m, 0.02},
    {ControlQuantity::kMass, "kMass", "mass_kg", ControlRanges<T>::mass_kg, 0},
    {ControlQuantity::kNormalForce, "kNormalForce", "normal_force_n", ControlRanges<T>::normal_force_n, 0.005},
    {ControlQuantity::kSurfaceSpeed, "kSurfaceSpeed", "surface_speed_m_per_s", ControlRanges<T>::speed_m_per_s,
     0.005}};

template <std::floating_point T>
[[nodiscard]] constexpr const ControlQuantityRow<T>& control_quantity(ControlQuantity quantity) {
  return kControlQuantities<T>[static_cast<std::size_t>(quantity)];
}

static_assert([] {
  for (const auto& row : kControlQuantities<double>)
    if (&control_quantity<double>(row.quantity) != &row) return false;
  return true;
}());

/// A control of the objects targets[first_target] to targets[first_target + count - 1].
struct InstrumentControl {
  ControlQuantity quantity;
  std::size_t first_target, count;
};

enum class OutputQuantity { kDisplacement, kVelocity, kForce, kPressure, kTension };

/// The sum of displacements or velocities of places, or of forces of connections, over such targets. A pressure has
/// two targets, the velocity of one place and the displacement of another, whose shapes are weights in Pa s/m and
/// Pa/m; to their sum its paths add what forces do at once. A tension is what that of strings that stretch, as
/// bodies, has risen by at their far ends.
struct InstrumentOutput {
  OutputQuantity quantity;
  std::size_t first_target, count;
  double at_rest_n = 0;  ///< of forces: the sum at rest, from which the output counts
};

/// A constant force on a place [N] that balances what presses or pulls there at rest: it stands for the bend of the
/// body, from which displacements are counted.
struct HoldingForce {
  std::size_t place;
  double force_n;
};

/// What a force at a place adds to an output, a pressure: the last forces there, filtered by `taps` taps [Pa/N] of
/// the instrument's, those of one path after those of the other.
struct PressurePath {
  std::size_t output, place, taps;
};

/// Stands for all strings of an instrument, and all other bodies that keys tune.
inline constexpr std::size_t kAllStrings = (std::numeric_limits<std::size_t>::max)();

/// Keys of MIDI from `first` to `last` that play an event. tuned_key: the key at which a string, a body with those
/// tuned with it, or all strings have the pitch of the file; the others tune them, a semitone for each key. -1: the
/// keys tune nothing. per_octave: by how much the parameter of the event is multiplied for each octave above
/// tuned_key.
struct KeyRange {
  int first, last;
  std::size_t event;
  int tuned_key = -1;
  std::size_t string = kAllStrings;
  double per_octave = 1;

  /// By how much a key multiplies the parameter of its event, beside the velocity.
  [[nodiscard]] double strength(int key) const {
    return tuned_key < 0 || per_octave == 1 ? 1 : std::pow(per_octave, (key - tuned_key) / 12.0);
  }
};

/// Connections from `first` on that are one bow: it is up until it is played. The limits are of the sum of its
/// points.
struct InstrumentBow {
  std::size_t first, count;
  BowLimits limits = {};
};

/// Stands for a parameter that an instrument lacks.
inline constexpr std::size_t kNoParameter = (std::numeric_limits<std::size_t>::max)();

/// Keys, tuning and damper of an instrument file. tension_squares: for each mode what the tension adds to w0^2
/// (square_by_tension) [1/s^2], or w^2 where all frequencies of a body go by one ratio; empty: nothing is tuned.
/// far_ends: so many places, the last ones, are far ends of strings, where a displacement is a force. damped: the
/// bodies under the damper. tuned_with: for each body the one that it is tuned with; empty: each by itself.
struct KeyedData {
  std::span<const KeyRange> ranges;
  std::size_t voices = 1;
  std::span<const double> tension_squares;
  std::size_t far_ends = 0;
  std::span<const std::size_t> damped;
  double damper_per_s = 0;
  std::size_t sustain = kNoParameter, bend = kNoParameter;
  std::span<const std::size_t> tuned_with = {};
};

/// A form by which a body stretches (StretchForm), with how many products of two modes it has. end_tension_n: what it
/// adds to the tension at the far end of a string, times s.
struct InstrumentForm {
  std::size_t body;
  double stiffness_j;
  std::size_t products;
  StretchForm::Linear linear = {};
  double end_tension_n = 0;
};

/// What an instrument is made of, as views of arrays that must outlive the instrument. body_ends[b]: number of modes
/// of the bodies 0 to b. place_bodies: the body of each place. shapes: one place after the other; a place has one
/// shape for each mode of its body. table_ends[t]: number of segments of the tables 0 to t. strikes: for each strike
/// the body that it throws, a free mass. plucks: for each pluck the control of its force. parameters: one for each
/// control, then the speed of each strike, then the force of each pluck, then the acceleration of all bows and their
/// assistance, then sustain and bend where keys have them.
/// preset_values: for each preset a value for each parameter. wavenumbers: of the modes, 0 where the body is no
/// string [rad/m]; empty where no place moves. memory_ends[t]: number of memories of the tables 0 to t; empty if no
/// contact has a memory. pressure_rate_hz: sample rate of pressure_taps. holds: empty where nothing is loaded at
/// rest, with the gaps as they are there. stretch_forms: how bodies stretch from where they rest, by rising body;
/// stretch_squares: for each form the squares of all modes of its body; stretch_products: of each form. assistance:
/// the parameter of the bows whose limits are known. input_places: that the input pushes, each by its whole force;
/// input_scale_n: the force that hosts play as 1, 0 without an input. offsets_m: of the places, how far they are from
/// where their control says; empty where all are there. license: SPDX identifier.
struct InstrumentData {
  const char *name, *description, *license;
  std::span<const double> angular_frequencies, decays, masses;
  std::span<const std::size_t> body_ends;
  std::span<const std::size_t> place_bodies;
  std::span<const double> shapes;
  std::span<const double> knots, energies, forces, half_curvatures;
  std::span<const std::size_t> table_ends;
  std::span<const InstrumentConnection> connections;
  std::span<const InstrumentControl> controls;
  std::span<const std::size_t> targets;
  std::span<const std::size_t> strikes, plucks;
  std::span<const InstrumentOutput> sources;
  std::span<const Parameter> parameters;
  std::span<const Event> events;
  std::span<const Output> outputs;
  KeyedData keyed = {};
  std::span<const char* const> preset_names = {};
  std::span<const double> preset_values = {};
  std::span<const double> wavenumbers = {};
  std::span<const Memory> memories = {};
  std::span<const std::size_t> memory_ends = {};
  double pressure_rate_hz = 0;
  std::span<const PressurePath> pressure_paths = {};
  std::span<const double> pressure_taps = {};
  std::span<const HoldingForce> holds = {};
  std::span<const InstrumentForm> stretch_forms = {};
  std::span<const double> stretch_squares = {};
  std::span<const StretchForm::Product> stretch_products = {};
  std::span<const InstrumentBow> bows = {};
  std::size_t assistance = kNoParameter;
  std::span<const std::size_t> input_places = {};
  double input_scale_n = 0;
  std::span<const double> offsets_m = {};

  [[nodiscard]] std::size_t modes_of(std::size_t body) const {
    return body_ends[body] - (body == 0 ? 0 : body_ends[body - 1]);
  }
  /// The part of an array over all modes that belongs to a body.
  [[nodiscard]] std::span<const double> part_of(std::span<const double> numbers, std::size_t body) const {
    return numbers.subspan(body_ends[body] - modes_of(body), modes_of(body));
  }
  /// How a body stretches.
  [[nodiscard]] std::vector<StretchForm> forms_of(std::size_t body) const {
    std::vector<StretchForm> forms;
    const double* square = stretch_squares.data();
    const StretchForm::Product* product = stretch_products.data();
    for (const InstrumentForm& form : stretch_forms) {
      const double* const squares_end = square + modes_of(form.body);
      const StretchForm::Product* const products_end = product + form.products;
      if (form.body == body)
        forms.push_back({form.stiffness_j, {square, squares_end}, {product, products_end}, form.linear});
      square = squares_end, product = products_end;
    }
    return forms;
  }
  [[nodiscard]] std::span<const double> shapes_of(std::size_t place) const {
    std::size_t begin = 0;
    for (std::size_t p = 0; p < place; ++p) begin += modes_of(place_bodies[p]);
    return shapes.subspan(begin, modes_of(place_bodies[place]));
  }
  [[nodiscard]] std::span<const Memory> memories_of(std::size_t table) const {
    if (memory_ends.empty()) return {};
    const std::size_t begin = table == 0 ? 0 : memory_ends[table - 1];
    return memories.subspan(begin, memory_ends[table] - begin);
  }
  [[nodiscard]] std::span<const std::size_t> targets_of(const InstrumentControl& control) const {
    return targets.subspan(control.first_target, control.count);
  }
  [[nodiscard]] std::vector<Mode> modes() const {
    std::vector<Mode> all;
    for (std::size_t i = 0; i < masses.size(); ++i) all.push_back({angular_frequencies[i], decays[i], masses[i]});
    return all;
  }
  /// The values that a parameter may take: those of its list that its quantity allows.
  [[nodiscard]] ControlRange<double> range_of(std::size_t parameter) const {
    const ControlRange<double>& listed = parameters[parameter].allowed;
    if (parameter >= controls.size()) return listed;
    const auto [min, max] = control_quantity<double>(controls[parameter].quantity).range;
    return {(std::max)(min, listed.min), (std::min)(max, listed.max)};
  }
  [[nodiscard]] double first_value(std::size_t control) const {
    return held(0.0, parameters[control].initial, range_of(control));
  }
};

}  // namespace contactspline
