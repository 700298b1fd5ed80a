// SPDX-License-Identifier: MIT
// Number of hammer-strings that one machine plays in real time: C4, 56 modes, float, each struck once per second.
// And what a voice costs while its hammer stays on the string, on every instruction set of this machine.
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <functional>
#include <vector>

#include "bench/linear_string.hpp"
#include "bench/models.hpp"
#include "bench/paired_timer.hpp"
#include "contactspline/host/threads.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/models/ensemble.hpp"
#include "contactspline/resonators/string_c4.hpp"

namespace contactspline::bench {
namespace {

constexpr std::size_t kRate = 44100;
constexpr std::size_t kBlock = 256;

Ensemble<float> ensemble_of(std::size_t voices) {
  using String = resonators::string_c4;
  const ModeShapes<float> strike(String::strike_shapes);
  const ModeShapes<float> pickup(String::pickup_shapes);
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

/// Plays by one instruction set from now on, 0 by the best.
void take(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  contactspline::detail::take_vectorised_kernels<float>();
  contactspline::detail::take_vectorised_kernels<double>();
}

/// C4 in permanent contact, as the workload of bench/models.hpp: times per sample and voice of 64 voices in an
/// Ensemble, of a HammerString alone, of the string alone by the kernels and of the string alone sample by sample
/// (LinearString). Each voice is pressed at a speed of its own, so that their felts rattle differently; the
/// HammerString alone takes these speeds by turns. Counters: ns/NAME, and ratio/NAME, the median over the rounds of
/// the time of the ensemble divided by that of NAME.
template <std::floating_point T>
void in_permanent_contact(benchmark::State& state, std::int64_t target) {
  constexpr std::size_t kVoices = 64;
  using String = resonators::string_c4;
  const Model model = c4();
  const Workload press = model.workloads()[3];
  const HammerStringControls<T> controls{.hammer_mass_kg = static_cast<T>(model.hammer.mass_kg * press.mass_ratio)};
  const ModeShapes<T> strike(String::strike_shapes), pickup(std::span<const double>(String::pickup_shapes));
  const auto speed = [&](std::size_t voice) {
    return static_cast<T>(press.speed_m_per_s * (0.8 + 0.4 * static_cast<double>(voice) / kVoices));
  };
  constexpr auto& felt = segments_of<materials::felt_c4, T>;
  Ensemble<T> ensemble(kRate);
  for (std::size_t i = 0; i < kVoices; ++i) ensemble.add(felt, modes_in<String>, strike, pickup, controls);
  HammerString<T> alone(felt, modes_in<String>, strike, kRate), string(felt, modes_in<String>, strike, kRate);
  const auto sound_pickup = string.string().sound_pickup(pickup);
  LinearString<T> linear(model.modes, String::pickup_shapes, kRate);

  std::vector<T> sound(static_cast<std::size_t>(press.samples_between));
  const auto computes_voices = [&](auto process) {
    return [&sound, process] {
      for (std::size_t voice = 0; voice < kVoices; ++voice) {
        process(voice);
        benchmark::DoNotOptimize(sound.data());
        benchmark::ClobberMemory();
      }
    };
  };
  std::vector<TimedTask<std::function<void()>>> tasks;
  tasks.push_back({"ensemble", [&] {
                     for (std::size_t voice = 0; voice < kVoices; ++voice) ensemble.strike(voice, speed(voice), T(0));
                     ensemble.process(sound);
                     benchmark::DoNotOptimize(sound.data());
                     benchmark::ClobberMemory();
                   }});
  tasks.push_back({"HammerString", computes_voices([&](std::size_t voice) {
                     alone.strike(speed(voice), T(0));
                     alone.process(controls, sound_pickup, sound);
                   })});
  tasks.push_back({"string", computes_voices([&](std::size_t) { string.process(controls, sound_pickup, sound); })});
  tasks.push_back({"string_by_sample", computes_voices([&](std::size_t) { linear.process(sound); })});

  take(target);
  PairedTimer timer(tasks, static_cast<double>(kVoices * sound.size()));
  for (auto _ : state) timer.round();
  take(0);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    state.counters["ns/" + tasks[i].name] = timer.nanoseconds(i);
    state.counters["ratio/" + tasks[i].name] = timer.ratio(i);
  }
}

const int kPermanentContact = [] {
  // By the library (runtime/CMakeLists.txt); EMU128 stands beside SCALAR.
  constexpr std::int64_t kLeftOut = HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_EMU128;
  for (int bit = 0; bit < 63; ++bit) {
    const std::int64_t target = std::int64_t{1} << bit;
    if (!(hwy::SupportedTargets() & target & ~kLeftOut)) continue;
    const std::string name = std::string("permanent contact, ") + hwy::TargetName(target);
    const auto add = [&](const std::string& precision, auto run) {
      benchmark::RegisterBenchmark((name + ", " + precision).c_str(),
                                   [=](benchmark::State& state) { run(state, target); })
          ->Iterations(101)
          ->Unit(benchmark::kMillisecond);
    };
    add("float", in_permanent_contact<float>);
    add("double", in_permanent_contact<double>);
  }
  return 0;
}();

}  // namespace
}  // namespace contactspline::bench

BENCHMARK_MAIN();
