// SPDX-License-Identifier: MIT
// What General MIDI strikes on the keys of the tenth channel (GM Level 1, percussion key map).
#pragma once

#include <array>
#include <string_view>

namespace contactspline {

inline constexpr int kFirstDrumKey = 35;
inline constexpr auto kDrumNames = std::to_array<std::string_view>(
    {"acoustic bass drum", "bass drum 1",   "side stick",     "acoustic snare", "hand clap",      "electric snare",
     "low floor tom",      "closed hi-hat", "high floor tom", "pedal hi-hat",   "low tom",        "open hi-hat",
     "low-mid tom",        "hi-mid tom",    "crash cymbal 1", "high tom",       "ride cymbal 1",  "Chinese cymbal",
     "ride bell",          "tambourine",    "splash cymbal",  "cowbell",        "crash cymbal 2", "vibraslap",
     "ride cymbal 2",      "hi bongo",      "low bongo",      "mute hi conga",  "open hi conga",  "low conga",
     "high timbale",       "low timbale",   "high agogo",     "low agogo",      "cabasa",         "maracas",
     "short whistle",      "long whistle",  "short guiro",    "long guiro",     "claves",         "hi wood block",
     "low wood block",     "mute cuica",    "open cuica",     "mute triangle",  "open triangle"});
static_assert(kFirstDrumKey + kDrumNames.size() - 1 == 81);

/// The drum on a key, empty where there is none.
[[nodiscard]] constexpr std::string_view drum_on(int key) {
  const int place = key - kFirstDrumKey;
  return place >= 0 && place < static_cast<int>(kDrumNames.size()) ? kDrumNames[static_cast<std::size_t>(place)] : "";
}

}  // namespace contactspline
