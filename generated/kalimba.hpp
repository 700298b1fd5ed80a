// SPDX-License-Identifier: MIT
// Instrument kalimba, tines on a box: 7 bodies with 29 modes below 22050.0 Hz, 7 connections.
// Written by contactspline 0.2.0: contactspline generate kalimba.json --emit cpp
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/voices.hpp"

namespace contactspline::instruments {

template <std::floating_point T = double>
class kalimba : public Voices<NetworkInstrument<T>> {
 public:
  static constexpr int format_version = 2;  // version of the layout; the runtime checks it

  kalimba() : Voices<NetworkInstrument<T>>(data::view()) {
    static_assert(contactspline::fits_runtime<kalimba>,
                  "generated for another version: run `contactspline generate` again");
  }
  explicit kalimba(double sample_rate_hz) : kalimba() { this->prepare(sample_rate_hz); }

  /// -20 to 20, at the beginning 0.
  void set_thumb_ds4_force_n(T value) { this->set(0, double(value)); }
  /// -20 to 20, at the beginning 0.
  void set_thumb_a4_force_n(T value) { this->set(1, double(value)); }
  /// -20 to 20, at the beginning 0.
  void set_thumb_ds5_force_n(T value) { this->set(2, double(value)); }
  /// -20 to 20, at the beginning 0.
  void set_thumb_a5_force_n(T value) { this->set(3, double(value)); }
  /// -20 to 20, at the beginning 0.
  void set_thumb_d6_force_n(T value) { this->set(4, double(value)); }
  /// 0 to 1000, at the beginning 0.
  void set_hand_damping_per_s(T value) { this->set(5, double(value)); }
  /// -20 to 20, at the beginning 4.03.
  void set_thumb_ds4_release_n(T value) { this->set(6, double(value)); }
  /// -20 to 20, at the beginning 2.23.
  void set_thumb_a4_release_n(T value) { this->set(7, double(value)); }
  /// -20 to 20, at the beginning 1.24.
  void set_thumb_ds5_release_n(T value) { this->set(8, double(value)); }
  /// -20 to 20, at the beginning 0.686.
  void set_thumb_a5_release_n(T value) { this->set(9, double(value)); }
  /// -20 to 20, at the beginning 0.419.
  void set_thumb_d6_release_n(T value) { this->set(10, double(value)); }
  /// -4800 to 4800, at the beginning 0.
  void set_bend_cents(T value) { this->set(11, double(value)); }
  void pluck_thumb_ds4(T force_n) { this->pluck(0, force_n); }
  void pluck_thumb_a4(T force_n) { this->pluck(1, force_n); }
  void pluck_thumb_ds5(T force_n) { this->pluck(2, force_n); }
  void pluck_thumb_a5(T force_n) { this->pluck(3, force_n); }
  void pluck_thumb_d6(T force_n) { this->pluck(4, force_n); }
  [[nodiscard]] T box_velocity_m_per_s() const { return this->output(0); }
  [[nodiscard]] T bridge_force_n() const { return this->output(1); }

