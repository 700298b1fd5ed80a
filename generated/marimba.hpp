// SPDX-License-Identifier: MIT
// Instrument marimba of three octaves: 18 bodies with 42 modes below 22050.0 Hz, 12 connections.
// Written by contactspline 0.2.0: contactspline generate marimba.json --emit cpp
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/voices.hpp"

namespace contactspline::instruments {

template <std::floating_point T = double>
class marimba : public Voices<NetworkInstrument<T>> {
 public:
  static constexpr int format_version = 2;  // version of the layout; the runtime checks it

  marimba() : Voices<NetworkInstrument<T>>(data::view()) {
    static_assert(contactspline::fits_runtime<marimba>,
                  "generated for another version: run `contactspline generate` again");
  }
  explicit marimba(double sample_rate_hz) : marimba() { this->prepare(sample_rate_hz); }

  /// 0 to 10000, at the beginning 0.
  void set_tubes_damping_per_s(T value) { this->set(0, double(value)); }
  /// 0.01 to 100, at the beginning 1.
  void set_head_stiffness_ratio(T value) { this->set(1, double(value)); }
  /// 0 to 1000, at the beginning 0.
  void set_hand_damping_per_s(T value) { this->set(2, double(value)); }
  /// -100 to 100, at the beginning 2.5.
  void set_mallet_ds3_speed_m_per_s(T value) { this->set(3, double(value)); }
  /// -100 to 100, at the beginning 2.5.
  void set_mallet_a3_speed_m_per_s(T value) { this->set(4, double(value)); }
  /// -100 to 100, at the beginning 2.5.
  void set_mallet_ds4_speed_m_per_s(T value) { this->set(5, double(value)); }
  /// -100 to 100, at the beginning 2.5.
  void set_mallet_a4_speed_m_per_s(T value) { this->set(6, double(value)); }
  /// -100 to 100, at the beginning 2.5.
  void set_mallet_ds5_speed_m_per_s(T value) { this->set(7, double(value)); }
  /// -100 to 100, at the beginning 2.5.
  void set_mallet_a5_speed_m_per_s(T value) { this->set(8, double(value)); }
  /// -4800 to 4800, at the beginning 0.
  void set_bend_cents(T value) { this->set(9, double(value)); }
  void strike_mallet_ds3(T speed_m_per_s) { this->strike(0, speed_m_per_s); }
  void strike_mallet_a3(T speed_m_per_s) { this->strike(1, speed_m_per_s); }
  void strike_mallet_ds4(T speed_m_per_s) { this->strike(2, speed_m_per_s); }
  void strike_mallet_a4(T speed_m_per_s) { this->strike(3, speed_m_per_s); }
  void strike_mallet_ds5(T speed_m_per_s) { this->strike(4, speed_m_per_s); }
  void strike_mallet_a5(T speed_m_per_s) { this->strike(5, speed_m_per_s); }
  [[nodiscard]] T both_velocity_m_per_s() const { return this->output(0); }
  [[nodiscard]] T bars_velocity_m_per_s() const { return this->output(1); }

