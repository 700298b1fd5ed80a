// SPDX-License-Identifier: MIT
// How a plug-in is tuned: by four parameters of its own, or by MTS-ESP where a program tunes the session.
#pragma once

#include <DistrhoPlugin.hpp>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "contactspline/host/hosted.hpp"
#include "contactspline/midi/temperament.hpp"
#include "mts_esp.hpp"

namespace contactspline {

/// The parameters: how far wheels bend, the pitch of A4, a temperament and its tonic.
class PluginTuning {
 public:
  static constexpr std::uint32_t kParameters = 4;

  /// number: 0 to kParameters - 1.
  static void describe(std::uint32_t number, DISTRHO_NAMESPACE::Parameter& parameter) {
    using namespace DISTRHO_NAMESPACE;
    const Row& row = kRows[number];
    parameter.hints = kParameterIsAutomatable;
    parameter.name = row.name;
    parameter.symbol = row.symbol;
    parameter.unit = row.unit;
    parameter.ranges = {row.initial, row.min, row.max};
    if (number == kTemperament)
      enumerate(parameter, kTemperaments.size(), [](std::size_t i) { return kTemperaments[i].name; });
    if (number == kTonic) enumerate(parameter, kTones.size(), [](std::size_t i) { return kTones[i]; });
  }

  // On any thread.
  [[nodiscard]] float value(std::uint32_t number) const { return values_[number]; }
  /// Moved into its range; of a list to the nearest of its entries. A value that is not a number does nothing.
  void set(std::uint32_t number, float value) {
    const auto& [name, symbol, unit, min, max, initial] = kRows[number];
    const float next = held(values_[number].load(), value, {min, max});
    values_[number] = number >= kTemperament ? std::round(next) : next;
    (number == kBendRange ? is_range_new_ : is_new_) = true;
  }

  /// A client of MTS-ESP while the plug-in is active. Not on the audio thread.
  void set_active(bool is_active) { is_active ? void(client_.emplace()) : client_.reset(); }

  /// What has been set since the last call, on the audio thread.
  template <typename T>
  void take(Hosted<T>& hosted) {
    if (is_range_new_.load(std::memory_order_relaxed) && is_range_new_.exchange(false))
      hosted.set_bend_range(values_[kBendRange]);
    if (is_new_.load(std::memory_order_relaxed) && is_new_.exchange(false))
      hosted.tune(tempered_keys(kTemperaments[entry(kTemperament)], entry(kTonic), values_[kA4]));
  }

  /// Before a note of a key of MIDI: as MTS-ESP has it now.
  template <typename T>
  void before_note(Hosted<T>& hosted, int key, int channel) {
    const bool is_tuned = client_ && client_->is_tuned();
    if (is_tuned) hosted.tune_key(key, cents(key, channel));
    if (!is_tuned && was_tuned_) {
      is_new_ = true;
      take(hosted);
    }
    was_tuned_ = is_tuned;
  }

 private:
  enum : std::uint32_t { kBendRange, kA4, kTemperament, kTonic };
  struct Row {
    const char *name, *symbol, *unit;
    float min, max, initial;
  };
  static constexpr std::array<const char*, 12> kTones = {"C",       "C sharp", "D",       "E flat", "E",      "F",
                                                         "F sharp", "G",       "G sharp", "A",      "B flat", "B"};
  static constexpr std::array<Row, kParameters> kRows = {
      {{"bend range", "bend_range", "semitones", 0, 96, 2},
       {"pitch of A4", "a4_hz", "Hz", 380, 500, 440},
       {"temperament", "temperament", "", 0, static_cast<float>(kTemperaments.size() - 1), 0},
       {"tonic", "tonic", "", 0, static_cast<float>(kTones.size() - 1), 0}}};

  template <typename Name>
  static void enumerate(DISTRHO_NAMESPACE::Parameter& parameter, std::size_t count, const Name& name) {
    using namespace DISTRHO_NAMESPACE;
    parameter.hints |= kParameterIsInteger;
    parameter.enumValues.count = static_cast<std::uint8_t>(count);
    parameter.enumValues.restrictedMode = true;
    parameter.enumValues.values = new ParameterEnumerationValue[count];  // the framework's to delete
    for (std::size_t i = 0; i < count; ++i) parameter.enumValues.values[i] = {static_cast<float>(i), name(i)};
  }

  [[nodiscard]] std::size_t entry(std::uint32_t number) const {
    return static_cast<std::size_t>(values_[number].load());
  }

  [[nodiscard]] double cents(int key, int channel) const {
    const double frequency_hz = client_->frequency_hz(key);
    if (client_->filters(key, channel) || !(frequency_hz > 0)) return std::numeric_limits<double>::quiet_NaN();
    return 1200 * std::log2(frequency_hz / 440) - 100 * (key - 69);
  }

  std::array<std::atomic<float>, kParameters> values_ = {2.0f, 440.0f, 0.0f, 0.0f};
  std::atomic<bool> is_new_ = false, is_range_new_ = false;
  std::optional<MtsClient> client_;
  bool was_tuned_ = false;
};

}  // namespace contactspline
