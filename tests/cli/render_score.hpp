// SPDX-License-Identifier: MIT
// Scores rendered by the program, beside what the models of the runtime play.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "generator/cli/render_output.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "svg.hpp"

namespace contactspline::testing {

inline constexpr double kRate = 44100;

/// File names and contents, beside the score.
using Files = std::map<std::string, std::string>;

inline Sound sound_of(const std::string& score, const Words& options = {}) {
  const Sandbox box;
  write_file(box / "probe.json", score);
  succeed({.arguments = followed_by({"render", "probe.json", "-o", "a.wav"}, options), .folder = box.path()});
  expect_drawn(box / "a.svg", 3);
  return read_sound(box / "a.wav");
}

/// The same without a figure, which takes longer than a short sound.
inline Sound sound_alone(const std::string& score, const Files& beside, const Words& options = {}) {
  const Sandbox box;
  write_file(box / "probe.json", score);
  for (const auto& [name, text] : beside) write_file(box / name, text);
  const Words words = {"render", "probe.json", "-o", "a.wav", "--no-figure"};
  succeed({.arguments = followed_by(words, options), .folder = box.path()});
  return read_sound(box / "a.wav");
}

/// The sound is the motion after the high-pass of every score. 24 bits round it by half a level, and single precision
/// by up to half a level each: before the high-pass, behind it, and the gain by its own and the peak's rounding.
inline void expect_is(const Sound& sound, std::vector<double> motion, double bound = 2.5 * kLevel) {
  high_pass(std::span(motion), sound.channels, sound.rate);
  const auto channels = static_cast<std::size_t>(sound.channels), frames = motion.size() / channels;
  for (std::size_t i = 0; i < motion.size(); ++i) {  // the last 10 ms fade to 0 by a raised cosine
    const double from_end = static_cast<double>(frames - 1 - i / channels) / (0.01 * sound.rate);
    if (from_end < 1) motion[i] *= std::pow(std::sin(std::numbers::pi / 2 * from_end), 2);
  }
  double largest = 0;
  for (const double value : motion) largest = std::max(largest, std::abs(value));
  ASSERT_GT(largest, 0);
  std::vector<double> expected;
  for (const double value : motion) expected.push_back(value * kPeak / largest);
  EXPECT_TRUE(within(sound.peak(), kPeak, kLevel));
  EXPECT_TRUE(sequences_within<double>(sound.samples, expected, bound));
}

inline std::string shipped(std::span<const EmbeddedFile> texts, const std::string& name) {
  return std::string(std::ranges::find(texts, name + ".json", &EmbeddedFile::name)->content);
}

inline Design shipped_material(const std::string& name) {
  return design_material(shipped(embedded_files(Shipped::kMaterials), name), name);
}

/// A shipped resonator and a material as the models take them.
struct Parts {
  Parts(const std::string& resonator_name, const Design& design)
      : resonator(parse_resonator(shipped(embedded_files(Shipped::kResonators), resonator_name), resonator_name)),
        set(modes_of(resonator, kRate / 2)),
        table(segment_table(design.spline)) {
    for (const auto& mode : set.modes) {
      modes.push_back(mode.mode);
      wavenumbers.push_back(mode.wavenumber_per_m);
    }
  }

  [[nodiscard]] ModeShapes<double> at(double place_m) const {
    ModeShapes<double> shapes(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i) shapes[i] = std::sin(wavenumbers[i] * place_m);
    return shapes;
  }

  Resonator resonator;
  ModeSet set;
  std::vector<Segment<double>> table;
  std::vector<Mode> modes;
  std::vector<double> wavenumbers;
};

/// From one value to another between two samples, as scores glide.
inline double glide(double from, double to, int n, int begin, int end) {
  if (n <= begin) return from;
  if (n >= end) return to;
  const double part = static_cast<double>(n - begin) / (end - begin);
  return from + (to - from) * part * part * (3 - 2 * part);
}

/// Two throws at once held, a damper between, a third throw elsewhere with another hammer, a damping that glides in.
inline const std::string kKeyScore = R"({
  "instrument": "piano", "duration_s": 0.4,
  "events": [
    { "time_s": 0.3, "key": 60, "speed_m_per_s": 1.5, "strike_m": 0.2, "stiffness_ratio": 4, "hammer_mass_kg": 0.002, "loss_s_per_m": 0.2 },
    { "time_s": 0.01, "key": 60, "speed_m_per_s": 2.5, "hold_s": 0.15 },
    { "time_s": 0.1, "key": 60, "speed_m_per_s": 3.5, "hold_s": 0.1 },
    { "time_s": 0.31, "over_s": 0.05, "damping_per_s": 20 }
  ]
})";

/// The phase of a decaying partial advances from one window to the next, half a second later: by exactly w/2 whatever
/// its decay. Other partials, 260 Hz away and more, leak by the side lobes of the window (Blackman-Harris, 4 terms,
/// below -92 dB and falling); the widest angle that makes is given by the check on sines of known frequency.
inline double frequency_near(const std::vector<double>& samples, double guess_hz) {
  const int window = 22050, shift = 22050, begin = 8820;
  std::complex<double> views[2];
  for (int view = 0; view < 2; ++view)
    for (int n = 0; n < window; ++n) {
      const double angle = 2 * std::numbers::pi * (n + 0.5) / window;
      const double weight =
          0.35875 - 0.48829 * std::cos(angle) + 0.14128 * std::cos(2 * angle) - 0.01168 * std::cos(3 * angle);
      const double phase = -2 * std::numbers::pi * guess_hz * n / kRate;
      views[view] += weight * samples[static_cast<std::size_t>(begin + view * shift + n)] * std::polar(1.0, phase);
    }
  const double advance =
      std::arg(views[1] / views[0] * std::polar(1.0, -2 * std::numbers::pi * guess_hz * shift / kRate));
  return guess_hz + advance / (2 * std::numbers::pi) * kRate / shift;
}

/// One track, 96 ticks a quarter of 0.5 s.
inline std::string midi_file(const std::string& events) {
  const std::string track = events + std::string("\0\xff\x2f\0", 4);
  return std::string("MThd\0\0\0\6\0\0\0\1\0\x60MTrk\0\0\0", 21) + static_cast<char>(track.size()) + track;
}

inline Sound sound_of_midi(const std::string& events, const Words& options = {}) {
  const Sandbox box;
  write_file(box / "probe.mid", midi_file(events));
  const Words words = {"render", "--score", "probe.mid", "-o", "a.wav", "--no-figure", "--tail", "1"};
  succeed({.arguments = followed_by(words, options), .folder = box.path()});
  return read_sound(box / "a.wav");
}

}  // namespace contactspline::testing
