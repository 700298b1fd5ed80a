// SPDX-License-Identifier: MIT
// The mode shapes of a place that moves along a string, through a block of samples and back.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/modal/string_place.hpp"

namespace contactspline::detail {

/// Where a place was, one position after the other, with its shapes there.
template <std::floating_point T>
class ShapesHistory {
 public:
  explicit ShapesHistory(std::span<const double> wavenumbers_per_m)
      : string_(wavenumbers_per_m),
        wavenumbers_(wavenumbers_per_m.begin(), wavenumbers_per_m.end()),
        shapes_(wavenumbers_per_m.size()) {}

  [[nodiscard]] std::size_t modes() const { return wavenumbers_.size(); }

  /// Begins again at a position [m].
  void begin(T place_m) {
    places_m_.clear();
    push(place_m);
  }
  void push(T place_m) {
    const bool stays = !places_m_.empty() && places_m_.back() == place_m;
    places_m_.push_back(place_m);
    if (rows_.size() < places_m_.size() * modes()) rows_.resize(places_m_.size() * modes());
    T* row = rows_.data() + (places_m_.size() - 1) * modes();
    if (stays) {
      std::copy_n(row - modes(), modes(), row);
      return;
    }
    string_.at(place_m, shapes_);
    std::copy_n(shapes_.data(), modes(), row);
  }
  void pop() { places_m_.pop_back(); }

  /// The last position and the shapes there, until the next push.
  [[nodiscard]] T place_m() const { return places_m_.back(); }
  [[nodiscard]] const T* shapes() const { return rows_.data() + (places_m_.size() - 1) * modes(); }
  /// The same of the position before it.
  [[nodiscard]] T place_before_m() const { return places_m_[places_m_.size() - 2]; }
  [[nodiscard]] const T* shapes_before() const { return shapes() - modes(); }

  /// The adjoint of the position x that the adjoints of sin(wavenumber x) give.
  [[nodiscard]] T of_place(T place_m, const std::vector<T>& of_shapes) const {
    T sum = 0;
    for (std::size_t i = 0; i < modes(); ++i) {
      if (of_shapes[i] == 0) continue;
      sum += of_shapes[i] * wavenumbers_[i] * std::cos(wavenumbers_[i] * place_m);
    }
    return sum;
  }

 private:
  StringShapes<T> string_;
  std::vector<T> wavenumbers_;
  ModeShapes<T> shapes_;
  std::vector<T> places_m_, rows_;
};

}  // namespace contactspline::detail
