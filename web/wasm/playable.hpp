// SPDX-License-Identifier: MIT
// An instrument as the page plays it: any Instrument behind one interface, as hosts play it.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "contactspline/host/oversampled.hpp"
#include "contactspline/host/replaceable.hpp"
#include "generated/piano.hpp"
#include "web/wasm/door.hpp"
#include "web/wasm/energy_books.hpp"

namespace contactspline::web {

/// Beside Hosted: the description that the page makes its controls of, and two channels.
class Playable {
 public:
  virtual ~Playable() = default;
  [[nodiscard]] virtual std::string described() const = 0;
  virtual void prepare(double sample_rate_hz) = 0;
  virtual void set(std::size_t parameter, double value) = 0;
  /// Where a parameter is or goes to; not a number behind the last one.
  [[nodiscard]] virtual double target(std::size_t parameter) const = 0;
  [[nodiscard]] virtual double velocity() const = 0;  ///< of a key that has none of its own
  virtual void note_on(int key, double velocity) = 0;
  virtual void note_off(int key) = 0;
  virtual void midi(std::span<const std::uint8_t> bytes) = 0;
  virtual void tune(const KeyCents& cents) = 0;
  /// A key that plays an event, at the pitch of the file if it has that; -1: none does.
  [[nodiscard]] virtual int key_of(std::size_t event) const = 0;
  /// Plays an event by this speed [m/s] or force [N] in the range of its parameter; by its parameter if it is NaN.
  virtual void play(std::size_t event, double value) = 0;
  virtual void process(std::span<float> left, std::span<float> right, std::span<float> force) = 0;
  [[nodiscard]] virtual double energy() const = 0;  ///< stored [J]
  /// Of the last strike; null where none are kept.
  [[nodiscard]] virtual const Books* books() const = 0;
  virtual void watch_none() = 0;
  /// Lets another instrument take its place, at `oversampling`, while it sounds (replaceable.hpp). False where it
  /// computes in another precision.
  virtual bool replace(Handle<float> next, double sample_rate_hz) = 0;
};

/// How many times finer than their host the instruments run that are made from now on: one of kOversamplings.
inline int oversampling = 1;

/// Where the velocity of a key multiplies a parameter, that is played as it is.
template <typename I>
inline constexpr double kVelocity = requires {
  I::speed_of(0.5);
}
? 0.7 : 1.0;

/// What the page needs to know of an instrument, as JSON. Numbers are those of the lists, in SI; shown values are
/// `factor` times as large. min, max: of the slider; allowed: what the parameter takes. keys: the first and the last
/// one, null where the keys from middle C on play the events. ranges: of the keys of a file, first, last and the
/// number of the event that they play. velocity: of a key that has none of its own. speeds: of the softest and the
/// loudest key [m/s], or null. isTunable: can its keys be tuned?
template <typename I>
[[nodiscard]] std::string description_of(const I& instrument, bool is_tunable) {
  std::vector<std::string> parameters, events, presets;
  for (std::size_t p = 0; p < instrument.parameters().size(); ++p) {
    const Parameter& x = instrument.parameters()[p];
    const Label label = label_of(x.name);
    parameters.push_back(fmt::format(
        R"({{"name": "{}", "label": "{}", "unit": "{}", "factor": {}, "min": {:.17g}, "max": {:.17g}, )"
        R"("allowed": [{:.17g}, {:.17g}], "init": {:.17g}, "isLogarithmic": {}, "controller": {}}})",
        x.name, label.text, label.unit.empty() ? x.unit : label.unit, label.factor, x.slider.min, x.slider.max,
        x.allowed.min, x.allowed.max, instrument.value(p), x.scale == Scale::kLogarithmic, x.controller));
  }
  for (const Event& x : instrument.events())
    events.push_back(fmt::format(R"({{"name": "{}", "label": "{}", "parameter": {}}})", x.name, label_of(x.name).text,
                                 x.parameter));
  for (const Preset& x : instrument.presets())
    presets.push_back(
        fmt::format(R"({{"name": {}, "values": [{:.17g}]}})", quoted(x.name), fmt::join(x.values, ", ")));
  std::string keys = "null";
  std::vector<std::string> ranges;
  if constexpr (requires { instrument.first_key(); })
    keys = fmt::format("[{}, {}]", instrument.first_key(),
                       keyboards::piano::first_key + static_cast<int>(keyboards::piano::keys) - 1);
  if constexpr (requires { instrument.keyed(); })
    if (const auto& all = instrument.keyed().ranges; !all.empty()) {
      keys = fmt::format("[{}, {}]", all.front().first, all.back().last);
      for (const KeyRange& range : all)
        ranges.push_back(fmt::format("[{}, {}, {}]", range.first, range.last, range.event));
    }
  std::string speeds = "null";
  if constexpr (requires { I::speed_of(0.5); })
    speeds = fmt::format("[{:.17g}, {:.17g}]", I::speed_of(0), I::speed_of(1));
  const bool takes_material = requires {
    I::takes_material;
  };
  return fmt::format(
      R"({{"name": "{}", "title": "{}", "description": {}, "keys": {}, "ranges": [{}], "velocity": {}, "speeds": {}, )"
      R"("takesMaterial": {}, "isTunable": {}, "parameters": [{}], "events": [{}], "presets": [{}]}})",
      instrument.name(), label_of(instrument.name()).text, quoted(instrument.description()), keys,
      fmt::join(ranges, ", "), kVelocity<I>, speeds, takes_material, is_tunable, fmt::join(parameters, ", "),
      fmt::join(events, ", "), fmt::join(presets, ", "));
}

/// I: an Instrument. Its sound is its outputs left_... and right_..., or else the one of number `otherwise`.
template <Instrument I, std::size_t otherwise = 0>
class PlayableBehind final : public Playable {
  using T = typename I::value_type;

