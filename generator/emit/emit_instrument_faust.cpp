// SPDX-License-Identifier: MIT
#include "generator/emit/emit_instrument_faust.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/instrument/sliders.hpp"
#include "contactspline/step/contact.hpp"
#include "generator/emit/emit_material.hpp"
#include "generator/emit/faust_chain.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

// With these a program compiles within 3 s (docs/reference/instruments.md).
constexpr std::size_t kMaxContacts = 6;
constexpr std::size_t kMaxLinear = 8;  // springs and links
constexpr std::size_t kMaxModes = 400;
constexpr int kSteps = 5;  // contact steps of several contacts that act on each other; between them Newton steps

// A number that may stand in a product or a sum. Faust takes "-1" for a unary minus only after an operator.
std::string number(double value) {
  return value < 0 ? fmt::format("(0.0 - {})", literal(-value)) : literal(value);
}

// A sum, term after term; empty for 0.
class Sum {
 public:
  Sum& add(const std::string& term, bool is_negative = false) {
    if (term.empty()) return *this;
    if (text_.empty() && is_negative) text_ = "0.0";
    text_ += text_.empty() ? term : fmt::format(" {} {}", is_negative ? "-" : "+", term);
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::string or_zero() const { return text_.empty() ? "0.0" : text_; }

 private:
  std::string text_;
};

std::string product(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return "";
  return a == "1.0" ? b : b == "1.0" ? a : fmt::format("{} * {}", a, b);
}

std::string kept(const std::string& expression) {
  return expression.empty() ? "" : fmt::format("keep({})", expression);
}

std::string slider(std::size_t order, const ModelParameter& parameter) {
  const auto [min, max] = parameter.slider;
  return fmt::format("hslider(\"[{}]{}{}{}\", {}, {}, {}, {})", order, parameter.name,
                     parameter.scale == Scale::kLogarithmic ? "[scale:log]" : "",
                     parameter.unit.empty() ? "" : fmt::format("[unit:{}]", parameter.unit),
                     literal(parameter.initial), literal(min), literal(max), literal(slider_step(parameter)));
}

/// Writes an instrument, part after part.
class Writer {
 public:
  Writer(const InstrumentModel& model, const InstrumentArrays& arrays) : model_(model), arrays_(arrays) {
    for (std::size_t k = 0; k < connections().size(); ++k)
      (connections()[k].kind == ConnectionKind::kContact ? contacts_ : linear_).push_back(k);
  }

  TemplateValues write() {
    write_sliders();
    write_materials();
    list_places();
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) write_body(b);
    write_connections();
    solve_linear();
    reduce();
    search();
    TemplateValues values = finish();
    values["SLIDERS"] = sliders_;
    values["MATERIALS"] = materials_;
    values["BODIES"] = bodies_;
    values["FUNCTIONS"] = functions_;
    return values;
  }

 private:
  [[nodiscard]] const std::vector<InstrumentConnection>& connections() const { return arrays_.connections; }
  [[nodiscard]] std::span<const std::size_t> targets(std::size_t first, std::size_t count) const {
    return std::span(arrays_.targets).subspan(first, count);
  }

  // Their number, for a contact.
  [[nodiscard]] std::size_t memories_of(std::size_t k) const {
    return model_.tables[connections()[k].table].memories.size();
  }

  // An input of the loop, computed outside.
  void input(std::string name, std::string expression) {
    inputs_.push_back(std::move(name));
    input_expressions_.push_back(std::move(expression));
  }

  // The control of this quantity for a body, place or connection; none: the number of controls.
  [[nodiscard]] std::size_t control_of(ControlQuantity quantity, std::size_t target) const {
    for (std::size_t c = 0; c < arrays_.controls.size(); ++c) {
      const InstrumentControl& control = arrays_.controls[c];
      if (control.quantity == quantity &&
          std::ranges::count(targets(control.first_target, control.count), target) != 0)
        return c;
    }
    return arrays_.controls.size();
  }
  [[nodiscard]] bool is_control(std::size_t c) const { return c < arrays_.controls.size(); }

  void write_sliders() {
    const auto& parameters = model_.parameters;
    const auto& events = model_.events;
    std::size_t order = 0;
    for (const auto& [is_button, number] :
         sliders_of(std::span<const ModelParameter>(parameters), std::span<const ModelEvent>(events))) {
      if (is_button)
        sliders_ += fmt::format("{} = button(\"[{}]{}[midi:key {}]\");\n", button_name(events[number]), order,
                                events[number].name, key_of_button(number));
      else
        sliders_ += fmt::format("{} = {};\n", parameter_name(number), shown_parameter(order, number));
      ++order;
    }
    for (std::size_t c = 0; c < model_.controls.size(); ++c)
      input(fmt::format("control_{}", c), fmt::format("control_{}", c));
  }

  static std::string button_name(const ModelEvent& event) {
    return fmt::format("{}_{}", event.kind == EventKind::kStrike ? "strike" : "pluck", event.number);
  }

  // control_2, speed_0 or release_1.
  [[nodiscard]] std::string parameter_name(std::size_t number) const {
    for (const ModelEvent& event : model_.events)
      if (event.parameter == number)
        return fmt::format("{}_{}", event.kind == EventKind::kStrike ? "speed" : "release", event.number);
    return fmt::format("control_{}", number);
  }

