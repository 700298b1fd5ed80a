// SPDX-License-Identifier: MIT
// Where a network rests under its springs, contacts and pushes.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_parts.hpp"
#include "contactspline/step/contact.hpp"

namespace contactspline::detail {

/// Finds the displacements with the least potential energy, under the gaps and stiffnesses that the controls ask for
/// and the pushes of the last sample. The energy is convex, and Newton's method on the forces of the connections
/// lowers it in each step. Free masses are held by weak springs, which are relaxed and made weaker until they no
/// longer pull. Both have a bound on their steps (docs/how-it-works/several-contacts.md). In double precision,
/// whatever T is. No allocation after construction.
template <std::floating_point T>
class StaticEquilibrium {
 public:
  explicit StaticEquilibrium(const NetworkParts<T>& parts)
      : laws_(parts.connections.size()),
        compliance_(parts.connections.size() * parts.connections.size()),
        system_(parts.connections.size()) {
    for (const NetworkBody<T>& body : parts.bodies) {
      first_mode_.push_back(modes_.size());
      modes_.resize(modes_.size() + body.bank.size());
    }
    for (auto* list :
         {&unloaded_, &compression_, &force_, &law_force_, &root_slope_, &step_, &trial_, &trial_y_, &right_})
      list->resize(laws_.size());
  }

  /// Searches. False if all rests at displacement 0 as it is, or if nothing holds it.
  bool find(const NetworkParts<T>& parts, const CoupledContacts<T>& solver) {
    for (std::size_t k = 0; k < laws_.size(); ++k) laws_[k] = Law(parts.connections[k], solver[k]);
    const double load = take_loads(parts);
    if (is_balanced(parts)) return false;
    weak_spring_ = load / kReach_m;
    std::ranges::fill(force_, 0.0);
    for (int round = 0; round < kMaxRounds; ++round, weak_spring_ /= 4) {
      take_compliances(parts);
      if (!minimise(parts)) return false;
      const double pull = move(parts);
      if (pull <= kBalanced * load) return true;
      if (!(farthest() < kFar_m)) return false;
    }
    return false;
  }

  [[nodiscard]] double displacement(std::size_t body, std::size_t mode) const {  ///< found [m]
    return modes_[first_mode_[body] + mode].rest;
  }
  [[nodiscard]] double force(std::size_t connection) const { return law_force_[connection]; }  ///< found [N]

 private:
  static constexpr int kMaxRounds = 32, kMaxSteps = 64, kMaxHalvings = 30;
  static constexpr double kReach_m = 1e-4;  // so far the weak springs let the loads move a free mass at first
  static constexpr double kFar_m = 10;      // a mass that the loads move so far is held by nothing
  static constexpr double kBalanced = 1e-9, kFound = 1e-12;  // parts of the forces that may be left

  struct ModeAtRest {
    double compliance = 0;  // [m/N]
    double load = 0;        // of pushes [N]
    double start = 0;       // where the weak spring of a free mass is relaxed [m]
    double rest = 0;        // [m]
    bool is_free = false;
  };

  // The law of a connection at rest. A contact with memories has relaxed.
  struct Law {
    Law() = default;
    Law(const NetworkConnection<T>& plan, const CoupledConnection<T>& c)
        : table(c.table),
          stiffness(c.table.empty() ? double(plan.spring)
                                    : double(plan.contact.stiffness_ratio * plan.weight) * c.memory.held_stiffness()),
          gap(double(plan.target_gap)) {}

    struct Values {
      double energy, force, slope;
    };
    [[nodiscard]] Values at(double y) const {
      if (table.empty()) return {stiffness / 2 * y * y, stiffness * y, stiffness};
      if (!(y > 0)) return {0, 0, 0};
      const Segment<T>& s = table[segment_index(table, static_cast<T>(y))];
      const double d = y - double(s.knot), force = double(s.force), half_curvature = double(s.half_curvature);
      return {stiffness * (double(s.energy) + d * (force + d * half_curvature)),
              stiffness * (std::max)(0.0, force + 2 * d * half_curvature), stiffness * 2 * half_curvature};
    }

    SegmentTable<T> table = {};
    double stiffness = 0, gap = 0;
  };

