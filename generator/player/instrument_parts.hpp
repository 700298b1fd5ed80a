// SPDX-License-Identifier: MIT
// What the instruments of the runtime are built of, from the voices of a score.
#pragma once

#include <vector>

#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instrument/resonator_parts.hpp"
#include "generator/player/score.hpp"

namespace contactspline {

/// The resonator of a voice: its modes below half the sample rate. Throws BadInput where it has none.
[[nodiscard]] ResonatorParts resonator_parts(const Voice& voice, double sample_rate_hz);

[[nodiscard]] HammerStringParts hammer_string_parts(const Voice& voice, double sample_rate_hz);
[[nodiscard]] PluckedStringParts plucked_string_parts(const Voice& voice, double sample_rate_hz);
/// The arrays of an instrument file. Throws BadInput where a body has no mode below half the sample rate.
[[nodiscard]] InstrumentArrays instrument_arrays(const InstrumentModel& model, double sample_rate_hz);

/// The body of a score, with its modes below half the sample rate: places and what they read. bridge: as in
/// BoardOfKeyboard.
struct BodyArrays {
  std::vector<Mode> modes;
  std::vector<double> bridge, knock, left, right;
  std::vector<EarRadiation> ears;  ///< none or two, in the room
  double sample_rate_hz;

  [[nodiscard]] BodyPressure pressure() const {
    if (ears.empty()) return {};
    const auto ear = [&](std::size_t e) -> EarPressure {
      return {ears[e].of_velocity, ears[e].of_displacement, ears[e].taps};
    };
    return {ear(0), ear(1), sample_rate_hz};
  }
};
/// Throws BadInput where the body has no such mode.
[[nodiscard]] BodyArrays body_arrays(const Score& score, double sample_rate_hz);

/// Stands for a derived class where nobody calls note_on() or note_off(). It is never defined.
struct WithoutKeysOfMidi;

/// The keyboard of a score on its body, with at most `max_modes` modes of each string. The score must outlive it.
/// Derived: the class that derives from this one, with first_key() and speed_of() for the keys of MIDI.
template <std::floating_point T, typename Derived = WithoutKeysOfMidi>
class KeyboardOfScore : public PedaledKeyboard<Derived, T> {
  using Base = PedaledKeyboard<Derived, T>;
  static constexpr std::size_t kAllModes = 4096;

 public:
  KeyboardOfScore(const Score& score, double sample_rate_hz, std::size_t max_modes = kAllModes)
      : KeyboardOfScore(score, {score}, body_arrays(score, sample_rate_hz), sample_rate_hz, max_modes) {}

  static std::span<const Preset> presets() { return {}; }

 private:
  /// Felts of each key; any other where no voice plays it, for nothing is struck there.
  struct Felts {
    Felts(const Score& score)  // NOLINT(google-explicit-constructor)
        : tables(score.keys.size()), memories(score.keys.size()) {
      for (const Voice& voice : score.voices) {
        tables[voice.key] = table_in<T>(voice.contact);
        memories[voice.key] = voice.memories;
      }
      for (auto& table : tables)
        if (table.empty()) table = table_in<T>(score.voices.front().contact);
    }
    std::vector<std::vector<Segment<T>>> tables;
    std::vector<std::vector<Memory>> memories;
  };

  KeyboardOfScore(const Score& score, Felts felts, const BodyArrays& body, double sample_rate_hz,
                  std::size_t max_modes)
      : Base(keys_of(score, felts),
             {body.modes, body.bridge, body.left, body.right, score.listening, body.knock, body.pressure()},
             sample_rate_hz, max_modes),
        felts_(std::move(felts)) {
    this->set_soft_ratio(score.una_corda_stiffness_ratio);
  }

  static std::vector<KeyOnBody<T>> keys_of(const Score& score, const Felts& felts) {
    std::vector<KeyOnBody<T>> keys;
    for (std::size_t k = 0; k < score.keys.size(); ++k) {
      const KeyOnBody<double>& key = score.keys[k];
      keys.push_back({key.strings,
                      key.strike_position_m,
                      felts.tables[k],
                      {.hammer_mass_kg = static_cast<T>(key.hammer.hammer_mass_kg)},
                      key.damper,
                      felts.memories[k],
                      key.bridge_ratio,
                      key.output_ratio,
                      key.horizontal,
                      key.bridge_place,
                      key.longitudinal});
    }
    return keys;
  }

  Felts felts_;
};

}  // namespace contactspline