 public:
  template <typename... Args>
  explicit PlayableBehind(Args&&... args)
      : PlayableBehind(std::make_unique<InstrumentBehind<I>>(std::forward<Args>(args)...)) {}
  explicit PlayableBehind(std::unique_ptr<InstrumentBehind<I>> behind)
      : own_(behind->instrument()),
        replaceable_(*new Replaceable<T>(at_oversampling(std::move(behind)))),
        hosted_(Handle<T>(&replaceable_)) {
    const std::span<const Output> outputs = hosted_.instrument().outputs();
    left_ = output_beginning(outputs, "left_", otherwise);
    right_ = output_beginning(outputs, "right_", left_);
    wanted_.resize(outputs.size());
  }

  [[nodiscard]] std::string described() const override {
    return description_of(own_, hosted_.instrument().bends_keys());
  }
  void prepare(double sample_rate_hz) override { hosted_.prepare(sample_rate_hz); }
  void set(std::size_t parameter, double value) override { hosted_.set(parameter, value); }
  [[nodiscard]] double target(std::size_t parameter) const override {
    return parameter < hosted_.instrument().parameters().size() ? hosted_.target(parameter) : NAN;
  }
  [[nodiscard]] double velocity() const override { return kVelocity<I>; }
  void note_on(int key, double velocity) override {
    const auto part = static_cast<std::uint8_t>(std::clamp(127 * velocity + 0.5, 1.0, 127.0));
    midi(std::array{std::uint8_t{0x90}, static_cast<std::uint8_t>(key & 127), part});
  }
  void note_off(int key) override {
    midi(std::array{std::uint8_t{0x80}, static_cast<std::uint8_t>(key & 127), std::uint8_t{0}});
  }
  void midi(std::span<const std::uint8_t> bytes) override { hosted_.midi(bytes); }
  void tune(const KeyCents& cents) override { hosted_.tune(cents); }
  [[nodiscard]] int key_of(std::size_t event) const override {
    if constexpr (requires { own_.keyed(); })
      if (const auto& ranges = own_.keyed().ranges; !ranges.empty()) {
        const auto found = std::ranges::find(ranges, event, &KeyRange::event);
        return found == ranges.end() ? -1 : std::clamp(found->tuned_key, found->first, found->last);
      }
    return kMiddleC + static_cast<int>(event);
  }
  void play(std::size_t event, double value) override {
    if (event >= hosted_.instrument().events().size()) return;
    const std::size_t parameter = hosted_.instrument().events()[event].parameter;
    const double usual = hosted_.target(parameter);
    hosted_.set(parameter, value);
    const bool bows = hosted_.instrument().events()[event].kind == EventKind::kBow;
    if (!bows) hosted_.press(event, false);  // a stroke that is under way goes on
    hosted_.press(event, !bows || value != 0);
    hosted_.set(parameter, usual);
  }

  void process(std::span<float> left, std::span<float> right, std::span<float> force) override {
    std::ranges::fill(wanted_, nullptr);
    wanted_[left_] = left.data();
    if (right_ != left_) wanted_[right_] = right.data();
    hosted_.process(std::span<float* const>(wanted_), left.size(), force);
    if (right_ == left_) std::ranges::copy(left, right.begin());
  }

  [[nodiscard]] double energy() const override { return hosted_.instrument().energy(); }
  [[nodiscard]] const Books* books() const override {
    if constexpr (requires { own_.books(); })
      return &own_.books();
    else
      return nullptr;
  }
  void watch_none() override {
    if constexpr (requires { own_.watch_none(); }) own_.watch_none();
  }
  bool replace(Handle<float> next, double sample_rate_hz) override {
    if constexpr (std::same_as<T, float>) {
      next = at_oversampling(std::move(next));
      next->prepare(sample_rate_hz);
      replaceable_.offer(std::move(next));
      return true;
    }
    return false;
  }

 private:
  static Handle<T> at_oversampling(Handle<T> handle) {
    if (oversampling == 1) return handle;
    return std::make_unique<Oversampled<T>>(std::move(handle), oversampling);
  }

  I& own_;                       // what hosted_ plays at first, of its class
  Replaceable<T>& replaceable_;  // which hosted_ owns
  Hosted<T> hosted_;
  std::size_t left_, right_;    // among the outputs
  std::vector<float*> wanted_;  // of the outputs
};

}  // namespace contactspline::web
