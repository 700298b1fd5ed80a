// SPDX-License-Identifier: MIT
// Speed of the instruments on one core, as a multiple of real time. Each is struck once per second.
#include <benchmark/benchmark.h>
#include <faust/gui/MapUI.h>
#include <faust/gui/UI.h>
#include <faust/gui/meta.h>

#include <array>
#include <concepts>

#include "contactspline/host/faust_dsp.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "examples/piano.hpp"
#include "faust_programs.hpp"
#include "two_bridges.hpp"
#ifdef CONTACTSPLINE_LV2_PATH
#include "plugins/lv2_host.hpp"
#endif

namespace contactspline::bench {
namespace {

constexpr int kRate = 44100;
constexpr int kBlock = 256;
constexpr int kBlocksPerSecond = kRate / kBlock;

/// Computes blocks of sound and strikes before the first block of each second.
void run(benchmark::State& state, std::invocable auto strike, std::invocable auto process_block) {
  AVOIDDENORMALS;  // as audio hosts do
  int block = 0;
  for (auto _ : state) {
    if (block % kBlocksPerSecond == 0) strike();
    ++block;
    process_block();
  }
  state.counters["times_real_time"] =
      benchmark::Counter(static_cast<double>(block) * kBlock / kRate, benchmark::Counter::kIsRate);
}

void faust(benchmark::State& state, std::unique_ptr<dsp> (*make)(), const char* trigger) {
  const std::unique_ptr<dsp> program = make();
  program->init(kRate);
  MapUI controls;
  program->buildUserInterface(&controls);
  std::array<std::array<float, kBlock>, 2> sound;
  std::array<float*, 2> outputs = {sound[0].data(), sound[1].data()};
  const auto process = [&](int samples) {
    program->compute(samples, nullptr, outputs.data());
    benchmark::DoNotOptimize(sound);
  };
  const auto strike = [&] {
    controls.setParamValue(trigger, 0);
    process(1);
    controls.setParamValue(trigger, 1);
  };
  run(state, strike, [&] { process(kBlock); });
}

/// HammerString with the C4 felt and the C4 string of 56 modes.
template <std::floating_point T>
void hammer_string(benchmark::State& state) {
  using String = resonators::string_c4;
  constexpr auto& felt = segments_of<materials::felt_c4, T>;
  HammerString<T, felt.size()> model(felt, modes_in<String>, ModeShapes<T>(String::strike_shapes), kRate);
  const ModeShapes<T> pickup(String::pickup_shapes);
  std::array<T, kBlock> sound;
  run(
      state, [&] { model.strike(T(2.5), T(1e-4)); },
      [&] {
        model.process({.hammer_mass_kg = T(0.00297)}, pickup, sound);
        benchmark::DoNotOptimize(sound);
      });
}

/// The same behind Faust's `dsp` interface, which also outputs the force.
template <std::floating_point T>
void hammer_string_dsp(benchmark::State& state) {
  InstrumentDsp<HammerStringOf<materials::felt_c4, resonators::string_c4, T>> program;
  program.init(kRate);
  MapUI controls;
  program.buildUserInterface(&controls);
  std::array<std::array<float, kBlock>, 2> sound;
  std::array<float*, 2> outputs = {sound[0].data(), sound[1].data()};
  const auto strike = [&] {
    controls.setParamValue("strike", 0);
    program.compute(0, nullptr, outputs.data());
    controls.setParamValue("strike", 1);
  };
  run(state, strike, [&] {
    program.compute(kBlock, nullptr, outputs.data());
    benchmark::DoNotOptimize(sound);
  });
}

constexpr int kChord = 16;  // notes, from C3 upwards

/// The piano of examples/ on its soundboard, 16 keys down; with the pedal down all other strings ring in sympathy.
void piano_example(benchmark::State& state, double pedal) {
  Piano piano(kRate);
  piano.sustain(pedal);
  std::array<KeyEvent, kChord> chord;
  for (int i = 0; i < kChord; ++i) chord[static_cast<std::size_t>(i)] = {0, 48 + i, 0.7f};
  std::array<float, kBlock> sound;
  std::span<const KeyEvent> events;
  run(
      state, [&] { events = chord; },
      [&] {
        piano.process(events, sound);
        events = {};
        benchmark::DoNotOptimize(sound);
      });
}

/// A keyboard on its body, kChord notes from C2 upwards, three semitones apart.
template <typename Keyboard>
void keyboard(benchmark::State& state, double pedal) {
  KeyboardInstrument<Keyboard, float> piano(kRate);
  piano.sustain(pedal);
  std::array<float, kBlock> left, right;
  run(
      state,
      [&] {
        for (int i = 0; i < kChord; ++i) piano.note_on(36 + 3 * i, 0.7);
      },
      [&] {
        piano.process(left, right);
        benchmark::DoNotOptimize(left);
      });
}

void one_place(benchmark::State& state, double pedal) {
  keyboard<keyboards::piano>(state, pedal);
}
void eight_places(benchmark::State& state, double pedal) {
  keyboard<keyboards::two_bridges>(state, pedal);
}

#ifdef CONTACTSPLINE_LV2_PATH
/// The LV2 piano with kChord voices, all of them sounding.
void piano_lv2(benchmark::State& state) {
  setenv("LV2_PATH", CONTACTSPLINE_LV2_PATH, 1);
  const testing::Lv2World world;
  testing::Lv2Instance piano(world, "urn:contactspline:piano", kRate);
  static_assert(testing::Lv2Instance::kBlock == kBlock);
  piano.set("polyphony", kChord);
  (void)piano.run(1);
  const auto strike = [&] {
    for (int i = 0; i < kChord; ++i) piano.note_on(48 + i, 90);
  };
  run(state, strike, [&] { benchmark::DoNotOptimize(piano.run(1)); });
}
BENCHMARK(piano_lv2)->Name("piano, LV2, 16 voices of 80 modes");
#endif

BENCHMARK(hammer_string<double>)->Name("hammer-string C4, 56 modes, C++ double");
BENCHMARK(hammer_string<float>)->Name("hammer-string C4, 56 modes, C++ float");
BENCHMARK(hammer_string_dsp<double>)->Name("hammer-string C4, 56 modes, C++ double as dsp");
BENCHMARK(hammer_string_dsp<float>)->Name("hammer-string C4, 56 modes, C++ float as dsp");
BENCHMARK_CAPTURE(piano_example, up, 0)->Name("piano on its board, C++ float, 16 notes of up to 80 modes");
BENCHMARK_CAPTURE(piano_example, down, 1)->Name("piano on its board, C++ float, 16 notes, pedal down");
BENCHMARK_CAPTURE(one_place, up, 0)->Name("piano, one bridge place, 16 notes from C2 to A5");
BENCHMARK_CAPTURE(one_place, down, 1)->Name("piano, one bridge place, 16 notes, pedal down");
BENCHMARK_CAPTURE(eight_places, up, 0)->Name("two_bridges, eight places, 16 notes from C2 to A5");
BENCHMARK_CAPTURE(eight_places, down, 1)->Name("two_bridges, eight places, 16 notes, pedal down");

const int kFaust = [] {
  const struct {
    const char* name;
    std::unique_ptr<dsp> (*make)();
    const char* trigger;
  } programs[] = {{"hammer-string C4, 56 modes, Faust double", hammer_string_double, "strike"},
                  {"hammer-string C4, 56 modes, Faust single", hammer_string_single, "strike"},
                  {"slide-string G3, Faust single", slide_string_single, "pluck"},
                  {"fret-string D3, Faust single", fret_string_single, "pluck"},
                  {"piano, one voice of 80 modes, Faust single", piano_single, "gate"}};
  for (const auto& program : programs)
    benchmark::RegisterBenchmark(program.name, faust, program.make, program.trigger);
  return 0;
}();

}  // namespace
}  // namespace contactspline::bench

BENCHMARK_MAIN();
