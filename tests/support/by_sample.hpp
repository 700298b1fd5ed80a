// SPDX-License-Identifier: MIT
// An instrument of a file, played by the compiled engine sample by sample.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/host/engine.hpp"

namespace contactspline::testing {

/// What a file describes, without its keys.
inline InstrumentData without_keys(InstrumentData data) {
  data.keyed.ranges = {};
  return data;
}

/// What the file describes, on one voice: without its keys.
template <std::floating_point T>
class BySample {
 public:
  using value_type = T;

  BySample(const InstrumentData& data, double sample_rate_hz)
      : BySample(Engine<T>::network(without_keys(data)), sample_rate_hz) {}
  /// Of any instrument, which it prepares.
  BySample(Handle<T> played, double sample_rate_hz) : played_(std::move(played)), last_(played_->outputs().size()) {
    for (T& sample : last_) outputs_.emplace_back(&sample, 1);
    played_->prepare(sample_rate_hz);
  }

  void set(std::size_t parameter, double value) { handle().set(parameter, value); }
  void strike(std::size_t number, T speed_m_per_s) { handle().strike(number, speed_m_per_s); }
  void pluck(std::size_t number, T force_n) { handle().pluck(number, force_n); }
  void release(std::size_t number) { handle().release(number); }
  void bow(std::size_t number, T acceleration_m_per_s2) {
    handle().play({0, Action::kBow, number, double(acceleration_m_per_s2)});
  }
  void reset() {
    handle().reset();
    for (T& sample : last_) sample = 0;
    force_ = 0;
  }
  void tick(T input_n = 0) { handle().process(outputs_, {&force_, 1}, {&input_n, 1}); }
  /// Over the last sample.
  [[nodiscard]] T output(std::size_t number) const { return last_[number]; }
  [[nodiscard]] T contact_force() const { return force_; }
  [[nodiscard]] double work() const { return books().work_j; }
  [[nodiscard]] double dissipated() const { return books().heat_j; }
  [[nodiscard]] double energy() const { return books().stored_j; }
  [[nodiscard]] std::span<const Parameter> parameters() const { return played_->parameters(); }
  [[nodiscard]] std::span<const Event> events() const { return played_->events(); }
  [[nodiscard]] double value(std::size_t parameter) const { return played_->value(parameter); }
  [[nodiscard]] bool is_silent(double limit_j) const { return played_->is_silent(limit_j); }
  [[nodiscard]] bool is_at_rest(double limit_j) const { return played_->is_at_rest(limit_j); }
  /// To do anything else with it.
  [[nodiscard]] AnyInstrument<T>& handle() {
    books_.reset();
    return *played_;
  }

 protected:
  [[nodiscard]] AnyInstrument<T>& played() const { return *played_; }

 private:
  const Books& books() const {
    if (!books_) books_ = played_->books();
    return *books_;
  }

  Handle<T> played_;
  std::vector<T> last_;
  T force_ = 0;
  std::vector<std::span<T>> outputs_;
  mutable std::optional<Books> books_;  // since the last change
};

}  // namespace contactspline::testing
