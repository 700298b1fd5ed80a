// SPDX-License-Identifier: MIT
// Shards as files: which are kept, how large they are, and who writes them.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <exception>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "cli/sandbox.hpp"
#include "generator/dataset/dataset.hpp"
#include "generator/dataset/pending_shard.hpp"
#include "generator/material/contact_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline::testing {
namespace {

Plan plan_of(const std::string& more, const std::string& comment = "") {
  return parse_plan(fmt::format(R"({}{{"name": "probe", "instrument": "hammer_string",
    "parts": {{"resonator": "string_c4", "material": "felt_c4"}}, "outputs": ["bridge_force_n", "energy_j"],
    "energy_step_samples": 88, "parameters": {{"speed_m_per_s": {{"uniform": [1, 4]}}}},
    "events": [{{"time_s": 0, "event": "strike"}}], "seed": 1, {}}})",
                                comment, more),
                    "probe.json", shipped_file);
}

ShardHeading heading_of(const Plan& plan) {
  return {"program", {0, plan.count}};
}

class Shards : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { let_hdf5_end_in_silence(); }

  fs::path write(
      const Plan& plan, const std::function<void(std::size_t)>& done = [](std::size_t) {}) const {
    fs::path path = box_ / "shard.h5";
    write_shard(path, plan, heading_of(plan), 1, done);
    return path;
  }

  Sandbox box_;
};

// Everything in a file lies under a checksum: texts, samples and what describes them.
TEST_F(Shards, AreDamagedByAnyBit) {
  const Plan plan = plan_of(R"("count": 4, "seconds": 0.01)");
  const fs::path path = write(plan);
  const std::string whole = read_file(path);
  EXPECT_EQ(state_of_shard(path, plan, heading_of(plan), true), ShardState::kComplete);
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> bits(0, 8 * whole.size() - 1);
  for (int i = 0; i < 500; ++i) {
    const std::size_t bit = bits(random);
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    write_file(path, damaged);
    EXPECT_EQ(state_of_shard(path, plan, heading_of(plan), true), ShardState::kDamaged) << bit;
  }
}

TEST_F(Shards, HaveTextsOfAnyLength) {
  const auto with = [](char last) {
    std::string comment = "// ";
    comment.append(100000, last);
    comment.push_back('\n');
    return plan_of(R"("count": 1, "seconds": 0.01)", comment);
  };
  const fs::path path = write(with('a'));
  EXPECT_EQ(state_of_shard(path, with('a'), heading_of(with('a')), true), ShardState::kComplete);
  EXPECT_EQ(state_of_shard(path, with('b'), heading_of(with('b')), true), ShardState::kOfOthers);
}

TEST_F(Shards, AreOfOthersWhereAnythingDiffers) {
  const Plan plan = plan_of(R"("count": 2, "seconds": 0.01)");
  const fs::path path = write(plan);
  const auto state_with = [&](const std::function<void(Plan&)>& change) {
    Plan other = plan;
    change(other);
    return state_of_shard(path, other, heading_of(plan), false);
  };
  EXPECT_EQ(state_with([](Plan&) {}), ShardState::kComplete);
  EXPECT_EQ(state_with([](Plan& other) { other.license = "other"; }), ShardState::kOfOthers);
  EXPECT_EQ(state_with([](Plan& other) { other.instrument = "other"; }), ShardState::kOfOthers);
  EXPECT_EQ(state_with([](Plan& other) { other.description = "other"; }), ShardState::kOfOthers);
  EXPECT_EQ(state_with([](Plan& other) { other.sample_rate_hz = 48000; }), ShardState::kOfOthers);
  EXPECT_EQ(state_with([](Plan& other) { other.recorded[0].unit = "m"; }), ShardState::kOfOthers);
  EXPECT_EQ(state_with([](Plan& other) { other.columns[0].unit = "km"; }), ShardState::kOfOthers);
}

// A long row is cut into blocks of equal size, and a short shard has little beside its samples.
TEST_F(Shards, TakeTheAnnouncedSize) {
  for (const char* more : {R"("count": 2, "seconds": 24)", R"("count": 1, "seconds": 0.01)",
                           R"("count": 3001, "seconds": 0.002)", R"("count": 7, "seconds": 1)"}) {
    const Plan plan = plan_of(more);
    const std::size_t bytes = fs::file_size(write(plan)), announced = largest_shard_bytes(plan, heading_of(plan));
    const std::size_t samples = plan.count * plan.bytes_per_sample();
    EXPECT_LE(bytes, announced) << more;
    EXPECT_LT(bytes, samples + samples / 50 + 6000) << more;  // 2 % and a heading
    EXPECT_LT(announced, samples + samples / 50 + 6000) << more;
  }
}

// A disk that fills while samples are rendered takes no room of theirs.
TEST_F(Shards, TakeTheirRoomBeforeTheFirstSample) {
  const Plan plan = plan_of(R"("count": 100, "seconds": 1)");
  const ShardWriter writer(box_ / "shard.h5", plan, heading_of(plan));
  struct stat file = {};
  ASSERT_EQ(::stat((box_ / ".contactspline-shard.h5.part").c_str(), &file), 0);
  EXPECT_GE(static_cast<std::size_t>(file.st_blocks) * 512, plan.count * plan.bytes_per_sample());
}

// Of many that want to write a file at once, one has it: the others are refused, or come after it has removed its
// own.
TEST_F(Shards, HaveOneWriterAtATime) {
  const fs::path path = box_ / "shard.h5";
  std::atomic<int> writers = 0, all = 0;
  std::atomic<bool> is_shared = false;
  const auto begin_again_and_again = [&] {
    for (int i = 0; i < 5000; ++i) try {
        const PendingShard pending(path);
        if (++writers > 1 || !fs::exists(pending.pending())) is_shared = true;
        --writers;
        ++all;
      } catch (const BadInput&) {
      }
  };
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) threads.emplace_back(begin_again_and_again);
  for (std::thread& thread : threads) thread.join();
  EXPECT_FALSE(is_shared);
  EXPECT_GT(all, 0);
}

struct Interrupted : std::exception {};

// This one is more than a second of work.
TEST_F(Shards, StopWithinASample) {
  const Plan plan = parse_plan(R"({"name": "probe", "instrument": "trichord_c4", "outputs": ["bridge_force_n"],
    "events": [{"time_s": 0, "event": "strike_hammer"}], "seed": 1, "count": 1, "seconds": 200})",
                               "probe.json", shipped_file);
  EXPECT_THROW((void)measured_time_of_sample(plan, {0, 1}, [] { throw Interrupted(); }), Interrupted);
  EXPECT_THROW(write(plan, [](std::size_t) { throw Interrupted(); }), Interrupted);
  EXPECT_TRUE(box_.listing().empty());
}

}  // namespace
}  // namespace contactspline::testing
