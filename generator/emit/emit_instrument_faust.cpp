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
#include "generator/emit/faust_bodies.hpp"
#include "generator/emit/faust_chain.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

constexpr int kSteps = 5;  // contact steps of several contacts that act on each other; between them Newton steps

std::string slider(std::size_t order, const ModelParameter& parameter) {
  const auto [min, max] = parameter.slider;
  return fmt::format("hslider(\"[{}]{}{}{}\", {}, {}, {}, {})", order, parameter.name,
                     parameter.scale == Scale::kLogarithmic ? "[scale:log]" : "",
                     parameter.unit.empty() ? "" : fmt::format("[unit:{}]", parameter.unit),
                     literal(parameter.initial), literal(min), literal(max), literal(slider_step(parameter)));
}

/// Writes an instrument, part after part.
class Writer : FaustBodies {
 public:
  Writer(const InstrumentModel& model, const InstrumentArrays& arrays)
      : FaustBodies(model, arrays), points_(contacts_) {
    points_.insert(points_.end(), frictions_.begin(), frictions_.end());
  }

  TemplateValues write() {
    write_sliders();
    write_materials();
    write_frictions();
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
  // Their number, for a contact.
  [[nodiscard]] std::size_t memories_of(std::size_t k) const {
    return model_.tables[connections()[k].table].memories.size();
  }

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
                           faust_number(parameter.allowed.min), faust_number(parameter.allowed.max));
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

  // What rubs, and what presses and moves it.
  void write_frictions() {
    for (const std::size_t k : frictions_) {
      const InstrumentFriction& friction = connections()[k].friction;
      const auto& [law, heat] = friction.material;
      materials_ += fmt::format(
          "rubbing_{} = environment {{\n  stiffness = {}; damping = {}; cold = {}; hot = {}; softening = {};\n"
          "  capacity = {}; conduction = {}; renewal = {}; width = {};\n}};\n",
          k, literal(law.stiffness_per_m), literal(law.damping_s_per_m), literal(heat.cold_coefficient),
          literal(heat.hot_coefficient), literal(heat.softening_k), literal(heat.capacity_j_per_n_k),
          literal(heat.conduction_w_per_n_k), literal(heat.renewal_w_per_m_k2), literal(friction.width_m));
      const auto value = [&](ControlQuantity quantity, double fixed) {
        const std::size_t c = control_of(quantity, k);
        return is_control(c) ? fmt::format("control_{}", c) : faust_number(fixed);
      };
      input(name_at("pressed", k), value(ControlQuantity::kNormalForce, friction.normal_force_n));
      input(name_at("carried", k),
            "cm.dt * " + value(ControlQuantity::kSurfaceSpeed, friction.surface_speed_m_per_s));
    }
  }

  [[nodiscard]] std::string& receptance(std::size_t k, std::size_t l) {
    return receptances_[std::min(k, l) * connections().size() + std::max(k, l)];
  }

  // Compressions, free increments, receptances, stiffnesses of all connections.
  void write_connections() {
    const std::size_t n = connections().size();
    receptances_.resize(n * n);
    ratio_.resize(n);
    chain_.next();
    for (std::size_t k = 0; k < n; ++k) {
      const InstrumentConnection& connection = connections()[k];
      const double initial = write_gap(k);
      const bool is_friction = connection.kind == ConnectionKind::kFriction;
      FaustSum increment, compression;
      increment.add(increment_at(connection.first)).add(increment_at(connection.second), true);
      if (is_control(control_of(ControlQuantity::kGapShift, k)))
        increment.add(are_steps_double() ? fmt::format("lift_{0} + lift_{0}'", k) : name_at("lift", k));
      if (is_friction) increment.add(name_at("carried", k));
      compression.add(fmt::format("select2(cm.is_first, last_compression_{}, {})", k, faust_number(-initial)));
      compression.add(jump_at(connection.first)).add(jump_at(connection.second), true);
      chain_.add(name_at("increment", k), faust_kept(increment.text()));
      if (!is_form(k) && !is_friction)
        chain_.add(name_at(are_steps_double() ? "resting_compression" : "compression", k),
                   faust_kept(compression.text()));
      for (std::size_t l = k; l < n; ++l) write_receptance(k, l);
    }
    if (are_steps_double()) write_compressions_before();
    for (const std::size_t k : contacts_) write_memory(k);
    for (const std::size_t k : frictions_) write_bristles(k);
    chain_.next();
    for (const std::size_t k : contacts_) write_surface(k);
    chain_.next();
    for (std::size_t k = 0; k < n; ++k) write_stiffness(k);
    chain_.next();
    for (const std::size_t k : contacts_) write_designed_stiffness(k);
    chain_.next();
    for (const std::size_t k : contacts_) write_resistance(k);
  }

