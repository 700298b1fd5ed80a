// SPDX-License-Identifier: MIT
// An instrument of a file, played by the compiled engine sample by sample.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/host/engine.hpp"

namespace contactspline::testing {

/// What the file describes, on one voice: without its keys.
template <std::floating_point T>
class BySample {
 public:
  BySample(const InstrumentData& data, double sample_rate_hz)
      : played_(Engine<T>::network(without_keys(data))), last_(data.outputs.size()) {
    for (T& sample : last_) outputs_.emplace_back(&sample, 1);
    played_->prepare(sample_rate_hz);
  }

  void set(std::size_t parameter, double value) { played_->set(parameter, value); }
  void strike(std::size_t number, T speed_m_per_s) { played_->strike(number, speed_m_per_s); }
  void reset() {
    played_->reset();
    for (T& sample : last_) sample = 0;
  }
  void tick() {
    played_->process(outputs_, {});
    books_ = played_->books();
  }
  /// Over the last sample.
  [[nodiscard]] T output(std::size_t number) const { return last_[number]; }
  [[nodiscard]] double work() const { return books_.work_j; }
  [[nodiscard]] double dissipated() const { return books_.heat_j; }
  [[nodiscard]] double energy() const { return played_->energy(); }

 private:
  static InstrumentData without_keys(InstrumentData data) {
    data.keyed.ranges = {};
    return data;
  }

  Handle<T> played_;
  std::vector<T> last_;
  std::vector<std::span<T>> outputs_;
  Books books_;
};

}  // namespace contactspline::testing
