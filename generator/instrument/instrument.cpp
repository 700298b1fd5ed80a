// SPDX-License-Identifier: MIT
#include "generator/instrument/instrument.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "generator/instrument/static_equilibrium.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

// The digits on which sin() and sqrt() of all machines agree.
double thirteen_digits(double value) {
  return rounded_to(value, 13);
}

// The pitch of the lowest key that tunes, 0 at most.
double lowest_key_cents(const InstrumentModel& model) {
  double lowest = 0;
  for (const KeyRange& range : model.keys.ranges)
    if (range.tuned_key >= 0) lowest = std::min(lowest, 100.0 * (range.first - range.tuned_key));
  return lowest;
}

// Counts displacements, and the forces of outputs, from where the instrument rests.
void count_from_rest(InstrumentArrays& arrays) {
  StaticEquilibrium rest = static_equilibrium(arrays.view());
  for (std::size_t k = 0; k < arrays.connections.size(); ++k) {
    InstrumentConnection& connection = arrays.connections[k];
    connection.moved_m = rest.gaps_m[k] - connection.gap_m;
    connection.gap_m = rest.gaps_m[k];
  }
  for (InstrumentOutput& output : arrays.sources) {
    if (output.quantity != OutputQuantity::kForce) continue;
    for (const std::size_t k : std::span(arrays.targets).subspan(output.first_target, output.count))
      output.at_rest_n += rest.forces_n[k];
    output.at_rest_n = thirteen_digits(output.at_rest_n);
  }
  arrays.holds = std::move(rest.holds);
}

// A body with its pickup at a point of a place.
Resonator picked_up_at(Resonator resonator, const InstrumentPlace& place, const Place& point) {
  resonator.strike = {};
  resonator.pickup = point;
  if (auto* table = std::get_if<ModeTable>(&resonator.body))
    for (std::size_t i = 0; i < place.shapes.size(); ++i) table->rows[i].pickup_shape = place.shapes[i];
  return resonator;
}

// By what the square of a mode's displacement counts in the form of a membrane that stretches [1/m^2]: the mean of
// the squared slope over it (docs/how-it-works/stretching.md).
double stretch_square(const Membrane& membrane, const NumberedMode& mode) {
  return mode.wavenumber_per_m * mode.wavenumber_per_m * mode.mode.mass_kg /
         (membrane.mass_per_area_kg_m2 * area_of(membrane));
}

// Modes of a plate that couple alike follow each other, as the kernels of forms like it: those of one order or, on a
// rectangular plate, of the same symmetries.
void sort_for_forms(const InstrumentBody& body, std::vector<NumberedMode>& modes) {
  if (body.airy_functions == 0) return;
  const bool is_round = std::holds_alternative<RoundPlate>(body.resonator.body);
  std::ranges::stable_sort(modes, {}, [&](const NumberedMode& mode) {
    return 2 * (is_round ? mode.row : mode.row % 2) + (is_round ? int(mode.is_sine) : mode.number % 2);
  });
}

// How a body stretches: a membrane by one form, a plate by one for each Airy function, a string by one for each
// longitudinal mode, too.
std::vector<StretchForm> forms_of(const InstrumentBody& body, std::span<const NumberedMode> modes) {
  if (const auto* plate = std::get_if<Plate>(&body.resonator.body); plate != nullptr && body.airy_functions > 0) {
    std::vector<PlateSine> sines;
    for (const NumberedMode& mode : modes) sines.push_back({mode.row, mode.number});
    return stretch_forms(*plate, body.edges, sines, body.airy_functions);
  }
  if (body.airy_functions > 0) {
    std::vector<RoundPlateMode> of_plate;
    for (const NumberedMode& mode : modes) of_plate.push_back({mode.row, mode.wavenumber_per_m, mode.is_sine});
    return stretch_forms(std::get<RoundPlate>(body.resonator.body), of_plate, body.airy_functions);
  }
  if (!body.stretches()) return {};
  if (const auto* membrane = std::get_if<Membrane>(&body.resonator.body)) {
    StretchForm form{body.stretch_j, {}};
    for (const NumberedMode& mode : modes) form.squares_per_m2.push_back(stretch_square(*membrane, mode));
    return {form};
  }
  std::vector<int> numbers;
  for (const NumberedMode& mode : modes) numbers.push_back(mode.number);
  return stretch_forms(body.as_stretching_string(), numbers);
}

