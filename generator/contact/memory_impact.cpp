// SPDX-License-Identifier: MIT
#include "generator/contact/memory_impact.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/roots.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace contactspline {
namespace {

namespace odeint = boost::numeric::odeint;
namespace tools = boost::math::tools;

/// Compression, velocity and what each memory holds, in units of a length, the impact speed and a force.
using State = std::vector<double>;
using Stepper = odeint::runge_kutta_fehlberg78<State>;

/// The equations of motion in these units; time is in units of length over speed.
class Motion {
 public:
  Motion(const LawView& law, double mass_kg, double speed, double loss, std::span<const Memory> memories)
      : law_(law), memories_(memories), speed_(speed), loss_(loss) {
    double slow = 1;
    for (const Memory& memory : memories) slow -= memory.weight;
    const double energy = mass_kg * speed * speed / 2;
    length_ = compression_at_energy(law, energy / slow);  // of a blow that the memories follow
    force_ = law.force(length_);
    acceleration_ = force_ * length_ / (mass_kg * speed * speed);
  }

  /// F(y) - sum w_i M_i, without loss: negative where the bodies are apart.
  [[nodiscard]] double spring(const State& x) const {
    double force = elastic(x);
    for (std::size_t i = 0; i < memories_.size(); ++i) force -= memories_[i].weight * x[2 + i];
    return force;
  }
  /// With loss; never negative.
  [[nodiscard]] double force(const State& x) const {
    return std::max(0.0, spring(x)) * std::max(0.0, 1 + loss_ * speed_ * x[1]);
  }
  void operator()(const State& x, State& rate, double /*time*/) const {
    rate[0] = x[1];
    rate[1] = -acceleration_ * force(x);
    const double spring_alone = elastic(x);
    for (std::size_t i = 0; i < memories_.size(); ++i)
      rate[2 + i] = (spring_alone - x[2 + i]) * time_s() / memories_[i].time_s;
  }

  [[nodiscard]] double length_m() const { return length_; }
  [[nodiscard]] double time_s() const { return length_ / speed_; }
  [[nodiscard]] double force_n() const { return force_; }

 private:
  [[nodiscard]] double elastic(const State& x) const { return x[0] > 0 ? law_.force(x[0] * length_) / force_ : 0.0; }

  const LawView& law_;
  std::span<const Memory> memories_;
  double speed_, loss_;
  double length_ = 0, force_ = 0, acceleration_ = 0;
};

// A state after one step of a length that the integrator has accepted, or a shorter one.
State after(const Motion& motion, const State& start, double step) {
  Stepper stepper;
  State end(start.size());
  stepper.do_step(std::cref(motion), start, 0.0, end, step);
  return end;
}

// The part of a step at which `value` of the state changes its sign.
template <typename Value>
double time_of_root(const Motion& motion, const State& start, double step, Value value) {
  const auto at = [&](double time) { return value(after(motion, start, time)); };
  std::uintmax_t steps = 100;
  const auto [below, above] = tools::toms748_solve(at, 0.0, step, tools::eps_tolerance<double>(48), steps);
  return below + (above - below) / 2;
}

/// Follows the impact and keeps what is asked of it. moments: of the beginning and after each step, unless it is
/// null.
class Follower {
 public:
  Follower(const Motion& motion, std::size_t memories, std::vector<ImpactMoment>* moments = nullptr)
      : motion_(motion), moments_(moments), now_(2 + memories) {
    now_[1] = 1;
    keep_moment();
  }

  [[nodiscard]] BarrierImpact follow(double speed_m_per_s) {
    auto stepper = odeint::make_controlled(1e-12, 1e-11, Stepper());
    double step = 1e-4;
    for (bool touches = true; touches;) {
      const State before = now_;
      const double start = time_;
      if (stepper.try_step(std::cref(motion_), now_, time_, step) == odeint::fail) continue;
      touches = take(before, time_ - start);
      keep_moment();
      step = std::min(step, kLongestStep);
    }
    const double force = motion_.force_n();
    return {compression_ * motion_.length_m(), time_ * motion_.time_s(), -now_[1] * speed_m_per_s, peak_ * force};
  }

 private:
  static constexpr double kLongestStep = 0.02;  // a blow lasts about 3: no peak is missed

  void keep_moment() {
    if (moments_ == nullptr) return;
    moments_->push_back(
        {time_ * motion_.time_s(), now_[0] * motion_.length_m(), motion_.force(now_) * motion_.force_n()});
  }

  // Looks into a step that was taken. False if the force ended in it.
  bool take(const State& before, double step) {
    if (before[1] > 0 && now_[1] <= 0) {
      const double turning = time_of_root(motion_, before, step, [](const State& x) { return x[1]; });
      compression_ = after(motion_, before, turning)[0];
    }
    const bool ends = now_[1] < 0 && motion_.spring(now_) <= 0;
    double length = step;
    if (ends) {
      length = time_of_root(motion_, before, step, [&](const State& x) { return motion_.spring(x); });
      now_ = after(motion_, before, length);
      time_ += length - step;
    }
    follow_peak(before, length);
    return !ends;
  }

  // The largest force lies within two steps of which the middle has the larger one.
  void follow_peak(const State& before, double step) {
    constexpr int kHalfOfTheBits = 26;
    const double middle = motion_.force(before), end = motion_.force(now_);
    if (middle >= peak_ && middle >= end && last_step_ > 0)
      for (const auto& [from, length] : {std::pair{last_, last_step_}, std::pair{before, step}}) {
        const auto negative = [this, &start = from](double time) {
          return -motion_.force(after(motion_, start, time));
        };
        peak_ = std::max(peak_, -tools::brent_find_minima(negative, 0.0, length, kHalfOfTheBits).second);
      }
    peak_ = std::max(peak_, end);
    last_ = before;
    last_step_ = step;
  }

  const Motion& motion_;
  std::vector<ImpactMoment>* moments_;
  State now_, last_;
  double time_ = 0, last_step_ = 0, compression_ = 0, peak_ = 0;
};

}  // namespace

BarrierImpact memory_impact(const LawView& law, double mass_kg, double speed_m_per_s, double loss_s_per_m,
                            std::span<const Memory> memories) {
  const Motion motion(law, mass_kg, speed_m_per_s, loss_s_per_m, memories);
  return Follower(motion, memories.size()).follow(speed_m_per_s);
}

std::vector<ImpactMoment> memory_motion(const LawView& law, double mass_kg, double speed_m_per_s, double loss_s_per_m,
                                        std::span<const Memory> memories) {
  const Motion motion(law, mass_kg, speed_m_per_s, loss_s_per_m, memories);
  std::vector<ImpactMoment> moments;
  (void)Follower(motion, memories.size(), &moments).follow(speed_m_per_s);
  return moments;
}

}  // namespace contactspline