  // use(connection, sign, shapes, modes): for each connection of each body. sign: of the compression by a
  // displacement.
  template <typename Use>
  void for_each_end(const NetworkParts<T>& parts, Use use) {
    for (std::size_t b = 0; b < parts.bodies.size(); ++b) {
      const NetworkBody<T>& body = parts.bodies[b];
      const std::size_t modes = body.bank.size();
      for (std::size_t i = 0; i < body.connections.size(); ++i)
        use(body.connections[i], std::span(body.shapes).subspan(i * modes, modes),
            std::span(modes_).subspan(first_mode_[b], modes));
    }
  }

  // The pushes as loads of the modes. Returns the sum of |force| of connections and pushes at displacement 0 [N].
  double take_loads(const NetworkParts<T>& parts) {
    double sum = 0;
    for (ModeAtRest& mode : modes_) mode = {};
    for (const NetworkPlace<T>& place : parts.places) {
      const double push = double(place.last_push);
      sum += std::abs(push);
      for (std::size_t i = 0; push != 0 && i < place.shapes.size(); ++i)
        modes_[first_mode_[place.body] + i].load += push * double(place.shapes[i]);
    }
    for (std::size_t k = 0; k < laws_.size(); ++k) {
      law_force_[k] = laws_[k].at(-laws_[k].gap).force;
      sum += std::abs(law_force_[k]);
    }
    return sum;
  }

  // Do the forces at displacement 0 balance each other in each mode?
  bool is_balanced(const NetworkParts<T>& parts) {
    for (ModeAtRest& mode : modes_) mode.rest = mode.load, mode.start = std::abs(mode.load);
    for_each_end(parts, [&](std::size_t k, std::span<const double> shapes, std::span<ModeAtRest> modes) {
      for (std::size_t i = 0; law_force_[k] != 0 && i < modes.size(); ++i) {
        modes[i].rest -= shapes[i] * law_force_[k];
        modes[i].start += std::abs(shapes[i] * law_force_[k]);
      }
    });
    const bool is_balanced =
        std::ranges::all_of(modes_, [](const ModeAtRest& m) { return std::abs(m.rest) <= kBalanced * m.start; });
    for (ModeAtRest& mode : modes_) mode.rest = mode.start = 0;
    return is_balanced;
  }

  void take_compliances(const NetworkParts<T>& parts) {
    for (std::size_t b = 0; b < parts.bodies.size(); ++b)
      for (std::size_t i = 0; i < parts.bodies[b].bank.size(); ++i) {
        const ModalBank<T>& bank = parts.bodies[b].bank;
        ModeAtRest& mode = modes_[first_mode_[b] + i];
        mode.compliance = bank.compliance(i);
        mode.is_free = mode.compliance == 0 && bank.admittance(i) > 0;
        if (mode.is_free) mode.compliance = 1 / weak_spring_;
      }
    const std::size_t n = laws_.size();
    std::ranges::fill(compliance_, 0.0);
    for (std::size_t b = 0; b < parts.bodies.size(); ++b) {
      const NetworkBody<T>& body = parts.bodies[b];
      const std::size_t modes = body.bank.size();
      for (std::size_t i = 0; i < body.connections.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j) {
          double sum = 0;
          for (std::size_t m = 0; m < modes; ++m)
            sum += modes_[first_mode_[b] + m].compliance * body.shapes[i * modes + m] * body.shapes[j * modes + m];
          const std::size_t k = body.connections[i], l = body.connections[j];
          compliance_[k * n + l] += sum;
          if (k != l) compliance_[l * n + k] += sum;
        }
    }
  }

  // to = compliance times forces.
  void bend(const std::vector<double>& forces, std::vector<double>& to) const {
    const std::size_t n = forces.size();
    for (std::size_t k = 0; k < n; ++k) {
      double sum = 0;
      for (std::size_t l = 0; l < n; ++l) sum += compliance_[k * n + l] * forces[l];
      to[k] = sum;
    }
  }

  struct State {
    double energy;             // without a constant [J]
    double residual, largest;  // of law and force, and their sum, in roots of joules
  };

  // The compressions under some forces, and what the laws answer.
  State evaluate(const std::vector<double>& forces, std::vector<double>& y) {
    const std::size_t n = laws_.size();
    bend(forces, y);
    State state{0, 0, 0};
    for (std::size_t k = 0; k < n; ++k) {
      state.energy += forces[k] * y[k] / 2;
      y[k] = unloaded_[k] - y[k];
      const auto [energy, force, slope] = laws_[k].at(y[k]);
      state.energy += energy;
      law_force_[k] = force;
      root_slope_[k] = std::sqrt(slope);
      const double root = std::sqrt(compliance_[k * n + k]);
      state.residual = (std::max)(state.residual, root * std::abs(force - forces[k]));
      state.largest = (std::max)(state.largest, root * (std::abs(force) + std::abs(forces[k])));
    }
    return state;
  }

