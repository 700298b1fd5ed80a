// SPDX-License-Identifier: MIT
// Resonator marimba bar, note C4: 13 modes below 22050.0 Hz.
// Written by contactspline 0.2.0: contactspline generate marimba_c4.json --emit cpp
#pragma once

#include <array>
#include <cstddef>

namespace contactspline::resonators {

struct marimba_c4 {
  static constexpr int format_version = 2;  // version of the layout; the runtime checks it
  static constexpr std::size_t modes = 13;
  static constexpr std::size_t strings = 1;
  static constexpr double strike_position_m = 0.165;

  // Angular frequency of the damped oscillation [rad/s], decay [1/s], modal mass [kg], wavenumber [rad/m], and shapes at
  // the places of strike and pickup.
  static constexpr std::array<double, modes> angular_frequencies = {
    1644.220549808, 4532.36619893, 8885.253345104, 14687.77712963, 21941.00647264, 30644.87766682,
    40799.39424187, 52404.55601971, 65460.36301309, 79966.81522338, 95923.91265168, 113331.6552986,
    132190.0431647};
  static constexpr std::array<double, modes> decays = {
    4.143583871299, 7.030602230885, 11.38179186241, 17.18205312229, 24.4324543837, 33.13293192547,
    43.2834892611, 54.88412620595, 67.93484276939, 82.43563895097, 98.38651475071, 115.7874701686,
    134.6385052047};
  static constexpr std::array<double, modes> masses = {
    0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825};
  static constexpr std::array<double, modes> wavenumbers = {
    14.33345680261, 23.79758976999, 33.32002375152, 42.83989542805, 52.3598777497, 61.87985528978,
    71.39983303649, 80.91981077427, 90.43978851243, 99.95976625058, 109.4797439887, 118.9997217269,
    128.519699465};
  static constexpr std::array<double, modes> strike_shapes = {
    -0.6078222294163, 0.0, 0.7111906070896, 0.0, -0.7069297624035, 0.0, 0.7071144298636, 0.0,
    -0.7071064506554, 0.0, 0.7071067954701, 0.0, -0.7071067805693};
  static constexpr std::array<double, modes> pickup_shapes = {
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
};

}  // namespace contactspline::resonators
