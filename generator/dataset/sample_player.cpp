// SPDX-License-Identifier: MIT
#include "generator/dataset/sample_player.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>

#include "generator/player/playing.hpp"

namespace contactspline {

class SamplePlayer::Interface {
 public:
  Interface() = default;
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  virtual ~Interface() = default;
  virtual void play(std::span<const double> values, const SampleArrays& into, const std::function<void()>& watch) = 0;
};

/// In one precision.
template <std::floating_point T>
class SamplePlayer::In final : public Interface {
 public:
  explicit In(const Plan& plan) : plan_(plan), instrument_(plan.maker.make<T>(plan.sample_rate_hz)) {
    for (std::size_t i = 0; i < instrument_->parameters().size(); ++i) initial_.push_back(instrument_->value(i));
    recording_.outputs.resize(instrument_->outputs().size());
    exact_.resize(plan.recorded.size());
  }

  void play(std::span<const double> values, const SampleArrays& into, const std::function<void()>& watch) override {
    for (std::size_t i = 0; i < initial_.size(); ++i) instrument_->set(i, initial_[i]);
    for (const FirstValue& first : plan_.first) instrument_->set(first.parameter, values[first.column]);
    instrument_->prepare(plan_.sample_rate_hz);
    direct(into);
    schedule(values);
    render<T>(*instrument_, events_, plan_.length, recording_, watch);
    if constexpr (!std::same_as<T, float>)
      for (std::size_t r = 0; r < exact_.size(); ++r)
        std::ranges::transform(exact_[r], into.sounds[r].begin(), [](T x) { return static_cast<float>(x); });
  }

 private:
  // Sounds in single precision go where they belong at once, others through arrays of their own.
  void direct(const SampleArrays& into) {
    recording_.energy = into.energy;
    recording_.energy_step = plan_.energy_step;
    for (std::size_t r = 0; r < plan_.recorded.size(); ++r) {
      const Recorded& recorded = plan_.recorded[r];
      if (recorded.kind == Recorded::kEnergy) continue;
      std::span<T> array;
      if constexpr (std::same_as<T, float>) {
        array = into.sounds[r];
      } else {
        exact_[r].resize(plan_.length);
        array = exact_[r];
      }
      (recorded.kind == Recorded::kForce ? recording_.force : recording_.outputs[recorded.output]) = array;
    }
  }

  // A blow takes the value that its parameter has at its time.
  void schedule(std::span<const double> values) {
    events_.clear();
    for (const PlannedEvent& event : plan_.events) {
      const double value = event.value == PlannedEvent::kNone ? 1 : values[event.value];
      switch (event.kind) {
        case PlannedEvent::kSet:
          events_.push_back({event.sample, Action::kSet, event.number, value, 0});
          break;
        case PlannedEvent::kPlay:
          add_held(event, event.number, event.action, event.action == Action::kBow ? Action::kBow : Action::kRelease,
                   TimedEvent::kOfParameter);
          break;
        case PlannedEvent::kKey:
          add_held(event, static_cast<std::size_t>(values[event.key]), Action::kNoteOn, Action::kNoteOff, value);
      }
    }
    std::ranges::stable_sort(events_, {}, &TimedEvent::sample);
    while (!events_.empty() && events_.back().sample >= plan_.length) events_.pop_back();
  }

  void add_held(const PlannedEvent& event, std::size_t number, Action begin, Action end, double value) {
    events_.push_back({event.sample, begin, number, value, event.rise_s});
    if (event.end != PlannedEvent::kNone) events_.push_back({event.end, end, number, 0, 0});
  }

  const Plan& plan_;
  std::unique_ptr<AnyInstrument<T>> instrument_;
  std::vector<double> initial_;
  std::vector<TimedEvent> events_;
  Recording<T> recording_;
  std::vector<std::vector<T>> exact_;
};

SamplePlayer::SamplePlayer(const Plan& plan) {
  if (plan.is_double)
    player_ = std::make_unique<In<double>>(plan);
  else
    player_ = std::make_unique<In<float>>(plan);
}
SamplePlayer::~SamplePlayer() = default;
SamplePlayer::SamplePlayer(SamplePlayer&&) noexcept = default;

void SamplePlayer::play(std::span<const double> values, const SampleArrays& into,
                        const std::function<void()>& watch) {
  player_->play(values, into, watch);
}

}  // namespace contactspline
