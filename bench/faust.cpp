// SPDX-License-Identifier: MIT
// Compares the hammer-string that Faust generates with that of the C++ runtime, alone and behind Faust's interface.
// Prints a Markdown table; scripts/bench --faust runs it.
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "bench/block_players.hpp"
#include "bench/paired_timer.hpp"

namespace contactspline::bench {
namespace {

/// A player that is struck every `samples_between` samples.
class Struck {
 public:
  Struck(std::unique_ptr<BlockPlayer> player, std::size_t samples_between)
      : player_(std::move(player)),
        between_(samples_between),
        max_block_(std::min(BlockPlayer::kMax, between_ / 2)) {}
  void process(std::size_t samples) {
    while (samples > 0) {
      if (until_strike_ == 0) {
        player_->strike();
        until_strike_ = between_;
      }
      const std::size_t block = std::min({samples, until_strike_, max_block_});
      player_->process(block);
      until_strike_ -= block;
      samples -= block;
    }
  }

 private:
  std::unique_ptr<BlockPlayer> player_;
  std::size_t between_, max_block_, until_strike_ = 0;
};

// Samples of each player in a round. With fewer, the cache contents of the player before affect the times.
constexpr std::size_t kSamples = kSampleRate;

void print_header(const std::vector<NamedBlockPlayer>& players) {
  std::printf("| string | struck every | %s, ns |", players.front().name.c_str());
  for (std::size_t i = 1; i < players.size(); ++i) std::printf(" %s |", players[i].name.c_str());
  std::printf("\n|---|---|");
  for (std::size_t i = 0; i < players.size(); ++i) std::printf("---:|");
  std::printf("\n");
}

void print_row(const std::string& string, const std::string& workload, std::vector<NamedBlockPlayer> players,
               std::size_t samples_between, int rounds) {
  using Run = std::function<void()>;
  std::vector<TimedTask<Run>> tasks;
  for (auto& [name, player] : players) {
    auto struck = std::make_shared<Struck>(std::move(player), samples_between);
    tasks.push_back({name, [struck] { struck->process(kSamples); }});
  }
  PairedTimer<Run, ThreadClock> timer(tasks, static_cast<double>(kSamples));
  for (int i = 0; i < rounds; ++i) timer.round();
  std::printf("| %s | %s | %.3g |", string.c_str(), workload.c_str(), timer.nanoseconds(0));
  for (std::size_t i = 1; i < tasks.size(); ++i) std::printf(" %.3g |", 1 / timer.ratio(i));
  std::printf("\n");
  std::fflush(stdout);
}

template <std::floating_point T>
void print_table(const char* precision, int rounds) {
  std::printf("\n%s: ns per sample, then the factor\n\n", precision);
  bool is_first = true;
  for_each_faust_string([&](const std::string& string, auto make) {
    const auto players = [&] { return make.template operator()<T>(); };
    if (std::exchange(is_first, false)) print_header(players());
    print_row(string, "second", players(), kSampleRate, rounds);
    print_row(string, "100 ms", players(), kSampleRate / 10, rounds);
    print_row(string, "1.36 ms", players(), 60, rounds);
  });
}

}  // namespace
}  // namespace contactspline::bench

// bench/faust [ROUNDS]: an odd number of rounds; the default is 41.
int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 41;
  if (argc > 2 || rounds < 1) {
    std::fprintf(stderr, "bench/faust: '%s'; allowed: a number of rounds, 1 and more\n", argv[argc - 1]);
    return 2;
  }
  contactspline::bench::print_table<double>("Double precision", rounds);
  contactspline::bench::print_table<float>("Single precision", rounds);
}
