// SPDX-License-Identifier: MIT
// A handle that costs nothing while it rests.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/timed_event.hpp"
#include "contactspline/host/any_instrument.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/step/first_push.hpp"

namespace contactspline {

/// Plays an instrument and computes nothing while it rests. One that is silent falls asleep: its outputs are exactly
/// 0 until an event, a new value of a parameter, an input or another instrument (replaceable.hpp) wakes it. One that
/// rests under a load, as a slide does that a hand presses, falls asleep too: its outputs stay where they are. The
/// constructor and prepare() allocate, nothing else.
template <std::floating_point T>
class Sleeper {
 public:
  explicit Sleeper(Handle<T> instrument)
      : instrument_(std::move(instrument)), levels_(instrument_->outputs().size()) {
    wanted_.resize(levels_.size());
  }

  [[nodiscard]] const AnyInstrument<T>& instrument() const { return *instrument_; }
  [[nodiscard]] Handle<T>&& release() { return std::move(instrument_); }  ///< whoever takes it ends this

  void prepare(double sample_rate_hz) {
    instrument_->prepare(sample_rate_hz);
    wake();
  }

  /// Does what an event says, now.
  void play(const TimedEvent& event) {
    const bool has_next = instrument_->has_next();
    const std::optional<double> before = value_of(event);
    instrument_->play(event);
    if (has_next || !before || *before != value_of(event)) wake();
  }

  void reset() {
    instrument_->reset();
    wake();
    since_check_ = 0;
  }

  /// Advances a block. outputs: a span of the block's length for each output, empty for one that nobody wants; force:
  /// the same for the sum of the contact forces [N]; input: a force on the body over each sample [N], or empty.
  void process(Outputs<T> outputs, std::span<T> force, std::size_t samples, std::span<const T> input = {}) {
    if (!(instrument_->input_scale_n() > 0)) input = {};
    const bool is_any_wanted =
        !force.empty() || std::ranges::any_of(outputs, [](std::span<T> output) { return !output.empty(); });
    if (is_any_wanted) return process_wanted(outputs, force, samples, input);
    // An instrument advances by the length of its outputs: where nobody wants one, it writes the first.
    for (std::size_t done = 0; done < samples; done += kBlock) {
      const std::size_t length = (std::min)(samples - done, kBlock);
      wanted_.front() = std::span(unwanted_).first(length);
      process_wanted(wanted_, {}, length, detail::part_of(input, done, length));
    }
  }

 private:
  static constexpr std::size_t kBlock = 256;  // samples
  // 100 dB below what models themselves take for silent. Without an end the smallest numbers go round for ever: the
  // losses of a sample are flushed to 0, and rounding keeps 5e-28 J of a tom that stretches in single precision.
  static constexpr double kInaudible_J = 1e-24;
  // Part of full scale that counts as silent: a mass that rests away from 0 has no energy, but an output.
  static constexpr double kInaudible = 1e-9;
  // An instrument rests under a load if in kStillBlocks blocks in a row its outputs stay within kStill of full scale,
  // 108 dB below it, and its kinetic energy is below kStill_J. Single precision rounds loads and reaches no less.
  static constexpr double kStill_J = 1e-13, kStill = 0x1p-18;
  static constexpr int kStillBlocks = 8;

  // What an output has been in the blocks in which it was still, and what it is now.
  struct Level {
    T low = 0, high = 0, now = 0;
    bool is_known = false;  // was it computed?
  };

  // The value of the parameter that an event sets, if it sets one.
  [[nodiscard]] std::optional<double> value_of(const TimedEvent& event) const {
    if (event.action != Action::kSet || event.number >= instrument_->parameters().size()) return {};
    return instrument_->value(event.number);
  }

  void process_wanted(Outputs<T> outputs, std::span<T> force, std::size_t samples, std::span<const T> input) {
    const bool is_pushed = first_push(input) < input.size();
    if (is_asleep_ && (is_pushed || instrument_->has_next() || !stay(outputs, force))) wake();
    if (is_asleep_) return;
    instrument_->process(outputs, force, input);
    force_ = force.empty() ? std::nullopt : std::optional(force.back());
    since_check_ += samples;
    if (is_pushed) return wake();
    // An energy is a sum over all modes: it is looked at once in a block.
    if (since_check_ >= kBlock) go_to_sleep(outputs);
  }

  void go_to_sleep(Outputs<T> outputs) {
    since_check_ = 0;
    if (is_inaudible(outputs) && instrument_->is_silent(kInaudible_J)) {
      for (std::size_t o = 0; o < levels_.size(); ++o) levels_[o] = {.is_known = !outputs[o].empty()};
      force_ = T(0);
      is_asleep_ = true;
    } else {
      if (!are_still(outputs) || !instrument_->is_at_rest(kStill_J)) still_blocks_ = 0;
      is_asleep_ = still_blocks_ == kStillBlocks;
      if (is_asleep_ && instrument_->is_silent(kStill_J)) silence_faint_levels();
    }
  }

  // What bears no load and is still has faded.
  void silence_faint_levels() {
    for (std::size_t o = 0; o < levels_.size(); ++o)
      if (std::abs(levels_[o].now) <= static_cast<T>(kStill * full_scale(o))) levels_[o].now = 0;
  }

  // Have all outputs stayed where they are, with those of the last block? Counts the blocks.
  bool are_still(Outputs<T> outputs) {
    const bool is_first = still_blocks_++ == 0;
    for (std::size_t o = 0; o < levels_.size(); ++o) {
      Level& level = levels_[o];
      level.is_known = !outputs[o].empty();
      if (!level.is_known) continue;
      const auto [low, high] = std::ranges::minmax(outputs[o]);
      level.low = is_first ? low : (std::min)(level.low, low);
      level.high = is_first ? high : (std::max)(level.high, high);
      level.now = outputs[o].back();
      if (!(level.high - level.low <= static_cast<T>(kStill * full_scale(o)))) return false;
    }
    return true;
  }

  // Writes what the outputs are while all rests; false if one was not computed when it fell asleep.
  bool stay(Outputs<T> outputs, std::span<T> force) {
    if (!force.empty() && !force_) return false;
    for (std::size_t o = 0; o < levels_.size(); ++o)
      if (!outputs[o].empty() && !levels_[o].is_known) return false;
    std::ranges::fill(force, force_.value_or(T(0)));
    for (std::size_t o = 0; o < levels_.size(); ++o) std::ranges::fill(outputs[o], levels_[o].now);
    return true;
  }

  // Does the last block have no sound?
  [[nodiscard]] bool is_inaudible(Outputs<T> outputs) const {
    for (std::size_t o = 0; o < levels_.size(); ++o)
      for (const T sample : outputs[o])
        if (!(std::abs(double(sample)) <= kInaudible * full_scale(o))) return false;
    return true;
  }

  [[nodiscard]] double full_scale(std::size_t output) const { return instrument_->outputs()[output].full_scale; }

  void wake() {
    is_asleep_ = false;
    still_blocks_ = 0;
  }

  Handle<T> instrument_;
  std::vector<Level> levels_;  // of the outputs
  std::optional<T> force_;     // of the contacts in the last sample, if it was computed
  std::vector<std::span<T>> wanted_;
  std::array<T, kBlock> unwanted_;
  std::size_t since_check_ = 0;  // samples
  int still_blocks_ = 0;
  bool is_asleep_ = false;
};

}  // namespace contactspline
