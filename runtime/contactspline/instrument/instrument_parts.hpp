// SPDX-License-Identifier: MIT
// From the arrays of an instrument to the plan of its network, with what its controls have set.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <optional>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline::detail {

/// What the network of an instrument is built of, and what its controls have set so far.
template <std::floating_point T>
struct InstrumentParts {
  explicit InstrumentParts(const InstrumentData& data)
      : connections(data.connections.begin(), data.connections.end()) {
    for (std::size_t t = 0, j = 0; t < data.table_ends.size(); ++t) {
      std::vector<Segment<T>>& table = tables.emplace_back(1);
      for (; j < data.table_ends[t]; ++j)
        table.push_back({static_cast<T>(data.knots[j]), static_cast<T>(data.energies[j]),
                         static_cast<T>(data.forces[j]), static_cast<T>(data.half_curvatures[j])});
    }
    for (const InstrumentConnection& connection : connections) {
      gaps_m.push_back(static_cast<T>(connection.gap_m));
      ratios.push_back(1);
    }
    places_m.resize(data.place_bodies.size());
    offsets_m.assign(data.offsets_m.begin(), data.offsets_m.end());
    offsets_m.resize(data.place_bodies.size());
    masses_kg.resize(data.body_ends.size());
    for (std::size_t c = 0; c < data.controls.size(); ++c)
      for (const std::size_t target : data.targets_of(data.controls[c]))
        set(data.controls[c].quantity, target, static_cast<T>(data.first_value(c)));
  }

  /// Keeps the value of a control for one of its targets.
  void set(ControlQuantity quantity, std::size_t target, T value) {
    switch (quantity) {
      case ControlQuantity::kStiffnessRatio:
        ratios[target] = value;
        break;
      case ControlQuantity::kLoss:
        connections[target].loss_s_per_m = double(value);
        break;
      case ControlQuantity::kGapShift:
        gaps_m[target] = held(gaps_m[target], static_cast<T>(connections[target].gap_m) + value,
                              gap_range<T>(connections[target]));
        break;
      case ControlQuantity::kStiffness:
        connections[target].stiffness_n_per_m = double(value);
        break;
      case ControlQuantity::kResistance:
        connections[target].resistance_n_s_per_m = double(value);
        break;
      case ControlQuantity::kPlace:
        places_m[target] = value + offsets_m[target];
        break;
      case ControlQuantity::kMass:
        masses_kg[target] = double(value);
        break;
      case ControlQuantity::kNormalForce:
        connections[target].friction.normal_force_n = connections[target].weight * double(value);
        break;
      case ControlQuantity::kSurfaceSpeed:
        connections[target].friction.surface_speed_m_per_s = double(value);
        break;
      case ControlQuantity::kForce:
      case ControlQuantity::kDamping:
        break;
    }
  }

  [[nodiscard]] ContactControls<T> contact(std::size_t k) const {
    return {ratios[k], static_cast<T>(connections[k].loss_s_per_m)};
  }

  /// The network with the values that are kept; friction is not pressed yet.
  [[nodiscard]] NetworkPlan<T> plan(const InstrumentData& data) const {
    NetworkPlan<T> plan;
    std::vector<Mode> modes;
    for (std::size_t b = 0, i = 0; b < data.body_ends.size(); ++b) {
      modes.clear();
      for (; i < data.body_ends[b]; ++i)
        modes.push_back({data.angular_frequencies[i], data.decays[i], data.masses[i]});
      if (masses_kg[b]) modes.front().mass_kg = *masses_kg[b];
      plan.add_body(modes, data.forms_of(b));
    }
    for (std::size_t p = 0; p < data.place_bodies.size(); ++p) {
      const std::size_t body = data.place_bodies[p];
      if (places_m[p])
        plan.add_moving_place(body, data.part_of(data.wavenumbers, body), *places_m[p]);
      else
        plan.add_place(body, data.shapes_of(p));
    }
    for (std::size_t k = 0; k < connections.size(); ++k) {
      const InstrumentConnection& c = connections[k];
      if (c.kind == ConnectionKind::kContact)
        plan.roughen(plan.add_contact(c.first, c.second, tables[c.table], gaps_m[k], contact(k),
                                      static_cast<T>(c.weight), data.memories_of(c.table)),
                     c.roughness);
      else if (c.kind == ConnectionKind::kSpring)
        plan.add_spring(c.first, c.second, static_cast<T>(c.stiffness_n_per_m),
                        static_cast<T>(c.resistance_n_s_per_m), gaps_m[k]);
      else if (c.kind == ConnectionKind::kLink)
        plan.add_rigid_link(c.first, c.second, gaps_m[k]);
      else
        plan.add_friction(c.first, c.second, c.friction.material, c.friction.width_m, c.friction.pressed_by);
    }
    return plan;
  }

