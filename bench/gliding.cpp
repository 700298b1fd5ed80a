// SPDX-License-Identifier: MIT
// gliding [ROUNDS]: 16 notes that each glide by up to an octave their own way, over the same notes at rest, in single
// precision at 44.1 kHz. Their bends change each 64 samples, as hosts send them. Each round renders 0.2 s of both
// after the notes have begun anew, by turns; the median of the ratios counts.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "bench/paired_timer.hpp"
#include "contactspline/host/engine.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instruments/lap_steel.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/step/flush_denormals.hpp"

namespace contactspline::bench {
namespace {

constexpr double kRate = 44100, kDeepest_cents = 1200, kSlowest_hz = 0.5;
constexpr std::size_t kBlock = 64, kBlocks = 140, kNotes = 16;

// The bend of a note at a time: up to an octave, each at its own pace.
double cents(std::size_t note, double time_s) {
  const double part = static_cast<double>(note) / kNotes;
  return kDeepest_cents * (note % 2 == 0 ? 1 : -1) *
         (1 - std::cos(2 * std::numbers::pi * kSlowest_hz * (1 + part) * time_s)) / 2;
}

class Player {
 public:
  Player(Handle<float> instrument, int first_key, int step, bool glides)
      : instrument_(std::move(instrument)), first_key_(first_key), step_(step), glides_(glides) {
    instrument_->prepare(kRate);
    sound_.resize(instrument_->outputs().size(), std::vector<float>(kBlock));
    for (auto& sound : sound_) outputs_.emplace_back(sound);
  }

  void operator()() {
    const FlushDenormals flushed;
    instrument_->reset();
    for (std::size_t note = 0; note < kNotes; ++note) {
      instrument_->play({0, Action::kBendKey, key(note), 0});
      instrument_->note_on(static_cast<int>(key(note)), 0.6);
    }
    for (std::size_t block = 0; block < kBlocks; ++block) {
      // As far into the glide as after a second.
      const double time_s = 0.5 + static_cast<double>(block * kBlock) / kRate;
      for (std::size_t note = 0; glides_ && note < kNotes; ++note)
        instrument_->play({0, Action::kBendKey, key(note), cents(note, time_s)});
      instrument_->process(outputs_, {});
    }
  }

 private:
  [[nodiscard]] std::size_t key(std::size_t note) const {
    return static_cast<std::size_t>(first_key_ + step_ * static_cast<int>(note));
  }

  Handle<float> instrument_;
  int first_key_, step_;
  bool glides_;
  std::vector<std::vector<float>> sound_;
  std::vector<std::span<float>> outputs_;
};

// The lap steel with a voice for each note.
Handle<float> lap_steel() {
  InstrumentData data = instruments::lap_steel<float>::data::view();
  data.keyed.voices = kNotes;
  return Engine<float>::network(data);
}
Handle<float> piano() {
  return Engine<float>::keyboard(KeyboardInstrument<keyboards::piano, float>::parts());
}

void print(const char* name, Handle<float> (*make)(), int first_key, int step, int rounds) {
  std::vector<TimedTask<Player>> tasks;
  tasks.push_back({"gliding", Player(make(), first_key, step, true)});
  tasks.push_back({"at rest", Player(make(), first_key, step, false)});
  PairedTimer<Player, ThreadClock> timer(tasks, kBlocks * kBlock);
  for (int round = 0; round < rounds; ++round) timer.round();
  fmt::print("{:12} {:8.0f} {:8.0f} {:8.2f}\n", name, timer.nanoseconds(0), timer.nanoseconds(1), timer.ratio(1));
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  using namespace contactspline::bench;
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 9;
  fmt::print("{:12} {:>8} {:>8} {:>8}\n", "16 notes", "gliding", "at rest", "ratio");
  fmt::print("{:12} {:>8} {:>8}\n", "", "ns", "ns");
  print("piano", piano, 40, 3, rounds);
  print("lap steel", lap_steel, 47, 2, rounds);
}
