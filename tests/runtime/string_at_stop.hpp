// SPDX-License-Identifier: MIT
// A plucked string that stretches and meets a stop.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "contactspline/modal/stretching_bank.hpp"
#include "power_table.hpp"

namespace contactspline::testing {

// A steel string of 0.65 m and 0.3 mm at 110 Hz, plucked 4 mm, which raises its tension by a tenth, with a stiff stop
// 2.5 mm on the other side, of 1e7 N/m^exponent. The contact acts from every sample to the one after the next.
template <typename T>
class StringAtStop {
 public:
  static constexpr std::size_t kModes = 40;
  static constexpr double kLength_m = 0.65, kGap_m = 2.5e-3;

  explicit StringAtStop(double rate, double exponent = 1.5)
      : table_(table(exponent)),
        bank_(modes(), std::vector{form()}, rate),
        at_(std::span<const double>(stop_shapes())),
        pickup_(std::span<const double>(pickup_shapes())) {
    for (std::size_t i = 0; i < kModes; ++i) bank_.set_motion(i, static_cast<T>(plucked(i)), 0);
    const T y = bank_.displacement(at_) - static_cast<T>(kGap_m), before = y - bank_.last_change(at_);
    ends_ = {end_at(before), end_at(y)};
  }

  static std::vector<Mode> modes() {
    std::vector<Mode> modes;
    for (std::size_t n = 1; n <= kModes; ++n) modes.push_back({2 * std::numbers::pi * 110 * double(n), 0, 1.8e-4});
    return modes;
  }
  static StretchForm form() {
    StretchForm form{2e11 * 7.07e-8 * kLength_m / 8, {}, {}};
    for (std::size_t n = 1; n <= kModes; ++n)
      form.squares_per_m2.push_back(std::pow(std::numbers::pi * double(n) / kLength_m, 2));
    return form;
  }
  static std::vector<double> shapes_at(double part) {
    std::vector<double> shapes;
    for (std::size_t n = 1; n <= kModes; ++n) shapes.push_back(std::sin(std::numbers::pi * double(n) * part));
    return shapes;
  }
  static std::vector<double> stop_shapes() {
    auto shapes = shapes_at(0.6);
    for (double& shape : shapes) shape = -shape;
    return shapes;
  }
  static std::vector<double> pickup_shapes() { return shapes_at(0.17); }
  static std::vector<Segment<T>> table(double exponent = 1.5) { return power_table<T>(1e7, exponent, 1e-3); }
  /// Displacement of a mode of the triangle from which the string is released [m].
  static double plucked(std::size_t mode) {
    const double at = 0.3, n_pi = std::numbers::pi * double(mode + 1);
    return 0.004 / at / (1 - at) * 2 * std::sin(n_pi * at) / (n_pi * n_pi);
  }

  void tick() {
    bank_.predict();
    End& end = ends_[sample_++ % 2];
    const Approach<T> approach{end.compression, bank_.increment(at_), bank_.receptance(at_, at_)};
    const auto step = contact_step(SegmentTable<T>(table_), approach, end.segment);
    bank_.push(at_, -step.force);
    bank_.commit();
    end = {step.compression, step.segment};
    max_force_ = std::max(max_force_, step.force);
  }

  [[nodiscard]] double energy() const {
    double energy = bank_.energy();
    for (const End& end : ends_) energy += double(potential(SegmentTable<T>(table_), end.compression)) / 2;
    return energy;
  }
  [[nodiscard]] double sound() const { return double(bank_.displacement(pickup_)); }
  [[nodiscard]] double max_force() const { return double(max_force_); }

 private:
  struct End {
    T compression;
    std::size_t segment;
  };

  [[nodiscard]] End end_at(T compression) const {
    return {compression, segment_index(SegmentTable<T>(table_), compression)};
  }

  std::vector<Segment<T>> table_;
  StretchingBank<T> bank_;
  ModeShapes<T> at_, pickup_;
  std::array<End, 2> ends_{};  // of the last sample but one, and of the last one, at first
  std::size_t sample_ = 0;
  T max_force_ = 0;
};

}  // namespace contactspline::testing
