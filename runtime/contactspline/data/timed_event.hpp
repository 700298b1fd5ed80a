// SPDX-License-Identifier: MIT
// What happens to an instrument, and when: the one form in which scores, data sets and hosts say it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cstddef>
#include <limits>

#include "contactspline/data/parameter.hpp"

namespace contactspline {

/// What an event does. Bindings for other languages know these numbers.
enum class Action : int {
  kStrike = 0,     ///< number: of a strike; value: speed [m/s]; 0 lifts the damper without a blow
  kRelease = 1,    ///< number: of a strike, whose damper comes down
  kPluck = 2,      ///< number: of a pluck; value: force [N]
  kNoteOn = 3,     ///< number: key of MIDI; value: velocity, 0 to 1
  kNoteOff = 4,    ///< number: key of MIDI; value: release velocity, 0 to 1, or 0 where none is known
  kSet = 5,        ///< number: of a parameter; value: in its unit
  kBendKey = 6,    ///< number: key of MIDI; value: cents above its own pitch
  kDampKey = 7,    ///< number: key of MIDI; value: damping beside the damper's [1/s]
  kPlaceKey = 8,   ///< number: key of MIDI; value: place of its hammer from the next strike on [m]
  kBow = 9,        ///< number: of a bow; value: its acceleration [m/s^2]; 0 lifts it
  kMoveKey = 10,   ///< number: key of MIDI; value: how far above the value of all its `parameter` is [its unit]
  kLevelKey = 11,  ///< number: key of MIDI; value: its gain, 0 to 4
  kPanKey = 12     ///< number: key of MIDI; value: -1, left, to 1, right
};

/// What plays an event of a kind.
[[nodiscard]] constexpr Action action_of(EventKind kind) {
  constexpr Action kActions[] = {Action::kStrike, Action::kPluck, Action::kBow};
  return kActions[static_cast<std::size_t>(kind)];
}

/// An event of a performance. Numbers that an instrument lacks do nothing, nor do actions on single keys where it has
/// no voice for each key.
struct TimedEvent {
  /// As the value of a strike, a pluck or a bow: the one that its parameter has at that time.
  static constexpr double kOfParameter = std::numeric_limits<double>::quiet_NaN();

  std::size_t sample;  ///< from the beginning of the performance, or of the block that it is given with
  Action action;
  std::size_t number;
  double value = 0;
  double rise_s = 0;          ///< of a pluck
  std::size_t parameter = 0;  ///< of kMoveKey
};

/// The books of energy of an instrument [J], and what has happened in it.
struct Books {
  double stored_j = 0;
  double string_j = 0;            ///< the same without a hammer that flies
  double work_j = 0, heat_j = 0;  ///< work of hands and controls and losses over the last sample, of a network
  std::size_t contacts = 0;       ///< that have begun, of a keyboard
  std::size_t failures = 0;       ///< how often a keyboard came to rest because it was not finite
};

}  // namespace contactspline
