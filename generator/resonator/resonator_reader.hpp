// SPDX-License-Identifier: MIT
// Resonator files (docs/reference/resonators.md).
#pragma once

#include <string>
#include <string_view>

#include "generator/resonator/radiation.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Parses the text of a resonator file: JSON with comments, SI units in the key names (docs/reference/resonators.md).
/// `file` stands in messages only. Throws BadInput.
[[nodiscard]] Resonator parse_resonator(std::string_view text, std::string_view file);

/// Reads the body of an object that has one of the keys string, bar, membrane, plate, round_plate. Throws BadInput.
[[nodiscard]] decltype(Resonator::body) read_shaped_body(const JsonObject& object);

/// Reads one of two words, the first one where the key is missing. Throws BadInput.
[[nodiscard]] std::string read_word(const JsonObject& object, const char* key, std::string_view first,
                                    std::string_view second);

/// Largest position on a body [m]: length or radius; 0 for a table of modes.
[[nodiscard]] double extent_of(const decltype(Resonator::body)& body);

/// Reads a place in the room: distance_m, angle_rad, around_rad and side_m.
[[nodiscard]] ListeningPlace read_listening_place(const JsonObject& object);

/// Throws BadInput unless the body that a key of a file names can be listened to in the room.
void check_radiation(const Resonator& resonator, std::string_view file, std::string_view key);

/// Throws BadInput if the distances from a body to a listening place, of this key, are too different.
void check_reach(const Reach& reach, std::string_view file, std::string_view key);

inline constexpr int kMaxModes = 4096;  ///< largest number of modes in one resonator

/// The largest `max_modes` of a body, which it has by default: fewer than kMaxModes for a plate with ribs.
[[nodiscard]] int max_modes_of(const decltype(Resonator::body)& body);

/// Ranges that files of resonators, instruments and scores have in common.
inline constexpr Range kTuningCents{-1200, 1200};
inline constexpr Range kModeFrequency_hz{0.1, 1e6};
inline constexpr Range kModeDecay_per_s{0, 1e6};
inline constexpr Range kModalMass_kg{1e-9, 1e4};
inline constexpr Range kPlaceAngle_rad{-7, 7};
inline constexpr Range kModeShape{-1e6, 1e6};
inline constexpr Range kLongitudinalLoss{10, 1e4};  // gone before a key that is damped falls asleep
inline constexpr Range kLongitudinalQuadratic{0, 1e3};

}  // namespace contactspline
