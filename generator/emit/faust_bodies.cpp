// SPDX-License-Identifier: MIT
#include "generator/emit/faust_bodies.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "contactspline/data/mode.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {

FaustBodies::FaustBodies(const InstrumentModel& model, const InstrumentArrays& arrays)
    : model_(model), arrays_(arrays), connections_(arrays.connections), place_bodies_(arrays.place_bodies) {
  // A form is a spring between the ground and a place of its body whose shapes are the form's gradient.
  for (const InstrumentForm& form : arrays.stretch_forms) {
    connections_.push_back({.kind = ConnectionKind::kSpring,
                            .first = place_bodies_.size(),
                            .second = kGround,
                            .stiffness_n_per_m = form.stiffness_j});
    place_bodies_.push_back(form.body);
  }
  for (std::size_t k = 0; k < connections().size(); ++k) list_of(connections()[k].kind).push_back(k);
}

std::vector<std::size_t>& FaustBodies::list_of(ConnectionKind kind) {
  if (kind == ConnectionKind::kContact) return contacts_;
  return kind == ConnectionKind::kFriction ? frictions_ : linear_;
}

std::size_t FaustBodies::control_of(ControlQuantity quantity, std::size_t target) const {
  for (std::size_t c = 0; c < arrays_.controls.size(); ++c) {
    const InstrumentControl& control = arrays_.controls[c];
    if (control.quantity == quantity && std::ranges::count(targets(control.first_target, control.count), target) != 0)
      return c;
  }
  return arrays_.controls.size();
}

void FaustBodies::input(std::string name, std::string expression) {
  inputs_.push_back(std::move(name));
  input_expressions_.push_back(std::move(expression));
}

double FaustBodies::hold_at(std::size_t place) const {
  const auto hold = std::ranges::find(arrays_.holds, place, &HoldingForce::place);
  return hold == arrays_.holds.end() ? 0 : hold->force_n;
}

std::string FaustBodies::force_at(std::size_t place) const {
  FaustSum sum;
  for (std::size_t k = 0; k < connections().size(); ++k) {
    if (connections()[k].second == place) sum.add(name_at("last_force", k));
    if (connections()[k].first == place) sum.add(name_at("last_force", k), true);
  }
  const std::size_t push = control_of(ControlQuantity::kForce, place);
  if (is_control(push)) sum.add(fmt::format("control_{}'", push));
  if (const double hold = hold_at(place); hold != 0) sum.add(fmt::format("({})'", faust_number(hold)));
  return sum.or_zero();
}

std::string FaustBodies::gain_of(std::size_t body) const {
  const std::size_t c = control_of(ControlQuantity::kDamping, body);
  return is_control(c) ? fmt::format("damper_gain_{}", c) : "1.0";
}

double FaustBodies::initial_gap(std::size_t k) const {
  const std::size_t c = control_of(ControlQuantity::kGapShift, k);
  const auto [min, max] = gap_range<double>(connections()[k]);
  return std::clamp(connections()[k].gap_m + (is_control(c) ? arrays_.parameters[c].initial : 0), min, max);
}

std::string FaustBodies::wanted_gap(std::size_t k) const {
  const auto [min, max] = gap_range<double>(connections()[k]);
  return fmt::format("max({}, min({}, {} + control_{}))", faust_number(min), faust_number(max),
                     faust_number(connections()[k].gap_m), control_of(ControlQuantity::kGapShift, k));
}

std::string FaustBodies::mutual(std::size_t p, std::size_t q) const {
  if (p == kGround || q == kGround || place_bodies_[p] != place_bodies_[q]) return "";
  return faust_product(gain_of(place_bodies_[p]),
                       fmt::format("place_receptance_{}_{}", std::min(p, q), std::max(p, q)));
}

std::string FaustBodies::own_receptance(const InstrumentConnection& connection) {
  FaustSum sum;
  for (const std::size_t p : {connection.first, connection.second})
    if (p != kGround) sum.add(fmt::format("place_receptance_{}_{}", p, p));
  return sum.text();
}

std::string FaustBodies::increment_at(std::size_t place) const {
  if (place == kGround) return "";
  FaustSum sum;
  sum.add(fmt::format("place_increment_{}", place));
  for (const std::size_t q : places_[place_bodies_[place]]) {
    const std::size_t push = control_of(ControlQuantity::kForce, q);
    if (is_control(push)) sum.add(faust_product(mutual(place, q), fmt::format("control_{}", push)));
    if (const double hold = hold_at(q); hold != 0) sum.add(faust_product(mutual(place, q), faust_number(hold)));
  }
  return fmt::format("({})", sum.text());
}