  // The slider of a parameter, how it glides, and the plucks that add to it.
  [[nodiscard]] std::string shown_parameter(std::size_t order, std::size_t index) const {
    const ModelParameter& parameter = model_.parameters[index];
    std::string text = slider(order, parameter);
    if (parameter.glide_s > 0) text += fmt::format(" : ci.glide({})", literal(parameter.glide_s));
    for (std::size_t p = 0; p < model_.plucks.size(); ++p)
      if (model_.plucks[p] == index)
        text = fmt::format("({}) + ci.pluck(release_{}, pluck_{}) : max({}) : min({})", text, p, p,
                           number(parameter.allowed.min), number(parameter.allowed.max));
    return text;
  }

  void write_materials() {
    for (std::size_t t = 0, begin = 0; t < arrays_.table_ends.size(); begin = arrays_.table_ends[t++]) {
      const std::size_t size = arrays_.table_ends[t] - begin;
      materials_ += fmt::format("// {}\nmaterial_{} = environment {{\n  segments = {};\n  probes = {};\n",
                                model_.tables[t].material, t, size, std::bit_width(size));
      for (const auto& [name, column] : {std::pair("knot", &arrays_.knots),
                                         {"energy", &arrays_.energies},
                                         {"force", &arrays_.forces},
                                         {"half_curvature", &arrays_.half_curvatures}})
        materials_ += fmt::format("  {}(index) = rdtable(waveform{{0.0,\n{}}}, int(index));\n", name,
                                  literal_rows(std::span(*column).subspan(begin, size), 4));
      materials_ += faust_memory(model_.tables[t].memories, "  ") + "};\n";
    }
  }

