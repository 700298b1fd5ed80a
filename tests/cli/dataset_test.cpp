// SPDX-License-Identifier: MIT
// contactspline dataset: what it writes, keeps and refuses. hosts/python/tests/test_dataset.py reads the files.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

constexpr auto kStrikes = R"({
  "name": "strikes", "instrument": "hammer_string",
  "parts": {"resonator": "string_c4", "material": "felt_c4"},
  "parameters": {"speed_m_per_s": {"uniform": [1, 4]}, "stiffness_ratio": {"logarithmic": [0.5, 2]}},
  "events": [{"time_s": 0, "event": "strike"}],
  "outputs": ["bridge_force_n", "force_n", "energy_j"], "energy_step_samples": 100,
  "sequence": "sobol", "seed": 1, "count": 20, "seconds": 0.05 })";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no " + from);
  return text.replace(at, from.size(), to);
}

class Dataset : public ::testing::Test {
 protected:
  Dataset() { write_file(box_ / "strikes.json", kStrikes); }

  [[nodiscard]] Call call(const Words& more) const {
    return {.arguments = followed_by({"dataset", "strikes.json", "-o", "out"}, more), .folder = box_.path()};
  }
  [[nodiscard]] std::string shard(int index, int shards) const { return read_file(box_ / fmt(index, shards)); }
  [[nodiscard]] static std::string fmt(int index, int shards) {
    const auto five = [](int number) {
      const std::string digits = std::to_string(number);
      return std::string(5 - digits.size(), '0') + digits;
    };
    return "out/strikes-" + five(index) + "-of-" + five(shards) + ".h5";
  }

  Sandbox box_;
};

TEST_F(Dataset, SaysWhatItWillWriteAndWritesIt) {
  const std::string out = succeed(call({"--shards", "2", "--threads", "2"}));
  EXPECT_TRUE(out.starts_with("strikes: 20 samples of 0.05 s in 2 shards, 0.369 MB, about 0.1 s on 2 threads\n"))
      << out;
  EXPECT_TRUE(out.ends_with("wrote " + fmt(1, 2) + "\nwrote " + fmt(2, 2) + "\njoined out/strikes.h5\n")) << out;
  EXPECT_EQ(box_.listing().size(), 5u) << names_in(box_.listing());
}

TEST_F(Dataset, SameCommandAgainKeepsWholeShards) {
  succeed(call({"--shards", "3"}));
  const FileState first = state_of(box_ / fmt(1, 3)), second = state_of(box_ / fmt(2, 3));
  std::string damaged = second.content;
  damaged[damaged.size() / 2] ^= 1;
  write_file(box_ / fmt(2, 3), damaged);
  fs::remove(box_ / fmt(3, 3));
  const std::string out = succeed(call({"--shards", "3"}));
  EXPECT_NE(out.find("kept " + fmt(1, 3) + "\nwrote " + fmt(2, 3) + "\nwrote " + fmt(3, 3)), std::string::npos)
      << out;
  EXPECT_TRUE(state_of(box_ / fmt(1, 3)) == first);
  EXPECT_TRUE(shard(2, 3) == second.content);
}

// A file holds nothing but what the plan and the program say: no time, no folder. The samples of each shard fill
// several blocks of several arrays, whose order in the file is that in which they are full.
TEST_F(Dataset, FilesAreTheSameWhereverAndOnHoweverManyThreadsTheyAreWritten) {
  const std::string plan = replaced(replaced(kStrikes, "\"count\": 20", "\"count\": 1200"),
                                    "\"energy_step_samples\": 100", "\"energy_step_samples\": 5");
  const Words shard = {"--shard", "2/3"};
  std::string first;
  for (const char* threads : {"1", "2", "3", "8"}) {
    const Sandbox other;
    write_file(other / "strikes.json", plan);
    Call one = call(followed_by(shard, {"--threads", threads}));
    one.folder = other.path();
    succeed(one);
    const std::string bytes = read_file(other / fmt(2, 3));
    EXPECT_TRUE(first.empty() || bytes == first) << threads;
    EXPECT_FALSE(fs::exists(other / "out/strikes.h5"));
    first = bytes;
  }
}

