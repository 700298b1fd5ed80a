// SPDX-License-Identifier: MIT
// piano_phrase OUT.wav: plays a few notes on the piano of piano.hpp, block by block like an audio host.
#include <algorithm>
#include <array>
#include <cstdio>
#include <sndfile.hh>

#include "piano.hpp"

namespace {

constexpr int kRateHz = 48000;
constexpr std::size_t kBlock = 256;
constexpr double kEnd_s = 6;

struct Note {
  double begin_s, end_s;
  int key;
  float velocity;
};

// A rising arpeggio, a repeated note, a chord.
constexpr Note kPhrase[] = {
    {0.0, 1.6, 48, 0.50f}, {0.4, 1.6, 55, 0.45f}, {0.6, 1.6, 64, 0.50f}, {0.8, 1.6, 67, 0.55f}, {1.0, 1.6, 72, 0.60f},
    {1.6, 1.9, 76, 0.40f}, {1.9, 2.2, 76, 0.55f}, {2.2, 2.5, 76, 0.70f}, {2.6, 5.0, 36, 0.65f}, {2.6, 5.0, 60, 0.55f},
    {2.6, 5.0, 64, 0.55f}, {2.6, 5.0, 67, 0.55f}, {2.6, 5.0, 72, 0.75f},
};

/// All key events, sorted by time in samples from the beginning. At equal times, key up comes before key down.
std::vector<KeyEvent> events_of_phrase() {
  std::vector<KeyEvent> events;
  for (const Note& note : kPhrase) {
    events.push_back({static_cast<std::size_t>(note.begin_s * kRateHz), note.key, note.velocity});
    events.push_back({static_cast<std::size_t>(note.end_s * kRateHz), note.key, 0});
  }
  std::ranges::sort(events, {}, [](const KeyEvent& event) { return std::pair(event.time, event.velocity > 0); });
  return events;
}

std::vector<float> play(const std::vector<KeyEvent>& events) {
  Piano piano(kRateHz);
  std::vector<float> sound(static_cast<std::size_t>(kEnd_s * kRateHz));
  std::vector<KeyEvent> of_block;
  auto next = events.begin();
  for (std::size_t begin = 0; begin < sound.size(); begin += kBlock) {
    const auto block = std::span(sound).subspan(begin, std::min(kBlock, sound.size() - begin));
    of_block.clear();
    for (; next != events.end() && next->time < begin + block.size(); ++next)
      of_block.push_back({next->time - begin, next->key, next->velocity});
    piano.process(of_block, block);
  }
  return sound;
}

}  // namespace

int main(int argc, char* argv[]) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: piano_phrase OUT.wav\n");
    return 2;
  }
  const std::vector<float> sound = play(events_of_phrase());
  SndfileHandle file(argv[1], SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_PCM_24, 1, kRateHz);
  if (file.error() != 0 ||
      file.write(sound.data(), static_cast<sf_count_t>(sound.size())) != static_cast<sf_count_t>(sound.size())) {
    std::fprintf(stderr, "piano_phrase: %s: %s\n", argv[1], file.strError());
    return 1;
  }
}
