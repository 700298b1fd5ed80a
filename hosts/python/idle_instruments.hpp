// SPDX-License-Identifier: MIT
// Instruments that wait for the next rendering, so that their modes are computed once.
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "generator/player/instrument_maker.hpp"

namespace contactspline::python {

/// Instruments of one maker, at the rate of the last call. For any number of threads.
template <std::floating_point T>
class IdleInstruments {
 public:
  /// One with its first values, to be prepared at the rate: one that waits, or a new one.
  [[nodiscard]] std::unique_ptr<AnyInstrument<T>> take(const InstrumentMaker& maker, double rate) {
    if (auto waiting = take_waiting(rate)) {
      for (std::size_t p = 0; p < first_values_.size(); ++p) waiting->set(p, first_values_[p]);
      return waiting;
    }
    auto made = maker.make<T>(rate);
    const std::scoped_lock lock(mutex_);
    if (first_values_.empty())
      for (std::size_t p = 0; p < made->parameters().size(); ++p) first_values_.push_back(made->value(p));
    return made;
  }

  /// Takes it back after a rendering that has not failed.
  void put(std::unique_ptr<AnyInstrument<T>> instrument, double rate) {
    const std::scoped_lock lock(mutex_);
    if (rate == rate_) waiting_.push_back(std::move(instrument));
  }

 private:
  std::unique_ptr<AnyInstrument<T>> take_waiting(double rate) {
    const std::scoped_lock lock(mutex_);
    if (std::exchange(rate_, rate) != rate) waiting_.clear();
    if (waiting_.empty()) return nullptr;
    auto instrument = std::move(waiting_.back());
    waiting_.pop_back();
    return instrument;
  }

  std::mutex mutex_;
  std::vector<double> first_values_;  // of the parameters, once one is made
  double rate_ = 0;
  std::vector<std::unique_ptr<AnyInstrument<T>>> waiting_;
};

}  // namespace contactspline::python
