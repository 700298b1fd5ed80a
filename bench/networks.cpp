// SPDX-License-Identifier: MIT
// networks [ROUNDS [SCORE]]: time and solver steps of each shipped instrument file over its score, on one core, as a
// table. Notes of all keys play on one voice. Each block of 64 samples is timed ROUNDS times, by default 5, in time
// of the processor; the shortest counts, because other programs interrupt. The 99.9th percentile of the blocks is
// divided by the median of all blocks, and by that of the blocks in which a contact has a force. SCORE: only those
// whose name contains it, or the path of a score's .json file. bounded: samples in which the steps did not suffice.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "bench/paired_timer.hpp"
#include "contactspline/instrument/network_instrument.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/input_file.hpp"
#include "tests/support/one_voice.hpp"

namespace contactspline::bench {
namespace {

constexpr double kRate = 44100;
constexpr std::size_t kBlock = 64;

/// What a score does to a voice, sorted by sample. note: then the rest does not count.
struct Gesture {
  std::size_t sample, number;
  double value;
  bool is_strike;
  std::optional<NoteTrack::Change> note = {};
};

std::vector<Gesture> gestures_of(const Voice& voice, std::size_t samples) {
  std::vector<Gesture> gestures;
  ControlTrack controls(voice, kRate);
  StrikeTrack strikes(voice.strikes, kRate);
  NoteTrack notes(voice.notes, kRate);
  std::vector<double> last(voice.initial.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t n = 0; n < samples; ++n) {
    const auto values = controls.at(n);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] != std::exchange(last[i], values[i])) gestures.push_back({n, i, values[i], false});
    while (const auto* change = strikes.next_until(n))
      gestures.push_back({n, change->strike->strike, change->strike->speed_m_per_s, true});
    while (const auto* change = notes.next_until(n)) gestures.push_back({n, 0, 0, false, *change});
  }
  return gestures;
}

/// Plays a voice. begin() is called once the instrument is made, after_block(block) after each block and
/// after_sample(instrument) after each sample.
template <typename T>
void play(const Voice& voice, const std::vector<Gesture>& gestures, std::size_t samples, std::invocable auto begin,
          std::invocable<std::size_t> auto after_block,
          std::invocable<const NetworkInstrument<T>&> auto after_sample) {
  const InstrumentArrays arrays = arrays_of(*voice.model, kRate / 2);
  NetworkInstrument<T> instrument(arrays.view(), kRate);
  auto gesture = gestures.begin();
  volatile T output = 0;  // is not optimised away
  begin();
  for (std::size_t n = 0; n < samples; ++n) {
    for (; gesture != gestures.end() && gesture->sample <= n; ++gesture) {
      const T value = static_cast<T>(gesture->value);
      if (gesture->note)
        testing::play_note(instrument, *gesture->note);
      else if (gesture->is_strike)
        instrument.strike(gesture->number, value);
      else
        instrument.set(gesture->number, value);
    }
    instrument.tick();
    output = instrument.output(0);
    (void)output;
    after_sample(instrument);
    if ((n + 1) % kBlock == 0) after_block(n / kBlock);
  }
}

struct Measurement {
  std::size_t voices = 0, samples = 0, bounded = 0;
  std::vector<double> block_ns, in_contact_ns;       // times of all blocks; times of blocks with a force in a contact
  std::map<std::size_t, std::size_t> steps, forces;  // number of samples by solver steps, by contacts with a force
};

template <typename T>
void measure(const Voice& voice, double duration_s, int rounds, Measurement& total) {
  const std::size_t blocks = static_cast<std::size_t>(duration_s * kRate) / kBlock, samples = blocks * kBlock;
  const auto gestures = gestures_of(voice, samples);
  std::vector<double> shortest(blocks, std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round) {
    std::chrono::nanoseconds begin{};
    const auto start = [&] { begin = ThreadClock::now(); };
    const auto stop = [&](std::size_t block) {
      const auto end = ThreadClock::now();
      shortest[block] = std::min(shortest[block], std::chrono::duration<double, std::nano>(end - begin).count());
      start();
    };
    play<T>(voice, gestures, samples, start, stop, [](const auto&) {});
  }
  std::size_t bounded = 0;
  bool is_in_contact = false;
  const auto count = [&](const NetworkInstrument<T>& instrument) {
    const auto& solver = instrument.network().solver();
    is_in_contact |= instrument.contact_force() != 0;
    const auto acts = [&](std::size_t k) { return solver[k].force != 0; };
    const auto with_force = static_cast<std::size_t>(std::ranges::count_if(solver.active(), acts));
    ++total.steps[static_cast<std::size_t>(solver.steps())];
    ++total.forces[with_force];
    bounded = solver.bounded();
  };
  const auto sort = [&](std::size_t block) {
    if (std::exchange(is_in_contact, false)) total.in_contact_ns.push_back(shortest[block]);
  };
  play<T>(
      voice, gestures, samples, [] {}, sort, count);
  total.voices += 1;
  total.samples += samples;
  total.bounded += bounded;
  total.block_ns.insert(total.block_ns.end(), shortest.begin(), shortest.end());
}

double mean_of(const std::map<std::size_t, std::size_t>& counts) {
  double sum = 0, n = 0;
  for (const auto& [value, count] : counts) {
    sum += static_cast<double>(value * count);
    n += static_cast<double>(count);
  }
  return sum / n;
}

template <typename T>
void report(const Score& score, const std::string& name, const char* precision, int rounds) {
  Measurement m;
  for (const Voice& voice : score.voices) measure<T>(voice, score.duration_s, rounds, m);
  const double ns = std::accumulate(m.block_ns.begin(), m.block_ns.end(), 0.0);
  const double slow = percentile(m.block_ns, 0.999);
  fmt::print("| {} | {} | {:.1f} | {:.0f} | {:.2f} | {} | {:.2f} | {} | {:.1f} | {} | {} |\n", name, precision,
             static_cast<double>(m.samples) / kRate / (ns * 1e-9), ns / static_cast<double>(m.samples),
             slow / median(m.block_ns),
             m.in_contact_ns.empty() ? "-" : fmt::format("{:.2f}", slow / median(m.in_contact_ns)), mean_of(m.steps),
             m.steps.rbegin()->first, mean_of(m.forces), m.forces.rbegin()->first, m.bounded);
}

void report_both(const Score& score, const std::string& name, int rounds) {
  report<double>(score, name, "double", rounds);
  report<float>(score, name, "float", rounds);
}

void report_file(int rounds, const std::filesystem::path& path) {
  const auto read = [&](const std::string& named) { return read_input(path.parent_path() / named); };
  report_both(parse_score(read_input(path), path.string(), read), path.stem().string(), rounds);
}

void report_all(int rounds, const std::string& only) {
  fmt::print(
      "| score | precision | times real time | ns per sample | block, 99.9 % / median | / median in contact | "
      "steps, mean | max | forces, mean | max | bounded |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  flush_denormals();
  if (is_path(only)) return report_file(rounds, only);
  for (const EmbeddedFile& file : embedded_files(Shipped::kScores)) {
    if (file.name.find(".json") == file.name.npos || file.name.find(only) == file.name.npos) continue;
    const Score score = parse_score(file.content, file.name, shipped_file);
    if (!score.voices.front().model) continue;  // of a keyboard
    const std::string name(file.name.substr(0, file.name.find('.')));
    report_both(score, name, rounds);
  }
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  contactspline::bench::report_all(argc > 1 ? std::max(1, std::atoi(argv[1])) : 5, argc > 2 ? argv[2] : "");
}
