// SPDX-License-Identifier: MIT
// Scores: what an instrument plays, from a file to values that `play` takes (docs/scores.md).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/contact.hpp"
#include "generator/contact_input.hpp"
#include "generator/json_input.hpp"
#include "generator/resonator.hpp"

namespace contactspline {

enum class Instrument { kHammerString, kSlideString, kFretString };

/// As scores and the command line name it: hammer-string, slide-string, fret-string.
[[nodiscard]] std::string_view name_of(Instrument instrument);

/// A live control of an instrument, as scores name it.
struct ControlName {
  const char* name;
  Range range;
  double initial;  ///< NaN: a score must set it at time 0
};

/// Places of the controls among a voice's values.
struct HammerStringControl {
  enum : std::size_t { kHammerMass, kStiffnessRatio, kLoss, kDamping, kPlace };
};
struct SlideStringControl {
  enum : std::size_t {
    kPlace,
    kSlideMass,
    kHandForce,
    kHandStiffness,
    kHandResistance,
    kRestResistance,
    kPluckForce,
    kStiffnessRatio,
    kLoss,
    kVibratoDepth,
    kVibratoRate
  };
};
struct FretStringControl {
  enum : std::size_t { kPlace, kGap, kPluckForce, kDamping, kStiffnessRatio, kLoss };
};

/// The controls of an instrument, in the order of the enumerations above.
[[nodiscard]] std::span<const ControlName> controls_of(Instrument instrument);

/// A control that moves from its value at `time_s` to another one, within `over_s`, easing in and out; 0: at once.
struct Glide {
  double time_s;
  double over_s;
  std::size_t control;
  double to;
};

/// A hammer thrown at a resonator; after `hold_s` the damper falls, if no other note holds it.
struct Strike {
  double time_s;
  double speed_m_per_s;
  double hold_s;  ///< infinite: for ever
};

/// One resonator with its hammer, slide or fret.
struct Voice {
  std::string name;
  Resonator resonator;
  std::vector<Segment<double>> contact;  ///< table of the contact potential
  std::vector<double> initial;           ///< values of the controls before the first event
  std::vector<Glide> glides;             ///< by rising time
  std::vector<Strike> strikes;           ///< by rising time; hammer-string
  double damper_per_s = 0;               ///< extra decay while the damper is down; hammer-string
  double pluck_m = 0;                    ///< place of the pluck; slide-string and fret-string
  double height_m = 0;                   ///< of the slide before the string at the beginning; slide-string
  double strings = 1;                    ///< so many that all move like the resonator
  double pan = 0;                        ///< -1 left to 1 right
};

struct Score {
  Instrument instrument;
  std::string description;  ///< one line, may be empty
  double duration_s;
  std::vector<Voice> voices;
};

/// Parses the text of a score: JSON with comments (docs/scores.md). `file` stands in messages only; `read` gives the
/// files it names. Throws BadInput.
[[nodiscard]] Score parse_score(std::string_view text, std::string_view file, const ReadFile& read);

/// The notes of a MIDI file on the piano that ships, with 1 s to ring after the last one. The velocity throws the
/// hammer at 0.2 m/s times 30^(velocity/127), as in instruments.lib. Throws BadInput.
[[nodiscard]] Score parse_midi_score(std::string_view bytes, std::string_view file);

}  // namespace contactspline
