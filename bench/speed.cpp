// SPDX-License-Identifier: MIT
// Compares all schemes in one run: medians of paired ratios, percentiles of single samples, scaling. bench/report.cpp
// writes docs/measurements/speed.md from its JSON output (scripts/bench).
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <initializer_list>
#include <string_view>

#include "bench/paired_timer.hpp"
#include "bench/performance.hpp"
#include "bench/schemes.hpp"
#include "bench/stopwatch.hpp"

namespace contactspline::bench {
namespace {

using Counts = std::initializer_list<std::size_t>;

/// Sets the counters ns/NAME, the median time per sample, and ratio/NAME, the median over the rounds of the time of
/// task 0 divided by the time of NAME.
template <typename Run>
void compare(benchmark::State& state, std::vector<TimedTask<Run>>& tasks, double samples) {
  PairedTimer timer(tasks, samples);
  for (auto _ : state) timer.round();
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    state.counters["ns/" + tasks[i].name] = timer.nanoseconds(i);
    state.counters["ratio/" + tasks[i].name] = timer.ratio(i);
  }
}

constexpr std::size_t kBlock = kSampleRate / 10;  // samples of each player in a round

template <std::floating_point T>
void compare(benchmark::State& state, std::vector<NamedPlayer<T>> players, const Workload& workload) {
  std::vector<T> out(kBlock);
  const auto process = [&out](Performance<T>& performance) {
    performance.process(out);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  };
  std::vector<Performance<T>> performances;
  for (auto& player : players) performances.emplace_back(std::move(player.player), workload);
  const auto of = [&](std::size_t i) { return [&, i] { process(performances[i]); }; };
  std::vector<TimedTask<decltype(of(0))>> tasks;
  for (std::size_t i = 0; i < players.size(); ++i) tasks.push_back({players[i].name, of(i)});
  compare(state, tasks, static_cast<double>(kBlock));
}

/// For each sample: is the felt in contact? Computed by HammerString.
template <std::floating_point T>
std::vector<bool> touching(const Model& model, const Workload& workload, std::size_t samples) {
  SplineHammerString<T> scheme(model, model.hammer.mass_kg * workload.mass_ratio);
  std::vector<bool> touching;
  T out;
  for (std::size_t n = 0; n < samples; ++n) {
    if (n % static_cast<std::size_t>(workload.samples_between) == 0)
      scheme.strike(static_cast<T>(workload.speed_m_per_s), static_cast<T>(workload.distance_m));
    scheme.process(std::span(&out, 1));
    touching.push_back(scheme.force() > 0);
  }
  return touching;
}

/// Sets the counters p50/NAME, p99/NAME and p99.9/NAME: ticks of single samples in contact, minus the time of the
/// stopwatch itself. The whole sound is computed several times and the minimum time of each sample is kept. This
/// removes interruptions by the operating system and keeps the dependence on the data. Another player runs first,
/// because a processor needs time to power up its 512-bit vector units.
template <std::floating_point T>
void single_samples(benchmark::State& state, const Model& model, const Workload& workload) {
  constexpr int kReplays = 7;
  constexpr std::size_t kWarmSamples = 2000;
  flush_denormals();
  const std::size_t samples = kSampleRate / 2;
  const auto in_contact = touching<T>(model, workload, samples);
  const std::uint64_t nothing = ticks_of_nothing();
  for (auto _ : state) {
    for (std::size_t scheme = 0; scheme < players_of<T>(model, workload).size(); ++scheme) {
      std::vector<std::uint64_t> min(samples, ~std::uint64_t{0});
      std::string name;
      for (int replay = 0; replay < kReplays; ++replay) {
        auto player = std::move(players_of<T>(model, workload)[scheme]);
        name = player.name;
        Performance<T> performance(std::move(player.player), workload);
        Performance<T> warm(std::move(players_of<T>(model, workload)[scheme].player), workload);
        std::vector<T> discarded(kWarmSamples);
        warm.process(discarded);
        T out;
        for (std::size_t n = 0; n < samples; ++n) {
          const std::uint64_t begin = ticks();
          performance.process(std::span(&out, 1));
          const std::uint64_t end = ticks();
          benchmark::DoNotOptimize(out);
          min[n] = std::min(min[n], end - begin);
        }
      }
      std::vector<double> found;
      for (std::size_t n = 0; n < samples; ++n) {
        const bool struck = n % static_cast<std::size_t>(workload.samples_between) == 0;
        if (in_contact[n] && !struck) found.push_back(static_cast<double>(std::max(min[n], nothing) - nothing));
      }
      for (const auto& [label, fraction] : {std::pair{"p50/", 0.5}, {"p99/", 0.99}, {"p99.9/", 0.999}})
        state.counters[label + name] = percentile(found, fraction);
    }
  }
  state.counters["touching"] =
      static_cast<double>(std::ranges::count(in_contact, true)) / static_cast<double>(samples);
}

/// Time for different numbers of felt segments. Task 0 has 16.
template <std::floating_point T>
void segments(benchmark::State& state, const Model& model, const Workload& workload) {
  std::vector<NamedPlayer<T>> players;
  for (const std::size_t count : Counts{16, 4, 8, 32, 64, 128, 256, 512, 1024, 2048, 4096}) {
    PowerLawHammer hammer = model.hammer;
    hammer.mass_kg *= workload.mass_ratio;
    players.push_back({std::to_string(count), detail::spline<T>(with_segments(model, count), hammer)});
  }
  compare<T>(state, std::move(players), workload);
}

/// `count` C4 hammer-strings, each struck once per second, in blocks of 64 samples.
template <std::floating_point T>
void voices(benchmark::State& state, std::size_t count) {
  constexpr std::size_t kVoiceBlock = 64, kMinSamples = 16384;
  const Model model = c4();
  const Workload workload{"every second", kSampleRate, 2.5, 1e-4};
  std::vector<T> out(kVoiceBlock);
  const std::size_t blocks = std::max<std::size_t>(1, kMinSamples / kVoiceBlock / count);
  std::vector<std::vector<Performance<T>>> choirs;
  std::vector<std::string> names;
  for (const Scheme<T>& scheme : schemes<T>()) {
    if (scheme.name != "spline" && scheme.name != "EXP-3" && scheme.name != "string alone") continue;
    names.push_back(scheme.name);
    auto& choir = choirs.emplace_back();
    for (std::size_t voice = 0; voice < count; ++voice)
      choir.emplace_back(scheme.make(model, model.hammer), workload, static_cast<int>(voice * kSampleRate / count));
  }
  const auto of = [&](std::size_t i) {
    return [&, i] {
      for (std::size_t block = 0; block < blocks; ++block)
        for (auto& voice : choirs[i]) voice.process(out);
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    };
  };
  std::vector<TimedTask<decltype(of(0))>> tasks;
  for (std::size_t i = 0; i < choirs.size(); ++i) tasks.push_back({names[i], of(i)});
  compare(state, tasks, static_cast<double>(blocks * kVoiceBlock * count));
}

template <typename Run>
void add(const std::string& name, int rounds, Run run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Iterations(rounds)->Unit(benchmark::kMillisecond);
}

template <std::floating_point T>
void add_all(const std::string& precision, int rounds) {
  for (const Model& model : models())
    for (const Workload& workload : model.workloads())
      add("ratios/" + model.name + "/" + workload.name + "/" + precision, rounds,
          [=](benchmark::State& state) { compare<T>(state, players_of<T>(model, workload), workload); });
  for (const Model& model : models())
    for (const std::size_t i : Counts{1, 3}) {
      const Workload workload = model.workloads()[i];
      add("percentiles/" + model.name + "/" + workload.name + "/" + precision, 1,
          [=](benchmark::State& state) { single_samples<T>(state, model, workload); });
    }
  for (const std::size_t count : Counts{8, 16, 32, 64, 128, 256, 512, 1024}) {
    const Model model = c4_with_modes(count);
    add("modes/" + std::to_string(count) + "/" + precision, rounds, [=](benchmark::State& state) {
      compare<T>(state, players_of<T>(model, model.workloads()[1]), model.workloads()[1]);
    });
  }
  for (const Model& model : {mb1(), c4()})
    add("segments/" + model.name + "/" + precision, rounds,
        [=](benchmark::State& state) { segments<T>(state, model, model.workloads()[3]); });
  for (const std::size_t count : Counts{1, 4, 16, 64, 256, 1024})
    add("voices/" + std::to_string(count) + "/" + precision, rounds,
        [=](benchmark::State& state) { voices<T>(state, count); });
}

}  // namespace
}  // namespace contactspline::bench

// bench_speed [ROUNDS] [Google Benchmark's options]: an odd number of rounds; the default is 101.
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