std::string FaustBodies::jump_at(std::size_t place, const char* jump) const {
  if (place == kGround || !model_.bodies[place_bodies_[place]].is_mass) return "";
  return name_at(jump, place_bodies_[place]);
}

OutputQuantity FaustBodies::motion_of(const InstrumentOutput& output, std::size_t target) {
  if (output.quantity != OutputQuantity::kPressure) return output.quantity;
  return target == output.first_target ? OutputQuantity::kVelocity : OutputQuantity::kDisplacement;
}

void FaustBodies::list_places() {
  places_.resize(model_.bodies.size());
  const auto list = [&](std::size_t place) {
    if (place == kGround) return;
    auto& of_body = places_[place_bodies_[place]];
    if (std::ranges::count(of_body, place) == 0) of_body.push_back(place);
  };
  for (const InstrumentConnection& connection : connections()) {
    list(connection.first);
    list(connection.second);
  }
  for (const InstrumentControl& control : arrays_.controls)
    if (control.quantity == ControlQuantity::kForce)
      for (const std::size_t place : targets(control.first_target, control.count)) list(place);
  std::size_t begin = 0;
  for (const std::size_t body : arrays_.place_bodies) {
    first_shape_.push_back(begin);
    begin += modes_of(body);
  }
}

void FaustBodies::write_body(std::size_t body) {
  const std::size_t c = control_of(ControlQuantity::kDamping, body);
  const std::string gain = gain_of(body);
  if (is_control(c) && std::ranges::count(inputs_, gain) == 0)
    input(gain, fmt::format("cm.damping_gain(cm.dt * control_{})", c));
  model_.bodies[body].is_mass ? write_mass(body)
  : are_steps_double()        ? write_bank_of_two_samples(body)
                              : write_bank(body);
}

void FaustBodies::add_stretch(const InstrumentOutput& output, std::size_t target, FaustSum& sum) const {
  const std::size_t place = arrays_.targets[target], body = place_bodies_[place];
  const bool is_velocity = motion_of(output, target) == OutputQuantity::kVelocity;
  if (!is_pulled(place, is_velocity)) return;
  const double stiffness_j = connections()[connection_of_form(body)].stiffness_n_per_m;
  sum.add(fmt::format("{} * stretch_{} * pull_{}", literal(stiffness_j), body, target), is_velocity);
}

std::string FaustBodies::damping_of(std::size_t body) const {
  const std::size_t c = control_of(ControlQuantity::kDamping, body);
  return is_control(c) ? fmt::format("control_{}", c) : "0.0";
}

void FaustBodies::write_mass(std::size_t body) {
  const double mass = arrays_.masses[first_mode(body)];
  const std::size_t place =
      static_cast<std::size_t>(std::ranges::find(arrays_.place_bodies, body) - arrays_.place_bodies.begin());
  const auto strike = std::ranges::find(model_.strikes, body);
  const auto s = strike - model_.strikes.begin();
  const bool is_struck = strike != model_.strikes.end();
  if (is_struck) {
    input(fmt::format("is_thrown_{}", s), fmt::format("(strike_{0} > strike_{0}')", s));
    input(fmt::format("throw_speed_{}", s), fmt::format("speed_{}", s));
  }
  for (const std::size_t q : places_[body])
    input(fmt::format("place_receptance_{}_{}", q, q),
          fmt::format("cm.dt * cm.dt / {}", literal(are_steps_double() ? mass : 2 * mass)));
  const std::string moved = fmt::format("{}, {}, {}", literal(mass), force_at(place), gain_of(body));
  std::vector<std::string> signals{fmt::format("place_increment_{}", place), fmt::format("jump_{}", body)};
  if (are_steps_double()) signals.push_back(fmt::format("earlier_jump_{}", body));
  signals.push_back(fmt::format("displacement_{}", body));
  signals.push_back(fmt::format("velocity_{}", body));
  const char* const steps = are_steps_double() ? "_of_two_samples" : "";
  chain_.add(signals, is_struck ? fmt::format("modal.struck_mass{}({}, is_thrown_{}, throw_speed_{}, {}, {})", steps,
                                              moved, s, s, pressed_at(body, &InstrumentConnection::first),
                                              pressed_at(body, &InstrumentConnection::second))
                                : fmt::format("modal.free_mass{}({})", steps, moved));
}

