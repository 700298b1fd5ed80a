// SPDX-License-Identifier: MIT
// When instruments are silent, and that Hosted then writes exactly 0.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "contactspline/host/engine.hpp"
#include "contactspline/host/hosted.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instruments/marimba.hpp"
#include "contactspline/instruments/prepared_piano.hpp"
#include "contactspline/instruments/snare.hpp"
#include "contactspline/instruments/tom.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/resonators/guitar_g3.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

// The next samples of the first output.
template <typename T>
std::vector<float> hosted_sound(Hosted<T>& hosted, std::size_t samples) {
  std::vector<float> sound(samples);
  std::vector<float*> outputs(hosted.instrument().outputs().size());
  outputs.front() = sound.data();
  hosted.process(std::span<float* const>(outputs), samples);
  return sound;
}

float peak(const std::vector<float>& sound) {
  float peak = 0;
  for (const float x : sound) peak = std::max(peak, std::abs(x));
  return peak;
}

template <typename I>
class InstrumentOfAFile : public ::testing::Test {};
using Drums = ::testing::Types<instruments::tom<float>, instruments::tom<double>, instruments::marimba<float>,
                               instruments::marimba<double>>;
TYPED_TEST_SUITE(InstrumentOfAFile, Drums);

// It decays by 22 decades of energy in less than 6 s; its mallets fly away.
TYPED_TEST(InstrumentOfAFile, FallsExactlySilentAndWakes) {
  Hosted<typename TypeParam::value_type> hosted(compiled<TypeParam>());
  hosted.prepare(kRate);
  for (int note = 0; note < 2; ++note) {
    hosted.press(0, true);
    EXPECT_GT(peak(hosted_sound(hosted, 4410)), 1e-3f);
    hosted.press(0, false);
    (void)hosted_sound(hosted, static_cast<std::size_t>(6 * kRate));
    EXPECT_EQ(peak(hosted_sound(hosted, 1000)), 0.0f) << "after note " << note;
  }
}

// The force of a mass at a barrier is an output, too. While it sleeps, both are 0.
TEST(ForceOfAHost, IsThatOfTheContacts) {
  using Barrier = MassBarrierOf<materials::steel_on_steel, double>;
  Hosted<double> hosted(compiled<Barrier>());
  hosted.prepare(kRate);
  hosted.press(0, true);
  std::vector<float> output(4410);
  std::vector<double> force(output.size(), -1);
  const std::vector<float*> outputs = {nullptr, output.data()};
  hosted.process(std::span<float* const>(outputs), output.size(), std::span(force));
  EXPECT_GT(peak(output), 1);
  for (std::size_t n = 0; n < force.size(); ++n)
    EXPECT_EQ(output[n], static_cast<float>(force[n] / Barrier::kOutputs[1].full_scale)) << n;
  Hosted<double> asleep(compiled<instruments::tom<double>>());
  asleep.prepare(kRate);
  const std::vector<float*> none(2);
  for (int block = 0; block < 2; ++block) {
    std::ranges::fill(force, -1);
    asleep.process(std::span<float* const>(none), force.size(), std::span(force));
    EXPECT_EQ(std::ranges::count(force, 0.0), 4410) << "block " << block;
  }
}

// A mass that rests in front of the barrier has no energy, but an output.
TEST(MassAtRest, IsHeardWhereItIs) {
  using Barrier = MassBarrierOf<materials::steel_on_steel, double>;
  Hosted<double> hosted(compiled<Barrier>());
  hosted.prepare(kRate);
  hosted.set(Barrier::kStart, -1e-3);
  hosted.set(Barrier::kSpeed, 0);
  hosted.press(0, true);
  const std::vector<float> sound = hosted_sound(hosted, 4410);
  EXPECT_TRUE(hosted.instrument().is_silent(1e-30));
  EXPECT_EQ(std::ranges::count(sound, -0.1f), 4410);
}

template <typename T>
std::size_t parameter(const AnyInstrument<T>& instrument, std::string_view name) {
  const auto list = instrument.parameters();
  return static_cast<std::size_t>(
      std::ranges::find(list, name, [](const Parameter& p) { return std::string_view(p.name); }) - list.begin());
}

