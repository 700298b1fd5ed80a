// SPDX-License-Identifier: MIT
// Models of one contact and ensembles at their limits: 8 to 768 kHz, blocks of 1 to 4096 samples, controls that jump
// between the ends of their ranges, infinity and NaN in every sample or block. They stay finite, allocate nothing,
// and play again when their controls do. Strings hold no more energy than they were given.
#include "contactspline/ensemble.hpp"
#include "contactspline/hammer_voice.hpp"
#include "contactspline/mass_barrier.hpp"
#include "storm.hpp"
#include "support/count_allocations.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRates[] = {8000, 44100, 192000, 768000};
constexpr std::size_t kBlocks[] = {1, 2, 3, 64, 257, 4096};
constexpr int kStorm = 30000;  // samples

template <typename T>
class Extremes : public ::testing::Test {};
using Precisions = ::testing::Types<double, float>;
TYPED_TEST_SUITE(Extremes, Precisions);

/// A number that is finite, and of which no more than `bound` is expected.
void expect_bounded(double value, double bound, const char* what, double rate_hz) {
  EXPECT_TRUE(is_finite(value) && std::abs(value) <= bound) << what << ' ' << value << " at " << rate_hz << " Hz";
}

TYPED_TEST(Extremes, OfAMassBarrier) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  for (const double rate : kRates) {
    const Parts<T> parts(rate);
    Weather<T> weather;
    MassBarrier<T> model(parts.table, static_cast<T>(rate));
    model.throw_from(T(-1e-3), 2);
    const std::size_t before = allocations;
    bool finite = true;
    for (int n = 0; n < kStorm; ++n) {
      if (weather.now_and_then(3000))
        model.throw_from(weather.any(Ranges::displacement_m), weather.any(Ranges::speed_m_per_s));
      model.tick({weather.any(Ranges::mass_kg), weather.any(Ranges::gravity_m_per_s2), any_contact(weather)});
      finite &= is_finite(model.displacement()) && is_finite(model.velocity()) && is_finite(model.force());
    }
    EXPECT_TRUE(finite) << rate;
    model.throw_from(T(-1e-3), 2);
    T largest = 0;
    for (int n = 0; n < 30000; ++n) {
      model.tick({.mass_kg = T(0.003)});
      largest = std::max(largest, model.force());
    }
    EXPECT_EQ(allocations, before);
    EXPECT_GT(largest, 1);
    EXPECT_TRUE(std::abs(model.velocity() + 2) < T(1e-3)) << model.velocity();
  }
}

TYPED_TEST(Extremes, OfAHammerString) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  for (const double rate : kRates) {
    const Parts<T> parts(rate);
    Weather<T> weather;
    HammerString<T> model(parts.table, bare(parts.modes), parts.strike, rate);
    std::vector<T> out(4096), force(4096);
    const std::size_t before = allocations;
    double thrown_j = 0, worst = 0;
    bool finite = true;
    for (int n = 0, at = 0; n < kStorm; ++at) {
      const T mass = T(1e-4), speed = weather.any(Ranges::speed_m_per_s);
      if (weather.now_and_then(5)) {
        model.strike(speed, weather.any(Ranges::throw_distance_m));
        thrown_j += static_cast<double>(mass) * 1e6 / 2;
      }
      const HammerStringControls<T> controls{mass, any_contact(weather), weather.any(Ranges::damping_per_s)};
      const std::size_t block = kBlocks[static_cast<std::size_t>(at) % std::size(kBlocks)];
      const auto sound = std::span(out).first(block);
      if (block == 3)
        for (T& sample : sound) model.tick(controls), sample = model.string().displacement(parts.pickup);
      else
        model.process(controls, parts.pickup, sound, at % 2 == 0 ? force.data() : nullptr);
      finite &= contactspline::all_finite(std::span<const T>(sound));
      worst = std::max(worst, model.string().energy() / std::max(thrown_j, 1e-9));
      n += static_cast<int>(block);
    }
    EXPECT_TRUE(finite) << rate;
    expect_bounded(worst, 1 + 1e-3, "energy over what was thrown", rate);
    model.reset();
    model.strike(2, T(1e-4));
    model.process({.hammer_mass_kg = T(0.003)}, parts.pickup, out, force.data());
    EXPECT_EQ(allocations, before);
    EXPECT_GT(*std::ranges::max_element(force), 1) << rate;
    expect_bounded(model.string().energy(), 0.003 * 2 * 2 / 2, "energy", rate);
  }
}

