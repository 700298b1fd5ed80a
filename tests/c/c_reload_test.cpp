// SPDX-License-Identifier: MIT
// Instruments that others replace while they sound, in the library for C.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "c/handle.hpp"
#include "contactspline.h"
#include "support/measured.hpp"
#include "support/real_time.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;
constexpr std::size_t kFade = 441;  // 10 ms

/// A plate that a hand damps and a mallet strikes, of a frequency; `more` are further controls and outputs.
std::string plate(double frequency_hz, const std::string& controls = "", const std::string& outputs = "") {
  const auto at = [&](double ratio) { return std::to_string(ratio * frequency_hz); };
  return R"({ "name": "plate", "bodies": [ { "name": "mallet", "mass_kg": 0.02 }, { "name": "plate", "modes": [
    { "frequency_hz": )" +
         at(1) + R"(, "decay_per_s": 2, "mass_kg": 0.2 }, { "frequency_hz": )" + at(2.7) +
         R"(, "decay_per_s": 4, "mass_kg": 0.2 } ] },
    { "name": "rim", "modes": [ { "frequency_hz": 100, "decay_per_s": 2, "mass_kg": 1 } ] } ],
  "places": [ { "name": "middle", "body": "plate", "shapes": [1, 0.7] } ],
  "contacts": [ { "name": "tip", "between": ["mallet", "middle"], "material": "felt_over_wood", "gap_m": 0.004 } ],
  "controls": [ { "name": "hand", "damping_per_s": ["plate"], "max": 1000 })" +
         controls + R"( ],
  "strikes": ["mallet"],
  "outputs": [ )" +
         outputs + R"({ "name": "plate", "velocity_m_per_s": "middle" } ] })";
}

Handle create(const std::string& text, int precision = CONTACTSPLINE_DOUBLE, double rate = kRate) {
  Handle handle(contactspline_create_from_json(text.c_str(), "plate.json", rate, precision));
  EXPECT_TRUE(handle) << contactspline_last_error();
  return handle;
}

void replace(const Handle& handle, Handle other) {
  ASSERT_EQ(contactspline_replace(handle.get(), other.get()), 1) << contactspline_last_error();
  (void)other.release();
}

std::size_t parameter(const Handle& handle, const std::string& name) {
  std::size_t p = 0;
  while (contactspline_parameter_at(handle.get(), p) != nullptr &&
         contactspline_parameter_at(handle.get(), p)->name != name)
    ++p;
  return p;
}

struct Sound {
  std::vector<double> first, force;
};

Sound next_of(const Handle& handle, std::size_t samples, std::size_t output = 0) {
  Sound sound{std::vector<double>(samples), std::vector<double>(samples)};
  std::vector<double*> outputs(contactspline_output_count(handle.get()));
  outputs[output] = sound.first.data();
  contactspline_process_double(handle.get(), outputs.data(), sound.force.data(), samples);
  return sound;
}

double part_of_old(std::size_t sample) {
  const double x = std::min(1.0, double(sample + 1) / double(kFade));
  return 1 - x * x * (3 - 2 * x);
}

// Bit for bit what both play, the old one less and the new one more; a strike after the change is the new one's.
TEST(CLibraryReplace, FadesFromTheOldToTheNew) {
  const Handle handle = create(plate(400)), old = create(plate(400)), next = create(plate(700));
  for (const Handle* each : {&handle, &old}) {
    contactspline_strike(each->get(), 0, 2);
    (void)next_of(*each, 1000);
  }
  replace(handle, create(plate(700)));
  for (const Handle* each : {&handle, &next}) contactspline_strike(each->get(), 0, 3);
  const Sound sound = next_of(handle, 1000), fading = next_of(old, 1000), expected = next_of(next, 1000);
  const double peak = *std::ranges::max_element(expected.first);
  EXPECT_GT(peak, 0.01);
  EXPECT_GT(*std::ranges::max_element(fading.first), 0.01);
  for (std::size_t n = 0; n < 1000; ++n) {
    const double part = part_of_old(n);
    EXPECT_NEAR(sound.first[n], part * fading.first[n] + (1 - part) * expected.first[n], 1e-14 * peak) << n;
    EXPECT_NEAR(sound.force[n], part * fading.force[n] + (1 - part) * expected.force[n], 1e-10) << n;
  }
}

