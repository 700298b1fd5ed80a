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
#include <string>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "mts_esp.hpp"
#include "tuning_parameters.hpp"

namespace contactspline {

/// The parameters: how far wheels bend, the pitch of A4, a temperament and its tonic.
class PluginTuning {
 public:
  static constexpr std::uint32_t kParameters = kTuningParameters.size();

  PluginTuning() {
    for (std::uint32_t p = 0; p < kParameters; ++p) values_[p] = kTuningParameters[p].initial;
  }

  /// number: 0 to kParameters - 1.
  static void describe(std::uint32_t number, DISTRHO_NAMESPACE::Parameter& parameter) {
    using namespace DISTRHO_NAMESPACE;
    const TuningParameter& described = kTuningParameters[number];
    parameter.hints = kParameterIsAutomatable;
    parameter.name = described.name;
    parameter.symbol = described.symbol;
    parameter.unit = described.unit;
    parameter.ranges = {described.initial, described.min, described.max};
    const std::vector<std::string> entries = tuning_entries(number);
    if (entries.empty()) return;
    parameter.hints |= kParameterIsInteger;
    parameter.enumValues.count = static_cast<std::uint8_t>(entries.size());
    parameter.enumValues.restrictedMode = true;
    parameter.enumValues.values = new ParameterEnumerationValue[entries.size()];  // the framework's to delete
    for (std::size_t i = 0; i < entries.size(); ++i)
      parameter.enumValues.values[i] = {static_cast<float>(i), entries[i].c_str()};
  }

  // On any thread.
  [[nodiscard]] float value(std::uint32_t number) const { return values_[number]; }
  /// Moved into its range; of a list to the nearest of its entries. A value that is not a number does nothing.
  void set(std::uint32_t number, float value) {
    const auto& [name, symbol, unit, min, max, initial] = kTuningParameters[number];
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

  /// Does MTS-ESP tune? As look() has seen it on the audio thread last.
  [[nodiscard]] bool is_tuned_outside() const { return is_tuned_outside_; }
  void look() { is_tuned_outside_ = client_ && client_->is_tuned(); }

  /// Before a note of a key of MIDI: as MTS-ESP has it now.
  template <typename T>
  void before_note(Hosted<T>& hosted, int key, int channel) {
    const bool is_tuned = client_ && client_->is_tuned();
    if (is_tuned != std::exchange(was_tuned_, is_tuned)) {
      is_new_ = true;  // and strings nearer to the pitch play what is tuned far
      take(hosted);
    }
    if (is_tuned) hosted.tune_key(key, cents(key, channel));
  }

 private:
  [[nodiscard]] std::size_t entry(std::uint32_t number) const {
    return static_cast<std::size_t>(values_[number].load());
  }

  [[nodiscard]] double cents(int key, int channel) const {
    const double frequency_hz = client_->frequency_hz(key);
    if (client_->filters(key, channel) || !(frequency_hz > 0)) return std::numeric_limits<double>::quiet_NaN();
    return 1200 * std::log2(frequency_hz / 440) - 100 * (key - 69);
  }

  std::array<std::atomic<float>, kParameters> values_;
  std::atomic<bool> is_new_ = false, is_range_new_ = false, is_tuned_outside_ = false;
  std::optional<MtsClient> client_;
  bool was_tuned_ = false;
};

}  // namespace contactspline