// Moves a parameter of an instrument at rest: is it silent 10 samples later?
template <typename I>
bool is_silent_after(const char* name, double value) {
  const auto instrument = compiled<I>();
  instrument->prepare(kRate);
  std::vector<double> sound(10);
  const std::vector<std::span<double>> outputs = {sound};
  instrument->process(outputs, {});
  EXPECT_TRUE(instrument->is_silent(1e-14)) << "at rest";
  instrument->set(parameter(*instrument, name), value);
  instrument->process(outputs, {});
  return instrument->is_silent(1e-14);
}

using Slide = SlideStringOf<materials::steel_on_steel, resonators::guitar_g3, double>;
using Fret = FretStringOf<materials::steel_on_steel, resonators::guitar_g3, double>;

// What a hand moves may reach the string.
TEST(PluckedString, IsNotSilentWhileAHandMovesOrPushes) {
  EXPECT_FALSE(is_silent_after<Slide>("hand_force_n", -1e-3));
  EXPECT_FALSE(is_silent_after<Slide>("hand_force_n", -1e-9));  // before it has moved the slide
  EXPECT_FALSE(is_silent_after<Slide>("place_m", 0.1));
  EXPECT_FALSE(is_silent_after<Slide>("pluck_force_n", 1e-12));
  EXPECT_FALSE(is_silent_after<Fret>("gap_m", 0.05));
  EXPECT_FALSE(is_silent_after<Fret>("place_m", 0.1));
  EXPECT_FALSE(is_silent_after<Fret>("pluck_force_n", 1e-12));
}

// Away from the string, which it does not move: at rest before, without a force and a sound in any sample.
TEST(PluckedString, IsNotSilentWhileTheSlideFlies) {
  const auto slide = compiled<Slide>();
  slide->prepare(kRate);
  EXPECT_EQ(slide->energy(), 0);
  std::vector<double> sound(10, 1), touch(10, 1);
  const std::vector<std::span<double>> outputs = {sound};
  for (const double force_n : {-1.0, 0.0}) {
    slide->set(parameter(*slide, "hand_force_n"), force_n);
    slide->process(outputs, touch);
    EXPECT_EQ(std::ranges::count(sound, 0.0), 10);
    EXPECT_EQ(std::ranges::count(touch, 0.0), 10);
  }
  EXPECT_GT(slide->energy(), 0);  // of the slide
  EXPECT_FALSE(slide->is_silent(1e-14));
}

// In single precision the place is rounded.
template <typename T>
void expect_silent_where_the_fret_has_arrived() {
  for (const char* name : {"place_m", "gap_m"}) {
    const auto fret = compiled<FretStringOf<materials::steel_on_steel, resonators::guitar_g3, T>>();
    fret->prepare(kRate);
    fret->set(parameter(*fret, name), name[0] == 'p' ? 0.1 : 0.05);
    std::vector<T> sound(static_cast<std::size_t>(kRate));
    const std::vector<std::span<T>> outputs = {sound};
    fret->process(outputs, {});
    EXPECT_TRUE(fret->is_silent(1e-14)) << name;
  }
}

TEST(PluckedString, IsSilentWhereTheHandHasArrived) {
  expect_silent_where_the_fret_has_arrived<double>();
  expect_silent_where_the_fret_has_arrived<float>();
  EXPECT_TRUE(is_silent_after<Slide>("vibrato_m", 0.005));
}

template <typename T>
using SlideOf = SlideStringOf<materials::steel_on_steel, resonators::guitar_g3, T>;

// Presses the slide on the string, where the instrument has one.
template <typename T>
void press(Hosted<T>& hosted) {
  const auto count = hosted.instrument().parameters().size();
  for (const auto& [name, value] :
       {std::pair{"hand_force_n", 2.0}, std::pair{"hand_stiffness_n_per_m", 100.0},
        std::pair{"hand_resistance_n_s_per_m", 5.0}, std::pair{"rest_resistance_n_s_per_m", 2.0}})
    if (const std::size_t p = parameter(hosted.instrument(), name); p < count) hosted.set(p, value);
}