// Neither under the names of its own temporary files nor under others.
TEST_F(Dataset, OverwritesNoFileOfOthersAndFollowsNoLink) {
  for (const std::string name :
       {"strikes.h5.part", "strikes-00001-of-00001.h5.part", ".contactspline-strikes.h5.part",
        ".contactspline-strikes-00001-of-00001.h5.part", ".contactspline-strikes-00001-of-00001.h5.lock"}) {
    const bool is_own = name.starts_with(".");
    for (const bool is_link : {false, true}) {
      if (is_own && !is_link) continue;
      fs::remove_all(box_ / "out");
      fs::create_directory(box_ / "out");
      write_file(box_ / "diary", "precious");
      const fs::path other = box_ / "out" / name;
      is_link ? fs::create_symlink("../diary", other) : write_file(other, "precious");
      const Outcome outcome = run(call({}));
      EXPECT_EQ(read_file(box_ / "diary"), "precious") << name;
      if (name.ends_with(".lock")) {
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_TRUE(outcome.err.starts_with("contactspline: " + fmt(1, 1) + ": file: cannot be written: "))
            << outcome.err;
        continue;
      }
      EXPECT_EQ(outcome.exit_code, 0) << name << outcome.err;
      if (!is_own) {
        EXPECT_EQ(read_file(other), "precious") << name;
      }
    }
  }
}

// HDF5 reads this once, so that each value has a process of its own. Clusters set them.
TEST_F(Dataset, AllowsHdf5ToLockItsFiles) {
  for (const char* value : {"TRUE", "BEST_EFFORT", "FALSE"}) {
    Call locking = call({"--force"});
    locking.environment = {{"HDF5_USE_FILE_LOCKING", value}};
    succeed(run_program(locking));
  }
}

TEST_F(Dataset, JoinsWhatIsThereAndNothingElse) {
  succeed(call({"--shard", "1/2"}));
  expect_refused(run(call({"--shards", "2", "--join"})), fmt(2, 2) + ": file: does not exist", "without --join");
  succeed(call({"--shard", "2/2"}));
  EXPECT_EQ(succeed(call({"--shards", "2", "--join"})), "joined out/strikes.h5\n");
}

TEST_F(Dataset, RefusesShardsOfAnotherPlanAndFilesOfOthers) {
  succeed(call({}));
  write_file(box_ / "strikes.json", replaced(kStrikes, "\"seed\": 1", "\"seed\": 2"));
  expect_refused(run(call({})), fmt(1, 1) + ": file: is of another plan or version", "--force");
  succeed(call({"--force"}));
  write_file(box_ / fmt(1, 1), "a diary");
  expect_refused(run(call({})), fmt(1, 1) + ": file: cannot be read, and may be of another program", "--force");
  EXPECT_EQ(shard(1, 1), "a diary");
}

// The program itself, because HDF5 speaks at the end of a process.
TEST_F(Dataset, WritesADamagedShardAgainInSilence) {
  succeed(call({"--shard", "1/1"}));
  const std::string whole = shard(1, 1);
  for (const std::size_t place : {200, 289, 700, 1512, 2075, 2426, 100000}) {  // headers, texts, samples
    std::string damaged = whole;
    damaged[place] ^= 0x10;
    write_file(box_ / fmt(1, 1), damaged);
    EXPECT_NE(succeed(run_program(call({"--shard", "1/1"}))).find("wrote " + fmt(1, 1)), std::string::npos) << place;
    EXPECT_TRUE(shard(1, 1) == whole) << place;
  }
}

