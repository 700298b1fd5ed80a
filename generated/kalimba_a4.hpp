// SPDX-License-Identifier: MIT
// Resonator kalimba tine, note A4: 4 modes below 22050.0 Hz.
// Written by contactspline 0.2.0: contactspline generate kalimba_a4.json --emit cpp
#pragma once

#include <array>
#include <cstddef>

namespace contactspline::resonators {

struct kalimba_a4 {
  static constexpr int format_version = 2;  // version of the layout; the runtime checks it
  static constexpr std::size_t modes = 4;
  static constexpr std::size_t strings = 1;
  static constexpr double strike_position_m = 0.0385;

  // Angular frequency of the damped oscillation [rad/s], decay [1/s], modal mass [kg], wavenumber [rad/m], and shapes at
  // the places of strike and pickup.
  static constexpr std::array<double, modes> angular_frequencies = {
    2765.118485422, 17328.72524561, 48520.93772654, 95081.67518119};
  static constexpr std::array<double, modes> decays = {
    5.372079789847, 17.86557029156, 44.624027265, 84.56648072343};
  static constexpr std::array<double, modes> masses = {
    0.00024175, 0.00024175, 0.00024175, 0.00024175};
  static constexpr std::array<double, modes> wavenumbers = {
    48.70400178473, 121.9244450123, 204.0196737205, 285.5984606461};
  static constexpr std::array<double, modes> strike_shapes = {
    1.0, -1.0, 1.0, -1.0};
  static constexpr std::array<double, modes> pickup_shapes = {
    1.0, -1.0, 1.0, -1.0};
};

}  // namespace contactspline::resonators
