// SPDX-License-Identifier: MIT
// Instruments of which all numbers are known, and recordings of their notes in a room with noise.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"
#include "sound.hpp"

namespace contactspline::testing {

/// A number of an instrument that is left open: its path, what it is, and how well the fit must find it.
struct Open {
  std::string key;
  double truth, min, max, error;
};

struct Note {
  int key;
  double velocity;
  bool is_kept = false;
};

/// An instrument file, or a keyboard of 0.2 to 6 m/s, with @0, @1, ... in place of its open numbers.
struct Known {
  std::string test, file;
  std::vector<Open> open;
  std::vector<Note> notes;
  double noise = 1e-3;  ///< its standard deviation, of the peak
  unsigned seed = 1;    ///< of the noise

  [[nodiscard]] std::string with(bool is_open) const {
    std::string text = file;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const std::string mark = fmt::format("@{}", i);
      const std::string number = is_open ? fmt::format(R"({{ "fit": [{}, {}] }})", open[i].min, open[i].max)
                                         : fmt::format("{}", open[i].truth);
      for (auto at = text.find(mark); at != text.npos; at = text.find(mark)) text.replace(at, mark.size(), number);
    }
    return text;
  }
};

inline void PrintTo(const Known& known, std::ostream* stream) {
  *stream << known.test;
}

// How a score says how hard a key is struck.
inline std::string strength(const Known& known, double velocity) {
  const bool is_keyboard = known.file.find("\"keyboard\"") != known.file.npos;
  return is_keyboard ? fmt::format(R"("speed_m_per_s": {})", 0.2 * std::pow(30, velocity))
                     : fmt::format(R"("velocity": {})", velocity);
}

inline std::vector<double> mean_of_channels(const Sound& sound) {
  const auto channels = static_cast<std::size_t>(sound.channels);
  std::vector<double> mean(sound.samples.size() / channels);
  for (std::size_t i = 0; i < sound.samples.size(); ++i) mean[i / channels] += sound.samples[i] / double(channels);
  return mean;
}

// A room of 0.2 s, 50 dB softer than the note, and noise.
inline std::vector<double> in_a_room(const std::vector<double>& dry, int rate, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto length = static_cast<std::size_t>(0.2 * rate);
  std::vector<double> room, wet = dry;
  double squares = 0, peak = 0;
  for (std::size_t i = 0; i < length; ++i) {
    room.push_back(i % 16 == 0 ? normal(random) * std::pow(10, -3.0 * double(i) / double(length)) : 0);
    squares += room.back() * room.back();
  }
  for (const double sample : dry) peak = std::max(peak, std::abs(sample));
  for (std::size_t k = 0; k < length; k += 16)
    for (std::size_t i = k; i < wet.size(); ++i) wet[i] += 0.0032 * room[k] / std::sqrt(squares) * dry[i - k];
  for (double& sample : wet) sample = 0.5 / peak * (sample + noise * peak * normal(random));
  return wet;
}

// Each channel is half as loud as the one before.
inline void write_sound(const fs::path& path, const std::vector<double>& samples, int rate, int channels = 1) {
  SndfileHandle file(path.string(), SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_PCM_16, channels, rate);
  std::vector<double> frames;
  for (const double sample : samples)
    for (int channel = 0; channel < channels; ++channel) frames.push_back(std::ldexp(sample, -channel));
  ASSERT_EQ(file.writef(frames.data(), std::ssize(samples)), std::ssize(samples));
}

constexpr int kRate = 22050;

// The notes as they would be recorded, and a fit file that names them.
inline void record(const Sandbox& box, const Known& known, const std::string& more = "") {
  write_file(box / "true.json", known.with(false));
  write_file(box / "open.json", known.with(true));
  std::string recordings;
  for (std::size_t n = 0; n < known.notes.size(); ++n) {
    const auto& [key, velocity, is_kept] = known.notes[n];
    write_file(box / "score.json", fmt::format(R"({{ "instrument": "true.json", "duration_s": 0.9,
                                 "events": [{{ "time_s": 0.2, "key": {}, {} }}] }})",
                                               key, strength(known, velocity)));
    succeed(run({.arguments = {"render", "score.json", "--no-figure", "--rate", fmt::format("{}", kRate),
                               "--oversample", "4", "-o", "dry.wav"},
                 .folder = box.path()}));
    const std::string name = fmt::format("note_{}.wav", n);
    write_sound(box / name,
                in_a_room(mean_of_channels(read_sound(box / "dry.wav")), kRate, known.noise,
                          known.seed + static_cast<unsigned>(n)),
                kRate, static_cast<int>(1 + n % 2));
    recordings += fmt::format(R"({}{{ "file": "{}", "key": {}, "velocity": {}, "kept": {} }})", n > 0 ? ", " : "",
                              name, key, velocity, is_kept);
  }
  write_file(
      box / "my.fit.json",
      fmt::format(R"({{ "instrument": "open.json", "recordings": [{}], "seconds": 0.5{} }})", recordings, more));
}

inline Outcome fitted(const Sandbox& box, const Words& more = {}) {
  return run({.arguments = followed_by({"fit", "my.fit.json", "--json"}, more), .folder = box.path()});
}

}  // namespace contactspline::testing
