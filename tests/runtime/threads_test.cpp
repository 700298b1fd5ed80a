// SPDX-License-Identifier: MIT
// Voices on many cores.
#include "contactspline/host/threads.hpp"

#include <oneapi/tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "band.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"

namespace contactspline::testing {
namespace {

/// Four threads, even where the machine has fewer cores.
class ThreadsTest : public ::testing::Test {
 private:
  oneapi::tbb::global_control four_{oneapi::tbb::global_control::max_allowed_parallelism, 4};
};

/// Half a second of 100 voices, struck at random and falling asleep, in blocks of 300.
template <typename T, typename Run>
std::vector<T> play_at_random(const std::vector<Player<T>>& players, Run&& run) {
  auto ensemble = ensemble_of(players, 1e-6);
  std::mt19937 random(3);
  std::vector<T> sound(300 * 74), right(300);
  for (std::size_t done = 0; done < sound.size(); done += 300) {
    for (int i = 0; i < 5; ++i) ensemble.strike(random() % players.size(), static_cast<T>(1 + random() % 4), T(1e-4));
    ensemble.process(std::span(sound).subspan(done, 300), right, run);
  }
  return sound;
}

TEST_F(ThreadsTest, PlayTheSameBits) {
  const auto check = [&]<typename T>(T) {
    const auto players = band<T>(100);
    const auto expected = play_at_random(players, OneThread());
    for (const int count : {1, 2, 3, 4}) {
      Threads threads(count);
      EXPECT_EQ(threads.size(), count);
      EXPECT_EQ(play_at_random(players, threads), expected) << count;
    }
    EXPECT_GT(std::ranges::max(expected), 1e-4);
  };
  check(float());
  check(double());
}

// So many tasks that each wait for all others to begin, 20 s at most; whether they ran at once.
bool run_at_once(Threads& threads, int count) {
  std::atomic<int> begun = 0;
  std::atomic<bool> in_time = true;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  threads(static_cast<std::size_t>(count), [&](std::size_t) {
    for (++begun; begun < count && in_time;) {
      std::this_thread::yield();
      if (std::chrono::steady_clock::now() > deadline) in_time = false;
    }
  });
  return begun == count && in_time;
}

TEST_F(ThreadsTest, RunAtOnce) {
  for (const int count : {2, 4}) {
    Threads threads(count);
    EXPECT_TRUE(run_at_once(threads, count));
  }
}

TEST_F(ThreadsTest, RunEveryTaskOnce) {
  Threads threads(4);
  for (const std::size_t tasks : {0u, 1u, 2u, 1000u}) {
    std::vector<std::atomic<int>> runs(tasks);
    threads(tasks, [&](std::size_t i) { ++runs[i]; });
    for (const auto& count : runs) EXPECT_EQ(count, 1);
  }
}

// By new, once all threads are awake; oneTBB keeps its tasks in pools of its own.
TEST_F(ThreadsTest, AllocateNothingInTheAudioThread) {
  const auto players = band<float>(64);
  auto ensemble = ensemble_of(players);
  Threads threads(4);
  std::vector<float> sound(512);
  ASSERT_TRUE(run_at_once(threads, 4));
  const std::size_t before = allocations;
  for (std::size_t block = 0; block < 50; ++block) {
    ensemble.strike(block, 2, 1e-4f);
    ensemble.process(sound, threads);
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace contactspline::testing