TYPED_TEST(Extremes, OfAHammerVoice) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  for (const double rate : kRates) {
    const Parts<T> parts(rate);
    Weather<T> weather;
    HammerVoice<T> voice(parts.table, bare(parts.modes), parts.strike, parts.pickup, {.hammer_mass_kg = 1}, {}, rate);
    std::vector<T> out(4096);
    const std::size_t before = allocations;
    bool finite = true;
    for (int n = 0, at = 0; n < kStorm; ++at) {
      if (weather.now_and_then(5)) voice.strike(weather.any(Ranges::speed_m_per_s));
      if (weather.now_and_then(5)) voice.release();
      voice.controls() = {weather.any(Ranges::mass_kg), any_contact(weather), weather.any(Ranges::damping_per_s)};
      const auto sound = std::span(out).first(kBlocks[static_cast<std::size_t>(at) % std::size(kBlocks)]);
      voice.process(sound);
      finite &= contactspline::all_finite(std::span<const T>(sound)) && is_finite(voice.tick());
      n += static_cast<int>(sound.size());
    }
    EXPECT_TRUE(finite) << rate;
    voice.reset();
    voice.controls() = {.hammer_mass_kg = T(0.003)};
    voice.strike(2);
    voice.process(out);
    EXPECT_EQ(allocations, before);
    EXPECT_GT(*std::ranges::max_element(out), T(1e-6)) << rate;
  }
}

/// is_placed: now and then it is also placed anywhere in the midst of the string, which puts any energy into the
/// contact, so that the work says nothing.
template <typename Stormy, typename T>
void expect_to_outlive_the_storm(const char* name, const Parts<T>& parts, bool is_placed) {
  const double rate = parts.rate_hz;
  ModeShapes<T> pluck(parts.modes.size());
  parts.places.at(T(0.1), pluck);
  Weather<T> weather;
  Stormy stormy(parts);
  const auto& model = stormy.model;
  WorkBooks<T> books(rate);
  bool finite = true;
  const std::size_t before = allocations;
  for (int n = 0; n < kStorm; ++n) {
    if (is_placed && weather.now_and_then(5000)) stormy.place(weather);
    const double displacement = model.string().displacement(pluck);
    const double work = stormy.tick(weather), energy = model.string().energy();
    finite &= is_finite(energy) && is_finite(model.force()) && is_finite(model.compression());
    books.close(work + stormy.pluck_force * (model.string().displacement(pluck) - displacement), energy);
  }
  stormy.model.reset();
  for (int n = 0; n < rate; ++n) stormy.calm();
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(finite) << rate;
  EXPECT_TRUE(is_placed || books.is_within()) << rate;
  EXPECT_GT(model.force(), T(0.1)) << rate;
  expect_bounded(model.string().energy(), 1, "energy in the calm", rate);
  std::cout << name << (is_placed ? ", placed, " : ", ") << rate << " Hz: " << books.peak() << " J\n";
}

TYPED_TEST(Extremes, OfASlideString) {
  for (const double rate : kRates)
    for (const bool is_placed : {false, true})
      expect_to_outlive_the_storm<StormySlide<TypeParam>>("slide", Parts<TypeParam>(rate), is_placed);
}

TYPED_TEST(Extremes, OfAFretString) {
  for (const double rate : kRates)
    for (const bool is_placed : {false, true})
      expect_to_outlive_the_storm<StormyFret<TypeParam>>("fret", Parts<TypeParam>(rate), is_placed);
}

// After the storm one voice plays alone.
TYPED_TEST(Extremes, OfAnEnsemble) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  for (const double rate : kRates) {
    const Parts<T> parts(rate);
    Weather<T> weather;
    Ensemble<T> ensemble(rate);
    for (int voice = 0; voice < 20; ++voice)
      ensemble.add(parts.table, bare(parts.modes), parts.strike, parts.pickup, {.hammer_mass_kg = T(0.003)});
    std::vector<T> left(4096), right(4096);
    const std::size_t before = allocations;
    bool finite = true;
    for (int n = 0, at = 0; n < kStorm; ++at) {
      for (std::size_t voice = 0; voice < 20; ++voice) {
        if (weather.now_and_then(3))
          ensemble.strike(voice, weather.any(Ranges::speed_m_per_s), weather.any(Ranges::throw_distance_m));
        ensemble.controls(voice) = {weather.any(Ranges::mass_kg), any_contact(weather),
                                    weather.any(Ranges::damping_per_s)};
        ensemble.mix(voice) = {weather.any(Ranges::gain), weather.any(Ranges::pan)};
      }
      const std::size_t block = kBlocks[static_cast<std::size_t>(at) % std::size(kBlocks)];
      ensemble.process(std::span(left).first(block), std::span(right).first(block));
      finite &= contactspline::all_finite(std::span<const T>(left).first(block)) &&
                contactspline::all_finite(std::span<const T>(right).first(block));
      n += static_cast<int>(block);
    }
    EXPECT_TRUE(finite) << rate;
    ensemble.reset();
    ensemble.controls(7) = {.hammer_mass_kg = T(0.003)};
    ensemble.mix(7) = {};
    ensemble.strike(7, 2, T(1e-4));
    ensemble.process(left);
    EXPECT_EQ(allocations, before);
    EXPECT_GT(*std::ranges::max_element(left), T(1e-6)) << rate;
  }
}

}  // namespace
}  // namespace contactspline::testing