std::string FaustBodies::pressed_at(std::size_t body, std::size_t InstrumentConnection::*end) {
  std::string largest;
  for (const std::size_t k : contacts_) {
    const std::size_t place = connections()[k].*end;
    if (place == kGround || place_bodies_[place] != body) continue;
    const double initial = initial_gap(k);
    std::string pressed = fmt::format("select2(cm.is_first, last_compression_{}, {})", k, faust_number(-initial));
    if (is_control(control_of(ControlQuantity::kGapShift, k))) {
      input(name_at("rest", k), fmt::format("({} : ci.pressed_by_gap({}))", wanted_gap(k), faust_number(initial)));
      pressed += fmt::format(" - rest_{}", k);
    } else if (initial < 0) {
      pressed += fmt::format(" - {}", literal(-initial));
    }
    largest = largest.empty() ? pressed : fmt::format("max({}, {})", largest, pressed);
  }
  return largest.empty() ? "0.0 - 1.0e9" : largest;  // nothing stands in the way
}

void FaustBodies::write_shapes(std::size_t place) {
  if (std::ranges::count(written_shapes_, place) != 0) return;
  written_shapes_.push_back(place);
  bodies_ += fmt::format("shape_{0}(mode) = shape_of_{0}(mode);\n", place);  // rules alone are no argument
  for (std::size_t i = 0; i < modes_of(place_bodies_[place]); ++i)
    bodies_ += fmt::format("shape_of_{}({}) = {};\n", place, i, literal(arrays_.shapes[first_shape_[place] + i]));
}

std::vector<std::pair<std::size_t, OutputQuantity>> FaustBodies::pickups_of(std::size_t body) const {
  std::vector<std::pair<std::size_t, OutputQuantity>> pickups;
  for (const InstrumentOutput& output : arrays_.sources)
    if (output.quantity != OutputQuantity::kForce)
      for (std::size_t t = output.first_target; t < output.first_target + output.count; ++t)
        if (arrays_.place_bodies[arrays_.targets[t]] == body) pickups.emplace_back(t, motion_of(output, t));
  return pickups;
}

void FaustBodies::write_constants(std::size_t body) {
  bodies_ +=
      fmt::format("// {}: angular frequency, decay and modal mass; shapes at its places\n", model_.bodies[body].name);
  const std::size_t begin = first_mode(body);
  for (std::size_t i = 0; i < modes_of(body); ++i)
    bodies_ +=
        fmt::format("constants_{}({}) = {}, {}, {};\n", body, i, literal(arrays_.angular_frequencies[begin + i]),
                    literal(arrays_.decays[begin + i]), literal(arrays_.masses[begin + i]));
}

