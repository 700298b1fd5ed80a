// SPDX-License-Identifier: MIT
// The parameters that tune a plug-in, as hosts and its window see them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "contactspline/midi/temperament.hpp"

namespace contactspline {

/// One of them: a number, or one of a list.
struct TuningParameter {
  const char *name, *symbol, *unit;
  float min, max, initial;
};

enum : std::uint32_t { kBendRange, kA4, kTemperament, kTonic };

inline constexpr std::array<const char*, 12> kTones = {"C",       "C sharp", "D",       "E flat", "E",      "F",
                                                       "F sharp", "G",       "G sharp", "A",      "B flat", "B"};
inline constexpr std::array<TuningParameter, 4> kTuningParameters = {
    {{"bend range", "bend_range", "semitones", 0, 96, 2},
     {"pitch of A4", "a4_hz", "Hz", 380, 500, 440},
     {"temperament", "temperament", "", 0, static_cast<float>(kTemperaments.size() - 1), 0},
     {"tonic", "tonic", "", 0, static_cast<float>(kTones.size() - 1), 0}}};

/// The names of the list of a parameter, from its value 0 on; of a number there are none.
[[nodiscard]] inline std::vector<std::string> tuning_entries(std::uint32_t number) {
  std::vector<std::string> names;
  if (number == kTemperament)
    for (const Temperament& temperament : kTemperaments) names.emplace_back(temperament.name);
  if (number == kTonic) names.assign(kTones.begin(), kTones.end());
  return names;
}

}  // namespace contactspline
