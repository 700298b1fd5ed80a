// SPDX-License-Identifier: MIT
// Scales and key maps of Scala, and the pitches that they mean by closed forms.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace contactspline::testing {

struct TuningCase {
  std::string test, scale, keymap;  ///< texts; empty: none
  std::optional<double> a4_hz;
  std::function<double(int)> hz;  ///< of a key; not a number: it does not sound
};

namespace tunings {

inline constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kMiddleC_hz = 261.6255653005986346778;  // 440 Hz down nine semitones

inline std::string scale(const std::vector<std::string>& pitches) {
  std::string text = fmt::format("! probe.scl\n!\nA scale\n {}\n!\n", pitches.size());
  for (const std::string& pitch : pitches) text += " " + pitch + "\n";
  return text;
}
/// So many equal tones in an interval, whose last pitch is `last`.
inline std::string equal(int tones, double cents, const std::string& last) {
  std::vector<std::string> pitches;
  for (int n = 1; n < tones; ++n) pitches.push_back(fmt::format("{:.9f}", n * cents / tones));
  pitches.push_back(last);
  return scale(pitches);
}
/// first and last key, key of the first entry, reference key and its frequency, degree of the octave, entries.
inline std::string keymap(int size, int first, int last, int middle, int reference, const std::string& hz, int octave,
                          const std::string& entries = {}) {
  return fmt::format("! probe.kbm\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n! Mapping\n{}", size, first, last, middle, reference,
                     hz, octave, entries);
}

inline int floor_of(int a, int b) {
  return static_cast<int>(std::floor(double(a) / b));
}

/// Equal steps, of which so many make a ratio, through a pitch of a key.
inline std::function<double(int)> steps(double ratio, int tones, int key = 60, double hz = kMiddleC_hz) {
  return [=](int k) { return hz * std::pow(ratio, double(k - key) / tones); };
}
/// Ratios above the first tone, the last of which is where they begin again.
inline std::function<double(int)> ratios(const std::vector<double>& all, int key = 60, double hz = kMiddleC_hz) {
  return [=](int k) {
    const int tones = static_cast<int>(all.size()), period = floor_of(k - key, tones),
              tone = k - key - period * tones;
    return hz * std::pow(all.back(), period) * (tone == 0 ? 1 : all[static_cast<std::size_t>(tone - 1)]);
  };
}
inline double cents(double c) {
  return std::exp2(c / 1200);
}

inline const std::vector<double> kJust = {16 / 15.0, 9 / 8.0, 6 / 5.0, 5 / 4.0, 4 / 3.0,  45 / 32.0,
                                          3 / 2.0,   8 / 5.0, 5 / 3.0, 9 / 5.0, 15 / 8.0, 2};
inline const std::string kJustScale =
    scale({"16/15", "9/8", "6/5", "5/4", "4/3", "45/32", "3/2", "8/5", "5/3", "9/5", "15/8", "2/1"});

/// Quarter-comma meantone: fifths of 5^(1/4) from E flat to G sharp.
inline std::vector<double> meantone() {
  std::vector<double> all;
  for (const int fifths : {7, 2, -3, 4, -1, 6, 1, 8, 3, -2, 5}) {
    const double ratio = std::pow(5, fifths / 4.0);
    all.push_back(ratio / std::exp2(std::floor(std::log2(ratio))));
  }
  all.push_back(2);
  return all;
}
inline std::string scale_of(const std::vector<double>& all) {
  std::vector<std::string> pitches;
  for (const double ratio : all) pitches.push_back(fmt::format("{:.9f}", 1200 * std::log2(ratio)));
  return scale(pitches);
}

/// White keys play a scale of seven tones, black keys nothing.
inline double on_white_keys(const std::vector<double>& all, int key, int first, double hz) {
  constexpr int kDegree[] = {0, -1, 1, -1, 2, 3, -1, 4, -1, 5, -1, 6};
  const int octave = floor_of(key - first, 12), degree = kDegree[key - first - 12 * octave];
  return degree < 0 ? kGap : hz * std::exp2(octave) * (degree == 0 ? 1 : all[static_cast<std::size_t>(degree - 1)]);
}
inline const std::vector<double> kPtolemy = {9 / 8.0, 5 / 4.0, 4 / 3.0, 3 / 2.0, 5 / 3.0, 15 / 8.0, 2};
inline const std::string kPtolemyScale = scale({"9/8", "5/4", "4/3", "3/2", "5/3", "15/8", "2"});
inline const std::string kWhiteKeys = "0\nx\n1\nx\n2\n3\nx\n4\nx\n5\nx\n6\n";

inline std::vector<TuningCase> all() {
  const double a4 = 440, c4 = kMiddleC_hz;
  const auto in_range = [](int first, int last, const std::function<double(int)>& hz) {
    return [=](int key) { return key < first || key > last ? 440 * std::exp2((key - 69) / 12.0) : hz(key); };
  };
  return {
      {"Equal12", equal(12, 1200, "2/1"), {}, {}, steps(2, 12)},
      {"Equal19", equal(19, 1200, "2/1"), {}, {}, steps(2, 19)},
      {"Equal31", equal(31, 1200, "1200.0"), {}, {}, steps(2, 31)},
      {"Equal53", equal(53, 1200, "2"), {}, {}, steps(2, 53)},
      {"Equal5", equal(5, 1200, "1200.000 cents"), {}, {}, steps(2, 5)},
      {"Equal24From48", equal(24, 1200, "2/1"), keymap(0, 0, 127, 48, 69, "440.0", 0), {}, steps(2, 24, 69, a4)},
      {"BohlenPierce", equal(13, 1200 * std::log2(3), "3/1"), {}, {}, steps(3, 13)},
      {"StepsOf78Cents", scale({"78."}), {}, {}, steps(cents(78), 1)},
      {"Just", kJustScale, {}, {}, ratios(kJust)},
      {"JustWithA4", kJustScale, {}, 442, ratios(kJust, 60, 442 / kJust[8])},
      {"Meantone", scale_of(meantone()), {}, 415, ratios(meantone(), 60, 415 / meantone()[8])},
      {"HarmonicsEightToSixteen",
       scale({"9/8", "10/8", "11/8", "12/8", "13/8", "14/8", "15/8", "16/8"}),
       {},
       {},
       ratios({9 / 8.0, 10 / 8.0, 11 / 8.0, 12 / 8.0, 13 / 8.0, 14 / 8.0, 15 / 8.0, 2})},
      {"CentsAndRatios", scale({"203.91", "3/2", "2"}), {}, {}, ratios({cents(203.91), 1.5, 2})},
      {"DownwardsAndUp", scale({"-50.0", "700.0", "2/1"}), {}, {}, ratios({cents(-50), cents(700), 2})},
      {"WindowsLinesAndComments",
       "! a\r\n\r\n 2 tones\r\n! b\r\n\t4/3 a fourth\r\n2/1 ! an octave\r\nleft out\r\n",
       {},
       {},
       ratios({4 / 3.0, 2})},
      {"GapsOnBlackKeys",
       kPtolemyScale,
       keymap(12, 0, 127, 60, 69, "440.0", 7, kWhiteKeys),
       {},
       [=](int key) { return on_white_keys(kPtolemy, key, 60, a4 / kPtolemy[4]); }},
      {"GapsAtTheEnd",
       kPtolemyScale,
       keymap(12, 0, 127, 48, 48, "130", 7, "0\n1\n2\n"),
       {},
       [](int key) {
         const int octave = floor_of(key - 48, 12), entry = key - 48 - 12 * octave;
         return entry > 2 ? kGap : 130 * std::exp2(octave) * (entry == 0 ? 1 : kPtolemy[std::size_t(entry - 1)]);
       }},
      {"RangeOfKeys",
       kJustScale,
       keymap(0, 48, 72, 60, 60, "260.0", 0),
       {},
       in_range(48, 72, ratios(kJust, 60, 260))},
      {"MapOfNineteenOnTwelve",
       equal(19, 1200, "2/1"),
       keymap(12, 0, 127, 60, 60, fmt::format("{:.12f}", c4), 19, "0\n1\n3\n5\n6\n8\n9\n11\n12\n14\n16\n17\n"),
       {},
       [=](int key) {
         constexpr int kDegree[] = {0, 1, 3, 5, 6, 8, 9, 11, 12, 14, 16, 17};
         const int octave = floor_of(key - 60, 12);
         return c4 * std::exp2(octave + kDegree[key - 60 - 12 * octave] / 19.0);
       }},
      {"OctaveOfTheMapInsideTheScale",
       equal(13, 1200 * std::log2(3), "3/1"),
       keymap(2, 0, 127, 60, 60, "250", 4, "0\n3"),
       {},
       [](int key) {
         const int pattern = floor_of(key - 60, 2);
         return 250 * std::pow(3, (4 * pattern + 3 * (key - 60 - 2 * pattern)) / 13.0);
       }},
      {"A4Alone", {}, {}, 432, steps(2, 12, 69, 432)},
      {"KeyMapAlone", {}, keymap(0, 0, 127, 60, 57, "221.5", 0), {}, steps(2, 12, 57, 221.5)},
  };
}

}  // namespace tunings
}  // namespace contactspline::testing
