// SPDX-License-Identifier: MIT
// The gradient of anything that is computed from the samples of a network in which bodies stretch, with respect to
// all its numbers at once: backwards (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/stretching_backwards.hpp"
#include "contactspline/tangent/stretching_body_tangent.hpp"
#include "contactspline/tangent/stretching_record.hpp"

namespace contactspline {

/// A ContactNetwork in which a body stretches that keeps what its gradient needs: in each sample a number for each
/// mode and each form, 3 numbers, and 9 for each spring and each contact that touches or remembers. As
/// RecordedNetwork, but places stay where the plan says, and contacts with a memory begin apart; at least one body of
/// the plan stretches.
template <std::floating_point T>
class RecordedStretching {
 public:
  /// The plan must outlive this.
  RecordedStretching(const NetworkPlan<T>& plan, double sample_rate_hz)
      : plan_(plan), rate_(sample_rate_hz), model_(plan, sample_rate_hz), modes_(plan, sample_rate_hz) {
    for (auto& last : last_increments_) last.resize(plan.connections().size());
    for (std::size_t k = 0; k < plan.connections().size(); ++k) {
      remembered_[0].push_back(ContactMemory<T>(plan.connections()[k].memories, sample_rate_hz / 2).remembered());
      remembered_[1].push_back(model_.solver()[k].memory.remembered());
    }
  }

  /// ContactNetwork::set_motion. A value beyond its range acts as the end of the range: its derivative is 0. If one
  /// of them is not a number the call does nothing, and the gradient leaves it out.
  void set_motion(std::size_t body, T displacement_m, T velocity_m_per_s, std::size_t mode = 0) {
    if (!is_number(displacement_m) || !is_number(velocity_m_per_s)) return;
    const ModalBank<T>& bank = model_.body(body);
    const T before = bank.displacement(mode);
    model_.set_motion(body, displacement_m, velocity_m_per_s, mode);
    for (auto& last : last_increments_) std::ranges::fill(last, T(0));
    record_.motions.push_back({body, bank.displacement(mode), held(T(0), velocity_m_per_s, Ranges::speed_m_per_s),
                               is_within(displacement_m, Ranges::displacement_m),
                               is_within(velocity_m_per_s, Ranges::speed_m_per_s)});
    record_.settings.push_back({mode, before, changes_of(body)});
  }

  /// Pushes at a place during the next sample [N], -1000 to 1000, with the same rules. Several pushes add up.
  void push(std::size_t place, T force_n) {
    if (!is_number(force_n)) return;
    model_.push(place, force_n);
    record_.pushes.push_back({place, held(T(0), force_n, Ranges::force_n), is_within(force_n, Ranges::force_n)});
  }

  /// Advances one sample. Allocates now and then.
  void tick() {
    model_.tick();
    for (std::size_t k = 0; k < plan_.connections().size(); ++k) keep(k);
    for (std::size_t f = 0; f < plan_.forms(); ++f)
      record_.form_forces.push_back(model_.solver()[plan_.connections().size() + f].force);
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b)
      std::ranges::copy(model_.body(b).displacements(), std::back_inserter(record_.states));
    record_.ends.push_back({record_.acting.size(), record_.pushes.size(), record_.motions.size()});
  }

  [[nodiscard]] const ContactNetwork<T>& model() const { return model_; }
  [[nodiscard]] std::size_t samples() const { return record_.ends.size(); }  ///< that were played

  /// The gradient of sum(weights times samples): goes back once through everything.
  [[nodiscard]] NetworkGradient<T> gradient(const NetworkWeights<T>& weights) const {
    return detail::StretchingBackwards<T>(plan_, rate_, model_.solver(), record_, weights).gradient();
  }

 private:
  using Ranges = ControlRanges<T>;

  [[nodiscard]] static bool is_within(T value, ControlRange<T> range) { return held(T(0), value, range) == value; }

  // The changes of modes over the last sample that TwoStepMotion::take_motion finds.
  [[nodiscard]] std::vector<T> changes_of(std::size_t body) const {
    const ModalBank<T>& bank = model_.body(body);
    std::vector<T> changes(bank.free_increments().begin(), bank.free_increments().end());
    for (const StretchForm& form : plan_.forms(body)) {
      if (!modes_.acts(body, form)) continue;
      std::vector<T> gradient(bank.size());
      detail::take_form_gradient(form, bank.displacements().data(), gradient);
      T force = detail::stretch_beside_gradient(form, bank.displacements().data());
      for (std::size_t i = 0; i < bank.size(); ++i) force += gradient[i] * bank.displacement(i);
      force *= static_cast<T>(form.stiffness_j);
      for (std::size_t i = 0; i < bank.size(); ++i) changes[i] += force * gradient[i] * bank.receptance(i);
    }
    for (std::size_t i = 0; i < bank.size(); ++i) {
      const std::size_t m = modes_.begins[body] + i;
      const bool has_velocity = double(modes_.loss[m]) <= detail::kMaxLoss;
      changes[i] =
          has_velocity ? (changes[i] + modes_.stiffness[m] * bank.displacement(i)) / (1 - modes_.loss[m]) : T(0);
    }
    return changes;
  }

  // Keeps springs, and contacts that press, remember, or whose loss in the next step may follow this one.
  void keep(std::size_t k) {
    const std::size_t step = samples() % 2;  // even or odd
    const CoupledConnection<T>& c = model_.solver()[k];
    const auto remembered = std::exchange(remembered_[step][k], c.memory.remembered());
    if (!c.table.empty() && !(c.force > 0 || c.compression > 0 || remembered.line() > 0)) return;
    const T before = model_.compression_before(k);
    record_.acting.push_back({k, {before, c.compression, c.force, last_increments_[step][k], remembered.values()}});
    last_increments_[step][k] = c.compression - before;
  }

  const NetworkPlan<T>& plan_;
  double rate_;
  ContactNetwork<T> model_;
  detail::NetworkModes<T> modes_;
  detail::StretchingRecord<T> record_;
  // Of each connection, before its next even or odd step: what it remembers, and its last increment.
  std::array<std::vector<detail::RememberedForces<T>>, 2> remembered_;
  std::array<std::vector<T>, 2> last_increments_;
};

}  // namespace contactspline