// What remains of a shard, or a file of somebody else, costs this shard only.
TEST_F(Dataset, FilesThatCannotBeReadCostTheirShardsOnly) {
  succeed(call({"--shards", "2"}));
  const std::string first = shard(1, 2), second = shard(2, 2);
  for (const std::size_t size : {0, 1, 100, 512, 1000, 20000}) {
    fs::remove(box_ / fmt(2, 2));
    write_file(box_ / fmt(1, 2), first.substr(0, size));
    const Outcome outcome = run(call({"--shards", "2"}));
    EXPECT_TRUE(shard(2, 2) == second) << size << outcome.err;
    if (outcome.exit_code == 0) continue;
    EXPECT_TRUE(outcome.err.starts_with("contactspline: " + fmt(1, 2) + ": file: cannot be read")) << outcome.err;
    EXPECT_TRUE(outcome.err.ends_with("(1 of 2 shards failed: the same command again writes these alone)\n"))
        << outcome.err;
    EXPECT_TRUE(shard(1, 2) == first.substr(0, size)) << size;
    succeed(call({"--shards", "2", "--force"}));
    EXPECT_TRUE(shard(1, 2) == first) << size;
  }
  for (const std::size_t size : {std::size_t(20000), first.size() - 1}) {  // has the mark of the program
    write_file(box_ / fmt(1, 2), first.substr(0, size));
    succeed(call({"--shards", "2"}));
    EXPECT_TRUE(shard(1, 2) == first) << size;
  }
}

TEST_F(Dataset, LeavesNoFolderWhereTheDiskIsTooSmall) {
  write_file(box_ / "strikes.json", replaced(kStrikes, "\"count\": 20", "\"count\": 1000000000"));
  expect_refused(run(call({})), "out: file: has ", "a folder on a disk with enough room");
  EXPECT_FALSE(fs::exists(box_ / "out"));
}

// A limit on the size of files stands for a full disk.
TEST_F(Dataset, FullDiskCostsItsShardOnly) {
  Call full = call({"--shards", "2"});
  full.largest_file_bytes = 150000;  // a shard has 180 kB
  const Outcome outcome = run(full);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find(fmt(1, 2) + ": file: cannot be written: File too large"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("2 of 2 shards failed"), std::string::npos) << outcome.err;
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 2) << outcome.err;
  for (const auto& [name, state] : box_.listing()) EXPECT_EQ(name.find(".h5"), std::string::npos) << name;
  succeed(call({"--shards", "2"}));
}

// Killed at any moment, what is there is whole, and the same command ends with the same bytes.
TEST_F(Dataset, KilledAtAnyMomentGoesOnToTheSameBytes) {
  const Words words = {"--shards", "4", "--threads", "1"};
  succeed(call(words));
  std::vector<std::string> wanted;
  for (int i = 1; i <= 4; ++i) wanted.push_back(shard(i, 4));
  Call traced = call(words);
  traced.traced = true;
  fs::remove_all(box_ / "out");
  const std::size_t stops = Process(traced).kill_at_stop(std::numeric_limits<std::size_t>::max());
  ASSERT_GT(stops, 100u);
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    fs::remove_all(box_ / "out");
    Process(traced).kill_at_stop(std::uniform_int_distribution<std::size_t>(0, stops - 1)(random));
    for (int i = 1; i <= 4; ++i)
      EXPECT_TRUE(!fs::exists(box_ / fmt(i, 4)) || shard(i, 4) == wanted[std::size_t(i - 1)]) << round << " " << i;
    succeed(call(words));
    for (int i = 1; i <= 4; ++i) EXPECT_TRUE(shard(i, 4) == wanted[std::size_t(i - 1)]) << round << " " << i;
    for (const auto& [name, state] : box_.listing()) EXPECT_FALSE(name.starts_with("out/.")) << name;
  }
}

struct BadPlan {
  const char *from, *to, *wrong, *allowed;
};