/// Fills the arrays, part after part.
class Flattener {
 public:
  Flattener(const InstrumentModel& model, double max_frequency_hz)
      : model_(model), max_frequency_hz_(max_frequency_hz) {
    arrays_.model = std::make_shared<InstrumentModel>(model);
  }

  InstrumentArrays flatten() {
    for (const InstrumentBody& body : model_.bodies) add_body(body);
    for (const InstrumentPlace& place : model_.places) add_place(place);
    for (const ContactTable& table : model_.tables) add_table(table);
    if (arrays_.memories.empty()) arrays_.memory_ends.clear();
    for (const ConnectionGroup& group : model_.connections) add_group(group);
    for (const ControlTargets& control : model_.controls) add_control(control);
    for (const std::size_t place : model_.input.places) arrays_.input_places.push_back(first_place_[place]);
    add_pressures();
    for (const ModelOutput& output : model_.outputs) add_source(output);
    arrays_.strikes = model_.strikes;
    arrays_.plucks = model_.plucks;
    for (const ModelBow& bow : model_.bows)
      arrays_.bows.push_back({first_connection_[bow.group], model_.connections[bow.group].gaps_m.size(), bow.limits});
    add_tuned();
    add_lists();
    return std::move(arrays_);
  }

 private:
  // Do keys name this body to tune it?
  [[nodiscard]] bool is_tuned_by_name(std::size_t body) const {
    return std::ranges::any_of(model_.keys.tuned, [body](const std::vector<std::size_t>& tuned) {
      return std::ranges::count(tuned, body) > 0;
    });
  }

  // Keys that lower a body bring down modes that lie above the limit.
  [[nodiscard]] double limit_of_tuned_hz() const {
    return max_frequency_hz_ * std::exp2(-lowest_key_cents(model_) / 1200);
  }

  void add_body(const InstrumentBody& body) {
    const auto* string = std::get_if<StiffString>(&body.resonator.body);
    const double ratio = std::exp2(body.tuning_cents / 1200);
    const bool is_tuned = is_tuned_by_name(modes_.size());
    const double limit_hz = (string != nullptr || is_tuned ? limit_of_tuned_hz() : max_frequency_hz_) / ratio;
    modes_.push_back(numbered_modes_of(body.resonator, limit_hz).modes);
    sort_for_forms(body, modes_.back());
    for (NumberedMode& mode : modes_.back()) {
      mode.mode.angular_frequency_rad_per_s *= ratio;
      const double w = mode.mode.angular_frequency_rad_per_s;
      add_mode(mode.mode,
               string != nullptr ? square_by_tension(*string, mode)
               : is_tuned        ? w * w
                                 : 0,
               string == nullptr ? 0 : mode.wavenumber_per_m);
    }
    if (body.longitudinal > 0)
      for (const Mode& mode : longitudinal_modes(body.as_stretching_string())) add_mode(mode, 0, 0);
    arrays_.body_ends.push_back(arrays_.masses.size());
    add_forms(body);
  }

  // Tension moves neither free masses nor longitudinal modes, and no place moves along them.
  void add_mode(const Mode& mode, double square_by_tension, double wavenumber_per_m) {
    if (model_.keys.tune()) arrays_.tension_squares.push_back(thirteen_digits(square_by_tension));
    if (model_.has_movers()) arrays_.wavenumbers.push_back(thirteen_digits(wavenumber_per_m));
    arrays_.angular_frequencies.push_back(thirteen_digits(mode.angular_frequency_rad_per_s));
    arrays_.decays.push_back(thirteen_digits(mode.decay_per_s));
    arrays_.masses.push_back(thirteen_digits(mode.mass_kg));
  }

