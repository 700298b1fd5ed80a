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
#include "contactspline/instruments/lap_steel.hpp"
#include "contactspline/instruments/marimba.hpp"
#include "contactspline/instruments/prepared_piano.hpp"
#include "contactspline/instruments/snare.hpp"
#include "contactspline/instruments/tom.hpp"
#include "contactspline/materials/steel_on_steel.hpp"

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

template <typename I>
class LoadedInstrument : public ::testing::Test {};
using Loaded =
    ::testing::Types<instruments::snare<float>, instruments::snare<double>, instruments::prepared_piano<float>>;
TYPED_TEST_SUITE(LoadedInstrument, Loaded);

// Wires that press on a head and a bolt between strings hold energy for ever. Asleep they keep
// it, bit by bit, and their outputs stay at the load, until they are played. Played on without sleep they hold almost
// the same energy E: what still moved, K = 1e-13 J at most, changes it by no more than 2 sqrt(E K) + K.
TYPED_TEST(LoadedInstrument, SleepsUnderItsLoadAndWakes) {
  Handle<typename TypeParam::value_type> handle = compiled<TypeParam>();
  auto& awake = *handle;
  Hosted<typename TypeParam::value_type> hosted(std::move(handle));
  hosted.prepare(kRate);
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

// A hand that presses harder bends the string: a control wakes what sleeps under a load.
TEST(LapSteel, WakesWhereAHandPressesHarder) {
  Hosted<double> hosted(compiled<instruments::lap_steel<double>>());
  hosted.prepare(kRate);
  (void)hosted_sound(hosted, 9 * 256);
  const double before_j = hosted.instrument().energy();
  (void)hosted_sound(hosted, 10000);
  EXPECT_EQ(hosted.instrument().energy(), before_j) << "not asleep";
  hosted.set(parameter(hosted.instrument(), "press_gap_shift_m"), 0.01);
  (void)hosted_sound(hosted, static_cast<std::size_t>(kRate));
  EXPECT_GT(hosted.instrument().energy(), 1.5 * before_j);
}

}  // namespace
}  // namespace contactspline::testing