template <typename I>
class LoadedInstrument : public ::testing::Test {};
using Loaded = ::testing::Types<instruments::snare<float>, instruments::snare<double>,
                                instruments::prepared_piano<float>, SlideOf<float>, SlideOf<double>>;
TYPED_TEST_SUITE(LoadedInstrument, Loaded);

// Wires that press on a head, a bolt between strings and a slide under a hand hold energy for ever. Asleep they keep
// it, bit by bit, and their outputs stay at the load, until they are played. Played on without sleep they hold almost
// the same energy E: what still moved, K = 1e-13 J at most, changes it by no more than 2 sqrt(E K) + K.
TYPED_TEST(LoadedInstrument, SleepsUnderItsLoadAndWakes) {
  Handle<typename TypeParam::value_type> handle = compiled<TypeParam>();
  auto& awake = *handle;
  Hosted<typename TypeParam::value_type> hosted(std::move(handle));
  hosted.prepare(kRate);
  press(hosted);
  hosted.press(0, true);
  std::vector<float> sound = hosted_sound(hosted, static_cast<std::size_t>(28 * kRate));
  EXPECT_GT(peak(sound), 1e-3f);
  hosted.press(0, false);
  const double energy_j = hosted.instrument().energy();
  EXPECT_FALSE(hosted.instrument().is_silent(1e-14));
  sound = hosted_sound(hosted, 10000);
  EXPECT_EQ(std::ranges::count(sound, sound.front()), 10000) << "not asleep";
  EXPECT_EQ(hosted.instrument().energy(), energy_j);
  std::vector<typename TypeParam::value_type> played(10000);
  std::vector<std::span<typename TypeParam::value_type>> outputs(awake.outputs().size());
  outputs.front() = played;
  awake.process(outputs, {});
  const double full_scale = awake.outputs()[0].full_scale;
  for (const auto sample : played) ASSERT_NEAR(double(sample) / full_scale, double(sound.front()), 0x1p-17);
  EXPECT_NEAR(awake.energy(), energy_j, 2 * std::sqrt(1e-13 * energy_j) + 1e-13);
  hosted.press(0, true);
  EXPECT_GT(peak(hosted_sound(hosted, 4410)), std::abs(sound.front()) + 1e-3f);
}

// Wires that lie on a head and a bolt that hangs on a string are at rest from the beginning: a host sleeps as soon as
// it has looked at eight blocks of 256 samples, and outputs what it slept with. That is 108 dB below full scale or
// less.
TYPED_TEST(LoadedInstrument, SleepsAtOnceUntilItIsPlayed) {
  for (const double rate : {44100.0, 48000.0, 96000.0, 192000.0}) {
    Hosted<typename TypeParam::value_type> hosted(compiled<TypeParam>());
    hosted.prepare(rate);
    EXPECT_LE(peak(hosted_sound(hosted, 9 * 256)), 1e-5f) << rate;
    const double energy_j = hosted.instrument().energy();
    const std::vector<float> sound = hosted_sound(hosted, 10000);
    EXPECT_EQ(std::ranges::count(sound, sound.front()), 10000) << rate;
    EXPECT_EQ(hosted.instrument().energy(), energy_j) << "not asleep";
  }
}

// A hand that presses harder moves the slide: a control wakes what sleeps under a load.
TEST(PluckedString, WakesWhereAHandPressesHarder) {
  Hosted<double> hosted(compiled<SlideOf<double>>());
  hosted.prepare(kRate);
  press(hosted);
  (void)hosted_sound(hosted, static_cast<std::size_t>(28 * kRate));
  const double before_j = hosted.instrument().energy();
  hosted.set(parameter(hosted.instrument(), "hand_force_n"), 3.0);
  (void)hosted_sound(hosted, static_cast<std::size_t>(kRate));
  EXPECT_GT(hosted.instrument().energy(), 1.5 * before_j);
}

}  // namespace
}  // namespace contactspline::testing
