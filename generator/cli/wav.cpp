// SPDX-License-Identifier: MIT
#include "generator/cli/wav.hpp"

#include <algorithm>
#include <cstring>
#include <sndfile.hh>
#include <stdexcept>
#include <vector>

#include "generator/cli/files.hpp"

namespace contactspline {
namespace {

/// A file in memory that libsndfile writes to.
struct MemoryFile {
  std::string bytes;
  std::size_t position = 0;

  static MemoryFile& of(void* user) { return *static_cast<MemoryFile*>(user); }
};

sf_count_t length(void* user) {
  return static_cast<sf_count_t>(MemoryFile::of(user).bytes.size());
}

sf_count_t seek(sf_count_t offset, int whence, void* user) {
  MemoryFile& file = MemoryFile::of(user);
  const auto from = whence == SEEK_CUR ? file.position : whence == SEEK_END ? file.bytes.size() : 0;
  file.position = static_cast<std::size_t>(static_cast<sf_count_t>(from) + offset);
  return static_cast<sf_count_t>(file.position);
}

sf_count_t read(void* target, sf_count_t count, void* user) {
  MemoryFile& file = MemoryFile::of(user);
  const std::size_t available = file.bytes.size() - std::min(file.position, file.bytes.size());
  const std::size_t taken = std::min(static_cast<std::size_t>(count), available);
  std::memcpy(target, file.bytes.data() + file.position, taken);
  file.position += taken;
  return static_cast<sf_count_t>(taken);
}

sf_count_t write(const void* source, sf_count_t count, void* user) {
  MemoryFile& file = MemoryFile::of(user);
  const auto size = static_cast<std::size_t>(count);
  file.bytes.resize(std::max(file.bytes.size(), file.position + size));
  std::memcpy(file.bytes.data() + file.position, source, size);
  file.position += size;
  return count;
}

sf_count_t tell(void* user) {
  return static_cast<sf_count_t>(MemoryFile::of(user).position);
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

template <typename T>
std::string bytes_of(std::span<const T> samples, double scale, int channels, int sample_rate_hz) {
  SF_VIRTUAL_IO io{length, seek, read, write, tell};
  MemoryFile file;
  file.bytes.reserve(3 * samples.size() + 256);
  {
    SndfileHandle handle(io, &file, SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_PCM_24, channels, sample_rate_hz);
    if (handle.error() != 0) throw std::runtime_error(handle.strError());
    handle.command(SFC_SET_CLIPPING, nullptr, SF_TRUE);
    handle.setString(SF_STR_COMMENT, std::string(mark()).c_str());
    write_scaled(handle, samples, scale, channels);
  }
  return file.bytes;
}

}  // namespace

std::string wav_bytes(std::span<const double> samples, double scale, int channels, int sample_rate_hz) {
  return bytes_of(samples, scale, channels, sample_rate_hz);
}

std::string wav_bytes(std::span<const float> samples, double scale, int channels, int sample_rate_hz) {
  return bytes_of(samples, scale, channels, sample_rate_hz);
}

}  // namespace contactspline
