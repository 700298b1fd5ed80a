// SPDX-License-Identifier: MIT
// Instrument marimba bar over its tube: 3 bodies with 14 modes below 22050.0 Hz, 2 connections.
// Written by contactspline 0.2.0: contactspline generate marimba_tube.json --emit cpp
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/voices.hpp"

namespace contactspline::instruments {

template <std::floating_point T = double>
class marimba_tube : public Voices<NetworkInstrument<T>> {
 public:
  static constexpr int format_version = 2;  // version of the layout; the runtime checks it

  marimba_tube() : Voices<NetworkInstrument<T>>(data::view()) {
    static_assert(contactspline::fits_runtime<marimba_tube>,
                  "generated for another version: run `contactspline generate` again");
  }
  explicit marimba_tube(double sample_rate_hz) : marimba_tube() { this->prepare(sample_rate_hz); }

  /// 0 to 100000, at the beginning 100.
  void set_air_stiffness_n_per_m(T value) { this->set(0, double(value)); }
  /// 0.01 to 100, at the beginning 1.
  void set_head_stiffness_ratio(T value) { this->set(1, double(value)); }
  /// 0 to 1000, at the beginning 0.
  void set_hand_damping_per_s(T value) { this->set(2, double(value)); }
  /// -100 to 100, at the beginning 2.5.
  void set_mallet_speed_m_per_s(T value) { this->set(3, double(value)); }
  void strike_mallet(T speed_m_per_s) { this->strike(0, speed_m_per_s); }
  [[nodiscard]] T both_velocity_m_per_s() const { return this->output(0); }
  [[nodiscard]] T bar_velocity_m_per_s() const { return this->output(1); }

