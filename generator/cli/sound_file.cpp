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
  int code;  ///< of libsndfile
};

constexpr std::array kFormats = {
    Format{".wav", SF_FORMAT_WAV | SF_FORMAT_PCM_24}, Format{".flac", SF_FORMAT_FLAC | SF_FORMAT_PCM_24},
    Format{".ogg", SF_FORMAT_OGG | SF_FORMAT_VORBIS}, Format{".aiff", SF_FORMAT_AIFF | SF_FORMAT_PCM_24},
    Format{".aif", SF_FORMAT_AIFF | SF_FORMAT_PCM_24}};

int format_of(const std::string& file) {
  const auto found = std::ranges::find(kFormats, file_ending(file), &Format::ending);
  if (found == kFormats.end())
    refuse(file, "sound", "its ending names no format that can be written", ".wav, .flac, .ogg, .aiff, .aif");
  return found->code;
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

void require_sound_format(const std::string& file, int channels, int sample_rate_hz) {
  const std::array<float, 2> silence{};
  format_of(file);
  try {
    (void)sound_bytes(file, std::span(silence).first(static_cast<std::size_t>(channels)), 1, channels,
                      sample_rate_hz);
  } catch (const std::runtime_error&) {
    refuse(file, "--rate", fmt::format("this format cannot have {} Hz", sample_rate_hz), "another rate, or .wav");
  }
}

template <typename T>
std::string sound_bytes(const std::string& name, std::span<const T> samples, double scale, int channels,
                        int sample_rate_hz) {
  SF_VIRTUAL_IO io = MemorySound::calls();
  MemorySound file;
  file.bytes.reserve(3 * samples.size() + 256);
  {
    SndfileHandle handle(io, &file, SFM_WRITE, format_of(name), channels, sample_rate_hz);
    if (handle.error() != 0) throw std::runtime_error(handle.strError());
    handle.command(SFC_SET_CLIPPING, nullptr, SF_TRUE);
    handle.setString(SF_STR_COMMENT, std::string(mark()).c_str());
    write_scaled(handle, samples, scale, channels);
  }
  return file.bytes;
}

template std::string sound_bytes(const std::string&, std::span<const double>, double, int, int);
template std::string sound_bytes(const std::string&, std::span<const float>, double, int, int);

}  // namespace contactspline
