// SPDX-License-Identifier: MIT
// sound_file.hpp without libsndfile: WAV files alone, byte for byte as libsndfile writes them.
// clang-format off: what this file implements stands first
#include "generator/cli/sound_file.hpp"
// clang-format on

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "generator/cli/file_ending.hpp"
#include "generator/cli/files.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

void append(std::string& bytes, std::size_t number, int size) {
  for (int byte = 0; byte < size; ++byte) bytes += static_cast<char>(number >> (8 * byte) & 0xff);
}

// A content of an even number of bytes.
std::string chunk(const char* name, const std::string& content) {
  std::string bytes = name;
  append(bytes, content.size(), 4);
  return bytes + content;
}

// Ended by a zero or two.
std::string even_text(std::string_view text) {
  return std::string(text) + std::string(2 - text.size() % 2, '\0');
}

std::string format_of(int channels, int sample_rate_hz, int bits) {
  constexpr int kPcm = 1, kFloat = 3;
  const auto rate = static_cast<std::size_t>(sample_rate_hz), frame = static_cast<std::size_t>(channels * bits / 8);
  std::string bytes;
  append(bytes, bits == kFloatBits ? kFloat : kPcm, 2);
  append(bytes, static_cast<std::size_t>(channels), 2);
  append(bytes, rate, 4);
  append(bytes, rate * frame, 4);
  append(bytes, frame, 2);
  append(bytes, static_cast<std::size_t>(bits), 2);
  return bytes;
}

// The number of frames, which stands before samples that are no integers.
std::string fact_of(std::size_t frames, int bits) {
  std::string bytes;
  append(bytes, frames, 4);
  return bits == kFloatBits ? chunk("fact", bytes) : "";
}

void append_sample(std::string& bytes, double sample, int bits) {
  if (bits == kFloatBits) return append(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(sample)), 4);
  const auto number =
      static_cast<std::int32_t>(std::lrint(std::clamp(0x80000000 * sample, -2147483648.0, 2147483647.0)));
  append(bytes, static_cast<std::uint32_t>(number) >> (32 - bits), bits / 8);
}

}  // namespace

void require_sound_format(const std::string& file, int /*channels*/, int /*sample_rate_hz*/, int /*bits*/) {
  if (file_ending(file) != ".wav")
    refuse(file, "sound", "this program was built without libsndfile and writes no such format", ".wav");
}

template <typename T>
std::string sound_bytes(const std::string& name, std::span<const T> samples, double scale, int channels,
                        int sample_rate_hz, int bits) {
  require_sound_format(name, channels, sample_rate_hz, bits);
  std::string data;
  data.reserve(static_cast<std::size_t>(bits / 8) * samples.size());
  for (const T sample : samples) append_sample(data, scale * static_cast<double>(sample), bits);
  const std::string padding(data.size() % 2, '\0');
  return chunk("RIFF", "WAVE" + chunk("fmt ", format_of(channels, sample_rate_hz, bits)) +
                           fact_of(samples.size() / static_cast<std::size_t>(channels), bits) +
                           chunk("LIST", "INFO" + chunk("ICMT", even_text(mark()))) + chunk("data", data) + padding);
}

template std::string sound_bytes(const std::string&, std::span<const double>, double, int, int, int);
template std::string sound_bytes(const std::string&, std::span<const float>, double, int, int, int);

}  // namespace contactspline
