// SPDX-License-Identifier: MIT
// A keyboard of struck strings: every key's string and hammer, interpolated from some published notes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "contactspline/data/keyboard_parts.hpp"
#include "generator/material/material.hpp"
#include "generator/resonator/radiation.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/contact_spline.hpp"

namespace contactspline {

/// One note as published, with its whole hammer; its tension follows from the pitch of its key.
struct PublishedNote {
  int key;  ///< MIDI number
  double length_m, mass_kg, bending_stiffness_n_m2;
  Losses losses;
  double strike_position_m;
  double hammer_mass_kg;
  PowerLaw felt;
  /// How far the bridge moves where the strings of the key end, as a ratio of its motion where the body is struck.
  double bridge_ratio = 1;
  double output_ratio = 1;      ///< weight of the force of the key's strings in the sound
  double horizontal_ratio = 1;  ///< factor of both ratios of KeyboardBody::horizontal
};

/// A place at which the keys from first_key up to the next place's drive the body.
struct BridgePlace {
  int first_key;  ///< MIDI number
  Place place;    ///< on a plate; of a table of modes it is a column of bridge_shapes
};

/// How the strings of the keys up to last_key move along themselves.
struct KeyboardLongitudinal {
  double frequency_ratio;  ///< of the first mode along a string to that across it, without bending stiffness
  Losses losses;
  double output_ratio;  ///< weight of the longitudinal force on the bridge in the sound
  int last_key;         ///< MIDI number
};

/// The body that the strings end at, and what they are when each of them moves by itself.
struct KeyboardBody {
  std::string resonator;             ///< name of one that ships, or a file; struck at its bridge
  std::vector<double> double_hz;     ///< by how much the strings of a key that has two are out of tune
  std::vector<double> triple_hz;     ///< and three
  double una_corda_stiffness_ratio;  ///< ratio for the felt that strikes while the soft pedal is down
  Listening listening;               ///< the sound of the body
  std::string knock = {};            ///< resonator that a played key strikes, as `resonator`; empty: none
  HorizontalMotion horizontal = {};
  /// By rising key, at most kMaxBridgePlaces; empty: all keys drive the body where it is struck.
  std::vector<BridgePlace> bridge_places = {};
  /// Left and right ear in the room; empty: the sound is that of `listening`.
  std::vector<ListeningPlace> ears = {};
  std::optional<KeyboardLongitudinal> longitudinal = {};
};

/// As read from a keyboard file.
struct Keyboard {
  std::string name;                        ///< lower-case identifier
  std::string description;                 ///< one line, may be empty
  int first_key, last_key;                 ///< MIDI numbers, 60 is middle C
  int first_double_key, first_triple_key;  ///< from here on two, three strings a key
  int last_damped_key;                     ///< higher strings have no damper
  double concert_pitch_hz;                 ///< pitch of key 69, the A above middle C
  double min_speed_m_per_s,
      max_speed_m_per_s;             ///< hammer speeds at velocity 0 and 1; the felts' splines reach to max
  double felt_loss_s_per_m;          ///< Hunt-Crossley loss of all felts
  double damper_per_s;               ///< extra decay while the damper is down
  double damper_time_s;              ///< time constant with which the damper comes down
  int segments;                      ///< segments of the felt's spline
  std::vector<PublishedNote> notes;  ///< two or more, by rising key
  std::optional<KeyboardBody> body = {};
};

/// What one key moves: one of its strings, with its share of the hammer's mass and stiffness. All strings of a key
/// are alike, so all move like this one.
struct KeyboardNote {
  /// Tuned so that its first partial has the key's equal-tempered pitch. It loses bridge_loss_per_s more than on the
  /// body, for it ends at rest.
  StiffString string;
  double strike_position_m;
  int strings;
  double hammer_mass_kg;                                ///< share of one string
  Material felt;                                        ///< share of one string
  double pitch_hz;                                      ///< equal-tempered
  double bridge_ratio, output_ratio, horizontal_ratio;  ///< as in PublishedNote
  /// Decay that the body gives strings which move together, if its mobility is the same at all frequencies:
  /// 2 f Z Y r^2 for each, with pitch f, impedance Z = sqrt(T mu), mobility Y and bridge_ratio r (G. Weinreich, JASA
  /// 62, 1977).
  double bridge_loss_per_s;
  std::size_t bridge_place;  ///< number of the body's place where the strings end
};

/// The strings of a key on the keyboard's body, each by itself: detuned, with their own losses.
[[nodiscard]] StiffString strings_on_body(const KeyboardNote& note, const KeyboardBody& body);

/// Their horizontal motion.
[[nodiscard]] HorizontalMotion horizontal_motion(const KeyboardNote& note, const KeyboardBody& body);

/// Their longitudinal motion: E A follows from their tension. None above its last key.
[[nodiscard]] LongitudinalMotion longitudinal_motion(const KeyboardNote& note, const KeyboardBody& body, int key);

/// What a keyboard's file names: its body, and what its keys strike when they are played (the knock).
struct KeyboardResonators {
  std::optional<Resonator> body, knock;
  std::vector<BridgePlace> bridge_places = {};  ///< of the body, a plate or a table with as many bridge_shapes
  std::vector<ListeningPlace> ears = {};        ///< before the body, which then radiates: none or two
};

/// A mode of a keyboard's body, with its shapes at the places of the bridge, where keys knock, and at those of the
/// ears.
struct BodyMode {
  Mode mode;
  std::vector<double> bridge_shapes;
  double knock_shape, left_shape, right_shape;
};

/// The modes of body and knock below `max_frequency_hz`, none if there is no body. The strike is where keys knock
/// and, if the body has no bridge_places, the bridge; the pickup is the left ear, and the mirrored place on a plate
/// the right ear. Other resonators than plates and tables of modes have one place for both ears.
[[nodiscard]] std::vector<BodyMode> body_modes(const KeyboardResonators& resonators, double max_frequency_hz);

/// What the left and the right ear in the room hear of these modes, as Radiation; the taps of all places of the
/// bridge, place after place, equally many: body_modes(resonators, sample_rate_hz/2); none without ears.
[[nodiscard]] std::vector<BodyArrays::Ear> radiation_at_ears(const KeyboardResonators& resonators,
                                                             const std::vector<BodyMode>& modes,
                                                             double sample_rate_hz);

/// The bridge_shapes of all modes: those of the first place, then those of the second one, and so on.
[[nodiscard]] std::vector<double> bridge_shapes_of(const std::vector<BodyMode>& modes);

/// Speed [m/s] at which a velocity throws the hammer: min (max/min)^velocity; velocity from 0 to 1, clamped. Not a
/// number if the velocity is not.
[[nodiscard]] double strike_speed(const Keyboard& keyboard, double velocity);

/// The note of a key, first_key to last_key: exponent and hammer's mass linear in the key between the published notes
/// and beyond the outermost, everything else linear in its logarithm; rounded to six digits before anything follows
/// from it, so that every machine finds the same. parse_keyboard() has made sure that every key has a note.
[[nodiscard]] KeyboardNote note_of(const Keyboard& keyboard, int key);

/// The note as a resonator whose pickup is the bridge, at the string's far end: pickup shapes are the force on the
/// bridge per modal displacement [N/m] (docs/reference/keyboard.md).
[[nodiscard]] std::vector<ResonatorMode> modes_of(const KeyboardNote& note, double max_frequency_hz);

}  // namespace contactspline
