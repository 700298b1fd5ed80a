// SPDX-License-Identifier: MIT
// A struck string with its derivatives with respect to several parameters, forwards.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/tangent/strike.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // of vectors that are returned: only by functions that are always inline

namespace contactspline {

/// A strike with its derivatives with respect to P parameters, sample by sample. The tangents of the modes are modes
/// that are driven by the tangents of the force. No allocation after construction.
template <std::floating_point T, std::size_t P>
class StrikeTangent {
 public:
  using Number = Dual<T, P>;

  /// directions: one for each parameter.
  StrikeTangent(const HammerStrike<T>& strike, double sample_rate_hz,
                const std::array<StrikeNumbers<T>, P>& directions)
      : model_(detail::struck(strike, sample_rate_hz)),
        modes_(strike, sample_rate_hz),
        contact_(strike.felt, strike.memories, sample_rate_hz,
                 detail::contacts_of(directions, &StrikeNumbers<T>::felt)),
        controls_(strike.controls),
        time_step_(static_cast<T>(1 / sample_rate_hz)),
        change_(strike.modes.size()),
        displacement_(strike.modes.size()),
        increment_(strike.modes.size()) {
    velocity_per_force_ = Number(time_step_) / detail::with_slopes(strike.controls.hammer_mass_kg, directions,
                                                                   &StrikeNumbers<T>::hammer_mass_kg);
    compression_ = Number(0) - detail::with_slopes(strike.distance_m, directions, &StrikeNumbers<T>::distance_m);
    velocity_ = detail::with_slopes(strike.velocity_m_per_s, directions, &StrikeNumbers<T>::velocity_m_per_s);
    Number string(modes_.receptance);
    for (std::size_t p = 0; p < P; ++p) {
      tangents_[p] = Tangent(strike, modes_, sample_rate_hz, directions[p]);
      string.slopes[p] = tangents_[p].receptance;
      varies_ = varies_ || !directions[p].modes.empty() || directions[p].output.size() > 0;
    }
    receptance_ = Number(time_step_ / 2) * velocity_per_force_ + string;
  }

  /// Advances one sample and returns the output.
  Number tick() {
    Number output;
    process({&output, 1});
    return output;
  }

  /// Advances out.size() samples and writes the output after each: many times as fast as tick() once the hammer is
  /// stopped.
  void process(std::span<Number> out) {
    while (!out.empty()) {
      const bool flies = model_.is_hammer_flying();
      const auto block = out.first(flies ? 1 : (std::min)(out.size(), kBlock));
      force_ = T(0);
      if (flies) {
        play_sample();
        varies_ ? advance<true, true>(block) : advance<true, false>(block);
      } else {
        varies_ ? advance<false, true>(block) : advance<false, false>(block);
      }
      out = out.subspan(block.size());
    }
  }

  [[nodiscard]] const Number& force() const { return force_; }              ///< over the last sample [N]
  [[nodiscard]] const Number& compression() const { return compression_; }  ///< after the last sample [m]
  /// True until the hammer is stopped.
  [[nodiscard]] bool is_hammer_flying() const { return model_.is_hammer_flying(); }

 private:
  using Lines = detail::ModeLines<T>;
  using Lanes = detail::Lanes<T>;
  static constexpr std::size_t kBlock = 8;  // samples of a free string at once

  /// The modes' tangents for one parameter, and how their constants change with it.
  struct Tangent : detail::StrikeLines<T> {
    using Constants = detail::StrikeLines<T>;
    using Constants::keep, Constants::pull, Constants::push, Constants::strike, Constants::output,
        Constants::receptance;
    Lines displacement, increment;

    Tangent() = default;
    Tangent(const HammerStrike<T>& of, const detail::StrikeModes<T>& modes, double rate,
            const StrikeNumbers<T>& direction)
        : Constants(of.modes.size()), displacement(of.modes.size()), increment(of.modes.size()) {
      for (std::size_t i = 0; i < of.modes.size(); ++i) {
        if (direction.output.size() > 0) output[i] = direction.output[i];
        if (direction.strike.size() > 0) strike[i] = direction.strike[i];
        push[i] = modes.gain * static_cast<T>(detail::step_of(of.modes[i], rate).receptance) * strike[i];
        if (!direction.modes.empty()) {
          const detail::ModeStep step = detail::step_tangent(of.modes[i], direction.modes[i], rate);
          keep[i] = -modes.gain * static_cast<T>(step.loss);
          pull[i] = modes.gain * static_cast<T>(step.stiffness);
          push[i] += modes.gain * static_cast<T>(step.receptance) * modes.strike[i];
        }
        receptance += push[i] * modes.strike[i] + modes.push[i] * strike[i];
      }
    }
  };