  // The places at which forces act, of each body.
  void list_places() {
    places_.resize(model_.bodies.size());
    const auto list = [&](std::size_t place) {
      if (place == kGround) return;
      auto& of_body = places_[arrays_.place_bodies[place]];
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

  [[nodiscard]] std::size_t first_mode(std::size_t body) const { return body == 0 ? 0 : arrays_.body_ends[body - 1]; }
  [[nodiscard]] std::size_t modes_of(std::size_t body) const { return arrays_.body_ends[body] - first_mode(body); }

  // Gain and extra decay of a body's damper.
  [[nodiscard]] std::string gain_of(std::size_t body) const {
    const std::size_t c = control_of(ControlQuantity::kDamping, body);
    return is_control(c) ? fmt::format("damper_gain_{}", c) : "1.0";
  }
  [[nodiscard]] std::string damping_of(std::size_t body) const {
    const std::size_t c = control_of(ControlQuantity::kDamping, body);
    return is_control(c) ? fmt::format("control_{}", c) : "0.0";
  }

  // Force of the last sample at a place.
  [[nodiscard]] std::string force_at(std::size_t place) const {
    Sum sum;
    for (std::size_t k = 0; k < connections().size(); ++k) {
      if (connections()[k].second == place) sum.add(name_at("last_force", k));
      if (connections()[k].first == place) sum.add(name_at("last_force", k), true);
    }
    const std::size_t push = control_of(ControlQuantity::kForce, place);
    if (is_control(push)) sum.add(fmt::format("control_{}'", push));
    if (const double hold = hold_at(place); hold != 0) sum.add(fmt::format("({})'", number(hold)));
    return sum.or_zero();
  }

  // What holds a place at rest [N].
  [[nodiscard]] double hold_at(std::size_t place) const {
    const auto hold = std::ranges::find(arrays_.holds, place, &HoldingForce::place);
    return hold == arrays_.holds.end() ? 0 : hold->force_n;
  }

  void write_body(std::size_t body) {
    const std::size_t c = control_of(ControlQuantity::kDamping, body);
    const std::string gain = gain_of(body);
    if (is_control(c) && std::ranges::count(inputs_, gain) == 0)
      input(gain, fmt::format("cm.damping_gain(cm.dt * control_{})", c));
    model_.bodies[body].is_mass ? write_mass(body) : write_bank(body);
  }

  void write_mass(std::size_t body) {
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
      input(fmt::format("place_admittance_{}_{}", q, q), fmt::format("cm.dt * cm.dt / {}", literal(2 * mass)));
    const std::string moved = fmt::format("{}, {}, {}", literal(mass), force_at(place), gain_of(body));
    chain_.add({fmt::format("place_increment_{}", place), fmt::format("jump_{}", body),
                fmt::format("displacement_{}", body), fmt::format("velocity_{}", body)},
               is_struck ? fmt::format("modal.struck_mass({}, is_thrown_{}, throw_speed_{}, {}, {})", moved, s, s,
                                       pressed_at(body, &InstrumentConnection::first),
                                       pressed_at(body, &InstrumentConnection::second))
                         : fmt::format("modal.free_mass({})", moved));
  }

  // The largest compression beyond that at rest of the contacts that have an end at a body, before the sample [m].
  [[nodiscard]] std::string pressed_at(std::size_t body, std::size_t InstrumentConnection::*end) {
    std::string largest;
    for (const std::size_t k : contacts_) {
      const std::size_t place = connections()[k].*end;
      if (place == kGround || arrays_.place_bodies[place] != body) continue;
      const double initial = initial_gap(k);
      std::string pressed = fmt::format("select2(cm.is_first, last_compression_{}, {})", k, number(-initial));
      if (is_control(control_of(ControlQuantity::kGapShift, k))) {
        input(name_at("rest", k), fmt::format("({} : ci.pressed_by_gap({}))", wanted_gap(k), number(initial)));
        pressed += fmt::format(" - rest_{}", k);
      } else if (initial < 0) {
        pressed += fmt::format(" - {}", literal(-initial));
      }
      largest = largest.empty() ? pressed : fmt::format("max({}, {})", largest, pressed);
    }
    return largest.empty() ? "0.0 - 1.0e9" : largest;  // nothing stands in the way
  }

  // The shapes at a place, as rules that Faust finds quickly.
  void write_shapes(std::size_t place) {
    if (std::ranges::count(written_shapes_, place) != 0) return;
    written_shapes_.push_back(place);
    bodies_ += fmt::format("shape_{0}(mode) = shape_of_{0}(mode);\n", place);  // rules alone are no argument
    for (std::size_t i = 0; i < modes_of(arrays_.place_bodies[place]); ++i)
      bodies_ += fmt::format("shape_of_{}({}) = {};\n", place, i, literal(arrays_.shapes[first_shape_[place] + i]));
  }

  // What an output takes of a target: a pressure takes the velocity of its first and the displacement of its second.
  static OutputQuantity motion_of(const InstrumentOutput& output, std::size_t target) {
    if (output.quantity != OutputQuantity::kPressure) return output.quantity;
    return target == output.first_target ? OutputQuantity::kVelocity : OutputQuantity::kDisplacement;
  }

  // What the outputs take from a body: targets with their quantity.
  [[nodiscard]] std::vector<std::pair<std::size_t, OutputQuantity>> pickups_of(std::size_t body) const {
    std::vector<std::pair<std::size_t, OutputQuantity>> pickups;
    for (const InstrumentOutput& output : arrays_.sources)
      if (output.quantity != OutputQuantity::kForce)
        for (std::size_t t = output.first_target; t < output.first_target + output.count; ++t)
          if (arrays_.place_bodies[arrays_.targets[t]] == body) pickups.emplace_back(t, motion_of(output, t));
    return pickups;
  }

  void write_constants(std::size_t body) {
    bodies_ += fmt::format("// {}: angular frequency, decay and modal mass; shapes at its places\n",
                           model_.bodies[body].name);
    const std::size_t begin = first_mode(body);
    for (std::size_t i = 0; i < modes_of(body); ++i)
      bodies_ +=
          fmt::format("constants_{}({}) = {}, {}, {};\n", body, i, literal(arrays_.angular_frequencies[begin + i]),
                      literal(arrays_.decays[begin + i]), literal(arrays_.masses[begin + i]));
  }

  void write_bank(std::size_t body) {
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
      observed.push_back(fmt::format("shape_{}(i) * {}", place,
                                     quantity == OutputQuantity::kVelocity ? "velocity" : "displacement"));
      signals.push_back(fmt::format("pickup_{}", target));
    }
    for (std::size_t m = 0; m < places.size(); ++m)
      for (std::size_t n = m; n < places.size(); ++n) {
        const auto [p, q] = std::minmax(places[m], places[n]);
        observed.push_back(fmt::format("shape_{}(i) * shape_{}(i) * admittance", p, q));
        signals.push_back(fmt::format("place_admittance_{}_{}", p, q));
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
        "  observe(i, increment, displacement{12}, admittance) =\n    {10};\n}};\n",
        body, fmt::join(forces, ", "), forces.empty() ? "" : ", ", scaled(forces), (modes + 15) / 16, signals.size(),
        forces.size() + 2, modes, forces.empty() ? "" : ", ", fmt::join(weighted, " + "), fmt::join(observed, ", "),
        has_velocity ? "_with_velocity" : "", has_velocity ? ", velocity" : "");
    arguments.push_back(gain_of(body));
    arguments.push_back(damping_of(body));
    chain_.add(signals, fmt::format("body_{}({})", body, fmt::join(arguments, ", ")));
  }

  static std::string scaled(const std::vector<std::string>& forces) {
    std::vector<std::string> scaled;
    for (const std::string& force : forces) scaled.push_back(fmt::format("keep(gain' * {})", force));
    return fmt::format("{}", fmt::join(scaled, ", "));
  }

  // Displacement over a sample at place p per newton at place q; empty for 0.
  [[nodiscard]] std::string mutual(std::size_t p, std::size_t q) const {
    if (p == kGround || q == kGround || arrays_.place_bodies[p] != arrays_.place_bodies[q]) return "";
    return product(gain_of(arrays_.place_bodies[p]),
                   fmt::format("place_admittance_{}_{}", std::min(p, q), std::max(p, q)));
  }

  // The same without dampers, between the ends of one connection.
  [[nodiscard]] static std::string own_admittance(const InstrumentConnection& connection) {
    Sum sum;
    for (const std::size_t p : {connection.first, connection.second})
      if (p != kGround) sum.add(fmt::format("place_admittance_{}_{}", p, p));
    return sum.text();
  }

  // Increment of a place without connections.
  [[nodiscard]] std::string increment_at(std::size_t place) const {
    if (place == kGround) return "";
    Sum sum;
    sum.add(fmt::format("place_increment_{}", place));
    for (const std::size_t q : places_[arrays_.place_bodies[place]]) {
      const std::size_t push = control_of(ControlQuantity::kForce, q);
      if (is_control(push)) sum.add(product(mutual(place, q), fmt::format("control_{}", push)));
      if (const double hold = hold_at(q); hold != 0) sum.add(product(mutual(place, q), number(hold)));
    }
    return fmt::format("({})", sum.text());
  }

  // The mass that a place belongs to jumps to 0 when it is thrown.
  [[nodiscard]] std::string jump_at(std::size_t place) const {
    if (place == kGround || !model_.bodies[arrays_.place_bodies[place]].is_mass) return "";
    return fmt::format("jump_{}", arrays_.place_bodies[place]);
  }

  [[nodiscard]] static std::string name_at(const char* name, std::size_t k) { return fmt::format("{}_{}", name, k); }

  [[nodiscard]] std::string& admittance(std::size_t k, std::size_t l) {
    return admittances_[std::min(k, l) * connections().size() + std::max(k, l)];
  }

  // Compressions, free increments, admittances, stiffnesses of all connections.
  void write_connections() {
    const std::size_t n = connections().size();
    admittances_.resize(n * n);
    ratio_.resize(n);
    chain_.next();
    for (std::size_t k = 0; k < n; ++k) {
      const InstrumentConnection& connection = connections()[k];
      const double initial = write_gap(k);
      Sum increment, compression;
      increment.add(increment_at(connection.first)).add(increment_at(connection.second), true);
      if (is_control(control_of(ControlQuantity::kGapShift, k))) increment.add(name_at("lift", k));
      compression.add(fmt::format("select2(cm.is_first, last_compression_{}, {})", k, number(-initial)));
      compression.add(jump_at(connection.first)).add(jump_at(connection.second), true);
      chain_.add(name_at("increment", k), kept(increment.text()));
      chain_.add(name_at("compression", k), kept(compression.text()));
      for (std::size_t l = k; l < n; ++l) write_admittance(k, l);
    }
    for (const std::size_t k : contacts_) write_memory(k);
    chain_.next();
    for (const std::size_t k : contacts_) write_surface(k);
    chain_.next();
    for (std::size_t k = 0; k < n; ++k) write_stiffness(k);
    chain_.next();
    for (const std::size_t k : contacts_) write_designed_stiffness(k);
    chain_.next();
    for (const std::size_t k : contacts_) write_resistance(k);
  }

  // What a contact remembers of the samples before, and the sum of it: the line that its potential lacks.
  void write_memory(std::size_t k) {
    const std::size_t n = memories_of(k);
    if (n == 0) return;
    std::vector<std::string> names{name_at("line", k)}, last;
    for (std::size_t i = 0; i < n; ++i) {
      fed_back_memories_.push_back(fmt::format("last_memory_{}_{}", k, i));
      last.push_back(begun_memory(k, i));
      names.push_back(fmt::format("memory_{}_{}", k, i));
    }
    chain_.add(names, fmt::format("({} : steps.remembered({}))", fmt::join(last, ", "), n));
  }

  // What memory i remembers of the sample before; at the beginning, of the force at rest.
  [[nodiscard]] std::string begun_memory(std::size_t k, std::size_t i) const {
    const std::span<const Segment<double>> table = model_.tables[connections()[k].table].segments;
    const double at_rest_n = force<double>(table, -initial_gap(k));
    std::string before = fmt::format("last_memory_{}_{}", k, i);
    if (at_rest_n == 0) return before;
    return fmt::format("select2(cm.is_first, {}, steps.memory_weight({}, {}) * {})", before, material_of(k), i,
                       literal(at_rest_n));
  }

  void write_surface(std::size_t k) {
    if (memories_of(k) != 0)
      chain_.add(surface_names(k), fmt::format("steps.surface_of({}, line_{})", material_of(k), k));
  }

  static std::vector<std::string> surface_names(std::size_t k) {
    return {name_at("split", k), name_at("surface", k), name_at("min_energy", k)};
  }

  [[nodiscard]] std::string material_of(std::size_t k) const { return name_at("material", connections()[k].table); }

  // The material that acts in this sample: less the line of its memories.
  [[nodiscard]] std::string acting_material(std::size_t k) const {
    if (memories_of(k) == 0) return material_of(k);
    return fmt::format("steps.less_line({}, line_{}, {})", material_of(k), k, fmt::join(surface_names(k), ", "));
  }

  [[nodiscard]] std::string remembered(std::size_t k) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < memories_of(k); ++i) names.push_back(fmt::format("memory_{}_{}", k, i));
    return fmt::format("{}", fmt::join(names, ", "));
  }

  // The stiffness ratio that the memories leave at this rate.
  void write_designed_stiffness(std::size_t k) {
    if (memories_of(k) == 0) return;
    chain_.add(name_at("designed_stiffness", k),
               kept(product(ratio_[k], fmt::format("steps.memory_stiffness({})", material_of(k)))));
    ratio_[k] = name_at("designed_stiffness", k);
  }

  // Energy of a contact for a stiffness ratio of 1.
  [[nodiscard]] std::string contact_energy(std::size_t k) const {
    if (memories_of(k) == 0) return fmt::format("ct.potential({}, compression_{})", material_of(k), k);
    return fmt::format("({} : steps.memory_energy({}, {}, compression_{}))", remembered(k), material_of(k),
                       acting_material(k), k);
  }

  // Gap that acts at the beginning [m].
  double write_gap(std::size_t k) {
    const std::size_t c = control_of(ControlQuantity::kGapShift, k);
    const double initial = initial_gap(k);
    if (is_control(c))
      input(name_at("lift", k), fmt::format("({} : ci.follow_gap({}))", wanted_gap(k), number(initial)));
    return initial;
  }

  [[nodiscard]] double initial_gap(std::size_t k) const {
    const std::size_t c = control_of(ControlQuantity::kGapShift, k);
    const auto [min, max] = gap_range<double>(connections()[k]);
    return std::clamp(connections()[k].gap_m + (is_control(c) ? arrays_.parameters[c].initial : 0), min, max);
  }

  // The gap that a control wants.
  [[nodiscard]] std::string wanted_gap(std::size_t k) const {
    const auto [min, max] = gap_range<double>(connections()[k]);
    return fmt::format("max({}, min({}, {} + control_{}))", number(min), number(max), number(connections()[k].gap_m),
                       control_of(ControlQuantity::kGapShift, k));
  }

  void write_admittance(std::size_t k, std::size_t l) {
    const InstrumentConnection &a = connections()[k], &b = connections()[l];
    Sum sum;
    sum.add(mutual(a.first, b.first)).add(mutual(a.second, b.second));
    sum.add(mutual(a.first, b.second), true).add(mutual(a.second, b.first), true);
    if (sum.text().empty()) return;
    admittance(k, l) = fmt::format("admittance_{}_{}", k, l);
    // Of its own a connection has at least that of ContactNetwork, also where nothing moves.
    chain_.add(admittance(k, l), k == l ? fmt::format("max(1.0e-18, {})", kept(sum.text())) : kept(sum.text()));
  }

  // The stiffness ratio of a contact or the stiffness of a spring that acts.
  void write_stiffness(std::size_t k) {
    const InstrumentConnection& connection = connections()[k];
    const bool is_contact = connection.kind == ConnectionKind::kContact;
    const std::size_t c = control_of(is_contact ? ControlQuantity::kStiffnessRatio : ControlQuantity::kStiffness, k);
    if (connection.kind == ConnectionKind::kLink) {
      ratio_[k] = name_at("stiffness", k);
      chain_.add(ratio_[k], fmt::format("cm.link_stiffness({})", own_admittance(connection)));
    } else if (!is_control(c)) {
      ratio_[k] = literal(is_contact ? connection.weight : connection.stiffness_n_per_m);
    } else {
      const double weight = is_contact ? connection.weight : 1;
      const std::string energy =
          is_contact ? contact_energy(k) : fmt::format("compression_{0} * compression_{0} * 0.5", k);
      ratio_[k] = name_at("stiffness", k);
      states_.push_back(ratio_[k]);
      chain_.add(ratio_[k],
                 fmt::format("ci.follow_stiffness(select2(cm.is_first, last_stiffness_{}, {}), {} * control_{}, {})",
                             k, literal(weight * arrays_.parameters[c].initial), literal(weight), c, energy));
      state_inputs_.push_back(name_at("last_stiffness", k));
    }
  }

  [[nodiscard]] std::string loss_of(std::size_t k) const {
    const std::size_t c = control_of(ControlQuantity::kLoss, k);
    return is_control(c) ? fmt::format("control_{}", c) : literal(connections()[k].loss_s_per_m);
  }

  // Hunt-Crossley resistance of a contact [N/m] over this sample. After a throw no contact has a last increment.
  void write_resistance(std::size_t k) {
    if (loss_of(k) == "0.0") return chain_.add(name_at("resistance", k), "0.0");
    std::string increment = fmt::format("last_compression_{0} - compression_{0}'", k);
    for (std::size_t s = 0; s < model_.strikes.size(); ++s)
      increment = fmt::format("select2(is_thrown_{}, {}, 0.0)", s, increment);
    chain_.add(name_at("resistance", k),
               fmt::format("(compression_{0}, {1}, {2}, {3}, compression_{0} > 0.0 : steps.resistance({4}))", k,
                           ratio_[k], loss_of(k), increment, acting_material(k)));
  }

  // Solves rows of names, the matrix and after it columns of the right side, by Gauss and Jordan. No pivot is sought:
  // all matrices here are similar to one with eigenvalues of at least 1. Empty: 0. Adds the function `name` that does
  // it, and the signals of its columns, which are returned.
  std::vector<std::vector<std::string>> solved(std::vector<std::vector<std::string>> rows, const std::string& name) {
    const std::size_t n = rows.size();
    if (n == 0) return rows;
    std::vector<std::string> inputs, outputs, columns;
    for (const auto& row : rows)
      for (const std::string& entry : row)
        if (!entry.empty() && entry != "1.0") inputs.push_back(entry);
    FaustChain outside = std::exchange(chain_, {});
    for (std::size_t j = 0; j < n; ++j) {
      if (rows[j][j] != "1.0") {
        for (std::size_t c = j + 1; c < rows[j].size(); ++c)
          if (!rows[j][c].empty())
            rows[j][c] = set(fmt::format("pivot_row_{}_{}", j, c), fmt::format("{} / {}", rows[j][c], rows[j][j]));
        chain_.next();
      }
      for (std::size_t i = 0; i < n; ++i) {
        if (i == j || rows[i][j].empty()) continue;
        for (std::size_t c = j + 1; c < rows[i].size(); ++c)
          if (!rows[j][c].empty())
            rows[i][c] = set(fmt::format("reduced_row_{}_{}_{}", j, i, c),
                             Sum().add(rows[i][c]).add(product(rows[i][j], rows[j][c]), true).text());
      }
      chain_.next();
    }
    for (std::size_t i = 0; i < n; ++i) {
      rows[i].erase(rows[i].begin(), rows[i].begin() + static_cast<std::ptrdiff_t>(n));
      for (std::size_t c = 0; c < rows[i].size(); ++c) {
        if (rows[i][c].empty()) continue;
        outputs.push_back(rows[i][c]);
        columns.push_back(rows[i][c] = fmt::format("solution_{}_{}", i, c));
      }
    }
    functions_ += chain_.text(name, inputs, outputs);
    chain_ = std::move(outside);
    chain_.add(columns, fmt::format("({} : {})", fmt::join(inputs, ", "), name));
    chain_.next();
    return rows;
  }

  // Adds a signal and returns its name.
  std::string set(std::string name, const std::string& expression) {
    chain_.add(name, kept(expression));
    return name;
  }

  // Springs and links: their forces are those without contacts less a part of each contact's force.
  void solve_linear() {
    chain_.next();
    const std::size_t n = linear_.size();
    std::vector<std::string> slopes;
    for (const std::size_t l : linear_) {
      const std::size_t c = control_of(ControlQuantity::kResistance, l);
      if (connections()[l].kind == ConnectionKind::kLink) {
        slopes.push_back(ratio_[l]);
        continue;
      }
      const std::string resistance =
          is_control(c) ? fmt::format("control_{}", c) : literal(connections()[l].resistance_n_s_per_m);
      slopes.push_back(
          set(name_at("slope", l), fmt::format("0.5 * {} + {} * ct.sample_rate", ratio_[l], resistance)));
    }
    chain_.next();
    std::vector<std::vector<std::string>> rows(n);
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = linear_[a];
      for (std::size_t b = 0; b < n; ++b) {
        Sum sum;
        if (a == b) sum.add("1.0");
        sum.add(product(slopes[a], admittance(k, linear_[b])));
        rows[a].push_back(sum.text().empty() ? "" : set(fmt::format("matrix_{}_{}", a, b), sum.text()));
      }
      rows[a].push_back(set(name_at("right_side", a),
                            fmt::format("{} * compression_{} + {} * increment_{}", ratio_[k], k, slopes[a], k)));
      for (const std::size_t c : contacts_) {
        const std::string coupling = product(slopes[a], admittance(k, c));
        rows[a].push_back(coupling.empty() ? "" : set(fmt::format("coupling_{}_{}", a, c), coupling));
      }
    }
    chain_.next();
    linear_solution_ = solved(std::move(rows), "links");
  }

  // Free increments and admittances of the contacts, with springs and links that follow.
  void reduce() {
    chain_.next();
    const std::size_t n = contacts_.size();
    reduced_.resize(n, std::vector<std::string>(n));
    for (std::size_t a = 0; a < n; ++a) {
      Sum increment;
      increment.add(name_at("increment", contacts_[a]));
      for (std::size_t l = 0; l < linear_.size(); ++l)
        increment.add(product(admittance(contacts_[a], linear_[l]), linear_solution_[l][0]), true);
      chain_.add(name_at("free_increment", a), kept(increment.text()));
      for (std::size_t b = a; b < n; ++b) {
        Sum sum;
        sum.add(admittance(contacts_[a], contacts_[b]));
        for (std::size_t l = 0; l < linear_.size(); ++l)
          sum.add(product(admittance(contacts_[a], linear_[l]), linear_solution_[l][1 + b]), true);
        if (sum.text().empty()) continue;
        reduced_[a][b] = reduced_[b][a] = fmt::format("contact_admittance_{}_{}", a, b);
        chain_.add(reduced_[a][b], a == b ? fmt::format("max(1.0e-18, keep({}))", sum.text()) : kept(sum.text()));
      }
    }
    chain_.next();
  }

  // The forces of the contacts, from those of the last sample. A step of the search: every contact step with the
  // other forces held, then Newton's method on these (docs/how-it-works/several-contacts.md). At the end the contact
  // steps alone.
  void search() {
    const std::size_t n = contacts_.size();
    if (n == 0) return;
    std::vector<std::string> given, forces, last;  // signals that steps need, forces before and after
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = contacts_[a];
      given.push_back(name_at("compression", k));
      given.push_back(name_at("free_increment", a));
      given.push_back(name_at("resistance", k));
      if (memories_of(k) != 0) {
        given.push_back(name_at("line", k));
        for (const std::string& name : surface_names(k)) given.push_back(name);
      }
      if (std::isalpha(static_cast<unsigned char>(ratio_[k].front())) != 0) given.push_back(ratio_[k]);
      for (std::size_t b = 0; b <= a; ++b)
        if (!reduced_[a][b].empty()) given.push_back(reduced_[a][b]);
      forces.push_back(name_at("force", a));
      last.push_back(name_at("last_force", k));
    }
    FaustChain whole = std::exchange(chain_, {});
    contact_steps(forces);
    std::vector<std::string> alone, inputs = given;
    for (std::size_t a = 0; a < n; ++a) alone.push_back(name_at("own_force", a));
    inputs.insert(inputs.end(), forces.begin(), forces.end());
    functions_ += chain_.text("contact_steps", inputs, alone);
    const bool is_coupled = is_any_coupled();
    if (is_coupled) {
      std::vector<std::string> outputs;
      for (const auto& columns : newton_step(forces)) outputs.push_back(columns[0]);
      functions_ += chain_.text("newton", inputs, outputs);
      functions_ += fmt::format("newton_step(\n{}) =\n{}, (\n{} : newton);\n", faust_list(inputs, "    "),
                                faust_list(given, "  "), faust_list(inputs, "    "));
    }
    chain_ = std::move(whole);
    std::vector<std::string> arguments = given;
    arguments.insert(arguments.end(), last.begin(), last.end());
    for (std::size_t a = 0; a < n; ++a) forces_.push_back(name_at("force", a));
    chain_.add(forces_, fmt::format("({}{} : contact_steps)", fmt::join(arguments, ", "),
                                    is_coupled ? fmt::format(" : seq(i, {}, newton_step)", kSteps - 1) : ""));
    chain_.next();
  }

  [[nodiscard]] bool is_any_coupled() const {
    for (std::size_t a = 0; a < contacts_.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (!reduced_[a][b].empty()) return true;
    return false;
  }

  // Increments that are given if the other forces hold, and forces by contact steps of their own.
  void contact_steps(const std::vector<std::string>& forces) {
    const std::size_t n = contacts_.size();
    for (std::size_t a = 0; a < n; ++a) {
      Sum alone;
      alone.add(name_at("free_increment", a));
      for (std::size_t b = 0; b < n; ++b)
        if (b != a) alone.add(product(reduced_[a][b], forces[b]), true);
      chain_.add(name_at("given_increment", a), kept(alone.text()));
    }
    chain_.next();
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = contacts_[a];
      chain_.add(name_at("own_force", a),
                 fmt::format("(compression_{0}, given_increment_{1}, {2}, {3}, resistance_{0} : "
                             "steps.contact_against({4}))",
                             k, a, reduced_[a][a], ratio_[k], acting_material(k)));
    }
    chain_.next();
  }

  // The forces after a step of Newton's method, after contact_steps().
  std::vector<std::vector<std::string>> newton_step(const std::vector<std::string>& forces) {
    const std::size_t n = contacts_.size();
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = contacts_[a];
      chain_.add(name_at("secant", a),
                 fmt::format("(compression_{}, given_increment_{} - {} * own_force_{}, own_force_{}, resistance_{} : "
                             "ct.secant({}, {}, {}))",
                             k, a, reduced_[a][a], a, a, k, acting_material(k), ratio_[k], reduced_[a][a]));
    }
    chain_.next();
    std::vector<std::vector<std::string>> rows(n);
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        const std::string coupling = a == b ? "" : product(name_at("secant", a), reduced_[a][b]);
        rows[a].push_back(a == b             ? "1.0"
                          : coupling.empty() ? ""
                                             : set(fmt::format("jacobian_{}_{}", a, b), coupling));
      }
      Sum right;  // of which the forces are the solution where the contact steps return them
      right.add(name_at("own_force", a));
      for (std::size_t b = 0; b < n; ++b)
        if (b != a && !reduced_[a][b].empty())
          right.add(fmt::format("secant_{} * {} * {}", a, reduced_[a][b], forces[b]));
      rows[a].push_back(set(name_at("newton_right_side", a), right.text()));
    }
    chain_.next();
    return solved(std::move(rows), "newton_solution");
  }

  TemplateValues finish() {
    std::vector<std::string> all(connections().size());
    for (std::size_t a = 0; a < contacts_.size(); ++a) all[contacts_[a]] = forces_[a];
    for (std::size_t l = 0; l < linear_.size(); ++l) {
      Sum force;
      force.add(linear_solution_[l][0]);
      for (std::size_t a = 0; a < contacts_.size(); ++a)
        force.add(product(linear_solution_[l][1 + a], forces_[a]), true);
      all[linear_[l]] = set(name_at("spring_force", l), force.text());
    }
    chain_.next();
    std::vector<std::string> fed_back, results = all;
    for (std::size_t k = 0; k < all.size(); ++k) fed_back.push_back(name_at("last_force", k));
    for (std::size_t k = 0; k < all.size(); ++k) {
      Sum end;
      end.add(name_at("compression", k)).add(name_at("increment", k));
      for (std::size_t l = 0; l < all.size(); ++l) end.add(product(admittance(k, l), all[l]), true);
      results.push_back(set(name_at("end_compression", k), end.text()));
      fed_back.push_back(name_at("last_compression", k));
    }
    results.insert(results.end(), states_.begin(), states_.end());
    fed_back.insert(fed_back.end(), state_inputs_.begin(), state_inputs_.end());
    if (!fed_back_memories_.empty()) chain_.next();
    for (const std::size_t k : contacts_) relax(k, results);
    fed_back.insert(fed_back.end(), fed_back_memories_.begin(), fed_back_memories_.end());
    for (std::size_t o = 0; o < arrays_.outputs.size(); ++o) results.push_back(write_output(o));
    if (inputs_.empty()) input("nothing", "0.0");  // an empty list is no Faust
    std::vector<std::string> inputs = fed_back;
    inputs.insert(inputs.end(), inputs_.begin(), inputs_.end());
    std::vector<std::string> outputs;
    for (const ModelOutput& output : model_.outputs) outputs.push_back(output.name);
    return {{"STEPS", chain_.text("sample", inputs, results)},
            {"INPUTS", faust_list(input_expressions_, "  ")},
            {"FED_BACK", fmt::format("{}", fed_back.size())},
            {"OUTPUTS", fmt::format("{}", arrays_.outputs.size())},
            {"OUTPUT_NAMES", fmt::format("{}", fmt::join(outputs, ", "))}};
  }

  // Memories follow the force at the end of the sample.
  void relax(std::size_t k, std::vector<std::string>& results) {
    if (memories_of(k) == 0) return;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < memories_of(k); ++i) names.push_back(fmt::format("next_memory_{}_{}", k, i));
    chain_.add(names, fmt::format("(line_{0}, end_compression_{0}, {1} : steps.relaxed({2}))", k, remembered(k),
                                  material_of(k)));
    results.insert(results.end(), names.begin(), names.end());
  }

  // Forces of the last sample, and motions at its end.
  std::string write_output(std::size_t o) {
    const InstrumentOutput& output = arrays_.sources[o];
    Sum sum;
    for (std::size_t t = output.first_target; t < output.first_target + output.count; ++t) {
      const std::size_t target = arrays_.targets[t];
      if (output.quantity == OutputQuantity::kForce) {
        sum.add(name_at("last_force", target));
      } else if (const std::size_t body = arrays_.place_bodies[target]; model_.bodies[body].is_mass) {
        sum.add(name_at(output.quantity == OutputQuantity::kVelocity ? "velocity" : "displacement", body));
      } else {
        sum.add(name_at("pickup", t));
      }
    }
    if (output.at_rest_n != 0) sum.add(fmt::format("({})'", literal(output.at_rest_n)), true);  // as the forces
    add_paths(o, sum);
    return set(name_at("out", o), fmt::format("({}) / {}", sum.text(), literal(arrays_.outputs[o].full_scale)));
  }

  // What forces add to a pressure.
  void add_paths(std::size_t o, Sum& sum) {
    std::size_t first = 0;
    for (std::size_t path = 0; path < arrays_.pressure_paths.size(); ++path) {
      const auto [output, place, taps] = arrays_.pressure_paths[path];
      const std::size_t begin = std::exchange(first, first + taps);
      const std::string force = force_at(place);
      if (output != o || force == "0.0") continue;
      functions_ += fmt::format("tap_{0}(i) = tap_of_{0}(i);\n", path);  // rules alone are no argument
      for (std::size_t i = 0; i < taps; ++i)
        functions_ += fmt::format("tap_of_{}({}) = {};\n", path, i, number(arrays_.pressure_taps[begin + i]));
      sum.add(fmt::format("({} : ci.taps({}, {}, tap_{}))", force, taps, literal(arrays_.pressure_rate_hz), path));
    }
  }

  const InstrumentModel& model_;
  const InstrumentArrays& arrays_;
  std::vector<std::size_t> contacts_, linear_;    // connections
  std::vector<std::vector<std::size_t>> places_;  // of each body, at which forces act
  std::vector<std::size_t> first_shape_, written_shapes_;
  std::vector<std::string> inputs_, input_expressions_;  // of the loop
  std::vector<std::string> states_, state_inputs_;       // stiffnesses that follow their controls
  std::vector<std::string> fed_back_memories_;
  std::vector<std::string> ratio_;        // stiffness of each connection
  std::vector<std::string> admittances_;  // of each pair of connections, first <= second
  std::vector<std::vector<std::string>> linear_solution_, reduced_;
  std::vector<std::string> forces_;  // of the contacts
  std::string sliders_, materials_, bodies_, functions_;
  FaustChain chain_;
};

}  // namespace