void FaustBodies::write_bank(std::size_t body) {
  const std::size_t modes = modes_of(body);
  const auto pickups = pickups_of(body);
  const auto& places = places_[body];
  if (places.empty() && pickups.empty()) return;  // a function of no output is no Faust
  write_constants(body);
  std::vector<std::string> forces, weighted, observed, signals, arguments;
  for (std::size_t n = 0; n < places.size(); ++n) {
    write_shapes(places[n]);
    forces.push_back(fmt::format("force_{}", n));
    weighted.push_back(fmt::format("force_{} * shape_{}(i)", n, places[n]));
    observed.push_back(fmt::format("shape_{}(i) * increment", places[n]));
    signals.push_back(fmt::format("place_increment_{}", places[n]));
    arguments.push_back(force_at(places[n]));
  }
  for (const auto& [target, quantity] : pickups) {
    const std::size_t place = arrays_.targets[target];
    write_shapes(place);
    observed.push_back(
        fmt::format("shape_{}(i) * {}", place, quantity == OutputQuantity::kVelocity ? "velocity" : "displacement"));
    signals.push_back(fmt::format("pickup_{}", target));
  }
  for (std::size_t m = 0; m < places.size(); ++m)
    for (std::size_t n = m; n < places.size(); ++n) {
      const auto [p, q] = std::minmax(places[m], places[n]);
      observed.push_back(fmt::format("shape_{}(i) * shape_{}(i) * receptance", p, q));
      signals.push_back(fmt::format("place_receptance_{}_{}", p, q));
    }
  if (modes == 0) {  // all of them are too fast: it does not move
    for (const std::string& signal : signals) chain_.add(signal, "0.0");
    return;
  }
  if (weighted.empty()) weighted.emplace_back("0.0");
  const bool has_velocity =
      std::ranges::any_of(pickups, [](const auto& pickup) { return pickup.second == OutputQuantity::kVelocity; });
  bodies_ += fmt::format(
      "body_{0}({1}{2}gain, damping) =\n  {3}{2}keep(2.0 * cm.dt * damping), keep((0.0 - 0.5) * gain)\n"
      "  <: par(j, {4}, sixteen(j)) :> par(k, {5}, keep)\n"
      "with {{\n"
      "  sixteen(j) = par(k, {6}, _) <: par(i, min(16, {7} - 16 * j), one(16 * j + i)) :> par(k, {5}, keep);\n"
      "  one(i{8}{1}, twice_damping, minus_half_gain) =\n"
      "    {9}, twice_damping, minus_half_gain, constants_{0}(i), (constants_{0}(i) : modal.coefficients)\n"
      "    : modal.bank_mode{11} : observe(i);\n"
      "  observe(i, increment, displacement{12}, receptance) =\n    {10};\n}};\n",
      body, fmt::join(forces, ", "), forces.empty() ? "" : ", ", scaled(forces), (modes + 15) / 16, signals.size(),
      forces.size() + 2, modes, forces.empty() ? "" : ", ", fmt::join(weighted, " + "), fmt::join(observed, ", "),
      has_velocity ? "_with_velocity" : "", has_velocity ? ", velocity" : "");
  arguments.push_back(gain_of(body));
  arguments.push_back(damping_of(body));
  chain_.add(signals, fmt::format("body_{}({})", body, fmt::join(arguments, ", ")));
}

std::string FaustBodies::scaled(const std::vector<std::string>& forces) {
  std::vector<std::string> scaled;
  for (const std::string& force : forces) scaled.push_back(fmt::format("keep(gain' * {})", force));
  return fmt::format("{}", fmt::join(scaled, ", "));
}

void FaustBodies::write_bank_of_two_samples(std::size_t body) {
  const std::size_t modes = modes_of(body), forces = places_[body].size();
  const auto observed = observed_over_two_samples(body);
  if (observed.empty()) return;  // a function of no output is no Faust
  std::vector<std::string> signals, terms, names, scaled, arguments;
  for (const auto& [signal, term] : observed) {
    signals.push_back(signal);
    terms.push_back(term);
  }
  if (modes == 0) {  // all of them are too fast: it does not move
    for (const std::string& signal : signals) chain_.add(signal, "0.0");
    return;
  }
  write_constants(body);
  std::string form = "0.0", square = "0.0";
  FaustSum weighted;
  for (std::size_t n = 0; n < forces; ++n) {
    const std::size_t place = places_[body][n];
    names.push_back(name_at("force", n) + ", ");
    scaled.push_back(fmt::format("keep(gain' * force_{}), ", n));
    arguments.push_back(force_at(place));
    if (is_place_of_form(place))
      form = name_at("force", n), square = fmt::format("square_{}(i)", body);
    else
      weighted.add(fmt::format("force_{} * {}", n, shape_of(place)));
  }
  bodies_ += fmt::format(
      "body_{0}({1}gain, damping) =\n  {2}keep(gain'), keep(cm.dt * damping'), keep(gain), keep(cm.dt * damping)\n"
      "  <: par(j, {3}, sixteen(j)) :> par(k, {4}, keep)\n"
      "with {{\n"
      "  sixteen(j) = par(k, {5}, _) <: par(i, min(16, {6} - 16 * j), one(16 * j + i)) :> par(k, {4}, keep);\n"
      "  one(i, {1}last_gain, last_damping, gain, damping) =\n"
      "    {7}, {8}, last_gain, last_damping, gain, damping, constants_{0}(i), (constants_{0}(i) : "
      "modal.coefficients),\n"
      "    {9} : modal.mode_of_two_samples : observe(i);\n"
      "  observe(i, increment, before, displacement, pickup_gain, velocity, velocity_gain, gradient, receptance) =\n"
      "    {10};\n}};\n",
      body, fmt::join(names, ""), fmt::join(scaled, ""), (modes + 15) / 16, signals.size(), forces + 4, modes,
      weighted.or_zero(), form, square, fmt::join(terms, ", "));
  arguments.push_back(gain_of(body));
  arguments.push_back(damping_of(body));
  chain_.add(signals, fmt::format("body_{}({})", body, fmt::join(arguments, ", ")));
}

