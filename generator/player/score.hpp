// SPDX-License-Identifier: MIT
// Scores: what an instrument plays.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/data/model_parameters.hpp"
#include "contactspline/step/contact.hpp"
#include "generator/instrument/instrument.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// What plays a score; kFile: what an instrument file describes.
enum class Model { kHammerString, kSlideString, kFretString, kFile };

/// Those whose voices have parts of their own: a resonator and a material.
inline constexpr std::array kModelsWithParts = {Model::kHammerString, Model::kSlideString, Model::kFretString};

/// What scores and the command line call a model, and what a score may say of it. kFile has its name only: the lists
/// are empty.
struct ModelRules {
  std::string_view name;                  ///< hammer-string, slide-string, fret-string, instrument
  std::span<const Parameter> parameters;  ///< first value NaN: a voice or a score at time 0 must set it
  std::span<const Event> events;
  std::size_t pluck_force;                  ///< the parameter that a pluck moves
  std::span<const char* const> voice_keys;  ///< beside name, resonator, material, tuning_cents, pan
};

[[nodiscard]] const ModelRules& rules_of(Model model);

[[nodiscard]] inline std::string_view name_of(Model model) {
  return rules_of(model).name;
}

/// The same name as an identifier, such as hammer_string.
[[nodiscard]] std::string identifier_of(Model model);

/// The model with parts of that identifier, or nothing.
[[nodiscard]] std::optional<Model> model_with_parts(std::string_view identifier);

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

/// One resonator with its hammer, slide or fret, or one instrument of a file.
struct Voice {
  std::string name;
  Resonator resonator;
  std::vector<Segment<double>> contact;       ///< table of the contact potential
  std::vector<Memory> memories = {};          ///< of the contact
  std::vector<double> initial;                ///< values of the controls before the first event
  std::vector<Glide> glides;                  ///< by rising time; none if it has `bends`
  std::vector<Strike> strikes;                ///< by rising time; hammer-string
  std::vector<Note> notes = {};               ///< by rising time; of an instrument file with keys
  Damper damper = {};                         ///< hammer-string
  double pluck_m = 0;                         ///< place of the pluck; slide-string and fret-string
  double height_m = 0;                        ///< of the slide before the string at the beginning; slide-string
  double strings = 1;                         ///< number of identical strings that the resonator stands for
  double pan = 0;                             ///< -1 left to 1 right
  std::size_t key = 0;                        ///< among the keys of the score
  double bend_cents = 0;                      ///< beside `bends`
  SharedGlides bends = {};                    ///< of a MIDI channel, which all its voices share; may be null
  std::optional<InstrumentModel> model = {};  ///< of an instrument file: replaces resonator and contact
};

inline constexpr Range kLevel_db{-200, 0};  ///< of a peak, relative to full scale

struct Score {
  std::string file;  ///< that it was read from, for messages
  Model model;
  std::string description;  ///< one line, may be empty
  double duration_s;
  std::vector<Voice> voices;
  std::optional<Resonator> body = {};  ///< that all strings end at; struck at its bridge; on a keyboard it moves them
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

}  // namespace contactspline
