// SPDX-License-Identifier: MIT
// The values of an instrument's parameters, where its parts decide first values and ranges.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>

#include "contactspline/data/parameter.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// The parameters of an instrument of hand-written models. Such a model holds spans of the instrument's tables, so
/// the instrument is neither copied nor moved.
template <std::floating_point T, std::size_t count>
class ParameterValues {
 public:
  ParameterValues(const ParameterValues&) = delete;
  ParameterValues& operator=(const ParameterValues&) = delete;

  [[nodiscard]] std::span<const Parameter> parameters() const { return list_; }
  /// Moves a value into the range of its parameter; one that is not a number does nothing.
  void set(std::size_t parameter, double value) {
    values_[parameter] = held(values_[parameter], value, list_[parameter].allowed);
  }
  [[nodiscard]] double value(std::size_t parameter) const { return values_[parameter]; }

 protected:
  explicit ParameterValues(const std::array<Parameter, count>& list) : list_(list) {
    for (std::size_t p = 0; p < count; ++p) values_[p] = list_[p].initial;
  }
  ~ParameterValues() = default;

  /// Sets what a parameter may be and where it is played, before set_initial().
  void limit(std::size_t parameter, ControlRange<double> allowed, ControlRange<double> slider) {
    list_[parameter].allowed = allowed;
    list_[parameter].slider = slider;
  }
  /// Sets the first value. Its slider reaches as far.
  void set_initial(std::size_t parameter, double value) {
    Parameter& set = list_[parameter];
    set.slider = {(std::min)(set.slider.min, value), (std::max)(set.slider.max, value)};
    values_[parameter] = set.initial = value;
  }
  [[nodiscard]] T value_of(std::size_t parameter) const { return static_cast<T>(values_[parameter]); }

 private:
  std::array<Parameter, count> list_;
  std::array<double, count> values_{};
};

}  // namespace contactspline