namespace {

// A strike that moves more than one mass: the class moves all that is joined to it, and puts back what it may meet.
std::optional<std::string> joined_strike(const InstrumentModel& model, const InstrumentArrays& arrays) {
  const auto body_at = [&](std::size_t place) { return place == kGround ? kGround : arrays.place_bodies[place]; };
  const auto is_mass = [&](std::size_t body) { return body != kGround && model.bodies[body].is_mass; };
  for (const std::size_t struck : model.strikes)
    for (const InstrumentConnection& c : arrays.connections) {
      const std::size_t first = body_at(c.first), second = body_at(c.second);
      if (first != struck && second != struck) continue;
      const std::size_t other = first == struck ? second : first;
      if (is_mass(other))
        return fmt::format("{}: the strike of {} moves {}, too, and a program of Faust moves one mass alone",
                           model.name, model.bodies[struck].name, model.bodies[other].name);
    }
  return {};
}

}  // namespace

std::optional<std::string> faust_obstacle(const InstrumentModel& model, const InstrumentArrays& arrays) {
  for (const ConnectionGroup& group : model.connections)
    if (group.each.kind == ConnectionKind::kFriction)
      return fmt::format("{} has the friction {}, which only the C++ class plays", model.name, group.name);
  if (const InstrumentBody* body = model.stretching_body())
    return fmt::format("{} has the body {} with stretch, which only the C++ class plays", model.name, body->name);
  for (std::size_t c = 0; c < model.controls.size(); ++c)
    if (model.controls[c].quantity == ControlQuantity::kPlace || model.parameters[c].acts == Acts::kAtNextNote)
      return fmt::format("{} has the control {}, which only the C++ class plays", model.name,
                         model.parameters[c].name);
  // A contact with memory takes Faust about as long as two without.
  std::size_t contacts = 0, linear = 0;
  for (const InstrumentConnection& connection : arrays.connections) {
    const bool is_contact = connection.kind == ConnectionKind::kContact;
    if (is_contact) contacts += model.tables[connection.table].memories.empty() ? 1 : 2;
    linear += is_contact ? 0 : 1;
  }
  const auto too_many = [&](std::size_t count, std::size_t max, std::string_view what) {
    return fmt::format("{} has {} {}, and Faust compiles at most {} in reasonable time", model.name, count, what,
                       max);
  };
  if (contacts > kMaxContacts)
    return too_many(
        contacts, kMaxContacts,
        arrays.memories.empty() ? "points of contact" : "points of contact, counting those with memory twice");
  if (linear > kMaxLinear) return too_many(linear, kMaxLinear, "springs and links");
  if (arrays.masses.size() > kMaxModes) return too_many(arrays.masses.size(), kMaxModes, "modes");
  return joined_strike(model, arrays);
}

TemplateValues faust_instrument_values(const InstrumentModel& model, const InstrumentArrays& arrays) {
  return Writer(model, arrays).write();
}

}  // namespace contactspline