std::vector<std::pair<std::string, std::string>> FaustBodies::observed_over_two_samples(std::size_t body) {
  const auto& places = places_[body];
  std::vector<std::pair<std::string, std::string>> observed;
  for (const std::size_t place : places) {
    is_place_of_form(place) ? write_squares(body) : write_shapes(place);
    observed.emplace_back(name_at("place_increment", place), fmt::format("{} * increment", shape_of(place)));
  }
  if (has_form(body)) {
    observed.emplace_back(name_at("compression", connection_of_form(body)), "gradient * before");
    observed.emplace_back(name_at("stretch", body), "gradient * displacement");
  }
  for (const auto& [target, quantity] : pickups_of(body)) {
    const std::size_t place = arrays_.targets[target];
    write_shapes(place);
    const bool is_velocity = quantity == OutputQuantity::kVelocity;
    observed.emplace_back(
        name_at("pickup", target),
        fmt::format("{} * {}", shape_of(place), is_velocity ? "velocity" : "pickup_gain * displacement"));
    if (is_pulled(place, is_velocity)) observed.emplace_back(name_at("pull", target), pull_at(place, is_velocity));
  }
  for (std::size_t m = 0; m < places.size(); ++m)
    for (std::size_t n = m; n < places.size(); ++n) {
      const auto [p, q] = std::minmax(places[m], places[n]);
      observed.emplace_back(fmt::format("place_receptance_{}_{}", p, q),
                            fmt::format("{} * {} * receptance", shape_of(p), shape_of(q)));
    }
  return observed;
}

std::string FaustBodies::shape_of(std::size_t place) const {
  return is_place_of_form(place) ? "gradient" : fmt::format("shape_{}(i)", place);
}

bool FaustBodies::has_form(std::size_t body) const {
  return std::ranges::find(arrays_.stretch_forms, body, &InstrumentForm::body) != arrays_.stretch_forms.end();
}

bool FaustBodies::is_pulled(std::size_t place, bool is_velocity) const {
  return has_form(place_bodies_[place]) && (is_velocity || place >= arrays_.place_bodies.size() - arrays_.far_ends);
}

std::size_t FaustBodies::connection_of_form(std::size_t body) const {
  const auto form = std::ranges::find(arrays_.stretch_forms, body, &InstrumentForm::body);
  return arrays_.connections.size() + static_cast<std::size_t>(form - arrays_.stretch_forms.begin());
}

std::span<const double> FaustBodies::squares_of(std::size_t body) const {
  std::size_t begin = 0;
  for (const InstrumentForm& form : arrays_.stretch_forms) {
    if (form.body == body) break;
    begin += modes_of(form.body);
  }
  return std::span(arrays_.stretch_squares).subspan(begin, modes_of(body));
}

void FaustBodies::write_squares(std::size_t body) {
  const auto squares = squares_of(body);
  bodies_ += fmt::format("square_{0}(mode) = square_of_{0}(mode);\n", body);
  for (std::size_t i = 0; i < squares.size(); ++i)
    bodies_ += fmt::format("square_of_{}({}) = {};\n", body, i, literal(squares[i]));
}

std::string FaustBodies::pull_at(std::size_t place, bool is_velocity) {
  if (is_velocity) return fmt::format("{} * velocity_gain * 0.5 * receptance * gradient", shape_of(place));
  const std::size_t body = place_bodies_[place], begin = first_mode(body);
  const auto squares = squares_of(body);
  bodies_ += fmt::format("pull_shape_{0}(mode) = pull_shape_of_{0}(mode);\n", place);
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const Mode mode{arrays_.angular_frequencies[begin + i], arrays_.decays[begin + i], arrays_.masses[begin + i]};
    bodies_ += fmt::format("pull_shape_of_{}({}) = {};\n", place, i,
                           literal(squares[i] / stiffness_of(mode) * arrays_.shapes[first_shape_[place] + i]));
  }
  return fmt::format("pull_shape_{}(i) * pickup_gain * displacement", place);
}

}  // namespace contactspline