  void add_forms(const InstrumentBody& body) {
    const std::vector<StretchForm> forms = forms_of(body, modes_.back());
    for (std::size_t k = 0; k < forms.size(); ++k) {
      const auto& [stiffness, squares, products, linear] = forms[k];
      arrays_.stretch_forms.push_back(
          {arrays_.body_ends.size() - 1,
           thirteen_digits(stiffness),
           products.size(),
           {linear.mode, thirteen_digits(linear.factor_per_m)},
           body.axial_stiffness_n > 0 ? thirteen_digits(end_tension_n(body.as_stretching_string(), k)) : 0});
      std::ranges::transform(squares, std::back_inserter(arrays_.stretch_squares), thirteen_digits);
      for (const auto& [first, second, factor] : products)
        arrays_.stretch_products.push_back({first, second, thirteen_digits(factor)});
    }
  }

  void add_place(const InstrumentPlace& place) {
    first_place_.push_back(arrays_.place_bodies.size());
    for (const Place& point : place.points) {
      arrays_.place_bodies.push_back(place.body);
      const Resonator resonator = picked_up_at(model_.bodies[place.body].resonator, place, point);
      for (const NumberedMode& mode : modes_[place.body])
        arrays_.shapes.push_back(thirteen_digits(pickup_shape(resonator, mode)));
      end_shapes(place.body);
    }
  }

  // Nothing acts on longitudinal modes but how their string stretches.
  void end_shapes(std::size_t body) {
    arrays_.shapes.resize(arrays_.shapes.size() + model_.bodies[body].longitudinal, 0.0);
  }

  void add_table(const ContactTable& table) {
    for (const Segment<double>& segment : std::span(table.segments).subspan(1)) {
      arrays_.knots.push_back(segment.knot);
      arrays_.energies.push_back(segment.energy);
      arrays_.forces.push_back(segment.force);
      arrays_.half_curvatures.push_back(segment.half_curvature);
    }
    arrays_.table_ends.push_back(arrays_.knots.size());
    arrays_.memories.insert(arrays_.memories.end(), table.memories.begin(), table.memories.end());
    arrays_.memory_ends.push_back(arrays_.memories.size());
  }

  // Point i of a place, or its only point.
  [[nodiscard]] std::size_t point(std::size_t place, std::size_t i) const {
    if (place == kGround) return kGround;
    return first_place_[place] + (model_.places[place].points.size() == 1 ? 0 : i);
  }

  // The points of friction share its force and its width.
  void add_group(const ConnectionGroup& group) {
    first_connection_.push_back(arrays_.connections.size());
    const auto points = static_cast<double>(group.gaps_m.size());
    for (std::size_t i = 0; i < group.gaps_m.size(); ++i) {
      InstrumentConnection connection = group.each;
      connection.first = point(group.each.first, i);
      connection.second = point(group.each.second, i);
      connection.gap_m = group.gaps_m[i];
      if (!group.weights.empty()) connection.weight = group.weights[i];
      if (group.each.kind == ConnectionKind::kFriction) {
        connection.weight = 1 / points;
        connection.friction.normal_force_n /= points;
        connection.friction.width_m /= points;
      }
      if (std::size_t& contact = connection.friction.pressed_by; contact != kNoConnection)
        contact = first_connection_[contact] + i;
      arrays_.connections.push_back(connection);
    }
  }

  void add_control(const ControlTargets& control) {
    const std::size_t begin = arrays_.targets.size();
    for (const std::size_t target : control.targets) {
      if (control.quantity == ControlQuantity::kForce) {
        arrays_.targets.push_back(first_place_[target]);
      } else if (control.quantity == ControlQuantity::kPlace) {
        add_moving_points(target);
      } else if (control.quantity == ControlQuantity::kDamping || control.quantity == ControlQuantity::kMass) {
        arrays_.targets.push_back(target);
      } else {
        add_connections(target);
      }
    }
    arrays_.controls.push_back({control.quantity, begin, arrays_.targets.size() - begin});
  }

