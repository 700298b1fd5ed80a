// SPDX-License-Identifier: MIT
// The gradient of anything that is computed from a struck string's samples, with respect to all numbers of the strike
// at once: backwards.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/tangent/strike.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // of vectors that are returned: only by functions that are always inline

namespace contactspline {

namespace detail {

/// What a sample of a strike is differentiated at.
template <std::floating_point T>
struct StrikeSample {
  ContactSample<T> contact = {};
  bool flies = false;  // the hammer
};

/// The samples of a strike backwards, a block at a time. The adjoint of a value is the derivative of the sum with
/// respect to it.
template <std::floating_point T>
class StrikeBackwards {
 public:
  StrikeBackwards(const HammerStrike<T>& strike, double sample_rate_hz, std::size_t block)
      : strike_(strike),
        rate_(sample_rate_hz),
        dt_(static_cast<T>(1 / sample_rate_hz)),
        modes_(strike, sample_rate_hz),
        receptance_(dt_ * dt_ / (2 * strike.controls.hammer_mass_kg) + modes_.receptance),
        samples_(block),
        moved_(block * modes_.padded_size()),
        displaced_(moved_.size()),
        adjoints_(strike.modes.size()),
        felt_(strike.felt, strike.memories, strike.controls.felt, sample_rate_hz) {}

  /// The samples after the hammer is stopped. model: then. Their output is linear in the motion of the modes then,
  /// and so are the adjoints of the constants: nothing is played.
  void begin(HammerString<T> model, std::span<const T> output_weights) {
    const std::size_t modes = modes_.padded_size();
    ModeLines<T> displacement(strike_.modes.size()), increment(strike_.modes.size());
    std::ranges::copy(model.string().displacements(), displacement.data());
    model.tick(strike_.controls);
    std::ranges::copy(model.string().changes(), increment.data());
    for (std::size_t i = 0; i < modes; i += kLaneCount<T>) {
      const Lanes<T> keep = load(&modes_.keep.data()[i]), pull = load(&modes_.pull.data()[i]);
      const Lanes<T> output = load(&modes_.output.data()[i]);
      // Derivatives of the sum, without the output's shapes, with respect to displacement and increment (q, d), and
      // of these with respect to keep and pull.
      Lanes<T> q{}, d{}, q_keep{}, d_keep{}, q_pull{}, d_pull{};
      for (std::size_t n = output_weights.size(); n-- > 0;) {
        q += output_weights[n] - pull * d;
        q_keep -= pull * d_keep;
        q_pull -= pull * d_pull + d;
        d_keep = keep * d_keep + q_keep + d;
        d_pull = keep * d_pull + q_pull;
        d = keep * d + q;
      }
      const Lanes<T> q0 = load(&displacement.data()[i]), d0 = load(&increment.data()[i]);
      store<T>(output * q, adjoints_.displacement.data() + i);
      store<T>(output * d, adjoints_.increment.data() + i);
      store<T>(output * (q_keep * q0 + d_keep * d0), adjoints_.keep.data() + i);
      store<T>(output * (q_pull * q0 + d_pull * d0), adjoints_.pull.data() + i);
      store<T>(q * q0 + d * d0, adjoints_.output.data() + i);
    }
  }

  /// Plays the samples of a block again and keeps what each needs.
  void record(HammerString<T>& model, std::size_t count) {
    const std::size_t modes = modes_.padded_size();
    for (std::size_t n = 0; n < count; ++n) {
      StrikeSample<T>& sample = samples_[n];
      const ContactMemory<T>& memory = model.memory();
      sample = {{model.compression(), 0, 0, memory.last_increment(), memory.remembered().values()},
                model.is_hammer_flying()};
      model.tick(strike_.controls);
      sample.contact.after = model.compression();
      sample.contact.force = model.force();
      std::ranges::copy(model.string().changes(), &moved_[n * modes]);
      std::ranges::copy(model.string().displacements(), &displaced_[n * modes]);
    }
  }

  /// One recorded sample, which adds its weights times output and force to the sum.
  void step(std::size_t n, T output_weight, T force_weight) {
    retract(n, output_weight);
    if (!samples_[n].flies) return;
    const ContactSample<T>& sample = samples_[n].contact;
    const T force = force_weight - dt_ / strike_.controls.hammer_mass_kg * velocity_ + by_force(sample.force);
    velocity_per_force_ -= sample.force * velocity_;
    const T increment = contact(sample, force);
    velocity_ += dt_ * increment;
    const T* moved = &moved_[n * modes_.padded_size()];
    for (std::size_t i = 0; i < modes_.padded_size(); ++i) {
      adjoints_.increment[i] -= modes_.strike[i] * increment;
      adjoints_.strike[i] -= (moved[i] - modes_.push[i] * sample.force) * increment;
    }
  }

  /// After the first sample: the gradient.
  [[nodiscard]] StrikeNumbers<T> gradient() {
    StrikeNumbers<T>& g = gradient_;
    const T mass = strike_.controls.hammer_mass_kg;
    g.hammer_mass_kg = -dt_ / (mass * mass) * (velocity_per_force_ + dt_ / 2 * receptance_slope_);
    g.velocity_m_per_s = velocity_;
    g.distance_m = -compression_;
    g.felt = felt_.gradient();
    finish_modes();
    return g;
  }

 private:
  /// The adjoints of state and constants of each mode.
  struct ModeAdjoints {
    ModeLines<T> displacement, increment, change;  ///< change: of the last sample, as the force sees it
    ModeLines<T> keep, pull, push, strike, output;

