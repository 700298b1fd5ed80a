// SPDX-License-Identifier: MIT
// An input that pushes the body: the response of a mode in closed form, energy, sleep, voices, oversampling,
// replacement.
#include <complex>
#include <random>

#include "contactspline/host/engine.hpp"
#include "contactspline/host/hosted.hpp"
#include "contactspline/host/oversampled.hpp"
#include "contactspline/host/replaceable.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instruments/cello.hpp"
#include "contactspline/instruments/kit.hpp"
#include "contactspline/instruments/tom.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/models/body.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

using Piano = KeyboardInstrument<keyboards::piano, double>;
template <typename T>
using Sound = std::vector<std::vector<T>>;

template <typename T>
std::vector<T> noise(std::size_t samples, double peak_n) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> force_n(-peak_n, peak_n);
  std::vector<T> noise(samples);
  for (T& x : noise) x = static_cast<T>(force_n(random));
  return noise;
}

// All outputs over the samples of an input.
template <typename T>
Sound<T> played(AnyInstrument<T>& instrument, std::span<const T> input, std::size_t block = 256) {
  Sound<T> sound(instrument.outputs().size(), std::vector<T>(input.size()));
  std::vector<std::span<T>> part(sound.size());
  for (std::size_t n = 0; n < input.size(); n += block) {
    const std::size_t length = std::min(block, input.size() - n);
    for (std::size_t o = 0; o < sound.size(); ++o) part[o] = std::span(sound[o]).subspan(n, length);
    instrument.process(part, {}, input.subspan(n, length));
  }
  return sound;
}

template <typename T>
double peak(std::span<const T> sound) {
  double peak = 0;
  for (const T x : sound) peak = std::max(peak, std::abs(double(x)));
  return peak;
}

constexpr auto kMode = R"({ "name": "probe",
  "bodies": [ { "name": "board", "modes": [ { "frequency_hz": 100, "decay_per_s": 20, "mass_kg": 4 } ] } ],
  "places": [ { "name": "foot", "body": "board", "shapes": [0.5] } ],
  "outputs": [ { "name": "foot", "displacement_m": "foot" } ],
  "input": { "force_n": "foot", "full_scale": 2 } })";

// The midpoint rule has the poles p and p* of the mode and one zero at -1, and the compliance 1/k of the mode at
// rest: H(z) = |1 - p|^2/(2 k) (z + 1)/((z - p)(z - p*)). In a steady state the mean work of a sample is that of the
// force with the change of place, F^2/2 Re[(z - 1) H(z)]. An output hears H over the part of it that averaging the
// force over a sample leaves, |1 - p|^2/|p dt|^2 (docs/how-it-works/modal.md). At the frequency of the mode, the
// amplitude is that of the continuous mode, F/(2 a m w), to the second order in w dt and in a/w.
TEST(Input, MovesAModeByItsResponse) {
  const InstrumentArrays arrays = arrays_of(parse_instrument(kMode, "probe.json"), kRate / 2);
  BySample<double> instrument(arrays.view(), kRate);
  EXPECT_EQ(instrument.handle().input_scale_n(), 2);
  constexpr double kForce_n = 3, kShape = 0.5;
  constexpr std::size_t kPeriod = 441, kSettling = 120 * kPeriod;  // e^-24 of the beginning is left
  const double w = arrays.angular_frequencies[0], decay = arrays.decays[0], mass = arrays.masses[0];
  std::vector<double> input(kSettling + kPeriod), place(input.size());
  for (std::size_t n = 0; n < input.size(); ++n)
    input[n] = kForce_n * std::cos(2 * std::numbers::pi * static_cast<double>(n) / kPeriod);
  double work = 0, heat = 0;
  for (std::size_t n = 0; n < input.size(); ++n) {
    instrument.tick(input[n]);
    place[n] = instrument.output(0);
    if (n < kSettling) continue;
    work += instrument.work();
    heat += instrument.dissipated();
  }
  std::complex<double> amplitude = 0;
  for (std::size_t n = kSettling; n < input.size(); ++n)
    amplitude +=
        2.0 / kPeriod * place[n] * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(n + 1) / kPeriod);
  const auto z = std::polar(1.0, 2 * std::numbers::pi / kPeriod), p = std::exp(std::complex(-decay, w) / kRate);
  const auto response = kShape * kShape * std::norm(1.0 - p) / (2 * mass * (w * w + decay * decay)) * (z + 1.0) /
                        ((z - p) * (z - std::conj(p)));
  const auto heard = kForce_n * response * (w * w + decay * decay) / (kRate * kRate * std::norm(1.0 - p));
  EXPECT_LT(std::abs(amplitude - heard), 1e-9 * std::abs(heard));
  const double mean_work = kForce_n * kForce_n / 2 * ((z - 1.0) * response).real();
  EXPECT_TRUE(relatively_within(work / kPeriod, mean_work, 1e-8));
  EXPECT_TRUE(relatively_within(heat / kPeriod, mean_work, 1e-8));
  const double w_dt = w / kRate, part = decay / w;
  EXPECT_TRUE(relatively_within(std::abs(amplitude), kForce_n * kShape * kShape / (2 * decay * mass * w),
                                w_dt * w_dt / 4 + part * part));
}

