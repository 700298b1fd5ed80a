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
  static constexpr double strike_position_m = 0.0;

  // Angular frequency of the damped oscillation [rad/s], decay [1/s], modal mass [kg], wavenumber [rad/m], and shapes at
  // the places of strike and pickup.
  static constexpr std::array<double, modes> angular_frequencies = {
    2764.601535159, 18550.47630092, 38645.35955034, 59087.70294725};
  static constexpr std::array<double, modes> decays = {
    10.6, 42.8, 90.0, 140.0};
  static constexpr std::array<double, modes> masses = {
    0.00023653, 0.00023368, 0.0010136, 0.00024854};
  static constexpr std::array<double, modes> wavenumbers = {
    0.0, 0.0, 0.0, 0.0};
  static constexpr std::array<double, modes> strike_shapes = {
    1.0, 1.0, 1.0, 1.0};
  static constexpr std::array<double, modes> pickup_shapes = {
    1.0, 0.522, 0.5, 0.5};
};

}  // namespace contactspline::resonators
