// SPDX-License-Identifier: MIT
#include "generator/instrument/static_equilibrium.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "contactspline/instrument/instrument_parts.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kBalanced = 1e-9;      // part of the forces that may be left
constexpr double kReleased = 1e-12;     // part of the loads that a weak spring may hold at last
constexpr double kLinkStiffness = 1e8;  // [N/m]
constexpr double kReach_m = 0.01;       // by which the loads move a free mass in the first round
constexpr double kFar_m = 1;            // a mass that moves so far is held by nothing
constexpr int kMaxRounds = 40, kMaxSteps = 100;

// Calls visit(place, force_n) with the first values of the controls of force.
template <typename Visit>
void for_each_push(const InstrumentData& data, Visit visit) {
  for (std::size_t c = 0; c < data.controls.size(); ++c)
    if (data.controls[c].quantity == ControlQuantity::kForce)
      for (const std::size_t place : data.targets_of(data.controls[c])) visit(place, data.first_value(c));
}

/// The network at rest: modes bend under loads and the forces of connections, which follow from the compressions.
class StaticNetwork {
 public:
  explicit StaticNetwork(const InstrumentData& data)
      : data_(data),
        parts_(data),
        ends_(MatrixXd::Zero(std::ssize(data.masses), std::ssize(data.connections))),
        loads_(VectorXd::Zero(std::ssize(data.masses))),
        gaps_(Eigen::Map<const VectorXd>(parts_.gaps_m.data(), std::ssize(parts_.gaps_m))) {
    for (Index k = 0; k < ends_.cols(); ++k) {
      add_shapes(connection(k).first, 1, ends_.col(k));
      add_shapes(connection(k).second, -1, ends_.col(k));
    }
    for_each_push(data, [&](std::size_t place, double force_n) { add_shapes(place, force_n, loads_); });
  }

  /// Forces of the connections where all displacements are 0 [N].
  [[nodiscard]] VectorXd forces_at_0() const { return laws_at(-gaps_).force; }

  /// Do these forces and the loads balance each other?
  [[nodiscard]] bool is_balanced(const VectorXd& forces) const {
    const VectorXd left = loads_ - ends_ * forces, sizes = loads_.cwiseAbs() + ends_.cwiseAbs() * forces.cwiseAbs();
    return (left.array().abs() <= kBalanced * sizes.array()).all();
  }

  /// The compressions at rest [m], or nothing where a mass finds no hold. A weak spring holds each free mass. In each
  /// round it begins relaxed, where the mass has come to, and half as stiff, until it pulls no longer.
  [[nodiscard]] std::optional<VectorXd> compressions() const {
    const double load = loads_.cwiseAbs().sum() + forces_at_0().cwiseAbs().sum();
    const VectorXd stiffnesses = mode_stiffnesses();
    VectorXd start = VectorXd::Zero(loads_.size()), forces = VectorXd::Zero(gaps_.size()), left = loads_;
    double reach = kReach_m;
    for (int round = 0; round < kMaxRounds; ++round, reach *= 2) {
      const VectorXd compliances = stiffnesses.unaryExpr([&](double k) { return k > 0 ? 1 / k : reach / load; });
      const MatrixXd coupling = ends_.transpose() * compliances.asDiagonal() * ends_;
      const VectorXd before = forces;
      const VectorXd compressions = ends_.transpose() * (start + compliances.cwiseProduct(left)) - gaps_;
      if (!solve(coupling, compressions, forces)) return {};
      left = loads_ - ends_ * forces;
      double pull = 0;  // of the weak springs
      for (Index i = 0; i < left.size(); ++i) {
        if (stiffnesses(i) > 0) continue;
        pull = std::max(pull, std::abs(left(i)));
        start(i) += compliances(i) * left(i);
        if (!(std::abs(start(i)) < kFar_m)) return {};
      }
      if (pull <= kReleased * load) return compressions - coupling * (forces - before);
    }
    return {};
  }

 private:
  struct Laws {
    VectorXd force, slope;
    double energy = 0;
  };

  [[nodiscard]] const InstrumentConnection& connection(Index k) const {
    return parts_.connections[static_cast<std::size_t>(k)];
  }

  template <typename Modes>
  void add_shapes(std::size_t place, double factor, Modes&& modes) const {
    if (place == kGround) return;
    const std::size_t body = data_.place_bodies[place];
    const auto shapes = data_.shapes_of(place);
    modes.segment(static_cast<Index>(data_.body_ends[body] - shapes.size()), std::ssize(shapes)) +=
        factor * Eigen::Map<const VectorXd>(shapes.data(), std::ssize(shapes));
  }

  // [N/m]; 0 of free masses.
  [[nodiscard]] VectorXd mode_stiffnesses() const {
    VectorXd all(loads_.size());
    for (std::size_t i = 0; i < data_.masses.size(); ++i)
      all(static_cast<Index>(i)) =
          data_.masses[i] * (std::pow(data_.angular_frequencies[i], 2) + std::pow(data_.decays[i], 2));
    return all;
  }

  // Of a spring or link, or of a contact in parts of its table. A memory that has relaxed takes its part.
  [[nodiscard]] double stiffness(Index k) const {
    const InstrumentConnection& c = connection(k);
    if (c.kind == ConnectionKind::kFriction) return 0;  // its bristles are relaxed
    if (c.kind == ConnectionKind::kLink) return kLinkStiffness;
    if (c.kind == ConnectionKind::kSpring) return c.stiffness_n_per_m;
    double left = 1;
    for (const Memory& memory : data_.memories_of(c.table)) left -= memory.weight;
    return left * c.weight * parts_.ratios[static_cast<std::size_t>(k)];
  }