  // Newton's method with halved steps from the forces of the last round. Has it found the least energy?
  bool minimise(const NetworkParts<T>& parts) {
    for (std::size_t k = 0; k < laws_.size(); ++k) unloaded_[k] = -laws_[k].gap;
    for_each_end(parts, [&](std::size_t k, std::span<const double> shapes, std::span<ModeAtRest> modes) {
      for (std::size_t i = 0; i < modes.size(); ++i)
        unloaded_[k] += shapes[i] * (modes[i].start + modes[i].compliance * modes[i].load);
    });
    State now = evaluate(force_, compression_);
    for (int steps = 0; steps < kMaxSteps && !(now.residual <= kFound * now.largest); ++steps) {
      if (!std::isfinite(now.energy)) return false;
      const double slope = choose_step();
      bool is_better = false;
      double length = 1;
      for (int halvings = 0; !is_better && halvings < kMaxHalvings; ++halvings, length /= 2) {
        for (std::size_t k = 0; k < laws_.size(); ++k) trial_[k] = force_[k] + length * step_[k];
        const State next = evaluate(trial_, trial_y_);
        is_better = next.energy <= now.energy + 1e-4 * length * slope || next.residual < now.residual / 2;
        if (is_better) now = next;
      }
      if (!is_better) {
        now = evaluate(force_, compression_);  // rounding, or it is not found
        break;
      }
      std::swap(force_, trial_);
      std::swap(compression_, trial_y_);
    }
    return now.residual <= kBalanced * now.largest;
  }

  // The step (1 + S C)^-1 (law - force), with S the slopes of the laws and C the compliances, by a symmetric matrix.
  // Returns the change of the energy along it [J].
  double choose_step() {
    const std::size_t n = laws_.size();
    for (std::size_t k = 0; k < n; ++k) step_[k] = law_force_[k] - force_[k];
    bend(step_, right_);
    double slope = 0;
    for (std::size_t j = 0; j < n; ++j) {
      double* column = system_.column(j);
      for (std::size_t i = 0; i < n; ++i)
        column[i] = root_slope_[i] * compliance_[i * n + j] * root_slope_[j] + (i == j ? 1 : 0);
      std::fill(column + n, column + system_.padded(n), 0.0);
      system_.right(j) = root_slope_[j] * right_[j];
    }
    system_.solve(n);
    for (std::size_t k = 0; k < n; ++k) step_[k] -= root_slope_[k] * system_.right(k);
    for (std::size_t k = 0; k < n; ++k) slope += step_[k] * right_[k];
    return -slope;
  }

  // Moves the modes to where the forces hold them. Returns the largest force of a weak spring [N].
  double move(const NetworkParts<T>& parts) {
    for (ModeAtRest& mode : modes_) mode.rest = mode.load;
    for_each_end(parts, [&](std::size_t k, std::span<const double> shapes, std::span<ModeAtRest> modes) {
      for (std::size_t i = 0; i < modes.size(); ++i) modes[i].rest -= shapes[i] * law_force_[k];
    });
    double pull = 0;
    for (ModeAtRest& mode : modes_) {
      const double force = mode.rest;
      mode.rest = mode.start + mode.compliance * force;
      if (!mode.is_free) continue;
      pull = (std::max)(pull, std::abs(force));
      mode.start = mode.rest;
    }
    return pull;
  }

  [[nodiscard]] double farthest() const {
    double farthest = 0;
    for (const ModeAtRest& mode : modes_)
      if (mode.is_free && !(std::abs(mode.rest) <= farthest)) farthest = std::abs(mode.rest);
    return farthest;
  }

  std::vector<Law> laws_;                // of the connections
  std::vector<std::size_t> first_mode_;  // of the bodies
  std::vector<ModeAtRest> modes_;        // of all bodies
  std::vector<double> compliance_;       // of all pairs of connections [m/N]
  LinearSystem<double> system_;
  std::vector<double> unloaded_, compression_;  // without and with the forces of the connections [m]
  std::vector<double> force_, law_force_;       // assumed, and by the laws [N]
  std::vector<double> root_slope_, step_, trial_, trial_y_, right_;
  double weak_spring_ = 0;  // [N/m]
};

}  // namespace contactspline::detail
