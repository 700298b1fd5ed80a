// SPDX-License-Identifier: MIT
// The hammer-string as Faust writes it beside the runtime, bare and behind Faust's interface, in one run, as a table
// in Markdown: scripts/bench --faust.
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <functional>

#include "bench/block_players.hpp"
#include "bench/compete.hpp"

namespace contactspline::bench {
namespace {

/// A player that is struck every so many samples.
class Struck {
 public:
  Struck(std::unique_ptr<BlockPlayer> player, std::size_t samples_between)
      : player_(std::move(player)), between_(samples_between), most_(std::min(BlockPlayer::kMost, between_ / 2)) {}
  void play(std::size_t samples) {
    while (samples > 0) {
      if (until_strike_ == 0) {
        player_->strike();
        until_strike_ = between_;
      }
      const std::size_t block = std::min({samples, until_strike_, most_});
      player_->play(block);
      until_strike_ -= block;
      samples -= block;
    }
  }

 private:
  std::unique_ptr<BlockPlayer> player_;
  std::size_t between_, most_, until_strike_ = 0;
};

// Each plays so many in a round: with fewer, it tells in the times what the one before left in the caches.
constexpr std::size_t kSamples = kSampleRate;

/// Time that this thread was on a processor: rounds of milliseconds are interrupted.
struct ThreadClock {
  static std::chrono::nanoseconds now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
  }
};

void print_header(const std::vector<NamedBlockPlayer>& players) {
  std::printf("| string | struck every | %s, ns |", players.front().name.c_str());
  for (std::size_t i = 1; i < players.size(); ++i) std::printf(" %s |", players[i].name.c_str());
  std::printf("\n|---|---|");
  for (std::size_t i = 0; i < players.size(); ++i) std::printf("---:|");
  std::printf("\n");
}

void print_row(const std::string& string, const std::string& duty, std::vector<NamedBlockPlayer> players,
               std::size_t samples_between, int rounds) {
  using Play = std::function<void()>;
  std::vector<Contestant<Play>> all;
  for (auto& [name, player] : players) {
    auto struck = std::make_shared<Struck>(std::move(player), samples_between);
    all.push_back({name, [struck] { struck->play(kSamples); }});
  }
  Contest<Play, ThreadClock> contest(all, static_cast<double>(kSamples));
  for (int i = 0; i < rounds; ++i) contest.round();
  std::printf("| %s | %s | %.3g |", string.c_str(), duty.c_str(), contest.nanoseconds(0));
  for (std::size_t i = 1; i < all.size(); ++i) std::printf(" %.3g |", 1 / contest.ratio(i));
  std::printf("\n");
  std::fflush(stdout);
}

template <std::floating_point T>
void print_table(const char* precision, int rounds) {
  std::printf("\n%s: ns a sample, then times that\n\n", precision);
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

// bench/faust [ROUNDS]: an odd number of rounds, 41 unless told.
int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 41;
  if (argc > 2 || rounds < 1) {
    std::fprintf(stderr, "bench/faust: '%s'; allowed: a number of rounds, 1 and more\n", argv[argc - 1]);
    return 2;
  }
  contactspline::bench::print_table<double>("Double precision", rounds);
  contactspline::bench::print_table<float>("Single precision", rounds);
}
