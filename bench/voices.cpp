// SPDX-License-Identifier: MIT
// Number of hammer-strings that one machine plays in real time: C4, 56 modes, float, each struck once per second.
#include <benchmark/benchmark.h>

#include <vector>

#include "contactspline/ensemble.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/threads.hpp"

namespace contactspline::bench {
namespace {

constexpr std::size_t kRate = 44100;
constexpr std::size_t kBlock = 256;

Ensemble<float> ensemble_of(std::size_t voices) {
  using String = resonators::string_c4;
  const ModeShapes<float> strike(std::span<const double>(String::strike_shapes));
  const ModeShapes<float> pickup(std::span<const double>(String::pickup_shapes));
  Ensemble<float> ensemble(kRate);
  for (std::size_t i = 0; i < voices; ++i)
    ensemble.add(segments_of<materials::felt_c4, float>, modes_in<String>, strike, pickup,
                 {.hammer_mass_kg = 0.00297f});
  return ensemble;
}

/// Computes one second of sound in each iteration. Before the first one, all voices are struck within one second.
template <Runner Run>
void play(benchmark::State& state, std::size_t voices, Run& run) {
  auto ensemble = ensemble_of(voices);
  std::vector<float> sound(kBlock);
  const auto play_second = [&] {
    std::size_t struck = 0;
    for (std::size_t done = 0; done < kRate; done += kBlock) {
      for (; struck < voices && struck * kRate < (done + kBlock) * voices; ++struck)
        ensemble.strike(struck, 2.5f, 1e-4f);
      const std::size_t samples = std::min(kBlock, kRate - done);
      ensemble.process(std::span(sound).first(samples), run);
      benchmark::DoNotOptimize(sound.data());
      benchmark::ClobberMemory();
    }
  };
  play_second();
  for (auto _ : state) play_second();
  using Counter = benchmark::Counter;
  const auto played = static_cast<double>(voices) * static_cast<double>(state.iterations());
  state.counters["voices_in_real_time"] = Counter(played, Counter::kIsRate);
  state.counters["s_per_sample_of_a_voice"] = Counter(played * kRate, Counter::kIsRate | Counter::kInvert);
  if (ensemble.awake() != voices) state.SkipWithError("a voice sleeps");
}

/// Measures CPU time, so that other programs do not matter.
void on_one_core(benchmark::State& state) {
  OneThread run;
  play(state, static_cast<std::size_t>(state.range(0)), run);
}
BENCHMARK(on_one_core)
    ->Name("voices, one core")
    ->ArgsProduct({{1, 4, 16, 64, 256, 1024, 2048, 2560, 3072}})
    ->Unit(benchmark::kMillisecond);

/// Measures wall time, so that other programs matter.
void on_threads(benchmark::State& state) {
  Threads threads(static_cast<int>(state.range(1)));
  play(state, static_cast<std::size_t>(state.range(0)), threads);
}
BENCHMARK(on_threads)
    ->Name("voices, threads")
    ->ArgsProduct({{16, 64, 256, 1024, 2048, 4096, 5120, 6144}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// All voices asleep: only silence is written.
void asleep(benchmark::State& state) {
  auto ensemble = ensemble_of(static_cast<std::size_t>(state.range(0)));
  std::vector<float> sound(kRate);
  for (auto _ : state) {
    ensemble.process(sound);
    benchmark::DoNotOptimize(sound.data());
  }
}
BENCHMARK(asleep)->Name("voices, asleep")->Arg(1)->Arg(1024)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace contactspline::bench

BENCHMARK_MAIN();
