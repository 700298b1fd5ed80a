// SPDX-License-Identifier: MIT
// Published temperaments of twelve tones, as hosts offer them by name.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "contactspline/midi/key_tuning.hpp"

namespace contactspline {

/// A temperament by its fifths: that on C, that on the G above it, and so on to that on F. Each is narrower than 3/2
/// by a part of the Pythagorean comma and a part of the syntonic one; all twelve together by one Pythagorean comma.
struct Temperament {
  const char* name;
  std::array<double, 12> of_pythagorean, of_syntonic;
};

inline const double kPythagoreanComma_cents = 1200 * std::log2(std::pow(3.0, 12) / std::pow(2.0, 19));
inline const double kSyntonicComma_cents = 1200 * std::log2(81.0 / 80);

/// Sources: J. M. Barbour, Tuning and Temperament (1951); Werckmeister 1691, Kirnberger 1779, Vallotti as Barbour has
/// it, Young's second of 1800; just intonation with 45/32 and 9/5. The wolf of the first ones is on G sharp.
inline constexpr std::array<Temperament, 8> kTemperaments = {{
    {"equal",
     {1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12, 1. / 12},
     {}},
    {"Pythagorean", {0, 0, 0, 0, 0, 0, 0, 0, 1}, {}},
    {"meantone, a quarter of a comma",
     {0, 0, 0, 0, 0, 0, 0, 0, 1},
     {.25, .25, .25, .25, .25, .25, .25, .25, -2.75, .25, .25, .25}},
    {"just", {0, 0, 0, 0, 0, 0, 1}, {0, 0, 1, 0, 0, 0, -2, 0, 0, 0, 1}},
    {"Werckmeister III", {.25, .25, .25, 0, 0, .25}, {}},
    {"Kirnberger III", {0, 0, 0, 0, 0, 0, 1}, {.25, .25, .25, .25, 0, 0, -1}},
    {"Vallotti", {1. / 6, 1. / 6, 1. / 6, 1. / 6, 1. / 6, 0, 0, 0, 0, 0, 0, 1. / 6}, {}},
    {"Young", {1. / 6, 1. / 6, 1. / 6, 1. / 6, 1. / 6, 1. / 6}, {}},
}};

/// Cents of all keys above equal temperament at 440 Hz: in a temperament whose C is `tonic`, 0 (C) to 11 (B), with A4
/// at a pitch [Hz].
[[nodiscard]] inline KeyCents tempered_keys(const Temperament& temperament, std::size_t tonic, double a4_hz) {
  std::array<double, 12> above_equal{};  // of each degree
  double cents = 0;
  for (std::size_t fifth = 0, degree = 0; fifth < 11; ++fifth) {
    cents += kPythagoreanComma_cents * (1. / 12 - temperament.of_pythagorean[fifth]) -
             kSyntonicComma_cents * temperament.of_syntonic[fifth];
    degree = (degree + 7) % 12;
    above_equal[degree] = cents;
  }
  const auto of_key = [&](std::size_t key) { return above_equal[(key + 12 - tonic % 12) % 12]; };
  KeyCents keys{};
  for (std::size_t key = 0; key < kMidiKeys; ++key)
    keys[key] = of_key(key) - of_key(69) + 1200 * std::log2(a4_hz / 440);
  return keys;
}

}  // namespace contactspline
