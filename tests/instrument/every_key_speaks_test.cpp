// SPDX-License-Identifier: MIT
// Every key of the violin and the cello that ship sounds at its pitch.
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

struct Pitch {
  double cents;     // from that of a key
  double likeness;  // of the sound to itself a period later: 1 where it repeats
};

// By the lag, within three semitones, at which a sound is most like itself.
Pitch pitch_of(const std::vector<double>& sound, int key) {
  const double period = kRate / (440 * std::exp2((key - 69) / 12.0));
  const auto likeness = [&](int lag) {
    const double both = std::inner_product(sound.begin() + lag, sound.end(), sound.begin(), 0.0);
    const double first = std::inner_product(sound.begin(), sound.end() - lag, sound.begin(), 0.0);
    const double second = std::inner_product(sound.begin() + lag, sound.end(), sound.begin() + lag, 0.0);
    return both / std::sqrt(first * second);
  };
  int best = static_cast<int>(period * 0.84);
  for (int lag = best; lag < period * 1.19; ++lag)
    if (likeness(lag) > likeness(best)) best = lag;
  const double before = likeness(best - 1), at = likeness(best), behind = likeness(best + 1);
  const double beside = (before - behind) / (2 * (before - 2 * at + behind));
  return {-1200 * std::log2((best + beside) / period), at - (before - behind) * beside / 4};
}

class EveryKey : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryKey, Speaks) {
  const std::string name = GetParam();
  const InstrumentArrays arrays =
      arrays_of(parse_instrument(find_embedded(Shipped::kInstruments, name + ".json")->content, name), kRate / 2);
  BySample<double> instrument(Engine<double>::network(arrays.view()), kRate);
  const bool is_full = std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr;
  const std::vector<double> velocities = is_full ? std::vector{0.1, 0.3, 0.5, 0.7, 0.9, 1.0} : std::vector{0.4, 0.9};
  double largest = 0;
  int of_key = 0;
  for (const KeyRange& range : arrays.model->keys.ranges)
    for (int key = range.first; key <= range.last; ++key)
      for (const double velocity : velocities) {
        instrument.reset();
        instrument.handle().note_on(key, velocity);
        std::vector<double> sound;
        for (int n = 0; n < (is_full ? 1.0 : 0.35) * kRate; ++n) {
          instrument.tick();
          sound.push_back(instrument.output(1));  // force on the bridge
        }
        sound.erase(sound.begin(), sound.end() - static_cast<std::ptrdiff_t>(0.12 * kRate));
        const double mean = std::accumulate(sound.begin(), sound.end(), 0.0) / static_cast<double>(sound.size());
        for (double& sample : sound) sample -= mean;
        const Pitch pitch = pitch_of(sound, key);
        EXPECT_TRUE(within(pitch.cents, 0, 20)) << "key " << key << " at velocity " << velocity;
        EXPECT_GT(pitch.likeness, 0.95) << "key " << key << " at velocity " << velocity;
        if (std::abs(pitch.cents) > std::abs(largest)) largest = pitch.cents, of_key = key;
      }
  Measured() << name << ": at most " << largest << " cents, of key " << of_key;
}
INSTANTIATE_TEST_SUITE_P(Bowed, EveryKey, ::testing::Values("violin", "cello"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace contactspline::testing
