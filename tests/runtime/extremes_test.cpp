// SPDX-License-Identifier: MIT
// Models of one contact and ensembles at their limits: 8 to 768 kHz, blocks of 1 to 4096 samples, controls that jump
// between the ends of their ranges, infinity and NaN in every sample or block. They stay finite, allocate nothing,
// and play again when their controls do. Strings hold no more energy than they were given.
#include "contactspline/models/ensemble.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "random_controls.hpp"
#include "support/count_allocations.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRates[] = {8000, 44100, 192000, 768000};
constexpr std::size_t kBlocks[] = {1, 2, 3, 64, 257, 4096};
constexpr std::size_t kSamples = 30000;

CONTACTSPLINE_EACH_PRECISION(Extremes);

/// Calls play(parts, random) at each rate.
template <typename T, typename Play>
void at_each_rate(const Play& play) {
  for (const double rate : kRates) {
    RandomControls<T> random;
    play(Parts<T>(rate), random);
  }
}

/// Calls play(n, block) for blocks of all sizes in turn, n = 0, 1, ..., until at least kSamples are played.
template <typename Play>
void in_blocks(const Play& play) {
  std::size_t samples = 0;
  for (std::size_t n = 0; samples < kSamples; ++n) {
    const std::size_t block = kBlocks[n % std::size(kBlocks)];
    play(n, block);
    samples += block;
  }
}

/// A number that is finite, and of which no more than `bound` is expected.
void expect_bounded(double value, double bound, const char* what, double rate_hz) {
  EXPECT_TRUE(is_finite(value) && std::abs(value) <= bound) << what << ' ' << value << " at " << rate_hz << " Hz";
}

TYPED_TEST(Extremes, OfAMassBarrier) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  at_each_rate<T>([](const Parts<T>& parts, RandomControls<T>& random) {
    MassBarrier<T> model(parts.table, static_cast<T>(parts.rate_hz));
    model.throw_from(T(-1e-3), 2);
    const std::size_t before = allocations;
    bool finite = true;
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (random.once_in(3000))
        model.throw_from(random.any(Ranges::displacement_m), random.any(Ranges::speed_m_per_s));
      model.tick({random.any(Ranges::mass_kg), random.any(Ranges::gravity_m_per_s2), any_contact(random)});
      finite &= is_finite(model.displacement()) && is_finite(model.velocity()) && is_finite(model.force());
    }
    EXPECT_TRUE(finite) << parts.rate_hz;
    model.throw_from(T(-1e-3), 2);
    T largest = 0;
    for (int n = 0; n < 30000; ++n) {
      model.tick({.mass_kg = T(0.003)});
      largest = std::max(largest, model.force());
    }
    EXPECT_EQ(allocations, before);
    EXPECT_GT(largest, 1);
    EXPECT_TRUE(std::abs(model.velocity() + 2) < T(1e-3)) << model.velocity();
  });
}

TYPED_TEST(Extremes, OfAHammerString) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  at_each_rate<T>([](const Parts<T>& parts, RandomControls<T>& random) {
    HammerString<T> model(parts.table, bare(parts.modes), parts.strike, parts.rate_hz);
    std::vector<T> out(4096), force(4096);
    const std::size_t before = allocations;
    double thrown_j = 0, worst = 0;
    bool finite = true;
    in_blocks([&](std::size_t n, std::size_t block) {
      const T mass = T(1e-4), speed = random.any(Ranges::speed_m_per_s);
      if (random.once_in(5)) {
        model.strike(speed, random.any(Ranges::throw_distance_m));
        thrown_j += static_cast<double>(mass) * 1e6 / 2;
      }
      const HammerStringControls<T> controls{mass, any_contact(random), random.any(Ranges::damping_per_s)};
      const auto sound = std::span(out).first(block);
      if (block == 3)
        for (T& sample : sound) model.tick(controls), sample = model.string().displacement(parts.pickup);
      else
        model.process(controls, parts.pickup, sound, n % 2 == 0 ? force.data() : nullptr);
      finite &= contactspline::all_finite(std::span<const T>(sound));
      worst = std::max(worst, model.string().energy() / std::max(thrown_j, 1e-9));
    });
    EXPECT_TRUE(finite) << parts.rate_hz;
    expect_bounded(worst, 1 + 1e-3, "energy over what was thrown", parts.rate_hz);
    model.reset();
    model.strike(2, T(1e-4));
    model.process({.hammer_mass_kg = T(0.003)}, parts.pickup, out, force.data());
    EXPECT_EQ(allocations, before);
    EXPECT_GT(*std::ranges::max_element(force), 1) << parts.rate_hz;
    expect_bounded(model.string().energy(), 0.003 * 2 * 2 / 2, "energy", parts.rate_hz);
  });
}

