// SPDX-License-Identifier: MIT
#include "generator/instrument/instrument.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

// The digits on which sin() and sqrt() of all machines agree.
double thirteen_digits(double value) {
  return rounded_to(value, 13);
}

/// Fills the arrays, part after part.
class Flattener {
 public:
  Flattener(const InstrumentModel& model, double max_frequency_hz)
      : model_(model), max_frequency_hz_(max_frequency_hz) {}

  InstrumentArrays flatten() {
    for (const InstrumentBody& body : model_.bodies) add_body(body);
    for (const InstrumentPlace& place : model_.places) add_place(place);
    for (const ContactTable& table : model_.tables) add_table(table);
    for (const ConnectionGroup& group : model_.connections) add_group(group);
    for (const ModelControl& control : model_.controls) add_control(control);
    for (const ModelOutput& output : model_.outputs) add_output(output);
    arrays_.strikes = model_.strikes;
    return std::move(arrays_);
  }

 private:
  void add_body(const InstrumentBody& body) {
    for (const ResonatorMode& mode : modes_of(body.resonator, max_frequency_hz_).modes) {
      arrays_.angular_frequencies.push_back(thirteen_digits(mode.mode.angular_frequency_rad_per_s));
      arrays_.decays.push_back(thirteen_digits(mode.mode.decay_per_s));
      arrays_.masses.push_back(thirteen_digits(mode.mode.mass_kg));
    }
    arrays_.body_ends.push_back(arrays_.masses.size());
  }

  // The shapes of a resonator at its pickup, with the pickup at this place.
  void add_place(const InstrumentPlace& place) {
    first_place_.push_back(arrays_.place_bodies.size());
    for (const Place& point : place.points) {
      Resonator resonator = model_.bodies[place.body].resonator;
      resonator.strike = {};
      resonator.pickup = point;
      if (auto* table = std::get_if<ModeTable>(&resonator.body))
        for (std::size_t i = 0; i < place.shapes.size(); ++i) table->rows[i].pickup_shape = place.shapes[i];
      arrays_.place_bodies.push_back(place.body);
      for (const ResonatorMode& mode : modes_of(resonator, max_frequency_hz_).modes)
        arrays_.shapes.push_back(thirteen_digits(mode.pickup_shape));
    }
  }

  void add_table(const ContactTable& table) {
    for (const Segment<double>& segment : std::span(table.segments).subspan(1)) {
      arrays_.knots.push_back(segment.knot);
      arrays_.energies.push_back(segment.energy);
      arrays_.forces.push_back(segment.force);
      arrays_.half_curvatures.push_back(segment.half_curvature);
    }
    arrays_.table_ends.push_back(arrays_.knots.size());
  }

  // Point i of a place, or its only point.
  [[nodiscard]] std::size_t point(std::size_t place, std::size_t i) const {
    if (place == kGround) return kGround;
    return first_place_[place] + (model_.places[place].points.size() == 1 ? 0 : i);
  }

  void add_group(const ConnectionGroup& group) {
    first_connection_.push_back(arrays_.connections.size());
    for (std::size_t i = 0; i < group.gaps_m.size(); ++i) {
      InstrumentConnection connection = group.each;
      connection.first = point(group.each.first, i);
      connection.second = point(group.each.second, i);
      connection.gap_m = group.gaps_m[i];
      if (!group.weights.empty()) connection.weight = group.weights[i];
      arrays_.connections.push_back(connection);
    }
  }

  void add_control(const ModelControl& control) {
    const std::size_t begin = arrays_.targets.size();
    for (const std::size_t target : control.targets) {
      if (control.quantity == ControlQuantity::kForce) {
        arrays_.targets.push_back(first_place_[target]);
      } else if (control.quantity == ControlQuantity::kDamping) {
        arrays_.targets.push_back(target);
      } else {
        add_connections(target);
      }
    }
    arrays_.controls.push_back({control.quantity, begin, arrays_.targets.size() - begin, control.initial,
                                control.range.min, control.range.max, control.release_n});
  }

  void add_output(const ModelOutput& output) {
    const std::size_t begin = arrays_.targets.size();
    for (const std::size_t target : output.targets) {
      if (output.quantity == OutputQuantity::kForce)
        add_connections(target);
      else
        arrays_.targets.push_back(output.is_end_force ? add_end(target) : first_place_[target]);
    }
    arrays_.outputs.push_back({output.quantity, begin, arrays_.targets.size() - begin, output.full_scale});
  }

  void add_connections(std::size_t group) {
    for (std::size_t i = 0; i < model_.connections[group].gaps_m.size(); ++i)
      arrays_.targets.push_back(first_connection_[group] + i);
  }

  // A place whose displacement is the force on the far end of a string.
  std::size_t add_end(std::size_t body) {
    const Resonator& resonator = model_.bodies[body].resonator;
    for (const ResonatorMode& mode : modes_of(resonator, max_frequency_hz_).modes)
      arrays_.shapes.push_back(thirteen_digits(bridge_shape(std::get<StiffString>(resonator.body), mode)));
    arrays_.place_bodies.push_back(body);
    return arrays_.place_bodies.size() - 1;
  }

  const InstrumentModel& model_;
  double max_frequency_hz_;
  InstrumentArrays arrays_;
  std::vector<std::size_t> first_place_, first_connection_;  // of each place and group
};

}  // namespace

std::string_view name_of(ConnectionKind kind) {
  constexpr std::array kNames = {"contact", "spring", "link"};  // in the order of ConnectionKind
  return kNames[static_cast<std::size_t>(kind)];
}

std::string strike_name(const InstrumentModel& model, std::size_t strike) {
  return model.bodies[model.strikes[strike]].name + "_speed_m_per_s";
}

Range range_of(ControlQuantity quantity) {
  const auto [min, max] = control_range<double>(quantity);
  return {min, max};
}

const char* key_of(ControlQuantity quantity) {
  constexpr std::array kKeys = {"force_n",     "damping_per_s",     "stiffness_ratio",     "loss_s_per_m",
                                "gap_shift_m", "stiffness_n_per_m", "resistance_n_s_per_m"};  // in its order
  return kKeys[static_cast<std::size_t>(quantity)];
}

std::string_view unit_of(const ModelOutput& output) {
  if (output.quantity == OutputQuantity::kVelocity) return "m/s";
  return output.quantity == OutputQuantity::kForce || output.is_end_force ? "N" : "m";
}

InstrumentData InstrumentArrays::view() const {
  return {angular_frequencies, decays,     masses,      body_ends, place_bodies, shapes,  knots,  energies, forces,
          half_curvatures,     table_ends, connections, controls,  targets,      strikes, outputs};
}

InstrumentArrays arrays_of(const InstrumentModel& model, double max_frequency_hz) {
  return Flattener(model, max_frequency_hz).flatten();
}

void tune(InstrumentModel& model, double cents) {
  for (InstrumentBody& body : model.bodies)
    if (auto* string = std::get_if<StiffString>(&body.resonator.body)) string->detuning_cents.front() += cents;
}

std::optional<std::string> silent_body(const InstrumentModel& model, double max_frequency_hz) {
  for (const InstrumentBody& body : model.bodies)
    if (modes_of(body.resonator, max_frequency_hz).modes.empty()) return body.name;
  return {};
}

}  // namespace contactspline
