// SPDX-License-Identifier: MIT
// read_recording() by libsndfile.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "generator/fit/recorded_note.hpp"
#include "generator/support/error.hpp"
#include "generator/support/memory_sound.hpp"

namespace contactspline {

RecordedSound read_recording(std::string_view bytes, const std::string& file) {
  constexpr auto kAllowed = "a sound file of one channel, such as .wav or .flac";
  constexpr std::size_t kMaxSamples = 1 << 24;  // a small file may hold many equal ones
  MemorySound memory{std::string(bytes)};
  SF_VIRTUAL_IO io = MemorySound::calls();
  SndfileHandle sound(io, &memory);
  if (sound.error() != 0) refuse(file, "file", "is no sound that can be read", kAllowed);
  if (sound.channels() != 1) refuse(file, "channels", fmt::format("has {}", sound.channels()), kAllowed);
  RecordedSound recording{static_cast<double>(sound.samplerate()), {}};
  std::vector<double> block(4096);
  while (true) {
    const sf_count_t count = sound.read(block.data(), static_cast<sf_count_t>(block.size()));
    if (count <= 0) break;
    recording.samples.insert(recording.samples.end(), block.begin(), block.begin() + count);
    if (recording.samples.size() > kMaxSamples)
      refuse(file, "samples", fmt::format("there are more than {}", kMaxSamples), "a recording of one note");
  }
  if (!std::ranges::all_of(recording.samples, [](double sample) { return std::isfinite(sample); }))
    refuse(file, "samples", "some of them are no numbers", "finite samples");
  return recording;
}

}  // namespace contactspline
