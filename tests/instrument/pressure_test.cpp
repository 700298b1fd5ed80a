// SPDX-License-Identifier: MIT
// The pressure of plates and membranes at listening places, as instruments of files play it, against a direct
// integration over the body.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "generator/instrument/instrument_reader.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

// A spruce plate as large as half a piano's board, and the head of a tom.
const std::string kBoard = R"("plate": { "length_m": 1.1, "width_m": 0.7, "thickness_m": 0.012, "density_kg_m3": 392,
  "youngs_modulus_pa": 11.5e9, "youngs_modulus_across_pa": 8e9, "shear_modulus_pa": 1.5e9, "poisson_ratio": 0.3,
  "constant_loss_per_s": 8, "quadratic_loss_m2_per_s": 0.2 }, "max_modes": 150)";
const std::string kHead = R"("membrane": { "radius_m": 0.165, "mass_per_area_kg_m2": 0.353, "tension_n_per_m": 1500,
  "constant_loss_per_s": 6, "quadratic_loss_m2_per_s": 0.02 }, "max_modes": 120)";

// A body that a force of 1 N drives at a place, before the two ears of a listener to the side of it.
InstrumentModel listened(const std::string& body, const std::string& place) {
  const std::string ear =
      R"("pressure_pa": "body", "distance_m": 1.2, "angle_rad": 0.7, "around_rad": 1.1, "side_m": )";
  return parse_instrument(R"({ "name": "listened", "bodies": [ { "name": "body", )" + body + R"( } ],
    "places": [ { "name": "driven", "body": "body", )" +
                              place + R"( } ],
    "controls": [ { "name": "driven", "force_n": "driven" } ],
    "outputs": [ { "name": "left", )" +
                              ear + R"(-0.09 }, { "name": "right", )" + ear + "0.09 } ] }",
                          "listened.json");
}
InstrumentModel board() {
  return listened(kBoard, R"("position_m": 0.24, "across_m": 0.18)");
}
InstrumentModel head() {
  return listened(kHead, R"("position_m": 0.05)");
}

// Its body, picked up where the force acts.
Resonator body_of(const InstrumentModel& model) {
  Resonator body = model.bodies.front().resonator;
  body.pickup = model.places.front().points.front();
  return body;
}

struct Point {
  double x, y, z;
};

// By the words of the docs: the listener's right hand is where x cross z points, for a listener who looks along -x.
Point point_of(const ListeningPlace& at) {
  const Point to_listener{std::sin(at.angle_rad) * std::cos(at.around_rad),
                          std::sin(at.angle_rad) * std::sin(at.around_rad), std::cos(at.angle_rad)};
  const Point right{-std::sin(at.around_rad), std::cos(at.around_rad), 0};
  return {at.distance_m * to_listener.x + at.side_m * right.x, at.distance_m * to_listener.y + at.side_m * right.y,
          at.distance_m * to_listener.z};
}

// Simpson's rule with `steps` (even) from a to b: weight of point i.
double simpson(std::size_t i, std::size_t steps, double a, double b) {
  return (i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2) * (b - a) / static_cast<double>(steps) / 3;
}

// Modal displacement per newton at the place where the force acts.
Complex modal_displacement(const Resonator& body, const NumberedMode& row, double w) {
  const auto& [w1, decay, mass] = row.mode;
  return pickup_shape(body, row) / (mass * Complex(w1 * w1 + decay * decay - w * w, 2 * decay * w));
}

// What a point of the body radiates to a place, for an acceleration of 1 over 1 m^2.
Complex from_point(const Point& at, double x, double y, double w) {
  const double distance = std::hypot(at.x - x, at.y - y, at.z);
  return 1.2 / (2 * pi * distance) * std::polar(1.0, -w / 343 * distance);
}

// The modal displacements by mode number along a plate or by order of a membrane, times their shapes in a row of
// points.
template <typename Shape>
std::vector<Complex> row_sums(std::span<const NumberedMode> modes, const std::vector<Complex>& moved, Shape shape) {
  std::vector<Complex> sums(64);
  for (std::size_t m = 0; m < modes.size(); ++m)
    sums.at(static_cast<std::size_t>(modes[m].row)) += moved[m] * shape(modes[m]);
  return sums;
}

// Displacement at a point of such a row.
template <typename Shape>
Complex point_sum(const std::vector<Complex>& sums, Shape shape) {
  Complex sum = 0;
  for (std::size_t n = 0; n < sums.size(); ++n)
    if (sums[n] != 0.0) sum += sums[n] * shape(static_cast<double>(n));
  return sum;
}

// Integrals of displacement times what a point of the surface radiates.
Complex integral_over(const Plate& plate, std::span<const NumberedMode> modes, const std::vector<Complex>& moved,
                      const Point& at, double w) {
  constexpr std::size_t kColumns = 400, kRows = 280;
  Complex sum = 0;
  for (std::size_t r = 0; r <= kRows; ++r) {
    const double y = plate.width_m * static_cast<double>(r) / kRows;
    const auto row = row_sums(
        modes, moved, [&](const NumberedMode& mode) { return std::sin(mode.number * pi * y / plate.width_m); });
    for (std::size_t c = 0; c <= kColumns; ++c) {
      const double x = plate.length_m * static_cast<double>(c) / kColumns;
      sum += simpson(r, kRows, 0, plate.width_m) * simpson(c, kColumns, 0, plate.length_m) *
             point_sum(row, [&](double n) { return std::sin(n * pi * x / plate.length_m); }) *
             from_point(at, x - plate.length_m / 2, y - plate.width_m / 2, w);
    }
  }
  return sum;
}

// Of a membrane or a circular plate.
Complex integral_over_disc(const decltype(Resonator::body)& body, std::span<const NumberedMode> modes,
                           const std::vector<Complex>& moved, const Point& at, double w) {
  constexpr std::size_t kCircles = 240, kSteps = 200;
  Complex sum = 0;
  for (std::size_t i = 0; i <= kCircles; ++i) {
    const double r = radius_of(body) * static_cast<double>(i) / kCircles;
    const auto row = row_sums(modes, moved, [&](const NumberedMode& mode) {
      return std::holds_alternative<Membrane>(body) ? std::cyl_bessel_j(mode.row, mode.wavenumber_per_m * r)
                                                    : radial_shape(body, mode.row, mode.wavenumber_per_m, r);
    });
    for (std::size_t j = 0; j < kSteps; ++j) {
      const double angle = 2 * pi * static_cast<double>(j) / kSteps;
      sum += simpson(i, kCircles, 0, radius_of(body)) * r * 2 * pi / kSteps *
             point_sum(row, [&](double n) { return std::cos(n * angle); }) *
             from_point(at, r * std::cos(angle), r * std::sin(angle), w);
    }
  }
  return sum;
}

// Pressure per newton [Pa/N], by direct integration of the acceleration of the surface.
Complex direct_pressure(const Resonator& body, std::span<const NumberedMode> modes, const ListeningPlace& place,
                        double frequency_hz) {
  const double w = 2 * pi * frequency_hz;
  std::vector<Complex> moved;
  for (const NumberedMode& row : modes) moved.push_back(modal_displacement(body, row, w));
  const auto* plate = std::get_if<Plate>(&body.body);
  return -w * w *
         (plate != nullptr ? integral_over(*plate, modes, moved, point_of(place), w)
                           : integral_over_disc(body.body, modes, moved, point_of(place), w));
}

// The samples of each output after a force of 1 N over one sample, until the body is silent.
std::vector<std::vector<double>> responses(const InstrumentArrays& arrays, double rate) {
  BySample<double> instrument(arrays.view(), rate);
  instrument.set(0, 1);
  std::vector<std::vector<double>> sound(arrays.outputs.size());
  for (std::size_t n = 0; n < static_cast<std::size_t>(2 * rate); ++n) {
    instrument.tick();
    instrument.set(0, 0);
    for (std::size_t o = 0; o < sound.size(); ++o) sound[o].push_back(instrument.output(o));
  }
  return sound;
}

Complex spectrum_at(const std::vector<double>& sound, double phase) {
  const Complex step = std::polar(1.0, -phase);
  Complex sum = 0;
  for (std::size_t n = sound.size(); n-- > 0;) sum = sum * step + sound[n];
  return sum;
}

// When the nearest point of the body begins to sound, for arrays of 44.1 kHz, less the time that is left out.
double left_out_s(const InstrumentModel& model) {
  double nearest_m = 1e9;
  for (const ModelOutput& output : model.outputs)
    nearest_m = std::min(nearest_m, reach_of(model.bodies.front().resonator.body, output.listening).nearest_m);
  return radiation_timing(nearest_m, 44100).left_out_s;
}

// The largest error in amplitude and phase, as the level of an amplitude [dB], over 20 frequencies and both ears. The
// force of a sample is the mean of a force over it, so a force that oscillates is as many times as large, and its
// middle is half a sample before the end.
double largest_error_db(const InstrumentModel& model, const InstrumentArrays& arrays, double rate, double low_hz,
                        double high_hz) {
  const Resonator body = body_of(model);
  const auto modes = numbered_modes_of(body, 22050).modes;
  const auto sound = responses(arrays, rate);
  double largest = 0;
  for (std::size_t ear = 0; ear < 2; ++ear)
    for (int i = 0; i < 20; ++i) {
      const double f = low_hz * std::pow(high_hz / low_hz, i / 19.0), half_phase = pi * f / rate;
      const Complex expected =
          direct_pressure(body, modes, model.outputs[ear].listening, f) *
          std::polar(half_phase / std::sin(half_phase), 2 * pi * f * left_out_s(model) + half_phase);
      const double error = std::abs(spectrum_at(sound[ear], 2 * half_phase) / expected - 1.0);
      EXPECT_TRUE(is_finite(error)) << f;
      largest = std::max(largest, 20 * std::log10(1 + error));
    }
  return largest;
}

// Between and at resonances, below the lowest mode and beyond the highest one. The taps are fitted within 1e-4;
// Simpson's rule has 14 points for each wavelength of the highest mode and 27 for that in air.
TEST(Pressure, OfAPlateIsThatOfADirectIntegration) {
  const InstrumentModel model = board();
  const double error_db = largest_error_db(model, arrays_of(model, 22050), 44100, 60, 12000);
  Measured() << error_db << " dB";
  EXPECT_LT(error_db, 0.01);
}

TEST(Pressure, OfAMembraneIsThatOfADirectIntegration) {
  const InstrumentModel model = head();
  const double error_db = largest_error_db(model, arrays_of(model, 22050), 44100, 60, 12000);
  Measured() << error_db << " dB";
  EXPECT_LT(error_db, 0.01);
}

// A plate as the gong that ships, with more losses and without stretching. Its response rises by 50 dB from the
// lowest mode on: below 2 kHz the error of the taps, 1e-4 of the largest response, counts.
TEST(Pressure, OfACircularPlateIsThatOfADirectIntegration) {
  InstrumentModel model = head();
  model.bodies[0].resonator.body = RoundPlate{0.15, 0.0012, 8700, 1.1e11, 0.34, {60, 0.01}};
  const double error_db = largest_error_db(model, arrays_of(model, 22050), 44100, 2000, 12000);
  Measured() << error_db << " dB";
  EXPECT_LT(error_db, 0.01);
}

// What forces do at once counts: without the taps a mode is right only where it is alone.
TEST(Pressure, NeedsWhatForcesDoAtOnce) {
  const InstrumentModel model = board();
  InstrumentArrays arrays = arrays_of(model, 22050);
  std::ranges::fill(arrays.pressure_taps, 0.0);
  EXPECT_GT(largest_error_db(model, arrays, 44100, 60, 12000), 10);
}

// Arrays that were made for another sample rate. What the two weights of a mode sound like at a distance from its
// resonance depends on the rate: by ((w - w1) dt)^2/24, 2 % at 5 kHz and 44.1 kHz, of which 96 kHz has a fifth.
TEST(Pressure, AtOtherRates) {
  const InstrumentModel model = board();
  for (const double rate : {48000.0, 96000.0}) {
    const double error_db = largest_error_db(model, arrays_of(model, 22050), rate, 60, 5000);
    Measured() << rate << " Hz: " << error_db << " dB";
    EXPECT_LT(error_db, 0.2);
  }
}

// A pair of microphones of which one is 40 cm farther away: the sound of the blow comes to it so much later.
TEST(Pressure, ArrivesAtTheNearerMicrophoneFirst) {
  InstrumentModel model = head();
  model.outputs[0].listening.distance_m += 0.4;
  const auto sound = responses(arrays_of(model, 22050), 44100);
  const auto peak = [&](std::size_t ear) {
    return std::ranges::max_element(sound[ear], {}, [](double x) { return std::abs(x); }) - sound[ear].begin();
  };
  const auto distance = [&](std::size_t ear) {
    const Point at = point_of(model.outputs[ear].listening);
    return std::hypot(at.x - 0.05, at.y, at.z);  // from the force
  };
  const double apart = (distance(0) - distance(1)) / 343 * 44100;
  ASSERT_GT(apart, 40);
  EXPECT_NEAR(double(peak(0) - peak(1)), apart, 1);
}

TEST(Pressure, EndsWithTheForceAndAtReset) {
  const InstrumentModel model = head();
  const InstrumentArrays arrays = arrays_of(model, 22050);
  BySample<double> instrument(arrays.view(), 44100);
  instrument.set(0, 1);
  for (int n = 0; n < 100; ++n) instrument.tick();
  EXPECT_NE(instrument.output(0), 0);
  instrument.set(0, 0);
  instrument.reset();
  EXPECT_EQ(instrument.output(0), 0);
  for (int n = 0; n < 100; ++n) instrument.tick();
  EXPECT_EQ(instrument.output(0), 0);
}

}  // namespace
}  // namespace contactspline::testing