  // A sample of the model, with its contact. After the last one the modes are left to themselves: the model runs one
  // sample ahead, for their increments, and stops.
  void play_sample() {
    const T y = model_.compression();
    model_.tick(controls_);
    std::ranges::copy(model_.string().displacements(), displacement_.data());
    std::ranges::copy(model_.string().changes(), change_.data());
    collide(y);
    if (model_.is_hammer_flying()) return;
    model_.tick(controls_);
    std::ranges::copy(model_.string().changes(), increment_.data());
  }

  // The contact of a sample that the model has advanced from compression y.
  void collide(T y) {
    Number increment;
    const T force = model_.force();
    const std::span<const T> moved = model_.string().changes();
    for (std::size_t p = 0; p < P; ++p) {
      increment.slopes[p] = detail::product<T>(modes_.strike, tangents_[p].increment.data());
      for (std::size_t i = 0; i < moved.size(); ++i)
        increment.slopes[p] += tangents_[p].strike[i] * (moved[i] - modes_.push[i] * force);
    }
    compression_.value = y;
    const Number free_increment = Number(time_step_) * velocity_ - increment;  // of which the slopes count
    const auto step =
        contact_.advance(controls_.felt, compression_, free_increment, receptance_, force, model_.compression());
    compression_ = step.compression;
    force_ = step.force;
    velocity_ = velocity_ - velocity_per_force_ * force_;
  }

  // The tangents of the modes over a block, and the output. Played: one sample, in which the model has advanced the
  // modes; else they are free. Varies: their constants or the output's shapes have slopes.
  template <bool Played, bool Varies>
  void advance(std::span<Number> out) {
    using detail::load, detail::store;
    Lanes sums[P + 1][kBlock] = {};
    for (std::size_t i = 0; i < modes_.padded_size(); i += detail::kLaneCount<T>) {
      const Lanes keep = load(&modes_.keep.data()[i]), pull = load(&modes_.pull.data()[i]);
      const Lanes shape = load(&modes_.output.data()[i]), keep_less_pull = keep - pull;  // a shorter path from d to d
      Lanes q = load(&displacement_.data()[i]), d = load(&increment_.data()[i]);
      Lanes changes[kBlock], displacements[kBlock];
      if constexpr (Played) changes[0] = load(&change_.data()[i]), displacements[0] = q;
      for (std::size_t n = 0; !Played && n < out.size(); ++n) {
        changes[n] = d;
        displacements[n] = q += d;
        d = keep * d - pull * q;
      }
      store<T>(q, &displacement_.data()[i]);
      store<T>(d, &increment_.data()[i]);
      for (std::size_t n = 0; n < out.size(); ++n) sums[P][n] += shape * displacements[n];
      for (std::size_t p = 0; p < P; ++p) {
        Tangent& tangent = tangents_[p];
        q = load(&tangent.displacement.data()[i]), d = load(&tangent.increment.data()[i]);
        Lanes pushed{}, by_keep{}, by_pull{}, by_output{};
        if constexpr (Played)
          pushed = load(&modes_.push.data()[i]) * force_.slopes[p] + load(&tangent.push.data()[i]) * force_.value;
        if constexpr (Varies)
          by_keep = load(&tangent.keep.data()[i]), by_pull = load(&tangent.pull.data()[i]),
          by_output = load(&tangent.output.data()[i]);
        for (std::size_t n = 0; n < out.size(); ++n) {
          if constexpr (Played) d += pushed;
          const Lanes kept = keep_less_pull * d, pulled = pull * q;
          q += d;
          d = kept - pulled;
          if constexpr (Played) d += pushed;
          if constexpr (Varies) d += by_keep * changes[n] - by_pull * displacements[n];
          sums[p][n] += Varies ? shape * q + by_output * displacements[n] : shape * q;
        }
        store<T>(q, &tangent.displacement.data()[i]);
        store<T>(d, &tangent.increment.data()[i]);
      }
    }
    for (std::size_t n = 0; n < out.size(); ++n) {
      out[n].value = detail::sum_of_lanes<T>(sums[P][n]);
      for (std::size_t p = 0; p < P; ++p) out[n].slopes[p] = detail::sum_of_lanes<T>(sums[p][n]);
    }
  }

  HammerString<T> model_;  // until the hammer is stopped, and one sample more
  detail::StrikeModes<T> modes_;
  ContactTangent<T, P> contact_;
  HammerStringControls<T> controls_;
  T time_step_;
  Lines change_, displacement_, increment_;  // of the modes: over the last sample, after it, over the next if free
  std::array<Tangent, P> tangents_;
  bool varies_ = false;
  Number velocity_per_force_, receptance_, compression_, velocity_, force_;
};

}  // namespace contactspline

#pragma GCC diagnostic pop
