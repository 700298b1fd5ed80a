// SPDX-License-Identifier: MIT
// Instrument marimba bar over its tube: 3 bodies with 18 modes below 22050.0 Hz, 2 connections.
// Written by contactspline 0.2.0: contactspline generate marimba_tube.json --emit cpp
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "contactspline/instrument/network_instrument.hpp"

namespace contactspline::instruments {

template <std::floating_point T = double>
class marimba_tube : public NetworkInstrument<T> {
 public:
  static constexpr int format_version = 2;  // version of the layout; the runtime checks it

  marimba_tube() : NetworkInstrument<T>(data::view()) {
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
    static constexpr std::array<double, 18> angular_frequencies = {
        1644.220549808, 4532.36619893, 8885.253345104, 14687.77712963, 21941.00647264, 30644.87766682,
        40799.39424187, 52404.55601971, 65460.36301309, 79966.81522338, 95923.91265168, 113331.6552986,
        132190.0431647, 1561.685708099, 4685.057124298, 7808.742699763, 10932.11411596, 0.0};
    static constexpr std::array<double, 18> decays = {
        4.143583871299, 7.030602230885, 11.38179186241, 17.18205312229, 24.4324543837, 33.13293192547,
        43.2834892611, 54.88412620595, 67.93484276939, 82.43563895097, 98.38651475071, 115.7874701686,
        134.6385052047, 9.745, 38.45, 89.35, 163.4, 0.0};
    static constexpr std::array<double, 18> masses = {
        0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825, 0.0825,
        0.0825, 0.00037458, 0.00037458, 0.00037458, 0.00037458, 0.02};
    static constexpr std::array<std::size_t, 3> body_ends = {13, 17, 18};
    static constexpr std::array<std::size_t, 4> place_bodies = {2, 0, 0, 1};
    static constexpr std::array<double, 31> shapes = {
        1.0, -0.5895229061669, -0.2399920233585, 0.6252198153304, 0.4243391454745, -0.4997655315656,
        -0.5660288690922, 0.3388926794289, 0.6625259441933, -0.1503056734071, -0.7053050079431,
        -0.05044438192418, 0.690947183742, 0.2471084933428, -0.6078222294163, 0.0, 0.7111906070896, 0.0,
        -0.7069297624035, 0.0, 0.7071144298636, 0.0, -0.7071064506554, 0.0, 0.7071067954701, 0.0,
        -0.7071067805693, 1.0, 1.0, 1.0, 1.0};
    static constexpr std::array<double, 32> knots = {
        0.0, 1.1456273199012834e-05, 2.335676570541018e-05, 3.573099842253088e-05, 4.8611087497963355e-05,
        6.203271754013915e-05, 7.603470907762478e-05, 9.066020804606928e-05, 0.00010595701019373553,
        0.00012197756108150029, 0.00013878176759745775, 0.00015643483525337826, 0.000175011377321437,
        0.00019459465788797427, 0.00021527875455703695, 0.00023717072115391968, 0.00026039275042870645,
        0.0002850854181115821, 0.00031141200831991545, 0.0003395585135582588, 0.00036974661093959623,
        0.0004022358248888846, 0.0004373343406607602, 0.0004754087365054745, 0.000516907773407849,
        0.0005623764526602928, 0.0006124906191194648, 0.0006681002152770984, 0.0007302876742556182,
        0.0008004630787639561, 0.0008804960860135727, 0.0009729332794243572};
    static constexpr std::array<double, 32> energies = {
        0.0, 7.803564028361641e-09, 8.056486641538566e-08, 3.5198410001906147e-07, 1.0310669288336825e-06,
        2.4185013980953306e-06, 4.929346837954242e-06, 9.123311737498661e-06, 1.5744268363105057e-05,
        2.577128109701785e-05, 4.048679184303086e-05, 6.156213873543833e-05, 9.117521039229548e-05,
        0.0001321603772761105, 0.00018821118711297852, 0.0002641519581056035, 0.0003663029171031909,
        0.0005029809370778409, 0.0006851922674047902, 0.0009275549977351644, 0.0012496931464605191,
        0.001678113742582114, 0.002248980595600345, 0.003012121445660395, 0.00403722314815642,
        0.005422896555995139, 0.007311112539793901, 0.00991014416431477, 0.013531991603731901,
        0.018656279876195257, 0.026041921507635634, 0.036932841130821556};
    static constexpr std::array<double, 32> forces = {
        0.0, 0.0013623215670230454, 0.01086596265699705, 0.03300249202757446, 0.07244442294910937,
        0.13430162278480037, 0.22433956524005558, 0.3491745293687072, 0.5164909295542238, 0.7352778522010457,
        1.0161301338932707, 1.3715961585779635, 1.8166260141346935, 2.369104435323094, 3.0505965778425956,
        3.887178578770179, 4.910584768165022, 6.159747666546839, 7.682632139195915, 9.538882807548449,
        11.803180897632478, 14.569916142530236, 17.95948519903113, 22.127341295734755, 27.276296909535137,
        33.67438081503243, 41.68219466895144, 51.79201856408585, 64.68958396185623, 81.3527027442932,
        103.21218829885233, 132.42715169684462};
    static constexpr std::array<double, 32> half_curvatures = {
        59.45744935361851, 399.2961251336923, 894.4606860330749, 1531.120269842178, 2304.38477447644,
        3215.183433521186, 4267.71641767544, 5468.9992905165145, 6828.320829276674, 8356.606467122529,
        10068.109169838135, 11978.274910537106, 14105.870038251973, 16473.81931691543, 19107.054572399764,
        22035.244579292746, 25294.20705823757, 28922.934200704534, 32974.798338797074, 37503.15996204248,
        42579.28876359227, 48286.50132289859, 54733.05622106439, 62037.04950928368, 70357.0458905886,
        79895.71033215703, 90899.99382909224, 103699.0866777926, 118724.77899615889, 136565.4390967788,
        158026.01918127813, 184759.8799545851};
    static constexpr std::array<std::size_t, 1> table_ends = {32};
    static constexpr std::array<InstrumentConnection, 2> connections = {{
        {ConnectionKind::kContact, 0, 1, 0, 0.005, 1.0, 0.0, 0.0, 0.0},
        {ConnectionKind::kSpring, 2, 3, 0, 0.0, 1.0, 0.0, 100.0, 0.0}}};
    static constexpr std::array<InstrumentControl, 3> controls = {{
        {ControlQuantity::kStiffness, 0, 1},
        {ControlQuantity::kStiffnessRatio, 1, 1},
        {ControlQuantity::kDamping, 2, 1}}};
    static constexpr std::array<std::size_t, 6> targets = {1, 0, 0, 3, 2, 2};
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

    static constexpr InstrumentData view() {
      return {"marimba_tube", "marimba bar over its tube", "MIT", angular_frequencies, decays, masses, body_ends, place_bodies, shapes,
              knots, energies, forces, half_curvatures, table_ends, connections, controls, targets, strikes, plucks, sources,
              parameters, events, outputs};
    }
  };
};

}  // namespace contactspline::instruments
