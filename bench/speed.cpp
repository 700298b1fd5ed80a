// SPDX-License-Identifier: MIT
// Every scheme beside every other in one run: medians of paired ratios, percentiles of single samples, scaling. Its
// JSON is what bench/report.cpp writes docs/speed.md from (scripts/bench).
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <initializer_list>
#include <string_view>

#include "bench/compete.hpp"
#include "bench/performance.hpp"
#include "bench/schemes.hpp"
#include "bench/stopwatch.hpp"

namespace contactspline::bench {
namespace {

using Counts = std::initializer_list<std::size_t>;

/// Counts ns/NAME, the median time of a sample, and ratio/NAME, the median over the rounds of the first one's time
/// over this one's.
template <typename Play>
void compete(benchmark::State& state, std::vector<Contestant<Play>>& all, double samples) {
  Contest contest(all, samples);
  for (auto _ : state) contest.round();
  for (std::size_t i = 0; i < all.size(); ++i) {
    state.counters["ns/" + all[i].name] = contest.nanoseconds(i);
    state.counters["ratio/" + all[i].name] = contest.ratio(i);
  }
}

constexpr std::size_t kBlock = kSampleRate / 10;  // samples each of them plays in a round

template <std::floating_point T>
void compete(benchmark::State& state, std::vector<NamedPlayer<T>> players, const Duty& duty) {
  std::vector<T> out(kBlock);
  const auto play = [&out](Performance<T>& performance) {
    performance.play(out);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  };
  std::vector<Performance<T>> performances;
  for (auto& player : players) performances.emplace_back(std::move(player.player), duty);
  const auto of = [&](std::size_t i) { return [&, i] { play(performances[i]); }; };
  std::vector<Contestant<decltype(of(0))>> all;
  for (std::size_t i = 0; i < players.size(); ++i) all.push_back({players[i].name, of(i)});
  compete(state, all, static_cast<double>(kBlock));
}

/// Which samples find the felt in contact, by our scheme.
template <std::floating_point T>
std::vector<bool> touching(const Model& model, const Duty& duty, std::size_t samples) {
  SplineHammerString<T> scheme(model, model.hammer.mass_kg * duty.mass_ratio);
  std::vector<bool> touching;
  T out;
  for (std::size_t n = 0; n < samples; ++n) {
    if (n % static_cast<std::size_t>(duty.samples_between) == 0)
      scheme.strike(static_cast<T>(duty.speed_m_per_s), static_cast<T>(duty.distance_m));
    scheme.play(std::span(&out, 1));
    touching.push_back(scheme.force() > 0);
  }
  return touching;
}

/// Counts p50/NAME, p99/NAME and p99.9/NAME: ticks of single samples in contact, less what the stopwatch itself
/// takes. Each sample is played again and again from the beginning and its least time kept, so that what the
/// operating system does in between is left out and what depends on the data stays in. Another player goes before,
/// for a processor takes its time to wake up vectors of 512 bits, whatever they compute.
template <std::floating_point T>
void single_samples(benchmark::State& state, const Model& model, const Duty& duty) {
  constexpr int kReplays = 7;
  constexpr std::size_t kWarmSamples = 2000;
  flush_denormals();
  const std::size_t samples = kSampleRate / 2;
  const auto in_contact = touching<T>(model, duty, samples);
  const std::uint64_t nothing = ticks_of_nothing();
  for (auto _ : state) {
    for (std::size_t scheme = 0; scheme < players_of<T>(model, duty).size(); ++scheme) {
      std::vector<std::uint64_t> least(samples, ~std::uint64_t{0});
      std::string name;
      for (int replay = 0; replay < kReplays; ++replay) {
        auto player = std::move(players_of<T>(model, duty)[scheme]);
        name = player.name;
        Performance<T> performance(std::move(player.player), duty);
        Performance<T> warm(std::move(players_of<T>(model, duty)[scheme].player), duty);
        std::vector<T> unheard(kWarmSamples);
        warm.play(unheard);
        T out;
        for (std::size_t n = 0; n < samples; ++n) {
          const std::uint64_t begin = ticks();
          performance.play(std::span(&out, 1));
          const std::uint64_t end = ticks();
          benchmark::DoNotOptimize(out);
          least[n] = std::min(least[n], end - begin);
        }
      }
      std::vector<double> found;
      for (std::size_t n = 0; n < samples; ++n) {
        const bool struck = n % static_cast<std::size_t>(duty.samples_between) == 0;
        if (in_contact[n] && !struck) found.push_back(static_cast<double>(std::max(least[n], nothing) - nothing));
      }
      for (const auto& [label, share] : {std::pair{"p50/", 0.5}, {"p99/", 0.99}, {"p99.9/", 0.999}})
        state.counters[label + name] = percentile(found, share);
    }
  }
  state.counters["touching"] =
      static_cast<double>(std::ranges::count(in_contact, true)) / static_cast<double>(samples);
}

/// How the felt's number of segments tells: the first one has 16.
template <std::floating_point T>
void segments(benchmark::State& state, const Model& model, const Duty& duty) {
  std::vector<NamedPlayer<T>> players;
  for (const std::size_t count : Counts{16, 4, 8, 32, 64, 128, 256, 512, 1024, 2048, 4096}) {
    PowerLawHammer hammer = model.hammer;
    hammer.mass_kg *= duty.mass_ratio;
    players.push_back({std::to_string(count), detail::spline<T>(with_segments(model, count), hammer)});
  }
  compete<T>(state, std::move(players), duty);
}

/// So many C4 hammer-strings, each struck every second, in blocks of 64 samples.
template <std::floating_point T>
void voices(benchmark::State& state, std::size_t count) {
  constexpr std::size_t kVoiceBlock = 64, kLeastSamples = 16384;
  const Model model = c4();
  const Duty duty{"every second", kSampleRate, 2.5, 1e-4};
  std::vector<T> out(kVoiceBlock);
  const std::size_t blocks = std::max<std::size_t>(1, kLeastSamples / kVoiceBlock / count);
  std::vector<std::vector<Performance<T>>> choirs;
  std::vector<std::string> names;
  for (const Scheme<T>& scheme : schemes<T>()) {
    if (scheme.name != "spline" && scheme.name != "EXP-3" && scheme.name != "string alone") continue;
    names.push_back(scheme.name);
    auto& choir = choirs.emplace_back();
    for (std::size_t voice = 0; voice < count; ++voice)
      choir.emplace_back(scheme.make(model, model.hammer), duty, static_cast<int>(voice * kSampleRate / count));
  }
  const auto of = [&](std::size_t i) {
    return [&, i] {
      for (std::size_t block = 0; block < blocks; ++block)
        for (auto& voice : choirs[i]) voice.play(out);
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    };
  };
  std::vector<Contestant<decltype(of(0))>> all;
  for (std::size_t i = 0; i < choirs.size(); ++i) all.push_back({names[i], of(i)});
  compete(state, all, static_cast<double>(blocks * kVoiceBlock * count));
}

template <typename Run>
void add(const std::string& name, int rounds, Run run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Iterations(rounds)->Unit(benchmark::kMillisecond);
}

template <std::floating_point T>
void add_all(const std::string& precision, int rounds) {
  for (const Model& model : models())
    for (const Duty& duty : model.duties())
      add("ratios/" + model.name + "/" + duty.name + "/" + precision, rounds,
          [=](benchmark::State& state) { compete<T>(state, players_of<T>(model, duty), duty); });
  for (const Model& model : models())
    for (const std::size_t i : Counts{1, 3}) {
      const Duty duty = model.duties()[i];
      add("percentiles/" + model.name + "/" + duty.name + "/" + precision, 1,
          [=](benchmark::State& state) { single_samples<T>(state, model, duty); });
    }
  for (const std::size_t count : Counts{8, 16, 32, 64, 128, 256, 512, 1024}) {
    const Model model = c4_with_modes(count);
    add("modes/" + std::to_string(count) + "/" + precision, rounds, [=](benchmark::State& state) {
      compete<T>(state, players_of<T>(model, model.duties()[1]), model.duties()[1]);
    });
  }
  for (const Model& model : {mb1(), c4()})
    add("segments/" + model.name + "/" + precision, rounds,
        [=](benchmark::State& state) { segments<T>(state, model, model.duties()[3]); });
  for (const std::size_t count : Counts{1, 4, 16, 64, 256, 1024})
    add("voices/" + std::to_string(count) + "/" + precision, rounds,
        [=](benchmark::State& state) { voices<T>(state, count); });
}

}  // namespace
}  // namespace contactspline::bench

// bench_speed [ROUNDS] [Google Benchmark's options]: an odd number of rounds, 101 unless told.
int main(int argc, char** argv) {
  int rounds = 101;
  if (argc > 1 && argv[1][0] != '-') {
    rounds = std::atoi(argv[1]);
    if (rounds < 1) {
      std::fprintf(stderr, "bench_speed: %s rounds; allowed: 1 and more\n", argv[1]);
      return 2;
    }
    std::rotate(argv + 1, argv + 2, argv + argc);
    --argc;
  }
  contactspline::bench::add_all<double>("double", rounds);
  contactspline::bench::add_all<float>("float", rounds);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("compiler", __VERSION__);
  benchmark::AddCustomContext("vector_bits",
                              std::to_string(8 * sizeof(contactspline::bench::detail::Modes<double>::Lanes)));
  benchmark::AddCustomContext("ticks", contactspline::bench::kTickName);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
