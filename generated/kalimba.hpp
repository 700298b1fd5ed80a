// SPDX-License-Identifier: MIT
// Instrument kalimba, tines on a box: 7 bodies with 42 modes below 22050.0 Hz, 7 connections.
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
  /// -20 to 20, at the beginning 3.
  void set_thumb_ds4_release_n(T value) { this->set(6, double(value)); }
  /// -20 to 20, at the beginning 3.
  void set_thumb_a4_release_n(T value) { this->set(7, double(value)); }
  /// -20 to 20, at the beginning 3.
  void set_thumb_ds5_release_n(T value) { this->set(8, double(value)); }
  /// -20 to 20, at the beginning 3.
  void set_thumb_a5_release_n(T value) { this->set(9, double(value)); }
  /// -20 to 20, at the beginning 3.
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
    static constexpr std::array<double, 42> angular_frequencies = {
        987.6236303368, 6189.720633745, 17331.44657156, 33962.73833818, 56142.85251054, 83867.70919503,
        117137.5522262, 155952.3682288, 1249.611478944, 7831.205824328, 21927.60917006, 42969.36545425,
        71031.4420114, 106108.6763439, 148201.3767543, 1557.492989567, 9760.672212129, 27330.17240715,
        53556.23391282, 88532.29464791, 132251.9201695, 1911.138655608, 11976.92993374, 33535.75808464,
        65716.70508217, 108634.4248056, 162281.0218012, 2240.157731396, 14038.85609733, 39309.21097224,
        77030.36846219, 127336.7210152, 3141.59265359, 5277.875658031, 6660.17642561, 7759.733854367,
        9676.105373057, 12126.54764286, 16336.28179867, 21928.31672206, 29530.97094374, 0.0};
    static constexpr std::array<double, 42> decays = {
        11.54464899209, 20.47018394963, 39.58682257784, 68.12230388183, 106.1782936526, 153.7477908226,
        210.8312134863, 277.4285385916, 3.954007902611, 15.24626817207, 39.43193994343, 75.53398686069,
        123.681032763, 183.8642201559, 256.084077997, 4.92226720303, 18.99681269766, 49.14156047549,
        94.13874347177, 154.148676985, 229.1603211342, 5.529064369918, 22.79954563089, 59.78932280077,
        115.0041079624, 188.6406195362, 280.6853107932, 6.093627788202, 26.33760417954, 69.69598918529,
        134.4172201906, 220.7318850407, 131.0, 220.0, 278.0, 323.0, 403.0, 505.0, 681.0, 914.0, 1230.0, 0.0};
    static constexpr std::array<double, 42> masses = {
        0.00040455, 0.00040455, 0.00040455, 0.00040455, 0.00040455, 0.00040455, 0.00040455, 0.00040455,
        0.00035965, 0.00035965, 0.00035965, 0.00035965, 0.00035965, 0.00035965, 0.00035965, 0.00032215,
        0.00032215, 0.00032215, 0.00032215, 0.00032215, 0.00032215, 0.000290825, 0.000290825, 0.000290825,
        0.000290825, 0.000290825, 0.000290825, 0.000268625, 0.000268625, 0.000268625, 0.000268625,
        0.000268625, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.00438};
    static constexpr std::array<std::size_t, 7> body_ends = {8, 15, 21, 27, 32, 41, 42};
    static constexpr std::array<std::size_t, 14> place_bodies = {6, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 5};
    static constexpr std::array<double, 92> shapes = {
        1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.1964329813923, 0.642399862995, 0.6445800302133,
        -0.06313724376904, -0.6686732376966, -0.4750162667169, 0.2838769325705, 0.7071776415418, 1.0, -1.0,
        1.0, -1.0, 1.0, -1.0, 1.0, 0.2423575060959, 0.694729576162, 0.4748050970214, -0.3970544924828,
        -0.6678338315946, 0.03692717243948, 0.689476548595, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.2940633036963,
        0.7193642293103, 0.2388081205201, -0.6381514749364, -0.3774151260841, 0.5454102931374, 1.0, -1.0, 1.0,
        -1.0, 1.0, -1.0, 0.3507665178706, 0.7085775086341, -0.03361647703486, -0.7036003715258,
        0.09673087961619, 0.6973308395991, 1.0, -1.0, 1.0, -1.0, 1.0, 0.4012164384486, 0.6690312263048,
        -0.2581319868474, -0.5981566062266, 0.4734785198099, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1,
        -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 12.3, -16.8, 19.4, -21.2, 24.2, -27.7, 33.2, -39.6, 47.3};
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
        {"thumb_ds4_release_n", "N", {-20.0, 20.0}, {0.0, 6.0}, 3.0, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_a4_release_n", "N", {-20.0, 20.0}, {0.0, 6.0}, 3.0, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_ds5_release_n", "N", {-20.0, 20.0}, {0.0, 6.0}, 3.0, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_a5_release_n", "N", {-20.0, 20.0}, {0.0, 6.0}, 3.0, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"thumb_d6_release_n", "N", {-20.0, 20.0}, {0.0, 6.0}, 3.0, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"bend_cents", "cents", {-4800.0, 4800.0}, {-200.0, 200.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.0, 0, 16}}};
    static constexpr std::array<Event, 5> events = {{
        {"pluck_thumb_ds4", EventKind::kPluck, 0, 6},
        {"pluck_thumb_a4", EventKind::kPluck, 1, 7},
        {"pluck_thumb_ds5", EventKind::kPluck, 2, 8},
        {"pluck_thumb_a5", EventKind::kPluck, 3, 9},
        {"pluck_thumb_d6", EventKind::kPluck, 4, 10}}};
    static constexpr std::array<Output, 2> outputs = {{
        {"box_velocity_m_per_s", "m/s", 0.5},
        {"bridge_force_n", "N", 30.0}}};
    static constexpr std::array<KeyRange, 5> key_ranges = {{
        {60, 65, 0, 63, 0},
        {66, 71, 1, 69, 1},
        {72, 77, 2, 75, 2},
        {78, 83, 3, 81, 3},
        {84, 88, 4, 86, 4}}};
    static constexpr std::array<double, 42> tension_squares = {
        975400.4351997, 38312641.52381, 300379040.2629, 1153467595.428, 3152019888.02, 7033792645.622,
        13721206141.55, 24321141156.19, 1561528.848309, 61327784.66298, 480820043.915, 1846366367.541,
        5045465754.219, 11259051195.46, 21963648071.86, 2425784.41255, 95270722.03263, 746938323.8046,
        2868270190.924, 7837967195.625, 17490570388.52, 3652450.960958, 143446850.6378, 1124647070.312,
        4318685326.856, 11801438252.85, 26335130036.85, 5018306.661533, 197089480.5216, 1545214067.26,
        5933677665.42, 16214640518.91, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
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
