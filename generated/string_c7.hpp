// SPDX-License-Identifier: MIT
// Resonator piano string, note C7: 8 modes below 22050.0 Hz.
// Written by contactspline 0.2.0: contactspline generate string_c7.json --emit cpp
#pragma once

#include <array>
#include <cstddef>

namespace contactspline::resonators {

struct string_c7 {
  static constexpr int format_version = 2;  // version of the layout; the runtime checks it
  static constexpr std::size_t modes = 8;
  static constexpr std::size_t strings = 1;
  static constexpr double strike_position_m = 0.0108;

  // Angular frequency of the damped oscillation [rad/s], decay [1/s], modal mass [kg], wavenumber [rad/m], and shapes at
  // the places of strike and pickup.
  static constexpr std::array<double, modes> angular_frequencies = {
    13327.57145835, 26992.23828274, 41317.34681599, 56600.99147933, 73108.26337065, 91067.66442309,
    110671.1495334, 132076.7404081};
  static constexpr std::array<double, modes> decays = {
    0.6218469679147, 0.9873878716587, 1.596622711232, 2.449551486635, 3.546174197867, 4.886490844929,
    6.470501427819, 8.29820594654};
  static constexpr std::array<double, modes> masses = {
    0.0002335, 0.0002335, 0.0002335, 0.0002335, 0.0002335, 0.0002335, 0.0002335, 0.0002335};
  static constexpr std::array<double, modes> wavenumbers = {
    34.90658503989, 69.81317007977, 104.7197551197, 139.6263401595, 174.5329251994, 209.4395102393,
    244.3460952792, 279.2526803191};
  static constexpr std::array<double, modes> strike_shapes = {
    0.3681245526847, 0.6845471059287, 0.904827052466, 0.9980267284283, 0.9510565162952, 0.7705132427758,
    0.4817536741017, 0.1253332335643};
  static constexpr std::array<double, modes> pickup_shapes = {
    0.9510565162952, 0.5877852522925, -0.5877852522925, -0.9510565162952, 0.0, 0.9510565162952,
    0.5877852522925, -0.5877852522925};
};

}  // namespace contactspline::resonators
