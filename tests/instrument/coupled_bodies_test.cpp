// SPDX-License-Identifier: MIT
// Bodies that share the spring of air between them: the frequencies and decays of theory.
#include <functional>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "place_index.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

constexpr double kRate = 44100;

InstrumentModel shipped(const std::string& name) {
  return parse_instrument(find_embedded(Shipped::kInstruments, name + ".json")->content, name);
}

// The frequency of the largest partial between two limits [Hz], by a Hann window.
double partial_between(double low_hz, double high_hz, const std::vector<double>& sound) {
  double largest = 0, found = 0;
  for (double f = low_hz; f <= high_hz; f += 0.1) {
    double re = 0, im = 0;
    for (std::size_t n = 0; n < sound.size(); ++n) {
      const double phase = 2 * pi * f * double(n) / kRate;
      const double window = 1 - std::cos(2 * pi * double(n) / double(sound.size()));
      re += window * sound[n] * std::cos(phase);
      im += window * sound[n] * std::sin(phase);
    }
    if (std::hypot(re, im) > largest) {
      largest = std::hypot(re, im);
      found = f;
    }
  }
  return found;
}

// Root of a function that rises from low to high.
double root(double low, double high, const std::function<double(double)>& f) {
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (f(middle) < 0 ? low : high) = middle;
  }
  return low;
}

// The mean of J_0(beta r) over a head that is fixed at its rim is 2 J_1(j)/j, with the modal mass sigma pi R^2
// J_1(j)^2. So the heads follow the air's force by the sum of 4/(j^2 sigma pi R^2 (w_n^2 - w^2)), and with the air's
// stiffness K the modes of both are the roots of 1 + K times this sum = 0: one between the lowest modes of the two
// heads, where the heads move alike, and one beyond. Decays of 8/s shift a partial by much less than 0.5 Hz.
TEST(Tom, SoundsAtTheFrequenciesOfTwoHeadsOnASpringOfAir) {
  InstrumentModel model = shipped("tom");
  for (InstrumentBody& body : model.bodies) body.stretch_j = 0;
  model.connections.back().each.resistance_n_s_per_m = 0;
  constexpr double kRadius = 0.1524, kDepth = 0.229;
  const double area = pi * kRadius * kRadius, stiffness = 1.2 * 343 * 343 * area / kDepth;
  const auto head = [&](std::size_t body) { return std::get<Membrane>(model.bodies[body].resonator.body); };
  std::vector<double> zeros;
  for (int n = 1; n <= 60; ++n) {
    const double about = (n - 0.25) * pi, sign = n % 2 == 1 ? -1 : 1;
    zeros.push_back(root(about - 0.5, about + 0.5, [&](double x) { return sign * std::cyl_bessel_j(0, x); }));
  }
  const auto frequency = [&](double zero, const Membrane& of) {
    return zero / kRadius * std::sqrt(of.tension_n_per_m / of.mass_per_area_kg_m2) / (2 * pi);
  };
  const auto rises = [&](double hz) {
    double sum = 1 / stiffness;
    for (const Membrane& of : {head(0), head(1)})
      for (const double zero : zeros) {
        const double square = std::pow(2 * pi, 2) * (std::pow(frequency(zero, of), 2) - hz * hz);
        sum += 4 / (zero * zero * of.mass_per_area_kg_m2 * area * square);
      }
    return sum;
  };
  const auto [low, high] = std::minmax({frequency(zeros[0], head(0)), frequency(zeros[0], head(1))});
  const double next = std::min(frequency(zeros[1], head(0)), frequency(zeros[1], head(1)));
  const double alike = root(low + 1e-9, high - 1e-9, rises), against = root(high + 1e-9, next - 1e-9, rises);
  EXPECT_GT(against, 1.4 * high) << "the air raises this pitch much";

  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  SeenNetwork<double> tom(arrays.view(), kRate);
  tom.strike(0, 2);
  std::vector<double> mean;
  for (int n = 0; n < 26460; ++n) {
    tom.tick();
    if (n >= 4410) mean.push_back(tom.displacement(place_index(model, "lower_mean")));
  }
  EXPECT_TRUE(within(partial_between(alike - 20, alike + 20, mean), alike, 0.5));
  EXPECT_TRUE(within(partial_between(against - 20, against + 20, mean), against, 0.5));
}