  // Over two samples what acts now has rested in the last sample: it begins where it ended before that.
  void write_compressions_before() {
    chain_.next();
    for (std::size_t k = 0; k < arrays_.connections.size(); ++k) {
      FaustSum before;
      before.add(fmt::format("select2(cm.is_first, resting_compression_{}', {})", k, faust_number(-initial_gap(k))));
      before.add(jump_at(connections()[k].first, "earlier_jump"));
      before.add(jump_at(connections()[k].second, "earlier_jump"), true);
      chain_.add(name_at("compression", k), faust_kept(before.text()));
    }
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

  // Bristles at the beginning of the sample.
  void write_bristles(std::size_t k) {
    chain_.add(bristles(k),
               fmt::format("(last_strain_{0}, last_warmth_{0} : steps.bristles(rubbing_{0}, pressed_{0}))", k));
  }

  static std::vector<std::string> bristles(std::size_t k) {
    std::vector<std::string> names;
    for (const char* name : {"strain", "yield", "bristles", "viscous", "warmth"}) names.push_back(name_at(name, k));
    return names;
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
               faust_kept(faust_product(ratio_[k], fmt::format("steps.memory_stiffness({})", material_of(k)))));
    ratio_[k] = name_at("designed_stiffness", k);
  }

  // Energy of a contact for a stiffness ratio of 1.
  [[nodiscard]] std::string contact_energy(std::size_t k, const std::string& compression) const {
    if (memories_of(k) == 0) return fmt::format("ct.potential({}, {})", material_of(k), compression);
    return fmt::format("({} : steps.memory_energy({}, {}, {}))", remembered(k), material_of(k), acting_material(k),
                       compression);
  }

  // Gap that acts at the beginning [m].
  double write_gap(std::size_t k) {
    const std::size_t c = control_of(ControlQuantity::kGapShift, k);
    const double initial = initial_gap(k);
    if (is_control(c))
      input(name_at("lift", k), fmt::format("({} : ci.follow_gap({}))", wanted_gap(k), faust_number(initial)));
    return initial;
  }

  void write_receptance(std::size_t k, std::size_t l) {
    const InstrumentConnection &a = connections()[k], &b = connections()[l];
    FaustSum sum;
    sum.add(mutual(a.first, b.first)).add(mutual(a.second, b.second));
    sum.add(mutual(a.first, b.second), true).add(mutual(a.second, b.first), true);
    if (sum.text().empty()) return;
    receptance(k, l) = fmt::format("receptance_{}_{}", k, l);
    // Of its own a connection has at least that of ContactNetwork, also where nothing moves.
    chain_.add(receptance(k, l),
               k == l ? fmt::format("max(1.0e-18, {})", faust_kept(sum.text())) : faust_kept(sum.text()));
  }

  // The stiffness ratio of a contact or the stiffness of a spring that acts.
  void write_stiffness(std::size_t k) {
    const InstrumentConnection& connection = connections()[k];
    if (connection.kind == ConnectionKind::kFriction) return;
    const bool is_contact = connection.kind == ConnectionKind::kContact;
    const std::size_t c = control_of(is_contact ? ControlQuantity::kStiffnessRatio : ControlQuantity::kStiffness, k);
    if (connection.kind == ConnectionKind::kLink) {
      ratio_[k] = name_at("stiffness", k);
      chain_.add(ratio_[k], fmt::format("cm.link_stiffness({})", own_receptance(connection)));
    } else if (!is_control(c)) {
      ratio_[k] = literal(is_contact ? connection.weight : connection.stiffness_n_per_m);
    } else {
      const double weight = is_contact ? connection.weight : 1;
      const auto follow = [&](const char* name, const char* last, const std::string& energy) {
        chain_.add(name_at(name, k),
                   fmt::format("ci.follow_stiffness(select2(cm.is_first, {}_{}, {}), {} * control_{}, {})", last, k,
                               literal(weight * arrays_.parameters[c].initial), literal(weight), c, energy));
        states_.push_back(name_at(name, k));
      };
      const auto energy_at = [&](const std::string& compression) {
        return is_contact ? contact_energy(k, compression) : fmt::format("{0} * {0} * 0.5", compression);
      };
      ratio_[k] = name_at("stiffness", k);
      if (are_steps_double()) {  // what rests now acts in the next sample
        follow("stiffness", "rested_stiffness", energy_at(name_at("compression", k)));
        follow("resting_stiffness", "last_stiffness", energy_at(name_at("resting_compression", k)));
        state_inputs_.push_back(name_at("last_stiffness", k));
        state_inputs_.push_back(name_at("rested_stiffness", k));
      } else {
        follow("stiffness", "last_stiffness", energy_at(name_at("compression", k)));
        state_inputs_.push_back(name_at("last_stiffness", k));
      }
    }
  }