  // What NetworkInstrument plays. Its members: struct InstrumentData.
  struct data {
    static constexpr std::array<double, 42> angular_frequencies = {
        973.8297638075, 3937.702068608, 9312.437919706, 16163.83939911, 972.3857581391, 2917.157274417, 0.0,
        1379.164246219, 5576.257865026, 13186.86242555, 22888.92934085, 1375.012272623, 4125.03681787, 0.0,
        1952.322726981, 7894.416160442, 18670.09652457, 32406.1087232, 1944.39452516, 5833.120743626, 0.0,
        2762.176644246, 11168.24991019, 26411.22228279, 45842.87704185, 2749.459058569, 8248.565671265, 0.0,
        3907.598956999, 15798.93881972, 37361.20034259, 64849.33926173, 3887.97223623, 11664.10520425, 0.0,
        5527.234135058, 22347.15042678, 52846.06640449, 91727.10978553, 5497.787143782, 16493.36143135, 0.0};
    static constexpr std::array<double, 42> decays = {
        2.504365978679, 5.013333644304, 9.563139300156, 15.36296775403, 17.8, 18.0, 0.0, 3.050574975317,
        5.912939891564, 11.10327755329, 17.71996671849, 25.2, 31.9, 0.0, 3.724686752928, 6.995599368211,
        12.92723203163, 20.48842337784, 35.6, 57.9, 0.0, 4.56107107338, 8.307557979383, 15.10117071309,
        23.76162978794, 50.4, 107.0, 0.0, 5.586242664797, 9.865620161667, 17.62530660469, 27.51755936694,
        71.3, 203.0, 0.0, 6.850225735977, 11.71986575108, 20.54979999554, 31.80649725289, 101.0, 389.0, 0.0};
    static constexpr std::array<double, 42> masses = {
        0.125913441, 0.153457981, 0.179792018, 0.175795546, 0.064417, 0.064417, 0.0584, 0.103354921,
        0.125963432, 0.147576598, 0.144310111, 0.032209, 0.032209, 0.0488, 0.0848319642, 0.103389883,
        0.121132636, 0.118436901, 0.016104, 0.016104, 0.0408, 0.0696224588, 0.08485229, 0.0994118856,
        0.0972094357, 0.0080522, 0.0080522, 0.034, 0.0571384064, 0.0696370572, 0.0815851973, 0.0797813648,
        0.0040261, 0.0040261, 0.0284, 0.0468964654, 0.0571547016, 0.0669610198, 0.0654812103, 0.002013,
        0.002013, 0.0238};
    static constexpr std::array<std::size_t, 18> body_ends = {4, 6, 7, 11, 13, 14, 18, 20, 21, 25, 27, 28, 32, 34, 35, 39, 41, 42};
    static constexpr std::array<std::size_t, 36> place_bodies = {2, 5, 8, 11, 14, 17, 0, 0, 0, 1, 1, 3, 3, 3, 4, 4, 6, 6, 6, 7, 7, 9, 
        9, 9, 10, 10, 12, 12, 12, 13, 13, 15, 15, 15, 16, 16};
    static constexpr std::array<double, 102> shapes = {
        1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -0.986922117, -1.03438835, 0.670832262, 1.69484002, -1.16903904, 0.0,
        2.02244351, 0.0, -0.748081566, -1.18953306, -0.399213121, 0.744372603, 1.0, 1.0, 8.0, 8.0,
        -0.986918189, -1.03439836, 0.670735779, 1.69485566, -1.1690353, 0.00185174245, 2.02224863,
        -0.00469458646, -0.517115198, -1.0763726, -0.861024212, -0.19179468, 1.0, 1.0, 8.0, 8.0, -0.986871006,
        -1.03447532, 0.670543791, 1.69473206, -1.16903993, 0.0, 2.02249654, 0.0, -0.306796586, -0.867605621,
        -0.941910078, -0.684234184, 1.0, 1.0, 8.0, 8.0, -0.98686231, -1.03449379, 0.670414102, 1.69473959,
        -1.16903646, 0.0, 2.02229412, 0.0, -0.121381331, -0.638525044, -0.835904743, -0.824533033, 1.0, 1.0,
        8.0, 8.0, -0.987115194, -1.03405991, 0.671907511, 1.69525198, -1.16903398, 0.00265079829, 2.02219531,
        -0.00672040364, 0.0404611584, -0.419058338, -0.655827745, -0.768384346, 1.0, 1.0, 8.0, 8.0,
        -0.987117114, -1.03405693, 0.67191126, 1.69525832, -1.16903447, 0.0, 2.02218183, 0.0, 0.181939859,
        -0.217748001, -0.454653302, -0.619896704, 1.0, 1.0, 8.0, 8.0};
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
    static constexpr std::array<InstrumentConnection, 12> connections = {{
        {ConnectionKind::kContact, 0, 6, 0, 0.005, 12.5, 0.0, 0.0, 0.0},
        {ConnectionKind::kContact, 1, 11, 0, 0.005, 25.9, 0.0, 0.0, 0.0},
        {ConnectionKind::kContact, 2, 16, 0, 0.005, 53.4, 0.0, 0.0, 0.0},
        {ConnectionKind::kContact, 3, 21, 0, 0.005, 110.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kContact, 4, 26, 0, 0.005, 228.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kContact, 5, 31, 0, 0.005, 470.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kSpring, 7, 9, 0, 0.0, 1.0, 0.0, 634.0, 0.0},
        {ConnectionKind::kSpring, 12, 14, 0, 0.0, 1.0, 0.0, 647.0, 0.0},
        {ConnectionKind::kSpring, 17, 19, 0, 0.0, 1.0, 0.0, 659.0, 0.0},
        {ConnectionKind::kSpring, 22, 24, 0, 0.0, 1.0, 0.0, 671.0, 0.0},
        {ConnectionKind::kSpring, 27, 29, 0, 0.0, 1.0, 0.0, 684.0, 0.0},
        {ConnectionKind::kSpring, 32, 34, 0, 0.0, 1.0, 0.0, 697.0, 0.0}}};
    static constexpr std::array<InstrumentControl, 3> controls = {{
        {ControlQuantity::kDamping, 0, 6},
        {ControlQuantity::kStiffnessRatio, 6, 6},
        {ControlQuantity::kDamping, 12, 6}}};
    static constexpr std::array<std::size_t, 36> targets = {1, 4, 7, 10, 13, 16, 0, 1, 2, 3, 4, 5, 0, 3, 6, 9, 12, 15, 10, 15, 
        20, 25, 30, 35, 8, 13, 18, 23, 28, 33, 8, 13, 18, 23, 28, 33};
    static constexpr std::array<std::size_t, 6> strikes = {2, 5, 8, 11, 14, 17};
    static constexpr std::array<std::size_t, 0> plucks = {};
    static constexpr std::array<InstrumentOutput, 2> sources = {{
        {OutputQuantity::kVelocity, 18, 12},
        {OutputQuantity::kVelocity, 30, 6}}};
    // Values that are allowed, those of sliders, the first one, scale, when it acts, how slowly it follows [s].
    static constexpr std::array<Parameter, 10> parameters = {{
        {"tubes_damping_per_s", "1/s", {0.0, 10000.0}, {0.0, 10000.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"head_stiffness_ratio", "", {0.01, 100.0}, {0.01, 100.0}, 1.0, Scale::kLogarithmic, Acts::kAtOnce, 0.0},
        {"hand_damping_per_s", "1/s", {0.0, 1000.0}, {0.0, 1000.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.005},
        {"mallet_ds3_speed_m_per_s", "m/s", {-100.0, 100.0}, {0.0, 10.0}, 2.5, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"mallet_a3_speed_m_per_s", "m/s", {-100.0, 100.0}, {0.0, 10.0}, 2.5, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"mallet_ds4_speed_m_per_s", "m/s", {-100.0, 100.0}, {0.0, 10.0}, 2.5, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"mallet_a4_speed_m_per_s", "m/s", {-100.0, 100.0}, {0.0, 10.0}, 2.5, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"mallet_ds5_speed_m_per_s", "m/s", {-100.0, 100.0}, {0.0, 10.0}, 2.5, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"mallet_a5_speed_m_per_s", "m/s", {-100.0, 100.0}, {0.0, 10.0}, 2.5, Scale::kLinear, Acts::kAtNextNote, 0.0},
        {"bend_cents", "cents", {-4800.0, 4800.0}, {-200.0, 200.0}, 0.0, Scale::kLinear, Acts::kAtOnce, 0.0, 0, 16}}};
    static constexpr std::array<Event, 6> events = {{
        {"strike_mallet_ds3", EventKind::kStrike, 0, 3},
        {"strike_mallet_a3", EventKind::kStrike, 1, 4},
        {"strike_mallet_ds4", EventKind::kStrike, 2, 5},
        {"strike_mallet_a4", EventKind::kStrike, 3, 6},
        {"strike_mallet_ds5", EventKind::kStrike, 4, 7},
        {"strike_mallet_a5", EventKind::kStrike, 5, 8}}};
    static constexpr std::array<Output, 2> outputs = {{
        {"both_velocity_m_per_s", "m/s", 5.5},
        {"bars_velocity_m_per_s", "m/s", 2.0}}};
    static constexpr std::array<KeyRange, 6> key_ranges = {{
        {48, 53, 0, 51, 0},
        {54, 59, 1, 57, 3},
        {60, 65, 2, 63, 6},
        {66, 71, 3, 69, 9},
        {72, 77, 4, 75, 12},
        {78, 84, 5, 81, 15}}};
    static constexpr std::array<double, 42> tension_squares = {
        948344.4088774, 15505497.58112, 86721500.00839, 261269704.1203, 945534.0626318, 8509806.563686, 0.0,
        1902094.018049, 31094651.77726, 173893340.6303, 523903086.3704, 1890658.749864, 17015928.74878, 0.0,
        3811564.030287, 62321806.51425, 348572504.2369, 1050155882.58, 3780670.069471, 34025297.60972, 0.0,
        7629619.814018, 124729806.0565, 697552662.4712, 2101569375.474, 7559525.114746, 68038835.63318, 0.0,
        15269329.60874, 249606467.8291, 1395859291.039, 4205436802.683, 15116328.10969, 136051350.2158, 0.0,
        30550317.18375, 499395132.1973, 2792706734.427, 8413862669.606, 30225663.47834, 272030971.305, 0.0};
    static constexpr std::array<std::size_t, 0> damped = {};
    static constexpr std::array<std::size_t, 18> tuned_with = {0, 0, 2, 3, 3, 5, 6, 6, 8, 9, 9, 11, 12, 12, 14, 15, 15, 17};
    static constexpr std::array<std::size_t, 1> input_places = {16};

    static constexpr InstrumentData view() {
      return {"marimba", "marimba of three octaves", "MIT", angular_frequencies, decays, masses, body_ends, place_bodies, shapes,
              knots, energies, forces, half_curvatures, table_ends, connections, controls, targets, strikes, plucks, sources,
              parameters, events, outputs,
              {key_ranges, 8, tension_squares, 0, damped, 0.0, kNoParameter, 9, tuned_with}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, input_places, 50.0};
    }
  };
};

}  // namespace contactspline::instruments