    explicit ModeAdjoints(std::size_t n)
        : displacement(n), increment(n), change(n), keep(n), pull(n), push(n), strike(n), output(n) {}
  };

  // The modes back over a sample.
  void retract(std::size_t n, T output_weight) {
    const std::size_t modes = modes_.padded_size();
    const T* __restrict moved = &moved_[n * modes], * __restrict displaced = &displaced_[n * modes];
    const T* __restrict keep = modes_.keep.data(), * __restrict pull = modes_.pull.data();
    const T* __restrict output = modes_.output.data();
    T* __restrict q = adjoints_.displacement.data(), * __restrict d = adjoints_.increment.data();
    T* __restrict by_keep = adjoints_.keep.data(), * __restrict by_pull = adjoints_.pull.data();
    T* __restrict by_output = adjoints_.output.data(), * __restrict change = adjoints_.change.data();
    for (std::size_t i = 0; i < modes; ++i) {
      const T next = d[i], displacement = q[i] + output_weight * output[i] - pull[i] * next;
      q[i] = displacement;
      d[i] = keep[i] * next + displacement;
      by_keep[i] += moved[i] * next;
      by_pull[i] -= displaced[i] * next;
      by_output[i] += output_weight * displaced[i];
      change[i] = d[i] + next;
    }
  }

  // The adjoint of the force of this sample through the modes.
  T by_force(T force) {
    const std::size_t modes = modes_.padded_size();
    for (std::size_t i = 0; i < modes; ++i) adjoints_.push[i] += force * adjoints_.change[i];
    return product<T>(modes_.push, adjoints_.change.data());
  }

  // The contact back over a sample: last increment and memory, then step. Returns the adjoint of the free increment.
  T contact(const ContactSample<T>& sample, T force) {
    const auto relaxed = felt_.relax(sample);
    compression_ += relaxed.after;
    const auto step = felt_.linearise(sample, receptance_);
    const T change = (force - receptance_ * compression_) / step.slopes.gain;
    felt_.push(sample, step, change);
    const T increment = compression_ + step.slopes.after * change;
    receptance_slope_ -= sample.force * increment;
    compression_ += step.slopes.moved() * change + relaxed.before;
    return increment;
  }

  void finish_modes() {
    StrikeNumbers<T>& g = gradient_;
    const T gain = modes_.gain;
    g.strike = g.output = ModeShapes<T>(strike_.modes.size());
    for (std::size_t i = 0; i < strike_.modes.size(); ++i) {
      const T shape = modes_.strike[i];
      const T push = adjoints_.push[i] + shape * receptance_slope_;  // the string's receptance is push times shape
      const auto by = [&](const Mode& direction) {
        const ModeStep step = step_tangent(strike_.modes[i], direction, rate_);
        return double(gain) * (double(adjoints_.pull[i]) * step.stiffness - double(adjoints_.keep[i]) * step.loss +
                               double(push * shape) * step.receptance);
      };
      g.modes.push_back({by({1, 0, 0}), by({0, 1, 0}), by({0, 0, 1})});
      const T receptance = gain * static_cast<T>(step_of(strike_.modes[i], rate_).receptance);
      g.strike[i] = adjoints_.strike[i] + receptance * push + modes_.push[i] * receptance_slope_;
      g.output[i] = adjoints_.output[i];
    }
  }

  const HammerStrike<T>& strike_;
  double rate_;
  T dt_;
  StrikeModes<T> modes_;
  T receptance_;
  std::vector<StrikeSample<T>> samples_;
  std::vector<T> moved_, displaced_;  // of each sample and mode
  ModeAdjoints adjoints_;
  ContactBackwards<T> felt_;
  T compression_ = 0, velocity_ = 0;  // adjoints of the state of the hammer
  T receptance_slope_ = 0, velocity_per_force_ = 0;
  StrikeNumbers<T> gradient_;
};

}  // namespace detail

/// The gradient of sum(output_weights[n] output[n]) + sum(force_weights[n] force[n]) over the samples of a strike
/// with respect to all its numbers. For a function of the samples, the weights are its derivatives with respect to
/// them. Missing force_weights are 0. It plays the flight of the hammer twice and goes back once through everything;
/// memory grows with the square root of the number of samples.
template <std::floating_point T>
[[nodiscard]] StrikeNumbers<T> strike_gradient(const HammerStrike<T>& strike, double sample_rate_hz,
                                               std::span<const T> output_weights,
                                               std::span<const T> force_weights = {}) {
  const std::size_t samples = output_weights.size();
  const auto block = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(samples))));
  detail::StrikeBackwards<T> backwards(strike, sample_rate_hz, block);
  std::vector<HammerString<T>> begins;  // of each block
  HammerString<T> model = detail::struck(strike, sample_rate_hz);
  std::size_t flight = 0;
  for (; flight < samples && model.is_hammer_flying(); ++flight) {
    if (flight % block == 0) begins.push_back(model);
    model.tick(strike.controls);
  }
  backwards.begin(model, output_weights.subspan(flight));
  for (; !begins.empty(); begins.pop_back()) {
    const std::size_t first = (begins.size() - 1) * block, count = (std::min)(block, flight - first);
    backwards.record(begins.back(), count);
    for (std::size_t n = count; n-- > 0;)
      backwards.step(n, output_weights[first + n],
                     first + n < force_weights.size() ? force_weights[first + n] : T(0));
  }
  return backwards.gradient();
}

}  // namespace contactspline

#pragma GCC diagnostic pop