// Two masses and the spring K of the air: with the top at f_p while the air spring is closed, and the hole's
// resonance f_h, f_+^2 + f_-^2 = f_p^2 + f_h^2 (Christensen and Vistisen 1980), and f_+ f_- = f_0 f_h, f_0 of the top
// in vacuum. The strings are taken off. Losses of 2 % shift a frequency by 1e-4, but draw overlapping resonances
// together: less than 1 Hz.
TEST(ClassicalGuitar, HasTheCoupledModesOfTopAndAir) {
  const InstrumentModel model = shipped("classical_guitar");
  InstrumentArrays arrays = arrays_of(model, kRate / 2);
  const InstrumentConnection cavity = arrays.connections[0];
  std::erase_if(arrays.connections, [](const auto& c) { return c.kind == ConnectionKind::kLink; });
  arrays.outputs.clear();
  arrays.sources.clear();
  arrays.targets[arrays.controls[0].first_target] = place_index(model, "saddle");
  SeenNetwork<double> guitar(arrays.view(), kRate);
  std::vector<double> air;
  guitar.set(0, 10);
  for (int n = 0; n < 22050; ++n) {
    guitar.tick();
    guitar.set(0, 0);
    air.push_back(guitar.displacement(place_index(model, "air")));
  }
  const auto first_mass_of = [&](const std::string& name) {
    const auto body = std::ranges::find(model.bodies, name, &InstrumentBody::name) - model.bodies.begin();
    return arrays.masses[arrays.body_ends[std::size_t(body) - 1]];
  };
  const double mass_of_air = first_mass_of("air"), mass_of_top = first_mass_of("top");
  const double unit = 4 * pi * pi, hole = cavity.stiffness_n_per_m / mass_of_air / unit, vacuum = 170 * 170;
  const double closed = vacuum + cavity.stiffness_n_per_m / mass_of_top / unit;
  const double half = (closed + hole) / 2, root_of = std::sqrt(half * half - vacuum * hole);
  const double low = std::sqrt(half - root_of), high = std::sqrt(half + root_of);
  EXPECT_LT(low, std::sqrt(hole));
  EXPECT_GT(high, std::sqrt(closed));
  EXPECT_TRUE(within(partial_between(80, 140, air), low, 1));
  EXPECT_TRUE(within(partial_between(170, 230, air), high, 1));
}

// Decay of the lowest mode of the lowest bar over 0.3 to 0.9 s [1/s].
double decay_of_bar(double tubes_per_s) {
  const InstrumentArrays arrays = arrays_of(shipped("marimba"), kRate / 2);
  SeenNetwork<double> marimba(arrays.view(), kRate);
  marimba.set(0, tubes_per_s);
  marimba.strike(0, 1);
  double early = 0, late = 0;
  for (int n = 0; n < 44100; ++n) {
    marimba.tick();
    const double square = std::pow(marimba.displacements(0)[0], 2);
    if (n >= 13230 && n < 17640) early += square;
    if (n >= 35280 && n < 39690) late += square;
  }
  return std::log(early / late) / 2 / 0.5;
}

// The tube takes energy from the bar: on real ones a note dies about twice as fast with it (Fletcher and Rossing, The
// Physics of Musical Instruments, 1998, 19.2). With a tube that is stuffed the bar's own loss is left: constant plus
// quadratic times beta^2, beta that of a uniform bar at the frequency of D#3.
TEST(Marimba, HasTubesThatShortenTheDecayOfTheBars) {
  const InstrumentModel model = shipped("marimba");
  const auto& bar = std::get<Bar>(model.bodies.front().resonator.body);
  const double beta_square = 2 * pi * 155.563 * std::sqrt(bar.mass_kg / bar.length_m / bar.bending_stiffness_n_m2);
  const double alone = decay_of_bar(1e4), with_tube = decay_of_bar(0);
  EXPECT_TRUE(
      relatively_within(alone, bar.losses.constant_per_s + bar.losses.quadratic_m2_per_s * beta_square, 0.01));
  EXPECT_GT(with_tube, 1.4 * alone);
  EXPECT_LT(with_tube, 2.5 * alone);
  Measured() << "decay alone " << alone << " 1/s, with the tube " << with_tube << " 1/s";
}

// The air and the box make keys of one bar or tine sharp by different amounts: measured up to 3 cents. The board of
// the dulcimer, lighter, moves strings near its modes by up to 7 cents, as do strings that nobody strikes. The
// frequency is read to 0.1 Hz.
TEST(BodiesOfKeys, HaveThePitchOfTheirKeys) {
  for (const auto& [name, cents] : {std::pair("marimba", 3), std::pair("kalimba", 3), std::pair("dulcimer", 7)}) {
    const InstrumentArrays arrays = arrays_of(shipped(name), kRate / 2);
    const auto instrument = Engine<double>::network(arrays.view());
    for (const KeyRange& range : arrays.model->keys.ranges)
      for (int key = range.first; key <= range.last; ++key) {
        instrument->prepare(kRate);
        instrument->note_on(key, 0.5);
        std::vector<double> sound(static_cast<std::size_t>(kRate / 2));
        for (const std::size_t samples :
             {std::size_t{8820}, sound.size()}) {  // until the air of a tube follows its bar
          const std::array<std::span<double>, 1> outputs = {std::span(sound).first(samples)};
          instrument->process(outputs, {});
        }
        const double hz = 440 * std::exp2((key - 69) / 12.0), found = partial_between(0.98 * hz, 1.02 * hz, sound);
        EXPECT_TRUE(within(1200 * std::log2(found / hz), 0, cents + 1200 * std::log2(1 + 0.1 / hz)))
            << name << ' ' << key;
      }
  }
}

}  // namespace
}  // namespace contactspline::testing
