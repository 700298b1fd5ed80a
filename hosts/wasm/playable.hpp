// SPDX-License-Identifier: MIT
// An instrument as the page plays it: a handle as hosts play it, in two channels, with its description.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "contactspline/host/oversampled.hpp"
#include "contactspline/host/replaceable.hpp"
#include "hosts/wasm/door.hpp"
#include "hosts/wasm/instruments.hpp"

namespace contactspline::web {

/// Beside Hosted: the description that the page makes its controls of, two channels, and events by a value. Runs
/// `oversampling` times finer than its host: one of kOversamplings.
class Playable {
 public:
  Playable(PageInstrument made, int oversampling)
      : made_(std::move(made)),
        oversampling_(oversampling),
        replaceable_(*new Replaceable<float>(finer(std::move(made_.handle)))),
        hosted_(Handle<float>(&replaceable_)) {
    const std::span<const Output> outputs = instrument().outputs();
    sides_ = sides_of(outputs, made_.output);
    wanted_.resize(outputs.size());
  }

  [[nodiscard]] Hosted<float>& hosted() { return hosted_; }

  void note_on(int key, double velocity) { hosted_.begin_note({.channel = 0, .key = key}, velocity); }
  void note_off(int key) { hosted_.end_note({.channel = 0, .key = key}, 0, true); }
  /// Where a parameter is or goes to; not a number behind the last one.
  [[nodiscard]] double target(std::size_t parameter) const {
    return parameter < instrument().parameters().size() ? hosted_.target(parameter) : NAN;
  }
  /// A key that plays an event, at the pitch of the file if it has that; -1: none does.
  [[nodiscard]] int key_of(std::size_t event) const {
    if (made_.ranges.empty()) return kMiddleC + static_cast<int>(event);
    const auto found = std::ranges::find(made_.ranges, event, &KeyRange::event);
    return found == made_.ranges.end() ? -1 : std::clamp(found->tuned_key, found->first, found->last);
  }
  /// Plays an event by this speed [m/s] or force [N] in the range of its parameter; by its parameter if it is NaN.
  void play(std::size_t event, double value) {
    if (event >= instrument().events().size()) return;
    const std::size_t parameter = instrument().events()[event].parameter;
    const double usual = hosted_.target(parameter);
    hosted_.set(parameter, value);
    const bool bows = instrument().events()[event].kind == EventKind::kBow;
    if (!bows) hosted_.press(event, false);  // a stroke that is under way goes on
    hosted_.press(event, !bows || value != 0);
    hosted_.set(parameter, usual);
  }

  void process(std::span<float> left, std::span<float> right, std::span<float> force) {
    std::ranges::fill(wanted_, nullptr);
    wanted_[sides_.left] = left.data();
    if (sides_.right != sides_.left) wanted_[sides_.right] = right.data();
    hosted_.process(std::span<float* const>(wanted_), left.size(), force);
    if (sides_.right == sides_.left) std::ranges::copy(left, right.begin());
  }

  [[nodiscard]] double energy() const { return instrument().energy(); }  ///< stored [J]
  /// Of the last strike; null where none are kept.
  [[nodiscard]] const StrikeEnergies* strike_energies() const {
    return made_.with_page_material == nullptr ? nullptr : &made_.with_page_material->books();
  }
  void watch_none() {
    if (made_.with_page_material != nullptr) made_.with_page_material->watch_none();
  }
  /// Lets another instrument take its place while it sounds (replaceable.hpp); no energies of strikes are kept then.
  void replace(Handle<float> next, double sample_rate_hz) {
    made_.with_page_material = nullptr;
    next = finer(std::move(next));
    next->prepare(sample_rate_hz);
    replaceable_.offer(std::move(next));
  }

  /// What the page needs to know, as JSON. Numbers are those of the lists, in SI; shown values are `factor` times as
  /// large. min, max: of the slider; allowed: what the parameter takes. keys: the first and the last one, null where
  /// the keys from middle C on play the events. ranges: of the keys of a file, first, last and the number of the
  /// event that they play. velocity: of a key that has none of its own. speeds: of the softest and the loudest key
  /// [m/s], or null. isTunable: can its keys be tuned?
  [[nodiscard]] std::string described() const {
    const AnyInstrument<float>& x = instrument();
    std::vector<std::string> parameters, events, presets, ranges;
    for (std::size_t p = 0; p < x.parameters().size(); ++p)
      parameters.push_back(described(x.parameters()[p], x.value(p)));
    for (const Event& event : x.events())
      events.push_back(fmt::format(R"({{"name": "{}", "label": "{}", "parameter": {}}})", event.name,
                                   label_of(event.name).text, event.parameter));
    for (const Preset& preset : x.presets())
      presets.push_back(
          fmt::format(R"({{"name": {}, "values": [{:.17g}]}})", quoted(preset.name), fmt::join(preset.values, ", ")));
    for (const KeyRange& range : made_.ranges)
      ranges.push_back(fmt::format("[{}, {}, {}]", range.first, range.last, range.event));
    return fmt::format(
        R"({{"name": "{}", "title": "{}", "description": {}, "keys": {}, "ranges": [{}], "velocity": {}, )"
        R"("speeds": {}, "takesMaterial": {}, "isTunable": {}, "parameters": [{}], "events": [{}], "presets": [{}]}})",
        x.name(), label_of(x.name()).text, quoted(x.description()), keys(), fmt::join(ranges, ", "), made_.velocity,
        speeds(), made_.with_page_material != nullptr, x.bends_keys(), fmt::join(parameters, ", "),
        fmt::join(events, ", "), fmt::join(presets, ", "));
  }

 private:
  [[nodiscard]] static std::string described(const Parameter& x, double value) {
    const Label label = label_of(x.name);
    return fmt::format(
        R"({{"name": "{}", "label": "{}", "unit": "{}", "factor": {}, "min": {:.17g}, "max": {:.17g}, )"
        R"("allowed": [{:.17g}, {:.17g}], "init": {:.17g}, "isLogarithmic": {}, "controller": {}}})",
        x.name, label.text, label.unit.empty() ? x.unit : label.unit, label.factor, x.slider.min, x.slider.max,
        x.allowed.min, x.allowed.max, value, x.scale == Scale::kLogarithmic, x.controller);
  }
  [[nodiscard]] std::string keys() const {
    if (!made_.ranges.empty()) return fmt::format("[{}, {}]", made_.ranges.front().first, made_.ranges.back().last);
    if (!instrument().events().empty()) return "null";
    int first = 0, last = 127;
    while (first < last && !instrument().has_key(first)) ++first;
    while (first < last && !instrument().has_key(last)) --last;
    return fmt::format("[{}, {}]", first, last);
  }
  [[nodiscard]] std::string speeds() const {
    if (made_.speed_of == nullptr) return "null";
    return fmt::format("[{:.17g}, {:.17g}]", made_.speed_of(0), made_.speed_of(1));
  }

  [[nodiscard]] const AnyInstrument<float>& instrument() const { return hosted_.instrument(); }
  [[nodiscard]] Handle<float> finer(Handle<float> handle) const {
    if (oversampling_ == 1) return handle;
    return std::make_unique<Oversampled<float>>(std::move(handle), oversampling_);
  }

  PageInstrument made_;  // without its handle
  int oversampling_;
  Replaceable<float>& replaceable_;  // which hosted_ owns
  Hosted<float> hosted_;
  Sides sides_;                 // among the outputs
  std::vector<float*> wanted_;  // of the outputs
};

}  // namespace contactspline::web