// Over each sample the energy changes by the work of the input less the heat. Rounding: 1e-12 of the energy.
TEST(Input, KeepsTheBooksOfEnergy) {
  for (const auto make : {compiled<instruments::tom<double>>, compiled<instruments::cello<double>>,
                          compiled<instruments::kit<double>>}) {
    const auto instrument = make();
    SCOPED_TRACE(instrument->name());
    instrument->prepare(kRate);
    const std::vector<double> input = noise<double>(4410, instrument->input_scale_n());
    std::array<double, 1> sample;
    std::vector<std::span<double>> outputs(instrument->outputs().size());
    outputs.front() = sample;
    double before = instrument->books().stored_j, work = 0;
    for (const double& force_n : input) {
      instrument->process(outputs, {}, std::span(&force_n, 1));
      const Books books = instrument->books();
      ASSERT_TRUE(within(books.stored_j - before, books.work_j - books.heat_j,
                         1e-12 * std::max({books.stored_j, before, std::abs(books.work_j), 1e-9})));
      before = books.stored_j;
      work += books.work_j;
    }
    EXPECT_GT(work, 0);
  }
}

// With the books of zero force, too: no bit changes.
TEST(Input, OfSilenceChangesNothing) {
  for (const auto make : {compiled<instruments::tom<float>>, compiled<instruments::cello<float>>,
                          compiled<KeyboardInstrument<keyboards::piano, float>>}) {
    const auto with = make(), without = make();
    SCOPED_TRACE(with->name());
    for (AnyInstrument<float>* const instrument : {with.get(), without.get()}) {
      instrument->prepare(kRate);
      for (int key = 40; key < 64; ++key) instrument->note_on(key, 0.7);
      instrument->strike(0, 2);
    }
    const std::vector<float> silence(8820);
    const Sound<float> sound = played<float>(*with, silence);
    Sound<float> expected(sound.size(), silence);
    std::vector<std::span<float>> outputs(expected.begin(), expected.end());
    without->process(outputs, {});
    EXPECT_GT(peak<float>(sound[0]), 0);
    EXPECT_EQ(sound, expected);
  }
}

// What hosts hear: nothing while the input is faint; from the block on in which it pushes what the class plays.
TEST(Input, WakesWhatSleeps) {
  for (const auto make :
       {compiled<instruments::tom<double>>, compiled<instruments::cello<double>>, compiled<Piano>}) {
    Hosted<double> hosted(make());
    SCOPED_TRACE(hosted.instrument().name());
    hosted.prepare(kRate);
    const double full_scale_n = hosted.instrument().input_scale_n();
    std::vector<double> input(44100), sound(input.size(), 1);
    std::vector<double*> outputs(hosted.instrument().outputs().size());
    outputs[0] = sound.data();
    const auto play = [&] { hosted.process<double>(outputs, input.size(), {}, input.data()); };
    play();
    std::ranges::fill(input, 0.9 * kFaintPush_n / full_scale_n);
    play();
    EXPECT_EQ(peak<double>(sound), 0);
    constexpr std::ptrdiff_t kBegin = 1234, kWoken = 1024;  // in blocks of 256
    std::ranges::fill(input, 0);
    std::ranges::copy(noise<double>(input.size() / 2, 1), input.begin() + kBegin);
    play();
    const auto expected = make();
    expected->prepare(kRate);
    std::vector<double> forces_n(input.begin() + kWoken, input.end());
    for (double& x : forces_n) x *= full_scale_n;
    std::vector<double> heard = played<double>(*expected, forces_n)[0];
    for (double& x : heard) x /= expected->outputs()[0].full_scale;
    EXPECT_GT(peak<double>(heard), 1e-3);
    EXPECT_EQ(peak<double>(std::span(sound).first(kBegin)), 0);
    EXPECT_EQ(std::vector(sound.begin() + kWoken, sound.end()), heard);
  }
}

// A constant force that ends lets go of the body, after any number of blocks in which it rested under the force.
TEST(Input, ThatEndsIsHeard) {
  const InstrumentArrays arrays = arrays_of(parse_instrument(kMode, "probe.json"), kRate / 2);
  for (std::size_t blocks = 400; blocks < 410; ++blocks) {
    Hosted<double> hosted(Engine<double>::network(arrays.view()));
    hosted.prepare(kRate);
    std::vector<double> input(256 * blocks, 0.5), sound(input.size());
    std::vector<double*> outputs = {sound.data()};
    const auto moved = [&](std::span<const double> part) {
      const auto [low, high] = std::ranges::minmax(part);
      return high - low;
    };
    hosted.process<double>(outputs, input.size(), {}, input.data());
    EXPECT_LT(moved(std::span(sound).last(1000)), 1e-9);
    std::ranges::fill(input, 0);
    hosted.process<double>(outputs, input.size(), {}, input.data());
    EXPECT_GT(moved(std::span(sound).first(1000)), 1e-4);
  }
}