  [[nodiscard]] std::string loss_of(std::size_t k) const {
    const std::size_t c = control_of(ControlQuantity::kLoss, k);
    return is_control(c) ? fmt::format("control_{}", c) : literal(connections()[k].loss_s_per_m);
  }

  // Hunt-Crossley resistance of a contact [N/m] over this sample. After a throw no contact has a last increment.
  void write_resistance(std::size_t k) {
    if (loss_of(k) == "0.0") return chain_.add(name_at("resistance", k), "0.0");
    // Over two samples: 1'' is 0 in the first two, before which there is no compression.
    std::string increment = fmt::format("last_compression_{0} - compression_{0}'", k);
    if (are_steps_double()) increment = fmt::format("1'' * (compression_{0} - compression_{0}'')", k);
    for (std::size_t s = 0; s < model_.strikes.size(); ++s)
      increment = fmt::format("select2(is_thrown_{}{}, {}, 0.0)", s,
                              are_steps_double() ? fmt::format(" | is_thrown_{}'", s) : "", increment);
    chain_.add(name_at("resistance", k),
               fmt::format("(compression_{0}, {1}, {2}{3}, {4}, compression_{0} > 0.0 : steps.resistance({5}))", k,
                           ratio_[k], are_steps_double() ? "0.5 * " : "", loss_of(k), increment, acting_material(k)));
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
                             FaustSum().add(rows[i][c]).add(faust_product(rows[i][j], rows[j][c]), true).text());
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
    chain_.add(name, faust_kept(expression));
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
      slopes.push_back(set(name_at("slope", l), fmt::format("0.5 * {} + {} * {}ct.sample_rate", ratio_[l], resistance,
                                                            are_steps_double() ? "0.5 * " : "")));
    }
    chain_.next();
    std::vector<std::vector<std::string>> rows(n);
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = linear_[a];
      for (std::size_t b = 0; b < n; ++b) {
        FaustSum sum;
        if (a == b) sum.add("1.0");
        sum.add(faust_product(slopes[a], receptance(k, linear_[b])));
        rows[a].push_back(sum.text().empty() ? "" : set(fmt::format("matrix_{}_{}", a, b), sum.text()));
      }
      rows[a].push_back(set(name_at("right_side", a),
                            fmt::format("{} * compression_{} + {} * increment_{}", ratio_[k], k, slopes[a], k)));
      for (const std::size_t c : points_) {
        const std::string coupling = faust_product(slopes[a], receptance(k, c));
        rows[a].push_back(coupling.empty() ? "" : set(fmt::format("coupling_{}_{}", a, c), coupling));
      }
    }
    chain_.next();
    linear_solution_ = solved(std::move(rows), "links");
  }

  // Free increments and receptances of the contacts, with springs and links that follow.
  void reduce() {
    chain_.next();
    const std::size_t n = points_.size();
    reduced_.resize(n, std::vector<std::string>(n));
    for (std::size_t a = 0; a < n; ++a) {
      FaustSum increment;
      increment.add(name_at("increment", points_[a]));
      for (std::size_t l = 0; l < linear_.size(); ++l)
        increment.add(faust_product(receptance(points_[a], linear_[l]), linear_solution_[l][0]), true);
      chain_.add(name_at("free_increment", a), faust_kept(increment.text()));
      for (std::size_t b = a; b < n; ++b) {
        FaustSum sum;
        sum.add(receptance(points_[a], points_[b]));
        for (std::size_t l = 0; l < linear_.size(); ++l)
          sum.add(faust_product(receptance(points_[a], linear_[l]), linear_solution_[l][1 + b]), true);
        if (sum.text().empty()) continue;
        reduced_[a][b] = reduced_[b][a] = fmt::format("contact_receptance_{}_{}", a, b);
        chain_.add(reduced_[a][b],
                   a == b ? fmt::format("max(1.0e-18, keep({}))", sum.text()) : faust_kept(sum.text()));
      }
    }
    chain_.next();
  }

  // The forces of the contacts, from those of the last sample. A step of the search: every contact step with the
  // other forces held, then Newton's method on these (docs/how-it-works/several-contacts.md). At the end the contact
  // steps alone.
  void search() {
    const std::size_t n = points_.size();
    if (n == 0) return;
    std::vector<std::string> given, forces, last;  // signals that steps need, forces before and after
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = points_[a];
      if (!rubs(a)) given.push_back(name_at("compression", k));
      given.push_back(name_at("free_increment", a));
      if (rubs(a)) {
        const auto names = bristles(k);
        given.insert(given.end(), names.begin(), names.end() - 1);  // the warmth acts in the next sample
      } else {
        given.push_back(name_at("resistance", k));
      }
      if (!rubs(a) && memories_of(k) != 0) {
        given.push_back(name_at("line", k));
        for (const std::string& name : surface_names(k)) given.push_back(name);
      }
      if (!rubs(a) && std::isalpha(static_cast<unsigned char>(ratio_[k].front())) != 0) given.push_back(ratio_[k]);
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

  [[nodiscard]] bool rubs(std::size_t a) const { return a >= contacts_.size(); }

  [[nodiscard]] bool is_any_coupled() const {
    for (std::size_t a = 0; a < points_.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (!reduced_[a][b].empty()) return true;
    return false;
  }

  // Increments that are given if the other forces hold, and forces by contact steps of their own.
  void contact_steps(const std::vector<std::string>& forces) {
    const std::size_t n = points_.size();
    for (std::size_t a = 0; a < n; ++a) give_increment(a, forces);
    chain_.next();
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = points_[a];
      if (rubs(a)) {
        chain_.add({name_at("own_force", a), name_at("slope", a)},
                   fmt::format("({} : steps.rub : _, !, !, !, _)", rubbed(a)));
        continue;
      }
      chain_.add(name_at("own_force", a),
                 fmt::format("(compression_{0}, given_increment_{1}, {2}, {3}, resistance_{0} : "
                             "steps.contact_against({4}))",
                             k, a, reduced_[a][a], ratio_[k], acting_material(k)));
    }
    chain_.next();
  }

  // The increment of a contact or friction if the other forces hold.
  void give_increment(std::size_t a, const std::vector<std::string>& forces) {
    FaustSum alone;
    alone.add(name_at("free_increment", a));
    for (std::size_t b = 0; b < points_.size(); ++b)
      if (b != a) alone.add(faust_product(reduced_[a][b], forces[b]), true);
    chain_.add(name_at("given_increment", a), faust_kept(alone.text()));
  }

  // What a friction step takes.
  [[nodiscard]] std::string rubbed(std::size_t a) const {
    return fmt::format("strain_{0}, yield_{0}, bristles_{0}, viscous_{0}, given_increment_{1}, {2}", points_[a], a,
                       reduced_[a][a]);
  }

  // The forces after a step of Newton's method, after contact_steps().
  std::vector<std::vector<std::string>> newton_step(const std::vector<std::string>& forces) {
    const std::size_t n = points_.size();
    for (std::size_t a = 0; a < n; ++a) {
      const std::size_t k = points_[a];
      if (rubs(a)) {
        chain_.add(name_at("secant", a), fmt::format("slope_{0} / (1.0 + {1} * slope_{0})", a, reduced_[a][a]));
        continue;
      }
      chain_.add(name_at("secant", a),
                 fmt::format("(compression_{}, given_increment_{} - {} * own_force_{}, own_force_{}, resistance_{} : "
                             "ct.secant({}, {}, {}))",
                             k, a, reduced_[a][a], a, a, k, acting_material(k), ratio_[k], reduced_[a][a]));
    }
    chain_.next();
    std::vector<std::vector<std::string>> rows(n);
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        const std::string coupling = a == b ? "" : faust_product(name_at("secant", a), reduced_[a][b]);
        rows[a].push_back(a == b             ? "1.0"
                          : coupling.empty() ? ""
                                             : set(fmt::format("jacobian_{}_{}", a, b), coupling));
      }
      FaustSum right;  // of which the forces are the solution where the contact steps return them
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
    for (std::size_t a = 0; a < points_.size(); ++a) all[points_[a]] = forces_[a];
    for (std::size_t a = contacts_.size(); a < points_.size(); ++a) give_increment(a, forces_);
    for (std::size_t l = 0; l < linear_.size(); ++l) {
      FaustSum force;
      force.add(linear_solution_[l][0]);
      for (std::size_t a = 0; a < points_.size(); ++a)
        force.add(faust_product(linear_solution_[l][1 + a], forces_[a]), true);
      all[linear_[l]] = set(name_at("spring_force", l), force.text());
    }
    chain_.next();
    std::vector<std::string> fed_back, results = all;
    for (std::size_t k = 0; k < all.size(); ++k) fed_back.push_back(name_at("last_force", k));
    for (std::size_t k = 0; k < arrays_.connections.size(); ++k) {
      if (connections()[k].kind == ConnectionKind::kFriction) continue;
      FaustSum end;
      end.add(name_at("compression", k)).add(name_at("increment", k));
      for (std::size_t l = 0; l < all.size(); ++l) end.add(faust_product(receptance(k, l), all[l]), true);
      results.push_back(set(name_at("end_compression", k), end.text()));
      fed_back.push_back(name_at("last_compression", k));
    }
    results.insert(results.end(), states_.begin(), states_.end());
    fed_back.insert(fed_back.end(), state_inputs_.begin(), state_inputs_.end());
    for (std::size_t a = contacts_.size(); a < points_.size(); ++a) end_rubbing(a, results, fed_back);
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

  // Strain and warmth after the sample.
  void end_rubbing(std::size_t a, std::vector<std::string>& results, std::vector<std::string>& fed_back) {
    const std::size_t k = points_[a];
    const std::string next = name_at("next_strain", k), warmer = name_at("next_warmth", k);
    chain_.next();
    chain_.add({name_at("rubbed_increment", k), next, name_at("slip", k)},
               fmt::format("({} : steps.rub : !, _, _, _, !)", rubbed(a)));
    chain_.next();
    chain_.add(warmer, fmt::format("(pressed_{0}, {1}, rubbed_increment_{0}, next_strain_{0}, slip_{0} : "
                                   "steps.warmed(rubbing_{0}, rubbing_{0}.width))",
                                   k, fmt::join(bristles(k), ", ")));
    results.insert(results.end(), {next, warmer});
    fed_back.insert(fed_back.end(), {name_at("last_strain", k), name_at("last_warmth", k)});
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
    FaustSum sum;
    for (std::size_t t = output.first_target; t < output.first_target + output.count; ++t) {
      const std::size_t target = arrays_.targets[t];
      if (output.quantity == OutputQuantity::kForce) {
        sum.add(name_at("last_force", target));
      } else if (const std::size_t body = arrays_.place_bodies[target]; model_.bodies[body].is_mass) {
        sum.add(name_at(output.quantity == OutputQuantity::kVelocity ? "velocity" : "displacement", body));
      } else {
        sum.add(name_at("pickup", t));
        if (are_steps_double()) add_stretch(output, t, sum);
      }
    }
    if (output.at_rest_n != 0) sum.add(fmt::format("({})'", literal(output.at_rest_n)), true);  // as the forces
    add_paths(o, sum);
    return set(name_at("out", o), fmt::format("({}) / {}", sum.text(), literal(arrays_.outputs[o].full_scale)));
  }

  // What forces add to a pressure.
  void add_paths(std::size_t o, FaustSum& sum) {
    std::size_t first = 0;
    for (std::size_t path = 0; path < arrays_.pressure_paths.size(); ++path) {
      const auto [output, place, taps] = arrays_.pressure_paths[path];
      const std::size_t begin = std::exchange(first, first + taps);
      const std::string force = force_at(place);
      if (output != o || force == "0.0") continue;
      functions_ += fmt::format("tap_{0}(i) = tap_of_{0}(i);\n", path);  // rules alone are no argument
      for (std::size_t i = 0; i < taps; ++i)
        functions_ += fmt::format("tap_of_{}({}) = {};\n", path, i, faust_number(arrays_.pressure_taps[begin + i]));
      sum.add(fmt::format("({} : ci.taps({}, {}, tap_{}))", force, taps, literal(arrays_.pressure_rate_hz), path));
    }
  }

  std::vector<std::size_t> points_;                 // contacts, then frictions
  std::vector<std::string> states_, state_inputs_;  // stiffnesses that follow their controls
  std::vector<std::string> fed_back_memories_;
  std::vector<std::string> ratio_;        // stiffness of each connection
  std::vector<std::string> receptances_;  // of each pair of connections, first <= second
  std::vector<std::vector<std::string>> linear_solution_, reduced_;
  std::vector<std::string> forces_;  // of the contacts
  std::string sliders_, materials_, functions_;
};

}  // namespace

TemplateValues faust_instrument_values(const InstrumentModel& model, const InstrumentArrays& arrays) {
  return Writer(model, arrays).write();
}

}  // namespace contactspline