  // A control sets the middle of the points of a place, which keep their distances.
  void add_moving_points(std::size_t place) {
    const InstrumentPlace& moved = model_.places[place];
    if (moved.points.size() > 1) arrays_.offsets_m.resize(arrays_.place_bodies.size());
    for (std::size_t i = 0; i < moved.points.size(); ++i) {
      const std::size_t point = first_place_[place] + i;
      arrays_.targets.push_back(point);
      if (moved.points.size() > 1)
        arrays_.offsets_m[point] = thirteen_digits(moved.points[i].position_m - moved.middle_m());
    }
  }

  // The points of a body where something acts.
  [[nodiscard]] std::vector<std::size_t> driven_places(std::size_t body) const {
    std::vector<std::size_t> driven;
    const auto add = [&](std::size_t place) {
      if (place != kGround && arrays_.place_bodies[place] == body && std::ranges::count(driven, place) == 0)
        driven.push_back(place);
    };
    for (const InstrumentConnection& connection : arrays_.connections) {
      add(connection.first);
      add(connection.second);
    }
    for (const InstrumentControl& control : arrays_.controls)
      if (control.quantity == ControlQuantity::kForce)
        for (std::size_t i = 0; i < control.count; ++i) add(arrays_.targets[control.first_target + i]);
    for (const std::size_t place : arrays_.input_places) add(place);
    return driven;
  }

  // Two places for the weights of each pressure, and its paths. All listening places leave out the same time.
  void add_pressures() {
    first_pressure_place_.assign(model_.outputs.size(), 0);
    if (std::ranges::count(model_.outputs, OutputQuantity::kPressure, &ModelOutput::quantity) == 0) return;
    double nearest_m = std::numeric_limits<double>::max();
    for (const ModelOutput& output : model_.outputs)
      if (output.quantity == OutputQuantity::kPressure)
        nearest_m = std::min(
            nearest_m, reach_of(model_.bodies[output.targets.front()].resonator.body, output.listening).nearest_m);
    arrays_.pressure_rate_hz = 2 * max_frequency_hz_;
    const RadiationTiming timing = radiation_timing(nearest_m, arrays_.pressure_rate_hz);
    for (std::size_t o = 0; o < model_.outputs.size(); ++o)
      if (model_.outputs[o].quantity == OutputQuantity::kPressure) add_pressure(o, timing);
  }

  void add_pressure(std::size_t output, const RadiationTiming& timing) {
    const std::size_t body = model_.outputs[output].targets.front();
    first_pressure_place_[output] = arrays_.place_bodies.size();
    const std::vector<std::size_t> places = driven_places(body);
    const InstrumentData data = arrays_.view();
    std::vector<std::vector<double>> driven;
    for (const std::size_t place : places) {
      const auto shapes = data.shapes_of(place);
      driven.emplace_back(shapes.begin(), shapes.end());
    }
    Resonator resonator = model_.bodies[body].resonator;
    resonator.strike = {};  // the places of an instrument count angles from 0
    const Radiation radiation =
        rounded(radiation_of(resonator, modes_[body], model_.outputs[output].listening, timing, driven));
    for (const auto* weights : {&radiation.of_velocity, &radiation.of_displacement}) {
      arrays_.place_bodies.push_back(body);
      std::ranges::copy(*weights, std::back_inserter(arrays_.shapes));
    }
    for (std::size_t d = 0; d < places.size(); ++d) {
      arrays_.pressure_paths.push_back({output, places[d], radiation.taps[d].size()});
      std::ranges::copy(radiation.taps[d], std::back_inserter(arrays_.pressure_taps));
    }
  }

