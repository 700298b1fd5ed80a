// SPDX-License-Identifier: MIT
// Scores: what an instrument plays.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/contact.hpp"
#include "contactspline/hammer_voice.hpp"
#include "contactspline/keyboard_instrument.hpp"
#include "generator/instrument/instrument.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// kFile: what an instrument file describes.
enum class Instrument { kHammerString, kSlideString, kFretString, kFile };

/// A live control of an instrument, as scores name it.
struct ControlName {
  const char* name;
  Range range;
  double initial;  ///< NaN: a score must set it at time 0
};

/// Places of the controls among a voice's values.
struct HammerStringControl {
  enum : std::size_t { kHammerMass, kStiffnessRatio, kLoss, kDamping, kPlace, kBend };
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

/// The pedals of a keyboard on its body, as scores name them, in the order of MIDI's controllers 64, 66, 67.
struct PedalControl {
  enum : std::size_t { kSustain, kSostenuto, kUnaCorda };
};
[[nodiscard]] std::span<const ControlName> pedal_controls();

/// What scores and the command line call an instrument, and what a score may say of it. kFile has its name only:
/// `note` is null, and both lists are empty.
struct InstrumentRules {
  std::string_view name;                    ///< hammer-string, slide-string, fret-string, instrument
  std::span<const ControlName> controls;    ///< in the order of the enumerations above
  const char* note;                         ///< the key of an event that plays; null for kFile
  std::size_t pluck_force;                  ///< the control that a pluck moves
  std::span<const char* const> voice_keys;  ///< beside name, resonator, material, tuning_cents, pan
};

[[nodiscard]] const InstrumentRules& rules_of(Instrument instrument);

[[nodiscard]] inline std::string_view name_of(Instrument instrument) {
  return rules_of(instrument).name;
}

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
  double speed_m_per_s;        ///< 0: a key is pressed without a blow
  double hold_s;               ///< infinite: for ever
  std::size_t strike = 0;      ///< of an instrument file: which mass is thrown
  double key_hold_s = hold_s;  ///< on a keyboard's body, where the score moves the pedals: by the key alone
};

/// One resonator with its hammer, slide or fret, or one instrument of a file.
struct Voice {
  std::string name;
  Resonator resonator;
  std::vector<Segment<double>> contact;       ///< table of the contact potential
  std::vector<double> initial;                ///< values of the controls before the first event
  std::vector<Glide> glides;                  ///< by rising time
  std::vector<Strike> strikes;                ///< by rising time; hammer-string
  Damper damper = {};                         ///< hammer-string
  double pluck_m = 0;                         ///< place of the pluck; slide-string and fret-string
  double height_m = 0;                        ///< of the slide before the string at the beginning; slide-string
  double strings = 1;                         ///< number of identical strings that the resonator stands for
  double pan = 0;                             ///< -1 left to 1 right
  std::size_t key = 0;                        ///< among the keys of the score
  std::optional<InstrumentModel> model = {};  ///< of an instrument file: replaces resonator and contact
};

struct Score {
  std::string file;  ///< that it was read from, for messages
  Instrument instrument;
  std::string description;  ///< one line, may be empty
  double duration_s;
  std::vector<Voice> voices;
  std::optional<Resonator> body = {};  ///< that all strings end at; struck at its bridge; on a keyboard it moves them
  std::vector<KeyOnBody<double>> keys = {};  ///< on the body, also those that are not played; without felts
  double una_corda_stiffness_ratio = 1;      ///< of all felts
  std::vector<Glide> pedals = {};            ///< by rising time; of PedalControl, all up at first
  std::string left_out = {};                 ///< what of a MIDI file is not played, in one line; empty: nothing
  std::string left_out_at_rest = {};         ///< the same without the body, as a list
};

}  // namespace contactspline