// An old one that is silent does not soften the attack of the new one.
TEST(CLibraryReplace, IsThereAtOnceBesideSilence) {
  const Handle handle = create(plate(400)), expected = create(plate(700));
  (void)next_of(handle, 100);
  replace(handle, create(plate(700)));
  for (const Handle* each : {&handle, &expected}) contactspline_strike(each->get(), 0, 2);
  EXPECT_EQ(next_of(handle, 1000).first, next_of(expected, 1000).first);
}

// One that sleeps calls nothing, but the next one is there after a block, or an event that sets what it has.
TEST(CLibraryReplace, TakesThePlaceOfOneThatSleeps) {
  for (const bool is_set : {false, true}) {
    const auto of_first_value = [](int value) {
      return plate(400, R"(, { "name": "arm", "damping_per_s": ["rim"], "max": 500, "initial": )" +
                            std::to_string(value) + " }");
    };
    const Handle handle = create(of_first_value(1));
    const std::size_t hand = parameter(handle, "hand_damping_per_s"), arm = parameter(handle, "arm_damping_per_s");
    (void)next_of(handle, 4096);
    replace(handle, create(of_first_value(5)));
    if (is_set) contactspline_set(handle.get(), hand, contactspline_get(handle.get(), hand));
    (void)next_of(handle, 1);
    EXPECT_EQ(contactspline_get(handle.get(), arm), 5) << is_set;
  }
}

TEST(CLibraryReplace, KeepsValuesAndOutputsByName) {
  const std::string more_controls = R"(, { "name": "arm", "damping_per_s": ["rim"], "max": 500, "initial": 1 })";
  const std::string more_outputs = R"({ "name": "push", "force_n": "tip" }, )";
  const Handle handle = create(plate(400, more_controls, more_outputs));
  const std::size_t hand = parameter(handle, "hand_damping_per_s"), arm = parameter(handle, "arm_damping_per_s");
  ASSERT_LT(std::max(hand, arm), contactspline_parameter_count(handle.get()));
  contactspline_set(handle.get(), arm, 7);
  contactspline_strike(handle.get(), 0, 2);
  (void)next_of(handle, 100);
  replace(handle, create(plate(400)));
  EXPECT_GT(next_of(handle, kFade).force[0], 0);
  EXPECT_STREQ(contactspline_output_at(handle.get(), 0)->name, "push_force_n");
  contactspline_strike(handle.get(), 0, 2);
  EXPECT_EQ(next_of(handle, 500).first, std::vector<double>(500)) << "it has no such output";
  EXPECT_NE(next_of(handle, 500, 1).first, std::vector<double>(500));
  EXPECT_EQ(contactspline_get(handle.get(), arm), 7) << "it is kept for the next one";
  contactspline_set(handle.get(), hand, 3);
  const std::string other_first_value = R"(, { "name": "arm", "damping_per_s": ["rim"], "max": 500, "initial": 2 })";
  replace(handle, create(plate(400, other_first_value)));
  (void)next_of(handle, 2 * kFade);
  EXPECT_EQ(contactspline_get(handle.get(), arm), 7);
  EXPECT_EQ(contactspline_get(handle.get(), hand), 3);
  const Handle untouched = create(plate(400, more_controls));
  replace(untouched, create(plate(400, other_first_value)));
  (void)next_of(untouched, 1);
  EXPECT_EQ(contactspline_get(untouched.get(), parameter(untouched, "arm_damping_per_s")), 2);
}

TEST(CLibraryReplace, IsRefusedInOneLine) {
  const Handle handle = create(plate(400));
  const auto refused = [&](contactspline_instrument* other) {
    EXPECT_EQ(contactspline_replace(handle.get(), other), 0);
    return std::string(contactspline_last_error());
  };
  EXPECT_EQ(refused(nullptr), "contactspline: other: is null; allowed: an instrument");
  EXPECT_EQ(refused(handle.get()), "contactspline: other: is the instrument itself; allowed: an instrument");
  const std::string differs = "contactspline: other: differs in rate or precision; allowed: 44100 Hz, in double";
  EXPECT_EQ(refused(create(plate(400), CONTACTSPLINE_DOUBLE, 48000).get()), differs);
  EXPECT_EQ(refused(create(plate(400), CONTACTSPLINE_FLOAT).get()), differs);
  EXPECT_EQ(contactspline_replace(nullptr, handle.get()), 0);
}

double largest_step(const std::vector<double>& sound) {
  double largest = 0;
  for (std::size_t n = 1; n < sound.size(); ++n) largest = std::max(largest, std::abs(sound[n] - sound[n - 1]));
  return largest;
}