  /// Do connections ask for double precision? Those that may be too stiff, with what the controls allow, and springs
  /// and links that may be strained at rest, beside whose gap single precision does not see small displacements.
  [[nodiscard]] bool needs_double(const InstrumentData& data, const ContactNetwork<T>& network,
                                  double sample_rate_hz) const {
    for (std::size_t k = 0; k < data.connections.size(); ++k) {
      const InstrumentConnection& c = data.connections[k];
      const double receptance = network.largest_receptance(k) + lightest(data, c, sample_rate_hz);
      if (c.kind == ConnectionKind::kLink && may_be_strained(data, k)) return true;
      if (c.kind == ConnectionKind::kSpring) {
        const double stiffness = largest(data, ControlQuantity::kStiffness, k, c.stiffness_n_per_m);
        const double resistance = largest(data, ControlQuantity::kResistance, k, c.resistance_n_s_per_m);
        if (stiffness > 0 && may_be_strained(data, k)) return true;
        if (receptance * (stiffness / 2 + resistance * sample_rate_hz) > kMaxSpring) return true;
      } else if (c.kind == ConnectionKind::kContact) {
        double half_curvature = 0;
        for (const Segment<T>& segment : tables[c.table])
          half_curvature = (std::max)(half_curvature, double(segment.half_curvature));
        const double ratio = c.weight * largest(data, ControlQuantity::kStiffnessRatio, k, 1);
        if (receptance * ratio * half_curvature > kMaxContact) return true;
      }
    }
    return false;
  }

  std::vector<InstrumentConnection> connections;
  std::vector<T> gaps_m, ratios, offsets_m;
  std::vector<std::optional<T>> places_m;        // of the places that a control moves
  std::vector<std::optional<double>> masses_kg;  // of the bodies, where a control sets it
  std::vector<std::vector<Segment<T>>> tables;

 private:
  // Largest slope of a force times receptance, of springs and of contacts, that single precision is trusted with.
  static constexpr double kMaxSpring = 100, kMaxContact = 1000;

  // May connection k have a gap at rest?
  [[nodiscard]] static bool may_be_strained(const InstrumentData& data, std::size_t k) {
    return data.connections[k].gap_m != 0 || std::ranges::any_of(data.controls, [&](const auto& control) {
             const std::span<const std::size_t> targets = data.targets_of(control);
             return control.quantity == ControlQuantity::kGapShift && std::ranges::find(targets, k) != targets.end();
           });
  }

  // The largest value that a quantity of connection k may have.
  [[nodiscard]] static double largest(const InstrumentData& data, ControlQuantity quantity, std::size_t k,
                                      double in_file) {
    for (std::size_t c = 0; c < data.controls.size(); ++c)
      for (const std::size_t target : data.targets_of(data.controls[c]))
        if (data.controls[c].quantity == quantity && target == k) in_file = (std::max)(in_file, data.range_of(c).max);
    return in_file;
  }

  // What controls of masses may add to the receptance of a connection.
  [[nodiscard]] double lightest(const InstrumentData& data, const InstrumentConnection& connection,
                                double sample_rate_hz) const {
    double added = 0;
    for (std::size_t c = 0; c < data.controls.size(); ++c)
      for (const std::size_t mass : data.targets_of(data.controls[c]))
        for (const std::size_t place : {connection.first, connection.second})
          if (data.controls[c].quantity == ControlQuantity::kMass && place != kGround &&
              data.place_bodies[place] == mass)
            added += (1 / data.range_of(c).min - 1 / *masses_kg[mass]) / (2 * sample_rate_hz * sample_rate_hz);
    return added;
  }
};

}  // namespace contactspline::detail
