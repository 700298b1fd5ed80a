// SPDX-License-Identifier: MIT
#include "generator/cli/sound_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "generator/cli/file_ending.hpp"
#include "generator/cli/files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/memory_sound.hpp"

namespace contactspline {
namespace {

struct Format {
  std::string_view ending;
  int code;              ///< of libsndfile
  int bits, other_bits;  ///< that it can have beside kUsualBits; 0: none
};

constexpr std::array kFormats = {Format{".wav", SF_FORMAT_WAV, 16, kFloatBits},
                                 Format{".flac", SF_FORMAT_FLAC, 16, 0}, Format{".ogg", SF_FORMAT_OGG, 0, 0},
                                 Format{".aiff", SF_FORMAT_AIFF, 16, kFloatBits},
                                 Format{".aif", SF_FORMAT_AIFF, 16, kFloatBits}};

int samples_of(const Format& format, int bits) {
  if (format.code == SF_FORMAT_OGG) return SF_FORMAT_VORBIS;
  return bits == 16 ? SF_FORMAT_PCM_16 : bits == kFloatBits ? SF_FORMAT_FLOAT : SF_FORMAT_PCM_24;
}

int format_of(const std::string& file, int bits) {
  const auto found = std::ranges::find(kFormats, file_ending(file), &Format::ending);
  if (found == kFormats.end())
    refuse(file, "sound", "its ending names no format that can be written", ".wav, .flac, .ogg, .aiff, .aif");
  if (bits != kUsualBits && bits != found->bits && bits != found->other_bits)
    refuse(file, "--bits", fmt::format("{} files cannot have samples of {} bits", found->ending, bits),
           found->bits == 0 ? "without --bits, or .wav" : "16, 24, or .wav");
  return found->code | samples_of(*found, bits);
}

// Writes in blocks, to avoid a second copy of a long sound in memory.
template <typename T>
void write_scaled(SndfileHandle& handle, std::span<const T> samples, double scale, int channels) {
  const std::size_t max = 4096 * static_cast<std::size_t>(channels);
  std::vector<double> block;
  for (; !samples.empty(); samples = samples.subspan(block.size())) {
    block.clear();
    for (const T sample : samples.first(std::min(max, samples.size())))
      block.push_back(scale * static_cast<double>(sample));
    const auto count = static_cast<sf_count_t>(block.size());
    if (handle.write(block.data(), count) != count) throw std::runtime_error(handle.strError());
  }
}

}  // namespace

void require_sound_format(const std::string& file, int channels, int sample_rate_hz, int bits) {
  const std::array<float, 2> silence{};
  format_of(file, bits);
  try {
    (void)sound_bytes(file, std::span(silence).first(static_cast<std::size_t>(channels)), 1, channels, sample_rate_hz,
                      bits);
  } catch (const std::runtime_error&) {
    refuse(file, "--rate", fmt::format("this format cannot have {} Hz", sample_rate_hz), "another rate, or .wav");
  }
}

template <typename T>
std::string sound_bytes(const std::string& name, std::span<const T> samples, double scale, int channels,
                        int sample_rate_hz, int bits) {
  SF_VIRTUAL_IO io = MemorySound::calls();
  MemorySound file;
  file.bytes.reserve(static_cast<std::size_t>(bits / 8) * samples.size() + 256);
  {
    SndfileHandle handle(io, &file, SFM_WRITE, format_of(name, bits), channels, sample_rate_hz);
    if (handle.error() != 0) throw std::runtime_error(handle.strError());
    handle.command(SFC_SET_CLIPPING, nullptr, SF_TRUE);
    handle.command(SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);  // it would hold the time of day
    handle.setString(SF_STR_COMMENT, std::string(mark()).c_str());
    write_scaled(handle, samples, scale, channels);
  }
  return file.bytes;
}

template std::string sound_bytes(const std::string&, std::span<const double>, double, int, int, int);
template std::string sound_bytes(const std::string&, std::span<const float>, double, int, int, int);

}  // namespace contactspline