// Whoever plays allocates nothing. While the old one fades by g, steps are at most those of its own sound and |x| dg,
// which is 1.5/kFade where g is steepest.
TEST(CLibraryReplace, NeitherClicksNorAllocatesNorLeaks) {
  for (const bool is_oversampled : {false, true}) {
    const Handle handle = create(plate(400));
    std::size_t used = 0;
    for (int change = 0; change < 100; ++change) {
      contactspline_strike(handle.get(), 0, 2);
      const Sound strike = next_of(handle, 900);
      if (is_oversampled) {
        ASSERT_EQ(contactspline_oversample(handle.get(), 1 << change % 4), 1) << contactspline_last_error();
      } else {
        replace(handle, create(plate(change % 2 == 0 ? 410 : 400)));
      }
      std::vector<double> sound(600), force(600);
      double* outputs[] = {sound.data()};
      expect_real_time([&] { contactspline_process_double(handle.get(), outputs, force.data(), 600); });
      sound.insert(sound.begin(), strike.first.back());
      const double ringing = largest_step({strike.first.end() - 400, strike.first.end()});
      double peak = 0;
      for (const double x : strike.first) peak = std::max(peak, std::abs(x));
      EXPECT_LE(largest_step(sound), 1.001 * ringing + 1.5 / double(kFade) * peak) << change;
      EXPECT_LT(largest_step(sound), largest_step(strike.first)) << change;
      EXPECT_GT(std::abs(sound[1]), 0) << change;
      EXPECT_EQ(sound.back(), 0) << change;
      if (change == 20) used = ::mallinfo2().uordblks;
    }
    EXPECT_NEAR(double(::mallinfo2().uordblks), double(used), 64e3) << is_oversampled;
  }
}

// A thread watches a file and replaces the instrument; every third file is damaged and changes nothing.
TEST(CLibraryReplace, FollowsAFileThatChangesWhileItSounds) {
  using Clock = std::chrono::steady_clock;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("contactspline_reload_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::filesystem::path file = folder / "plate.json";
  const auto save = [&](const std::string& text) {
    std::ofstream(folder / "new") << text;
    std::filesystem::rename(folder / "new", file);
  };
  const auto of_first_value = [](int value) {
    return plate(400, R"(, { "name": "arm", "damping_per_s": ["rim"], "max": 500, "initial": )" +
                          std::to_string(value) + " }");
  };
  save(of_first_value(0));
  Handle handle(contactspline_create(file.c_str(), kRate, CONTACTSPLINE_FLOAT));
  ASSERT_TRUE(handle) << contactspline_last_error();
  std::atomic<int> refused = 0;
  std::jthread watcher([&](const std::stop_token& ends) {
    for (auto seen = std::filesystem::last_write_time(file); !ends.stop_requested();) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const auto now = std::filesystem::last_write_time(file);
      if (now == std::exchange(seen, now)) continue;
      contactspline_instrument* const next = contactspline_create(file.c_str(), kRate, CONTACTSPLINE_FLOAT);
      if (next == nullptr)
        ++refused;
      else
        EXPECT_EQ(contactspline_replace(handle.get(), next), 1);
    }
  });
  std::vector<double> milliseconds;
  const std::size_t arm = parameter(handle, "arm_damping_per_s");
  const auto play = [&] {
    float sound[64];
    float* outputs[] = {sound};
    contactspline_process(handle.get(), outputs, nullptr, 64);
    std::this_thread::sleep_for(std::chrono::microseconds(1451));
  };
  for (int change = 1; change <= 100; ++change) {
    contactspline_strike(handle.get(), 0, 2);
    for (int block = 0; block < 8; ++block) play();  // a file system may count time in steps of 4 ms
    const bool is_damaged = change % 3 == 0;
    const int refused_before = refused;
    const double before = contactspline_get(handle.get(), arm);
    const auto saved = Clock::now();
    save(is_damaged ? R"({ "name": "plate", )" : of_first_value(change));
    const auto has_come = [&] {
      return is_damaged ? refused > refused_before : contactspline_get(handle.get(), arm) == change;
    };
    while (!has_come() && Clock::now() - saved < std::chrono::seconds(10)) play();
    ASSERT_TRUE(has_come()) << change;
    EXPECT_EQ(contactspline_get(handle.get(), arm), is_damaged ? before : change);
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - saved).count());
  }
  watcher.request_stop();
  watcher.join();
  EXPECT_EQ(refused, 33);
  std::ranges::sort(milliseconds);
  Measured() << "from the file to the sound " << milliseconds[50] << " ms, at most " << milliseconds.back() << " ms";
  EXPECT_LT(milliseconds[50], 100);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace contactspline::testing