TEST_F(Dataset, RefusesBadPlansInOneLine) {
  const BadPlan cases[] = {
      {"\"seed\": 1", "\"sed\": 1", "sed: unknown key", "seed, count"},
      {"\"name\": \"strikes\",", "", "name: missing", "a letter first"},
      {"\"seed\": 1,", "", "seed: missing", "an integer from 0"},
      {"\"count\": 20", "\"count\": 0", "count: 0 is out of range", "1 to 1000000000"},
      {"\"seconds\": 0.05", "\"seconds\": 4000", "seconds: 4000 is out of range", "to 3600"},
      {"sobol", "halton", "sequence: 'halton' is unknown", "random, sobol"},
      {"\"hammer_string\"", "\"hammer\"", "instrument: 'hammer' is unknown", "hammer_string, mass_barrier, piano"},
      {"\"hammer_string\"", "\"trichord_c4\"", "parts: has no meaning for trichord_c4", "no such key"},
      {"string_c4", "string_c44", "parts.resonator: 'string_c44' does not ship", "string_c4"},
      {"\"material\"", "\"felt\"", "parts.felt: unknown key", "resonator, material"},
      {"\"material\"", "\"tuning_cents\": 9999, \"material\"", "parts.tuning_cents: 9999 is out of range",
       "-1200 to"},
      {"\"string_c4\"", "\"marimba_c4\", \"tuning_cents\": 3", "parts.tuning_cents: is not for this resonator",
       "strings"},
      {"\"speed_m_per_s\"", "\"speed\"", "parameters.speed: unknown key", "hammer_mass_kg"},
      {"[1, 4]", "[1, 400]", "parameters.speed_m_per_s.uniform[1]: 400 is out of range", "0.001 to 100"},
      {"[1, 4]", "[4, 1]", "parameters.speed_m_per_s.uniform: is no range", "the smaller one first"},
      {"[1, 4]", "[1, 2, 4]", "parameters.speed_m_per_s.uniform: is no range", "two numbers from 0.001 to 100"},
      {"[1, 4]", "[4]", "parameters.speed_m_per_s.uniform: is no range", "two numbers from 0.001 to 100"},
      {"\"uniform\": [1, 4]", "", "parameters.speed_m_per_s: has no law or several", "one of uniform"},
      {"\"uniform\": [1, 4]", "\"normal\": [1, 4]", "parameters.speed_m_per_s.normal: unknown key", "uniform"},
      {"\"event\": \"strike\"", "\"event\": \"pluck\"", "events[0].event: 'pluck' is unknown", "strike"},
      {", \"event\": \"strike\"", "", "events[0].event: nothing happens", "one of event, key and parameter"},
      {"\"event\": \"strike\"", "\"event\": \"strike\", \"to\": 1", "events[0].to: has no meaning here", "parameter"},
      {"\"event\": \"strike\"", "\"key\": 60.5", "events[0].key: is no key", "60"},
      {"\"time_s\": 0", "\"time_s\": 1", "events[0].time_s: 1 is out of range", "from 0 to 0.05"},
      {"\"force_n\"", "\"sound\"", "outputs: 'sound' is unknown", "bridge_force_n, force_n, energy_j"},
      {"\"force_n\"", "\"energy_j\"", "outputs: 'energy_j' stands twice", "once"},
      {"\"energy_step_samples\": 100,", "", "energy_step_samples: missing", "such as 1"},
      {", \"energy_j\"", "", "energy_step_samples: has no meaning here", "energy_j"}};
  for (const auto& [from, to, wrong, allowed] : cases) {
    write_file(box_ / "strikes.json", replaced(kStrikes, from, to));
    expect_refused(run(call({})), "strikes.json: " + std::string(wrong), allowed);
    EXPECT_FALSE(fs::exists(box_ / "out")) << wrong;
  }
}

TEST_F(Dataset, RefusesBadOptions) {
  expect_refused(run(call({"--shard", "4/3"})), "--shard: '4/3' is refused", "such as 3/64");
  expect_refused(run(call({"--shard", "0/3"})), "--shard: '0/3' is refused", "I from 1 to N");
  expect_refused(run(call({"--shards", "21"})), "--shards: 21 are more than the samples", "1 to 20");
  expect_refused(run({.arguments = {"dataset", "strikes.json"}, .folder = box_.path()}), "--output: missing",
                 "folder");
  expect_refused(run({.arguments = {"dataset", "absent.json", "-o", "out"}, .folder = box_.path()}),
                 "absent.json: file: does not exist", "");
}

}  // namespace
}  // namespace contactspline::testing
