// SPDX-License-Identifier: MIT
// Files of Scala in the library for C: the table of the keys, and the keys that it plays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "c/handle.hpp"
#include "contactspline.h"

namespace contactspline::testing {
namespace {

Handle create(const char* name) {
  Handle handle(contactspline_create(name, 44100, CONTACTSPLINE_DOUBLE));
  EXPECT_TRUE(handle) << contactspline_last_error();
  return handle;
}

/// What the first output of an instrument plays next.
std::vector<double> next_of(const Handle& handle) {
  std::vector<double> sound(600);
  std::vector<double*> outputs(contactspline_output_count(handle.get()));
  outputs.front() = sound.data();
  contactspline_process_double(handle.get(), outputs.data(), nullptr, sound.size());
  return sound;
}

void expect_alike(const std::vector<double>& a, const std::vector<double>& b) {
  double peak = 0;
  for (const double sample : b) peak = std::max(peak, std::abs(sample));
  EXPECT_GT(peak, 0);
  for (std::size_t n = 0; n < a.size(); ++n) ASSERT_NEAR(a[n], b[n], 1e-6 * peak) << n;
}

// A key map that puts middle C four keys higher: the key plays the strings of middle C; one that is left out plays
// nothing. A tuned key plays its bend.
TEST(CLibraryTuning, PlaysAnotherKeyAndLeavesOneOut) {
  double cents[128];
  ASSERT_EQ(contactspline_read_tuning(nullptr, "2\n0\n127\n64\n64\n261.6255653005986\n12\n0\nx\n", 0, cents), 1);
  EXPECT_NEAR(cents[64], -400, 1e-9);
  EXPECT_TRUE(std::isnan(cents[65]));
  const Handle tuned = create("fret_guitar"), plain = create("fret_guitar");
  ASSERT_EQ(contactspline_tune(tuned.get(), cents), 1);
  contactspline_note_on(tuned.get(), 65, 0.7);
  EXPECT_EQ(std::ranges::count(next_of(tuned), 0.0), 600);
  contactspline_note_on(tuned.get(), 64, 0.7);
  contactspline_note_on(plain.get(), 60, 0.7);
  expect_alike(next_of(tuned), next_of(plain));

  ASSERT_EQ(contactspline_read_tuning(nullptr, nullptr, 442, cents), 1);
  const Handle sharp = create("fret_guitar"), bent = create("fret_guitar");
  ASSERT_EQ(contactspline_tune(sharp.get(), cents), 1);
  const contactspline_timed_event bend{0, CONTACTSPLINE_BEND_KEY, 60, 1200 * std::log2(442 / 440.0), 0};
  contactspline_play(bent.get(), &bend);
  for (const Handle* handle : {&sharp, &bent}) contactspline_note_on(handle->get(), 60, 0.7);
  expect_alike(next_of(sharp), next_of(bent));
}

TEST(CLibraryTuning, SaysWhatIsWrong) {
  double cents[128];
  EXPECT_EQ(contactspline_read_tuning("a\n2\n3/0\n2/1\n", nullptr, 0, cents), 0);
  EXPECT_TRUE(std::string(contactspline_last_error()).starts_with("scale: line 3: the ratio 3/0 is not positive"));
  EXPECT_EQ(contactspline_read_tuning(nullptr, nullptr, 100, cents), 0);
  EXPECT_TRUE(std::string(contactspline_last_error()).starts_with("tuning: a4_hz: 100 is out of range; allowed: "));
  EXPECT_EQ(contactspline_read_tuning(nullptr, nullptr, 0, nullptr), 0);
  EXPECT_EQ(contactspline_tune(nullptr, cents), 0);
  EXPECT_EQ(contactspline_tune(create("snare").get(), cents), 0);
}

}  // namespace
}  // namespace contactspline::testing