  // What NetworkInstrument plays. Its members: struct InstrumentData.
  struct data {
    static constexpr std::array<double, 14> angular_frequencies = {
        1643.84172628, 6646.704882657, 15718.75484276, 27283.52104472, 41434.07694773, 58097.51418945,
        77199.92618913, 98728.63215237, 122758.2598708, 1561.685708099, 4685.057124298, 7808.742699763,
        10932.11411596, 0.0};
    static constexpr std::array<double, 14> decays = {
        3.359910233497, 5.976952692661, 10.72262442333, 16.77225869573, 24.17454315354, 32.89133868998,
        42.88398409884, 54.14584594352, 66.7159625772, 29.9, 38.45, 89.35, 163.4, 0.0};
    static constexpr std::array<double, 14> masses = {
        0.0936253867, 0.114106236, 0.133686374, 0.130719782, 0.123683973, 0.115887316, 0.109143087,
        0.104578084, 0.102625432, 0.00037458, 0.00037458, 0.00037458, 0.00037458, 0.02};
    static constexpr std::array<std::size_t, 3> body_ends = {9, 13, 14};
    static constexpr std::array<std::size_t, 5> place_bodies = {2, 0, 0, 0, 1};
    static constexpr std::array<double, 32> shapes = {
        1.0, -0.944429636, -1.09630654, 0.427319044, 1.58372926, 1.16672611, -0.373050126, -1.39933475,
        -0.875595603, 0.578019599, -1.16903773, 0.0, 2.02236707, 0.0, -1.78200402, 0.0, 1.62684046, 0.0,
        -1.56109896, -0.0204141586, -0.502992115, -0.730679039, -0.805554736, -0.71598274, -0.477162115,
        -0.137387184, 0.232718436, 0.55628796, 1.0, 1.0, 1.0, 1.0};
    static constexpr std::array<double, 48> knots = {
        0.0, 6.335868946429475e-06, 1.2897116040413183e-05, 1.9694557070496382e-05, 2.673966874742654e-05,
        3.404462925484477e-05, 4.162237804803871e-05, 4.9486666677475764e-05, 5.765212691396464e-05,
        6.61343356297616e-05, 7.494988941184265e-05, 8.411648782598985e-05, 9.365301884358119e-05,
        0.00010357965940730531, 0.00011391798681039382, 0.00012469107277422538, 0.0001359236467324431,
        0.0001476422126169457, 0.00015987523160633675, 0.0001726532410746195, 0.00018600911411562187,
        0.0001999782325592796, 0.00021459870324199055, 0.0002299116824121458, 0.0002459615811869661,
        0.00026279647646617466, 0.0002804684028969754, 0.00029903377460124326, 0.00031855385015678586,
        0.0003390952408326754, 0.0003607304512651341, 0.00038353852826859694, 0.00040760582859546824,
        0.00043302677588236144, 0.0004599048122396573, 0.0004883534687897567, 0.0005184975443405107,
        0.0005504744787019698, 0.0005844359314599677, 0.0006205495878335796, 0.0006590012132434866,
        0.0006999970539129049, 0.0007437666267551562, 0.0007905659309884248, 0.0008406811463588143,
        0.000894433131563713, 0.0009521824525375274, 0.0010143355353432581};
    static constexpr std::array<double, 48> energies = {
        0.0, 9.83307747711253e-10, 1.0083267299111773e-08, 4.3767156565321264e-08, 1.272907454613743e-07,
        2.961875524342443e-07, 5.982842652501603e-07, 1.0962610993088515e-06, 1.8708148269544574e-06,
        3.024523213896793e-06, 4.686545297722559e-06, 7.018327489485318e-06, 1.0220523542921235e-05,
        1.4541389689547468e-05, 2.0286973537726798e-05, 2.7833468741261334e-05, 3.764226446756411e-05,
        5.027821598714541e-05, 6.64319457466172e-05, 8.694694375926383e-05, 0.00011285284330167977,
        0.00014540597619886356, 0.00018613907565255235, 0.00023692254117092047, 0.0003000393626164584,
        0.00037827808177674516, 0.00047504703796146094, 0.0005945161939541529, 0.0007417932229708256,
        0.000923142617952466, 0.001146258831334733, 0.0014206083766033757, 0.0017578597835134111,
        0.002172423578884776, 0.002682135463792993, 0.003309122344786144, 0.00408090321367584,
        0.005031795253622196, 0.006204716512490451, 0.00765350622048422, 0.009445923364676439,
        0.01166754144366078, 0.014426831136997675, 0.017861823625762267, 0.02214888939223708,
        0.02751438755650059, 0.03425017312104267, 0.04273441599428211};
    static constexpr std::array<double, 48> forces = {
        0.0, 0.0003103939668024187, 0.002463456620152207, 0.007447299241395065, 0.01626377667229368,
        0.02997789891277054, 0.049754676304620805, 0.07688788668440766, 0.11282676630829656,
        0.15920341488583278, 0.21786242236288958, 0.2908938439013815, 0.3806702809421414, 0.4898893245736241,
        0.6216219720144244, 0.7793684644993739, 0.9671227249268368, 1.1894468833546552, 1.4515577244990463,
        1.7594272201542545, 2.1198997939443576, 2.540828515931716, 3.031235521904855, 3.6014993566672073,
        4.26357472648627, 5.03125222226382, 5.920463377463374, 6.94964317313458, 8.140157949572076,
        9.516815508851026, 11.108471596980094, 12.948755606083934, 15.076939202194339, 17.53898110106757,
        20.388781041411942, 23.68970680485931, 27.516432696100722, 31.95718845830508, 37.116491470892484,
        43.11851397997562, 50.11120648486637, 58.27140222409953, 67.8111484684364, 78.98558473268373,
        92.10280568089208, 107.53626416222623, 125.74043765722239, 147.2707305822778};
    static constexpr std::array<double, 48> half_curvatures = {
        24.49498004352967, 164.07419370960935, 366.5969737130516, 625.7159456938738, 938.6855840322532,
        1304.9243206381466, 1725.0899387278164, 2200.664664515133, 2733.7601638572028, 3327.0177306552287,
        3983.5617444405234, 4706.975569793457, 5501.309477781052, 6371.081235125421, 7321.323389349677,
        8357.57953278831, 9485.97979560941, 10713.252442904888, 12046.848784209855, 13494.908669895882,
        15066.402496517905, 16771.24548914341, 18620.277231023323, 20625.53101137781, 22800.1862514003,
        25158.863089474282, 27717.72663820712, 30494.62521418004, 33509.356328410744, 36783.92898229328,
        40342.81383793204, 44213.17653426785, 48425.45541453207, 53013.54426456854, 58015.4946444357,
        63473.93013924561, 69436.85895600886, 75958.22018203256, 83099.06987801942, 90928.43839950017,
        99524.67867454197, 108976.91735213874, 119386.77772375585, 130870.64328928974, 143561.75332411393,
        157613.74495858175, 173203.74109480446, 190662.9364235686};
    static constexpr std::array<std::size_t, 1> table_ends = {48};
    static constexpr std::array<InstrumentConnection, 2> connections = {{
        {ConnectionKind::kContact, 0, 1, 0, 0.005, 19.7, 0.0, 0.0, 0.0},
        {ConnectionKind::kSpring, 2, 4, 0, 0.0, 1.0, 0.0, 100.0, 0.0}}};
    static constexpr std::array<InstrumentControl, 3> controls = {{
        {ControlQuantity::kStiffness, 0, 1},
        {ControlQuantity::kStiffnessRatio, 1, 1},
        {ControlQuantity::kDamping, 2, 1}}};
    static constexpr std::array<std::size_t, 6> targets = {1, 0, 0, 4, 3, 3};
    static constexpr std::array<std::size_t, 1> strikes = {2};
    static constexpr std::array<std::size_t, 0> plucks = {};
    static constexpr std::array<InstrumentOutput, 2> sources = {{
        {OutputQuantity::kVelocity, 3, 2},
        {OutputQuantity::kVelocity, 5, 1}}};
    // Values that are allowed, those of sliders, the first one, scale, when it acts, how slowly it follows [s].
    static constexpr std::array<Parameter, 4> parameters = {{
        {"air_stiffness_n_per_m", "N/m", {0.0, 100000.0}, {0.0, 100000.0}, 100.0, Scale::kLinear, Acts::kAtOnce, 0.0},
        {"head_stiffness_ratio", "", {0.01, 100.0}, {0.01, 100.0}, 1.0, Scale::kLogarithmic, Acts::kAtOnce, 0.0},
        {"hand_damping_per_s", "1/s", {0.0, 1000.0}, {0.0, 1000.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"mallet_speed_m_per_s", "m/s", {-100.0, 100.0}, {0.0, 10.0}, 2.5, Scale::kLinear, Acts::kAtNextNote, 0.0}}};
    static constexpr std::array<Event, 1> events = {{
        {"strike_mallet", EventKind::kStrike, 0, 3}}};
    static constexpr std::array<Output, 2> outputs = {{
        {"both_velocity_m_per_s", "m/s", 4.0},
        {"bar_velocity_m_per_s", "m/s", 0.5}}};
    static constexpr std::array<KeyRange, 1> key_ranges = {{
        {60, 60, 0, -1}}};
    static constexpr std::array<double, 0> tension_squares = {};
    static constexpr std::array<std::size_t, 0> damped = {};
    static constexpr std::array<std::size_t, 1> input_places = {1};

    static constexpr InstrumentData view() {
      return {"marimba_tube", "marimba bar over its tube", "MIT", angular_frequencies, decays, masses, body_ends, place_bodies, shapes,
              knots, energies, forces, half_curvatures, table_ends, connections, controls, targets, strikes, plucks, sources,
              parameters, events, outputs,
              {key_ranges, 1, tension_squares, 0, damped, 0.0, kNoParameter, kNoParameter}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, input_places, 50.0};
    }
  };
};

}  // namespace contactspline::instruments
