// SPDX-License-Identifier: MIT
// Scores: what an instrument plays.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/data/model_parameters.hpp"
#include "contactspline/step/contact.hpp"
#include "generator/instrument/instrument.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// The pedals of a keyboard on its body: places among KeyboardParameter::kList.
[[nodiscard]] constexpr bool is_pedal(std::size_t parameter) {
  return parameter >= KeyboardParameter::kSustain && parameter <= KeyboardParameter::kUnaCorda;
}

/// A parameter that moves from its value at `time_s` to another one, within `over_s`, easing in and out; 0: at once.
struct Glide {
  double time_s;
  double over_s;
  std::size_t control;
  double to;
};

using SharedGlides = std::shared_ptr<const std::vector<Glide>>;

/// A hammer thrown at a resonator; after `hold_s` the damper falls, if no other note holds it.
struct Strike {
  double time_s;
  double speed_m_per_s;        ///< 0: a key is pressed without a blow
  double hold_s;               ///< infinite: for ever
  std::size_t strike = 0;      ///< of an instrument file: which mass is thrown
  double key_hold_s = hold_s;  ///< on a keyboard's body, where the score moves the pedals: by the key alone
  double release = 0;          ///< velocity with which the key is let go, 0 to 1; 0: none is known
};

/// A key of an instrument file that goes down and, after `hold_s`, up.
struct Note {
  double time_s;
  int key;                           ///< of MIDI
  double velocity;                   ///< 0 to 1
  double hold_s;                     ///< infinite: for ever
  double cents = 0;                  ///< above the pitch of the key
  std::size_t begins = 0, ends = 0;  ///< numbers of both; in one sample the lower comes first
};

/// A key of a keyboard, which is a hammer on its strings; or one instrument of a file.
struct Voice {
  std::string name;
  Resonator resonator;
  std::vector<Segment<double>> contact;       ///< table of the contact potential
  std::vector<Memory> memories = {};          ///< of the contact
  std::vector<double> initial;                ///< values of the controls before the first event
  std::vector<Glide> glides;                  ///< by rising time; none if it has `bends`
  std::vector<Strike> strikes;                ///< by rising time
  std::vector<Note> notes = {};               ///< by rising time; of an instrument file with keys
  Damper damper = {};                         ///< of a key of a keyboard
  double strings = 1;                         ///< number of identical strings that the resonator stands for
  double pan = 0;                             ///< -1 left to 1 right
  std::size_t key = 0;                        ///< among the keys of the score
  double bend_cents = 0;                      ///< beside `bends`
  SharedGlides bends = {};                    ///< of a MIDI channel, which all its voices share; may be null
  std::optional<InstrumentModel> model = {};  ///< of an instrument file: in place of a hammer on strings
};

inline constexpr Range kLevel_db{-200, 0};  ///< of a peak, relative to full scale

struct Score {
  std::string file;         ///< that it was read from, for messages
  std::string description;  ///< one line, may be empty
  double duration_s;
  std::vector<Voice> voices;                    ///< at least one
  std::optional<Resonator> body = {};           ///< of a keyboard: its strings end at it, and it moves them
  std::optional<Resonator> knock = {};          ///< that keys strike when they are played
  std::vector<BridgePlace> bridge_places = {};  ///< of the body under a keyboard
  std::vector<ListeningPlace> ears = {};        ///< in the room before it
  std::vector<KeyParts> keys = {};              ///< on the body, also those that are not played; without felts
  double una_corda_stiffness_ratio = 1;         ///< of all felts
  Listening listening = {};                     ///< the sound of the body under a keyboard
  std::vector<Glide> pedals = {};               ///< by rising time; of KeyboardParameter, all up at first
  std::vector<double> silences_s = {};          ///< by rising time; when all that sounds stops
  int oversampling = 1;                         ///< its models run at so many times the rate: one of kOversamplings
  std::optional<double> level_db = {};          ///< of the peak of its sound; empty: what a program chooses
  double ring_s = 0;                            ///< of the duration, behind the last note of a MIDI file
  std::string left_out = {};                    ///< what of a MIDI file is not played, in one line; empty: nothing
  std::string left_out_at_rest = {};            ///< the same without the body, as a list
};

/// The instrument of a file that plays a score; null for a keyboard.
[[nodiscard]] inline const InstrumentModel* model_of(const Score& score) {
  const std::optional<InstrumentModel>& model = score.voices.front().model;
  return model ? &*model : nullptr;
}

}  // namespace contactspline
