// SPDX-License-Identifier: MIT
// Measures notes of the piano that ships, on its soundboard: for the test and for the table of
// docs/measurements/piano.md.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <span>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "generator/player/score_player.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/support/embedded_files.hpp"

namespace contactspline::testing {

inline constexpr double kFeatureRate = 44100;

/// A note of the piano that ships, without the knock of key and action; other_events begin with a comma.
[[nodiscard]] inline Score one_note(int key, double speed_m_per_s, double hold_s, double duration_s,
                                    const std::string& other_events = "") {
  const std::string text = fmt::format(
      R"({{ "instrument": "piano", "duration_s": {},
            "events": [ {{ "time_s": 0, "key": {}, "speed_m_per_s": {}, "hold_s": {} }}{} ] }})",
      duration_s, key, speed_m_per_s, hold_s, other_events);
  Score score = parse_score(text, "note.json", shipped_file);
  score.knock.reset();
  return score;
}

/// The mean of both channels of a note on the soundboard [m/s].
[[nodiscard]] inline std::vector<double> sound_of(const Score& score) {
  const Performance played = play(score, {.sample_rate_hz = kFeatureRate, .is_on_body = true}, [](double) {});
  std::vector<double> mean;
  for (std::size_t n = 0; n < played.samples.size(); n += 2)
    mean.push_back((double(played.samples[n]) + double(played.samples[n + 1])) / 2);
  return mean;
}

/// From the first to the last sample in which the hammer touches the strings in the first 20 ms [s], to 6 us.
/// Reflected waves may part them in between.
[[nodiscard]] inline double contact_time_s(int key, double speed_m_per_s) {
  constexpr double kRate = 176400, kDuration_s = 0.02;
  const Performance played = play(one_note(key, speed_m_per_s, 1, kDuration_s),
                                  {.sample_rate_hz = kRate, .is_on_body = true}, [](double) {});
  const auto touches = [](float force) { return force > 0; };
  const auto first = std::ranges::find_if(played.force_n, touches);
  const auto last = std::find_if(played.force_n.rbegin(), played.force_n.rend(), touches).base();
  return static_cast<double>(last - first) * kDuration_s / static_cast<double>(played.force_n.size());
}

/// Power spectrum of a part of a sound by a Hann window; bin k lies at k rate/size.
[[nodiscard]] inline std::vector<double> power_spectrum(std::span<const double> sound) {
  std::vector<double> windowed(sound.begin(), sound.end());
  for (std::size_t n = 0; n < windowed.size(); ++n)
    windowed[n] *=
        1 - std::cos(2 * std::numbers::pi * (static_cast<double>(n) + 0.5) / static_cast<double>(windowed.size()));
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double>().fwd(spectrum, windowed);
  std::vector<double> power(sound.size() / 2);
  for (std::size_t k = 0; k < power.size(); ++k)
    power[k] = std::norm(2.0 / static_cast<double>(sound.size()) * spectrum[k]);
  return power;
}

/// Mean frequency of the first half second, weighted by the amplitude of the bins up to 10 kHz [Hz].
[[nodiscard]] inline double spectral_centroid_hz(std::span<const double> sound) {
  const auto power = power_spectrum(sound.first(22050));
  double sum = 0, moment = 0;
  for (std::size_t k = 0; k < 5000; ++k) {
    sum += std::sqrt(power[k]);
    moment += std::sqrt(power[k]) * static_cast<double>(k) * kFeatureRate / 22050;
  }
  return moment / sum;
}

/// Time between 10 and 90 % of the largest root mean square over 10 ms [s].
[[nodiscard]] inline double attack_time_s(std::span<const double> sound) {
  constexpr std::size_t kWindow = 441, kEnd = 22050;
  std::vector<double> level;
  double power = 0;
  for (std::size_t n = 0; n < kEnd; ++n) {
    power += sound[n] * sound[n] - (n >= kWindow ? sound[n - kWindow] * sound[n - kWindow] : 0);
    level.push_back(std::sqrt(std::max(0.0, power)));
  }
  const double peak = std::ranges::max(level);
  const auto reaches = [&](double part) {
    return std::ranges::find_if(level, [&](double x) { return x >= part * peak; }) - level.begin();
  };
  return static_cast<double>(reaches(0.9) - reaches(0.1)) / kFeatureRate;
}