  void add_source(const ModelOutput& output) {
    const std::size_t begin = arrays_.targets.size();
    if (output.quantity == OutputQuantity::kPressure) {
      const std::size_t place = first_pressure_place_[arrays_.sources.size()];
      arrays_.targets.insert(arrays_.targets.end(), {place, place + 1});
      arrays_.sources.push_back({output.quantity, begin, 2});
      return;
    }
    for (const std::size_t target : output.targets) {
      if (output.quantity == OutputQuantity::kForce)
        add_connections(target);
      else if (output.quantity == OutputQuantity::kTension)
        arrays_.targets.push_back(target);
      else
        arrays_.targets.push_back(output.is_end_force ? add_end(target) : first_place_[target]);
    }
    arrays_.sources.push_back({output.quantity, begin, arrays_.targets.size() - begin});
  }

  // Bodies that are tuned alone need no list.
  void add_tuned() {
    for (const std::vector<std::size_t>& tuned : model_.keys.tuned) {
      if (tuned.size() == 1) continue;
      for (std::size_t b = arrays_.tuned_with.size(); b < model_.bodies.size(); ++b) arrays_.tuned_with.push_back(b);
      for (const std::size_t body : tuned) arrays_.tuned_with[body] = tuned.front();
    }
  }

  // What hosts see, with the names of the model that the arrays keep.
  void add_lists() {
    const InstrumentModel& kept = *arrays_.model;
    for (const ModelParameter& p : kept.parameters)
      arrays_.parameters.push_back({p.name.c_str(), p.unit.c_str(), p.allowed, p.slider, p.initial, p.scale, p.acts,
                                    p.glide_s, p.controller, p.step_samples});
    for (const ModelEvent& e : kept.events) arrays_.events.push_back({e.name.c_str(), e.kind, e.number, e.parameter});
    for (const ModelOutput& o : kept.outputs)
      arrays_.outputs.push_back({o.name.c_str(), unit_of(o.name).data(), o.full_scale});
    for (const ModelPreset& preset : kept.presets) {
      arrays_.preset_names.push_back(preset.name.c_str());
      std::ranges::copy(preset.values, std::back_inserter(arrays_.preset_values));
    }
  }

  void add_connections(std::size_t group) {
    for (std::size_t i = 0; i < model_.connections[group].gaps_m.size(); ++i)
      arrays_.targets.push_back(first_connection_[group] + i);
  }

  // A place whose displacement is the force on the far end of a string.
  std::size_t add_end(std::size_t body) {
    const Resonator& resonator = model_.bodies[body].resonator;
    ++arrays_.far_ends;
    for (const NumberedMode& mode : modes_[body])
      arrays_.shapes.push_back(thirteen_digits(bridge_shape(std::get<StiffString>(resonator.body), mode)));
    end_shapes(body);
    arrays_.place_bodies.push_back(body);
    return arrays_.place_bodies.size() - 1;
  }

  const InstrumentModel& model_;
  double max_frequency_hz_;
  InstrumentArrays arrays_;
  std::vector<std::vector<NumberedMode>> modes_;             // of each body: its places have them all
  std::vector<std::size_t> first_place_, first_connection_;  // one for each place, one for each group
  std::vector<std::size_t> first_pressure_place_;            // one for each output
};

}  // namespace

std::string_view kind_of(const InstrumentBody& body) {
  return body.is_mass ? "mass" : name_of(body.resonator.body);
}

double position_of(const Place& point) {
  return std::cos(point.angle_rad) < 0 ? -point.position_m : point.position_m;
}

std::string_view name_of(ConnectionKind kind) {
  constexpr std::array kNames = {"contact", "spring", "link", "friction"};  // in the order of ConnectionKind
  return kNames[static_cast<std::size_t>(kind)];
}

Range range_of(ControlQuantity quantity) {
  const auto [min, max] = control_quantity<double>(quantity).range;
  return {min, max};
}

