// SPDX-License-Identifier: MIT
// Many voices: their sum, their sleep.
#include "contactspline/models/ensemble.hpp"

#include <memory>
#include <thread>

#include "band.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

/// Adds one voice's sound, in blocks as an ensemble plays them.
template <typename T>
void play_alone(HammerString<T>& model, const Player<T>& player, T gain, std::span<T> sum) {
  const ModeShapes<T> pickup = model.string().sound_pickup(player.pickup);
  std::vector<T> sound(Ensemble<T>::kBlock);
  for (std::size_t done = 0; done < sum.size(); done += sound.size()) {
    const std::size_t samples = std::min(sound.size(), sum.size() - done);
    model.process(player.controls, pickup, std::span(sound).first(samples));
    for (std::size_t n = 0; n < samples; ++n) sum[done + n] += gain * sound[n];
  }
}

CONTACTSPLINE_EACH_PRECISION(EnsembleOf);

// What the voices play alone, within the bounds of kernels_together_test for voices side by side. Two of them are not
// struck, the others in another order than their numbers'.
TYPED_TEST(EnsembleOf, SumsWhatItsVoicesPlayAlone) {
  using T = TypeParam;
  const auto players = band<T>(21);
  auto ensemble = ensemble_of(players);
  std::vector<std::size_t> struck;
  for (std::size_t i = 0; i < players.size(); ++i)
    if (i != 3 && i != 12) struck.push_back(i);
  const auto speed = [](std::size_t voice) { return static_cast<T>(0.5 + 0.2 * static_cast<double>(voice)); };
  const auto gain = [](std::size_t voice) { return static_cast<T>(1 << voice % 3); };
  for (auto voice = struck.rbegin(); voice != struck.rend(); ++voice) {
    ensemble.mix(*voice).gain = gain(*voice);
    ensemble.strike(*voice, speed(*voice), T(1e-4));
  }
  EXPECT_EQ(ensemble.awake(), struck.size());

  std::vector<HammerString<T>> alone;
  for (const std::size_t voice : struck) {
    alone.push_back(players[voice].alone());
    alone.back().strike(speed(voice), T(1e-4));
  }
  double peak = 0;
  for (const std::size_t size : {1u, 300u, 128u, 5000u}) {
    std::vector<T> found(size), expected(size);
    ensemble.process(found);
    for (std::size_t first = 0; first < struck.size(); first += Ensemble<T>::kGroup) {
      std::vector<T> group(size);
      for (std::size_t i = first; i < std::min(first + Ensemble<T>::kGroup, struck.size()); ++i)
        play_alone<T>(alone[i], players[struck[i]], gain(struck[i]), group);
      for (std::size_t n = 0; n < size; ++n) expected[n] += group[n];
    }
    ASSERT_TRUE(sequences_within<T>(found, expected, sizeof(T) == sizeof(double) ? 1e-12 : 5.6e-5)) << size;
    for (const T x : found) peak = std::max(peak, static_cast<double>(std::abs(x)));
  }
  EXPECT_GT(peak, 1e-4);
}

// At the sides one channel is the mono sound and the other silent; in the midst both are 3 dB below it.
TYPED_TEST(EnsembleOf, Pans) {
  using T = TypeParam;
  const auto players = band<T>(1);
  const auto play = [&](T pan) {
    std::array<std::vector<T>, 3> sounds;
    for (auto& sound : sounds) sound.resize(1000);
    auto stereo = ensemble_of(players), mono = ensemble_of(players);
    for (auto* ensemble : {&stereo, &mono}) {
      ensemble->mix(0) = {T(0.5), pan};
      ensemble->strike(0, T(2), T(1e-4));
    }
    stereo.process(sounds[0], sounds[1]);
    mono.process(sounds[2]);
    return sounds;
  };
  const std::vector<T> silence(1000);
  for (const bool right : {false, true}) {
    const auto found = play(static_cast<T>(right));
    EXPECT_EQ(found[right], found[2]);
    EXPECT_EQ(found[!right], silence);
  }
  const auto found = play(T(0.5));
  std::vector<T> expected = found[2];
  for (T& x : expected) x *= static_cast<T>(std::sqrt(0.5));
  // sqrt(0.5) and two products are rounded: 3 halves of an epsilon.
  const double bound = 1.5 * std::numeric_limits<T>::epsilon();
  EXPECT_TRUE(sequences_within<T>(found[0], expected, bound));
  EXPECT_EQ(found[0], found[1]);
}

// Groups go to what is said to run them, in whatever order it takes them.
TEST(Ensemble, LeavesItsGroupsToTheRunner) {
  const auto players = band<float>(20);
  auto forwards = ensemble_of(players), backwards = ensemble_of(players);
  for (std::size_t voice = 0; voice < 20; ++voice)
    for (auto* ensemble : {&forwards, &backwards}) ensemble->strike(voice, 2, 1e-4f);
  std::vector<float> expected(300), found(300);
  std::vector<std::size_t> tasks;
  forwards.process(expected);
  backwards.process(found, [&](std::size_t count, const auto& task) {
    tasks.push_back(count);
    while (count-- > 0) task(count);
  });
  EXPECT_EQ(found, expected);
  EXPECT_EQ(tasks, (std::vector<std::size_t>{2, 2}));
}

// One thread for each group: `--preset tsan` shows that groups share no memory that one of them writes. It cannot
// look into oneTBB.
TEST(Ensemble, PlaysItsGroupsOnThreads) {
  const auto players = band<float>(40);
  auto threaded = ensemble_of(players), alone = ensemble_of(players);
  const auto run = [](std::size_t groups, const auto& play_group) {
    std::vector<std::jthread> threads;
    for (std::size_t group = 0; group < groups; ++group)
      threads.emplace_back([&play_group, group] { play_group(group); });
  };
  std::vector<float> found(1000), expected(1000);
  for (std::size_t voice = 0; voice < 20; ++voice) {
    for (auto* ensemble : {&threaded, &alone}) ensemble->strike(2 * voice, 2, 1e-4f);
    threaded.process(found, run);
    alone.process(expected);
    EXPECT_EQ(found, expected);
  }
}