// What pushes the bridge works against the tension of the strings there, at all places by equal parts.
TEST(Input, OfABodyIsTheWorkAtItsBridge) {
  const std::vector<Mode> modes = {{2 * std::numbers::pi * 100, 0, 2}, {2 * std::numbers::pi * 300, 0, 3}};
  const double first[] = {0.5, 1}, second[] = {1, -0.4};
  const std::vector<BridgeStiffness> stiffness = {{1e6, 0}, {2e5, 0}};
  Body<double> body(
      modes,
      {ModeShapes<double>(std::span<const double>(first)), ModeShapes<double>(std::span<const double>(second))},
      stiffness, kRate);
  double work = 0, largest = 0;
  const std::vector<double> input = noise<double>(44100, 3), none(2);
  for (const double force_n : input) {
    body.push(force_n);
    body.tick(none);
    work += force_n * (body.change(0) + body.change(1)) / 2;
    largest = std::max(largest, body.energy());
    ASSERT_TRUE(within(body.energy(), work, 1e-11 * largest));
  }
  body.push(std::numeric_limits<double>::quiet_NaN());
  body.tick(none);
  EXPECT_TRUE(within(body.energy(), work, 1e-11 * largest));
  EXPECT_GT(work, 0);
}

TEST(Input, PushesTheFirstVoiceAlone) {
  std::string text = kMode;
  text.replace(text.find("\"outputs\""), 0,
               R"("controls": [ { "name": "finger", "force_n": "foot", "release_n": 1 } ],
    "keys": [ { "first": 60, "last": 62, "event": "pluck_finger" } ], "polyphony": 2, )");
  const std::vector<double> input = noise<double>(1000, 2);
  double energy_j[2];
  for (const bool is_alone : {false, true}) {
    InstrumentModel model = parse_instrument(text, "probe.json");
    ASSERT_EQ(model.keys.voices, 2u);
    if (is_alone) model.keys.voices = 1;
    const InstrumentArrays arrays = arrays_of(model, kRate / 2);
    const auto voices = Engine<double>::network(arrays.view());
    voices->prepare(kRate);
    (void)played<double>(*voices, input);
    energy_j[is_alone] = voices->energy();
  }
  EXPECT_GT(energy_j[1], 0);
  EXPECT_EQ(energy_j[0], energy_j[1]);
}

// The force is held over each sample of the host.
TEST(Input, OfAnOversampledInstrumentIsHeld) {
  constexpr int kFactor = 4;
  const std::vector<double> input = noise<double>(5000, 5);
  Oversampled<double> oversampled(compiled<instruments::tom<double>>(), kFactor);
  oversampled.prepare(kRate);
  EXPECT_EQ(oversampled.input_scale_n(), 5);
  const Sound<double> sound = played<double>(oversampled, input, 333);
  const auto finer = compiled<instruments::tom<double>>();
  finer->prepare(kFactor * kRate);
  std::vector<double> forces_n;
  for (const double force_n : input) forces_n.insert(forces_n.end(), kFactor, force_n);
  Sound<double> at_finer = played<double>(*finer, forces_n);
  std::vector<double> expected(input.size());
  Decimator<double>(kFactor).process(at_finer[0], expected);
  EXPECT_EQ(sound[0], expected);
}

// Both are pushed while one fades out; afterwards the new one is where the input of all that time has moved it.
TEST(Input, PushesWhatReplacesAnInstrument) {
  const std::vector<double> input = noise<double>(5000, 5);
  Replaceable<double> replaceable(compiled<instruments::tom<double>>());
  replaceable.prepare(kRate);
  (void)played<double>(replaceable, input);
  const auto prepared = [] {
    auto tom = compiled<instruments::tom<double>>();
    tom->prepare(kRate);
    return tom;
  };
  replaceable.offer(prepared());
  const Sound<double> sound = played<double>(replaceable, input, 100), expected = played<double>(*prepared(), input);
  const auto faded = static_cast<std::ptrdiff_t>(Replaceable<double>::kFade_s * kRate) + 1;
  EXPECT_NE(sound[0], expected[0]);
  EXPECT_EQ(std::vector(sound[0].begin() + faded, sound[0].end()),
            std::vector(expected[0].begin() + faded, expected[0].end()));
}

// Emitted classes push where the file says.
TEST(Input, IsEmitted) {
  constexpr InstrumentData kData = instruments::cello<double>::data::view();
  EXPECT_EQ(kData.input_scale_n, 6);
  ASSERT_EQ(kData.input_places.size(), 1u);
  const auto shapes = kData.shapes_of(kData.input_places[0]);
  EXPECT_EQ(shapes.size(), 39u);
  for (const double shape : shapes) EXPECT_EQ(shape, 1);
  EXPECT_EQ(instruments::kit<double>::data::view().input_places.size(), 8u);
}

}  // namespace
}  // namespace contactspline::testing