TYPED_TEST(Extremes, OfAHammerVoice) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  at_each_rate<T>([](const Parts<T>& parts, RandomControls<T>& random) {
    HammerVoice<T> voice({parts.table, bare(parts.modes), parts.strike, parts.pickup, {.hammer_mass_kg = 1}},
                         parts.rate_hz);
    std::vector<T> out(4096);
    const std::size_t before = allocations;
    bool finite = true;
    in_blocks([&](std::size_t, std::size_t block) {
      if (random.once_in(5)) voice.strike(random.any(Ranges::speed_m_per_s));
      if (random.once_in(5)) voice.release();
      voice.controls() = {random.any(Ranges::mass_kg), any_contact(random), random.any(Ranges::damping_per_s)};
      const auto sound = std::span(out).first(block);
      voice.process(sound);
      finite &= contactspline::all_finite(std::span<const T>(sound)) && is_finite(voice.tick());
    });
    EXPECT_TRUE(finite) << parts.rate_hz;
    voice.reset();
    voice.controls() = {.hammer_mass_kg = T(0.003)};
    voice.strike(2);
    voice.process(out);
    EXPECT_EQ(allocations, before);
    EXPECT_GT(*std::ranges::max_element(out), T(1e-6)) << parts.rate_hz;
  });
}

/// A slide- or a fret-string. is_placed: now and then it is also placed anywhere in the midst of the string, which
/// puts any energy into the contact, so that the work says nothing.
template <typename T, template <typename> typename RandomModel>
void expect_bounded_and_playable(const char* name, bool is_placed) {
  at_each_rate<T>([&](const Parts<T>& parts, RandomControls<T>& random) {
    const double rate = parts.rate_hz;
    ModeShapes<T> pluck(parts.modes.size());
    parts.places.at(T(0.1), pluck);
    RandomModel<T> played(parts);
    const auto& model = played.model;
    WorkBooks<T> books(rate);
    bool finite = true;
    const std::size_t before = allocations;
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (is_placed && random.once_in(5000)) played.place(random);
      const double displacement = model.string().displacement(pluck);
      const double work = played.tick(random), energy = model.string().energy();
      finite &= is_finite(energy) && is_finite(model.force()) && is_finite(model.compression());
      books.close(work + played.pluck_force * (model.string().displacement(pluck) - displacement), energy);
    }
    played.model.reset();
    for (int n = 0; n < rate; ++n) played.play_moderately();
    EXPECT_EQ(allocations, before);
    EXPECT_TRUE(finite) << rate;
    EXPECT_TRUE(is_placed || books.is_within()) << rate;
    EXPECT_GT(model.force(), T(0.1)) << rate;
    expect_bounded(model.string().energy(), 1, "energy after moderate controls", rate);
    Measured() << name << (is_placed ? ", placed, " : ", ") << rate << " Hz: " << books.peak() << " J";
  });
}

TYPED_TEST(Extremes, OfASlideString) {
  for (const bool is_placed : {false, true}) expect_bounded_and_playable<TypeParam, RandomSlide>("slide", is_placed);
}

TYPED_TEST(Extremes, OfAFretString) {
  for (const bool is_placed : {false, true}) expect_bounded_and_playable<TypeParam, RandomFret>("fret", is_placed);
}

// After the random controls one voice plays alone.
TYPED_TEST(Extremes, OfAnEnsemble) {
  using T = TypeParam;
  using Ranges = ControlRanges<T>;
  at_each_rate<T>([](const Parts<T>& parts, RandomControls<T>& random) {
    Ensemble<T> ensemble(parts.rate_hz);
    for (int voice = 0; voice < 20; ++voice)
      ensemble.add(parts.table, bare(parts.modes), parts.strike, parts.pickup, {.hammer_mass_kg = T(0.003)});
    std::vector<T> left(4096), right(4096);
    const std::size_t before = allocations;
    bool finite = true;
    in_blocks([&](std::size_t, std::size_t block) {
      for (std::size_t voice = 0; voice < 20; ++voice) {
        if (random.once_in(3))
          ensemble.strike(voice, random.any(Ranges::speed_m_per_s), random.any(Ranges::throw_distance_m));
        ensemble.controls(voice) = {random.any(Ranges::mass_kg), any_contact(random),
                                    random.any(Ranges::damping_per_s)};
        ensemble.mix(voice) = {random.any(Ranges::gain), random.any(Ranges::pan)};
      }
      ensemble.process(std::span(left).first(block), std::span(right).first(block));
      finite &= contactspline::all_finite(std::span<const T>(left).first(block)) &&
                contactspline::all_finite(std::span<const T>(right).first(block));
    });
    EXPECT_TRUE(finite) << parts.rate_hz;
    ensemble.reset();
    ensemble.controls(7) = {.hammer_mass_kg = T(0.003)};
    ensemble.mix(7) = {};
    ensemble.strike(7, 2, T(1e-4));
    ensemble.process(left);
    EXPECT_EQ(allocations, before);
    EXPECT_GT(*std::ranges::max_element(left), T(1e-6)) << parts.rate_hz;
  });
}

}  // namespace
}  // namespace contactspline::testing