  [[nodiscard]] Laws laws_at(const VectorXd& y) const {
    Laws laws{VectorXd(y.size()), VectorXd(y.size())};
    for (Index k = 0; k < y.size(); ++k) {
      const double ratio = stiffness(k);
      Segment<double> law{0, 0, 0, 0.5};  // of a spring of 1 N/m
      if (connection(k).kind == ConnectionKind::kContact) {
        const SegmentTable<double> table = parts_.tables[connection(k).table];
        law = table[segment_index(table, y(k))];
      }
      laws.energy += ratio * law.energy_at(y(k));
      laws.force(k) = ratio * law.force_at(y(k));
      laws.slope(k) = ratio * 2 * law.half_curvature;
    }
    return laws;
  }

  // From forces and the compressions under them, Newton's method on law(compressions - C change) = forces + change.
  // The energy f C f/2 + sum of the connections' is convex, and steps are halved until it falls.
  [[nodiscard]] bool solve(const MatrixXd& coupling, const VectorXd& compressions, VectorXd& forces) const {
    if (forces.size() == 0) return true;
    const VectorXd before = forces;
    const auto look = [&](const VectorXd& f) {
      const VectorXd moved = coupling * (f - before);
      Laws laws = laws_at(compressions - moved);
      laws.energy += (f + before).dot(moved) / 2;
      return laws;
    };
    Laws now = look(forces);
    double left = (now.force - forces).cwiseAbs().maxCoeff();
    for (int steps = 0; steps < kMaxSteps && left > 1e-14 * now.force.cwiseAbs().maxCoeff(); ++steps) {
      const MatrixXd matrix = MatrixXd::Identity(forces.size(), forces.size()) + now.slope.asDiagonal() * coupling;
      const VectorXd step = matrix.partialPivLu().solve(now.force - forces);
      bool is_better = false;
      for (double length = 1; !is_better && length > 1e-9; length /= 2) {
        const VectorXd trial = forces + length * step;
        const Laws next = look(trial);
        const double next_left = (next.force - trial).cwiseAbs().maxCoeff();
        is_better = next.energy < now.energy || next_left < left / 2;
        if (is_better) now = next, forces = trial, left = next_left;
      }
      if (!is_better) break;  // but for rounding it is found
    }
    return left <= kBalanced * now.force.cwiseAbs().maxCoeff();
  }

  const InstrumentData& data_;
  detail::InstrumentParts<double> parts_;  // with the first values of the controls
  MatrixXd ends_;                          // of connections by modes: what compresses a connection
  VectorXd loads_, gaps_;
};

// The gaps at rest, less the shifts that controls add at first.
std::vector<double> gaps_at_rest(const InstrumentData& data, const VectorXd& compressions) {
  const detail::InstrumentParts<double> parts(data);
  std::vector<double> gaps_m;
  for (std::size_t k = 0; k < data.connections.size(); ++k) {
    const InstrumentConnection& c = data.connections[k];
    const double shift = parts.gaps_m[k] - c.gap_m;
    // A link is as long as it is under its load: its stiffness depends on the sample rate.
    const bool has_gap = c.kind == ConnectionKind::kContact || c.kind == ConnectionKind::kSpring;
    const double gap = has_gap ? -compressions(static_cast<Index>(k)) : 0;
    gaps_m.push_back(rounded_to(gap - shift, 13));
  }
  return gaps_m;
}

bool is_free_mass(const InstrumentData& data, std::size_t body) {
  const std::size_t last = data.body_ends[body] - 1;
  return data.modes_of(body) == 1 && data.angular_frequencies[last] == 0 && data.decays[last] == 0;
}

// What holds bodies at rest, other than free masses, which are in balance.
std::vector<HoldingForce> holding_forces(const InstrumentData& data, const VectorXd& forces) {
  std::vector<double> holds(data.place_bodies.size());
  for (std::size_t k = 0; k < data.connections.size(); ++k) {
    const double force = forces(static_cast<Index>(k));
    if (data.connections[k].first != kGround) holds[data.connections[k].first] += force;
    if (data.connections[k].second != kGround) holds[data.connections[k].second] -= force;
  }
  for_each_push(data, [&](std::size_t place, double force_n) { holds[place] -= force_n; });
  std::vector<HoldingForce> all;
  for (std::size_t place = 0; place < holds.size(); ++place)
    if (holds[place] != 0 && !is_free_mass(data, data.place_bodies[place]))
      all.push_back({place, rounded_to(holds[place], 13)});
  return all;
}

}  // namespace

StaticEquilibrium static_equilibrium(const InstrumentData& data) {
  StaticEquilibrium rest;
  for (const InstrumentConnection& connection : data.connections) rest.gaps_m.push_back(connection.gap_m);
  const StaticNetwork network(data);
  VectorXd forces = network.forces_at_0();
  if (!network.is_balanced(forces)) {
    const std::optional<VectorXd> compressions = network.compressions();
    if (compressions && (compressions->array().abs() <= ControlRanges<double>::gap_m.max).all()) {
      rest.gaps_m = gaps_at_rest(data, *compressions);
      InstrumentData at_rest = data;
      std::vector<InstrumentConnection> connections(data.connections.begin(), data.connections.end());
      for (std::size_t k = 0; k < connections.size(); ++k) connections[k].gap_m = rest.gaps_m[k];
      at_rest.connections = connections;
      forces = StaticNetwork(at_rest).forces_at_0();
      rest.holds = holding_forces(at_rest, forces);
    } else {
      forces.setZero();
    }
  }
  rest.forces_n.assign(forces.begin(), forces.end());
  return rest;
}

}  // namespace contactspline