// It sleeps once its energy has fallen below the threshold and not before, and that is looked at every 4096 samples.
TEST(Ensemble, SleepsWhenSilentAndWakesWhenStruck) {
  auto players = band<float>(1);
  players[0].controls.damping_per_s = 20;
  auto ensemble = ensemble_of(players, 1e-10);
  std::vector<float> sound(128);
  for (int strike = 0; strike < 3; ++strike) {
    ensemble.strike(0, 2, 1e-4f);
    ASSERT_EQ(ensemble.awake(), 1u);
    std::size_t below = 0;  // samples since the energy fell below
    int blocks = 0;
    bool has_sounded = false;
    for (; ensemble.awake() == 1; ++blocks) {
      ASSERT_LT(blocks, 1000);
      ensemble.process(sound);
      has_sounded |= std::abs(sound[0]) > 1e-4f;
      below = ensemble.model(0).string().energy() < 1e-10 ? below + sound.size() : 0;
    }
    EXPECT_GT(blocks, 30);  // and not at once
    EXPECT_TRUE(has_sounded);
    EXPECT_GT(below, 0u);
    EXPECT_LE(below, 4096u + sound.size());
    const double rest = ensemble.model(0).string().energy();
    EXPECT_GT(rest, 0);
    ensemble.process(sound);
    EXPECT_EQ(sound, std::vector<float>(128));
    EXPECT_EQ(ensemble.model(0).string().energy(), rest);  // nothing was done
  }
}

// A string at rest before a slow hammer is silent, but waits for it: 0.25 s, looked at twice.
TEST(Ensemble, StaysAwakeForAHammerInFlight) {
  const auto players = band<double>(1);
  auto ensemble = ensemble_of(players);
  ensemble.strike(0, 0.1, 0.025);
  std::vector<double> sound(11000);
  ensemble.process(sound);
  EXPECT_EQ(sound, std::vector<double>(11000));
  EXPECT_EQ(ensemble.awake(), 1u);
  ensemble.process(sound);
  EXPECT_GT(ensemble.model(0).string().energy(), 1e-7);
}

// A hammer without speed would hover for ever, and the voice stay awake.
TEST(Ensemble, FallsAsleepAfterAStrikeWithoutSpeed) {
  auto ensemble = ensemble_of(band<double>(1));
  ensemble.strike(0, 0, 0.025);
  std::vector<double> sound(11000);
  ensemble.process(sound);
  EXPECT_EQ(ensemble.awake(), 0u);
}

// Whatever is thrown at it: a string never holds more than the blows gave, whose energies are m v^2/2.
TEST(Ensemble, IsBounded) {
  const auto players = band<double>(30);
  auto ensemble = ensemble_of(players);
  std::mt19937 random(1);
  const auto draw = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  std::vector<double> thrown_j(players.size()), sound(100);
  for (int block = 0; block < 400; ++block) {
    for (std::size_t voice = 0; voice < players.size(); ++voice) {
      if (draw(0, 1) > 0.1) continue;
      auto& controls = ensemble.controls(voice);
      controls.hammer_mass_kg = std::exp(draw(-9, -2));
      controls.felt = {std::exp(draw(-7, 9)), draw(-1, 1) < 0 ? 0 : draw(0, 2)};
      controls.damping_per_s = std::max(0.0, draw(-1000, 1000));
      const double speed = draw(0.01, 20);
      thrown_j[voice] += controls.hammer_mass_kg * speed * speed / 2;
      ensemble.strike(voice, speed, draw(0, 1e-3));
    }
    ensemble.process(sound);
    for (std::size_t voice = 0; voice < players.size(); ++voice)
      ASSERT_TRUE(ensemble.model(voice).string().energy() <= thrown_j[voice] * (1 + 1e-12)) << voice;
    for (const double x : sound) ASSERT_TRUE(std::isfinite(x));
  }
}

TEST(Ensemble, LeavesNoDenormals) {
  auto players = band<float>(1);
  players[0].controls.damping_per_s = 100;
  auto ensemble = ensemble_of(players, 0);  // never sleeps
  ensemble.strike(0, 2, 1e-4f);
  std::vector<float> sound(44100);
  for (int second = 0; second < 3; ++second) ensemble.process(sound);
  EXPECT_EQ(ensemble.awake(), 1u);
  for (const float x : sound) {
    ASSERT_LT(std::abs(x), 1e-30f);
    ASSERT_NE(std::fpclassify(x), FP_SUBNORMAL);
  }
}

TEST(Ensemble, AllocatesNothingInTheAudioThread) {
  const auto players = band<float>(40);
  auto ensemble = ensemble_of(players, 1);  // sleeps at the first look
  std::vector<float> left(700), right(700);
  const std::size_t before = allocations;
  for (std::size_t block = 0; block < 60; ++block) {
    for (std::size_t i = 0; i < 10; ++i) ensemble.strike((block * 7 + i * 11) % 40, 2, 1e-4f);
    ensemble.process(left, right);
    ensemble.process(left);
  }
  EXPECT_EQ(allocations, before);
  ::operator delete(::operator new(1));  // a call that compilers keep
  EXPECT_EQ(allocations, before + 1);    // the counter counts
  const detail::ModalArray<float> aligned(1);
  EXPECT_EQ(allocations, before + 2);
}

}  // namespace
}  // namespace contactspline::testing