  // What NetworkInstrument plays. Its members: struct InstrumentData.
  struct data {
    static constexpr std::array<double, 29> angular_frequencies = {
        986.8729029083, 6184.849508962, 17317.78079362, 33935.94698794, 56098.55686447, 1246.395906894,
        7811.107168842, 21871.33667059, 42859.09509887, 1555.798249668, 9750.051064631, 27300.43060101,
        53497.95046601, 1900.696372399, 11911.47386199, 33352.47464522, 2231.245520428, 13982.98413751,
        39152.76233504, 3141.59265359, 5277.875658031, 6660.17642561, 7759.733854367, 9676.105373057,
        12126.54764286, 16336.28179867, 21928.31672206, 29530.97094374, 0.0};
    static constexpr std::array<double, 29> decays = {
        8.611976823886, 12.62522724341, 21.22077455341, 34.05138166653, 51.16276128013, 5.812348650466,
        10.88093604596, 21.73679556096, 37.94137954947, 4.201208571544, 10.52784561951, 24.07818571151,
        44.30483140368, 3.317518743093, 11.04678297628, 27.60125863635, 2.962698177821, 12.0359651961,
        31.4690151579, 449.0, 754.0, 951.0, 1110.0, 1380.0, 1730.0, 2330.0, 3130.0, 4220.0, 0.0};
    static constexpr std::array<double, 29> masses = {
        0.0004047, 0.0004047, 0.0004047, 0.0004047, 0.0004047, 0.000360125, 0.000360125, 0.000360125,
        0.000360125, 0.000322325, 0.000322325, 0.000322325, 0.000322325, 0.000291625, 0.000291625,
        0.000291625, 0.00026915, 0.00026915, 0.00026915, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.00438};
    static constexpr std::array<std::size_t, 7> body_ends = {5, 9, 13, 16, 19, 28, 29};
    static constexpr std::array<std::size_t, 14> place_bodies = {6, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 5};
    static constexpr std::array<double, 66> shapes = {
        1.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.1962902850188, 0.6421896876184, 0.6450168422172, -0.06197854706573,
        -0.668203382505, 1.0, -1.0, 1.0, -1.0, 0.2418111646049, 0.6942811152283, 0.477107319138,
        -0.3936552683713, 1.0, -1.0, 1.0, -1.0, 0.2937842445686, 0.7193227682287, 0.2401455122262,
        -0.6373068727869, 1.0, -1.0, 1.0, 0.3491308506686, 0.7094051653064, -0.02591234667714, 1.0, -1.0, 1.0,
        0.3998669466677, 0.670430239757, -0.2525462831065, 0.03, 0.03, 0.03, 0.03, 0.03, 0.03, 0.03, 0.03,
        0.03, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 18.2, -74.4, 265.0, -287.0, 80.6, -17.8, 16.0,
        -50.4, 90.9};
    static constexpr std::array<double, 0> knots = {
        };
    static constexpr std::array<double, 0> energies = {
        };
    static constexpr std::array<double, 0> forces = {
        };
    static constexpr std::array<double, 0> half_curvatures = {
        };
    static constexpr std::array<std::size_t, 0> table_ends = {};
    static constexpr std::array<InstrumentConnection, 7> connections = {{
        {ConnectionKind::kSpring, 12, 0, 0, 0.0, 1.0, 0.0, 21580.0, 0.0},
        {ConnectionKind::kSpring, 0, kGround, 0, 0.0, 1.0, 0.0, 0.0, 2.0},
        {ConnectionKind::kLink, 2, 11, 0, 0.0, 1.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kLink, 4, 11, 0, 0.0, 1.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kLink, 6, 11, 0, 0.0, 1.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kLink, 8, 11, 0, 0.0, 1.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kLink, 10, 11, 0, 0.0, 1.0, 0.0, 0.0, 0.0}}};
    static constexpr std::array<InstrumentControl, 6> controls = {{
        {ControlQuantity::kForce, 0, 1},
        {ControlQuantity::kForce, 1, 1},
        {ControlQuantity::kForce, 2, 1},
        {ControlQuantity::kForce, 3, 1},
        {ControlQuantity::kForce, 4, 1},
        {ControlQuantity::kDamping, 5, 5}}};
    static constexpr std::array<std::size_t, 17> targets = {1, 3, 5, 7, 9, 0, 1, 2, 3, 4, 13, 0, 2, 3, 4, 5, 6};
    static constexpr std::array<std::size_t, 0> strikes = {};
    static constexpr std::array<std::size_t, 5> plucks = {0, 1, 2, 3, 4};
    static constexpr std::array<InstrumentOutput, 2> sources = {{
        {OutputQuantity::kVelocity, 10, 2},
        {OutputQuantity::kForce, 12, 5}}};
    // Values that are allowed, those of sliders, the first one, scale, when it acts, how slowly it follows [s].
    static constexpr std::array<Parameter, 12> parameters = {{
        {"thumb_ds4_force_n", "N", {-20.0, 20.0}, {-20.0, 20.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"thumb_a4_force_n", "N", {-20.0, 20.0}, {-20.0, 20.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"thumb_ds5_force_n", "N", {-20.0, 20.0}, {-20.0, 20.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"thumb_a5_force_n", "N", {-20.0, 20.0}, {-20.0, 20.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"thumb_d6_force_n", "N", {-20.0, 20.0}, {-20.0, 20.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"hand_damping_per_s", "1/s", {0.0, 1000.0}, {0.0, 1000.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"thumb_ds4_release_n", "N", {-20.0, 20.0}, {0.0, 8.06}, 4.03, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_a4_release_n", "N", {-20.0, 20.0}, {0.0, 4.46}, 2.23, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_ds5_release_n", "N", {-20.0, 20.0}, {0.0, 2.48}, 1.24, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_a5_release_n", "N", {-20.0, 20.0}, {0.0, 1.372}, 0.686, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_d6_release_n", "N", {-20.0, 20.0}, {0.0, 0.838}, 0.419, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"bend_cents", "cents", {-4800.0, 4800.0}, {-200.0, 200.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.0, 0, 16}}};
    static constexpr std::array<Event, 5> events = {{
        {"pluck_thumb_ds4", EventKind::kPluck, 0, 6},
        {"pluck_thumb_a4", EventKind::kPluck, 1, 7},
        {"pluck_thumb_ds5", EventKind::kPluck, 2, 8},
        {"pluck_thumb_a5", EventKind::kPluck, 3, 9},
        {"pluck_thumb_d6", EventKind::kPluck, 4, 10}}};
    static constexpr std::array<Output, 2> outputs = {{
        {"box_velocity_m_per_s", "m/s", 0.08},
        {"bridge_force_n", "N", 40.0}}};
    static constexpr std::array<KeyRange, 5> key_ranges = {{
        {60, 65, 0, 63, 0, 0.307},
        {66, 71, 1, 69, 1, 0.307},
        {72, 77, 2, 75, 2, 0.307},
        {78, 83, 3, 81, 3, 0.307},
        {84, 88, 4, 86, 4, 0.307}}};
    static constexpr std::array<double, 29> tension_squares = {
        973918.1264947, 38252363.44851, 299905531.6158, 1151648497.968, 3147048082.276, 1553502.756722,
        61013395.20314, 478355367.7584, 1836902032.694, 2420508.193669, 95063495.76291, 745313511.0007,
        2862030704.064, 3612646.700051, 141883209.5648, 1112387564.96, 4978456.572432, 195523845.3898,
        1532938798.464, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    static constexpr std::array<std::size_t, 0> damped = {};
    static constexpr std::array<std::size_t, 1> input_places = {11};

    static constexpr InstrumentData view() {
      return {"kalimba", "kalimba, tines on a box", "MIT", angular_frequencies, decays, masses, body_ends, place_bodies, shapes,
              knots, energies, forces, half_curvatures, table_ends, connections, controls, targets, strikes, plucks, sources,
              parameters, events, outputs,
              {key_ranges, 8, tension_squares, 0, damped, 0.0, kNoParameter, 11}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, input_places, 10.0};
    }
  };
};

}  // namespace contactspline::instruments