/// Level of a partial around a time [dB], by a Hann window of 0.1 s.
[[nodiscard]] inline double partial_level_db(std::span<const double> sound, double frequency_hz, double time_s) {
  constexpr std::size_t kWindow = 4410;
  const auto begin = static_cast<std::size_t>(time_s * kFeatureRate) - kWindow / 2;
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < kWindow; ++n) {
    const double window = 1 - std::cos(2 * std::numbers::pi * (static_cast<double>(n) + 0.5) / kWindow);
    sum += window * sound[begin + n] *
           std::polar(1.0, -2 * std::numbers::pi * frequency_hz * static_cast<double>(n) / kFeatureRate);
  }
  return 20 * std::log10(2 * std::abs(sum) / kWindow);
}

/// Decay of a partial between two times [dB/s]: the line of least squares through its level.
[[nodiscard]] inline double decay_db_per_s(std::span<const double> sound, double frequency_hz, double from_s,
                                           double to_s) {
  double n = 0, t_sum = 0, l_sum = 0, tt = 0, tl = 0;
  for (double t = from_s; t <= to_s; t += 0.05) {
    const double level = partial_level_db(sound, frequency_hz, t);
    n += 1;
    t_sum += t;
    l_sum += level;
    tt += t * t;
    tl += t * level;
  }
  return -(n * tl - t_sum * l_sum) / (n * tt - t_sum * t_sum);
}

/// The frequency of the strongest bin near a frequency, by a parabola through the levels of three bins [Hz].
[[nodiscard]] inline double peak_near_hz(const std::vector<double>& power, double frequency_hz, double within_hz) {
  const double bin = kFeatureRate / (2 * static_cast<double>(power.size()));
  auto top = static_cast<std::size_t>((frequency_hz - within_hz) / bin);
  for (auto k = top; k <= static_cast<std::size_t>((frequency_hz + within_hz) / bin); ++k)
    if (power[k] > power[top]) top = k;
  const double a = std::log(power[top - 1]), b = std::log(power[top]), c = std::log(power[top + 1]);
  return (static_cast<double>(top) + (a - c) / (2 * (a - 2 * b + c))) * bin;
}

/// Frequencies of partials 1 to `partials` of a sound whose partials lie near those of the string [Hz].
[[nodiscard]] inline std::vector<double> partials_hz(std::span<const double> sound, const StiffString& string,
                                                     int partials) {
  const auto power = power_spectrum(sound.first(1 << 17));
  std::vector<double> found;
  for (int i = 1; i <= partials; ++i)
    found.push_back(
        peak_near_hz(power, undamped_mode(string, i).angular_frequency_rad_per_s / (2 * std::numbers::pi), 5));
  return found;
}

/// B and the pitch f of (f_i/i)^2 = f^2 (1 + B i^2), by least squares.
[[nodiscard]] inline double inharmonicity(const std::vector<double>& partials) {
  double n = 0, x_sum = 0, y_sum = 0, xx = 0, xy = 0;
  for (std::size_t i = 1; i <= partials.size(); ++i) {
    const double x = static_cast<double>(i * i), y = std::pow(partials[i - 1] / static_cast<double>(i), 2);
    n += 1;
    x_sum += x;
    y_sum += y;
    xx += x * x;
    xy += x * y;
  }
  const double slope = (n * xy - x_sum * y_sum) / (n * xx - x_sum * x_sum);
  return slope / ((y_sum - slope * x_sum) / n);
}

[[nodiscard]] inline Keyboard shipped_piano() {
  const EmbeddedFile* file = find_embedded(Shipped::kKeyboards, "piano.json");
  return parse_keyboard(file->content, file->name);
}

}  // namespace contactspline::testing