InstrumentData InstrumentArrays::view() const {
  return {.name = model->name.c_str(),
          .description = model->description.c_str(),
          .license = model->license.c_str(),
          .angular_frequencies = angular_frequencies,
          .decays = decays,
          .masses = masses,
          .body_ends = body_ends,
          .place_bodies = place_bodies,
          .shapes = shapes,
          .knots = knots,
          .energies = energies,
          .forces = forces,
          .half_curvatures = half_curvatures,
          .table_ends = table_ends,
          .connections = connections,
          .controls = controls,
          .targets = targets,
          .strikes = strikes,
          .plucks = plucks,
          .sources = sources,
          .parameters = parameters,
          .events = events,
          .outputs = outputs,
          .keyed = {.ranges = model->keys.ranges,
                    .voices = model->keys.voices,
                    .tension_squares = tension_squares,
                    .far_ends = far_ends,
                    .damped = model->keys.damped,
                    .damper_per_s = model->keys.damper_per_s,
                    .sustain = model->keys.sustain,
                    .bend = model->keys.bend,
                    .tuned_with = tuned_with},
          .preset_names = preset_names,
          .preset_values = preset_values,
          .wavenumbers = wavenumbers,
          .memories = memories,
          .memory_ends = memory_ends,
          .pressure_rate_hz = pressure_rate_hz,
          .pressure_paths = pressure_paths,
          .pressure_taps = pressure_taps,
          .holds = holds,
          .stretch_forms = stretch_forms,
          .stretch_squares = stretch_squares,
          .stretch_products = stretch_products,
          .bows = bows,
          .assistance = model->assistance,
          .input_places = input_places,
          .input_scale_n = model->input.full_scale_n,
          .offsets_m = offsets_m};
}

double effective_mass(const InstrumentModel& model, std::size_t place, std::size_t point, bool moves) {
  constexpr int kLowest = 64;
  constexpr double kMaxFrequency_hz = 384e3;  // half of the highest sample rate
  const InstrumentPlace& at = model.places[place];
  Resonator resonator = model.bodies[at.body].resonator;
  if (!std::holds_alternative<ModeTable>(resonator.body))
    resonator.max_modes = std::min(resonator.max_modes, kLowest);
  double motion_per_impulse = 0;
  for (const ResonatorMode& mode : modes_of(picked_up_at(resonator, at, at.points[point]), kMaxFrequency_hz).modes)
    motion_per_impulse += (moves ? 1 : mode.pickup_shape * mode.pickup_shape) / mode.mode.mass_kg;
  return 1 / motion_per_impulse;
}

InstrumentArrays arrays_of(const InstrumentModel& model, double max_frequency_hz) {
  InstrumentArrays arrays = Flattener(model, max_frequency_hz).flatten();
  count_from_rest(arrays);
  return arrays;
}

void tune(InstrumentModel& model, double cents) {
  for (InstrumentBody& body : model.bodies)
    if (auto* string = std::get_if<StiffString>(&body.resonator.body)) string->detuning_cents.front() += cents;
  for (const std::vector<std::size_t>& tuned : model.keys.tuned)
    for (const std::size_t b : tuned)
      if (!std::holds_alternative<StiffString>(model.bodies[b].resonator.body)) model.bodies[b].tuning_cents += cents;
}

InstrumentModel without_keys(InstrumentModel model) {
  const std::size_t rest = std::min({model.parameters.size(), model.keys.sustain, model.keys.bend});
  model.parameters.erase(model.parameters.begin() + std::ptrdiff_t(rest), model.parameters.end());
  for (ModelPreset& preset : model.presets) preset.values.resize(rest);
  model.keys = {};
  return model;
}

std::optional<std::string> silent_body(const InstrumentModel& model, double max_frequency_hz) {
  for (const InstrumentBody& body : model.bodies)
    if (modes_of(body.resonator, max_frequency_hz).modes.empty()) return body.name;
  return {};
}

}  // namespace contactspline
