// SPDX-License-Identifier: MIT
#include "generator/player/instrument_parts.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "contactspline/data/model_parameters.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

[[noreturn]] void refuse_rate(const std::string& what, double sample_rate_hz) {
  throw BadInput(
      fmt::format("--rate: no mode of {} lies below {} Hz; allowed: a higher rate", what, sample_rate_hz / 2));
}

template <typename Row>
std::vector<double> each(const std::vector<Row>& rows, double Row::*member) {
  std::vector<double> values;
  for (const Row& row : rows) values.push_back(row.*member);
  return values;
}

}  // namespace

ResonatorParts resonator_parts(const Voice& voice, double sample_rate_hz) {
  const Resonator& resonator = voice.resonator;
  const auto modes = numbered_modes_of(resonator, sample_rate_hz / 2).modes;
  if (modes.empty()) refuse_rate(fmt::format("voice {} ({})", voice.name, resonator.name), sample_rate_hz);
  ResonatorParts parts;
  parts.modes = bare(modes);
  parts.wavenumbers_per_m = each(modes, &NumberedMode::wavenumber_per_m);
  for (const NumberedMode& mode : modes) parts.pickup.push_back(pickup_shape(resonator, mode));
  parts.length_m = extent_of(resonator.body);
  parts.strike_m = resonator.strike.position_m;
  parts.strike_shapes = [struck = resonator, modes](double place_m, std::span<double> shapes) mutable {
    struck.strike.position_m = place_m;
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] = strike_shape(struck, modes[i]);
  };
  if (const auto* string = std::get_if<StiffString>(&resonator.body)) {
    for (const NumberedMode& mode : modes) parts.bridge.push_back(voice.strings * bridge_shape(*string, mode));
    parts.string = *string;
  }
  return parts;
}

HammerStringParts hammer_string_parts(const Voice& voice, double sample_rate_hz) {
  return {.resonator = resonator_parts(voice, sample_rate_hz),
          .felt = voice.contact,
          .hammer_mass_kg = voice.initial[HammerStringParameter::kHammerMass],
          .loss_s_per_m = voice.initial[HammerStringParameter::kLoss],
          .damper = voice.damper,
          .memories = voice.memories};
}

InstrumentArrays instrument_arrays(const InstrumentModel& model, double sample_rate_hz) {
  if (const auto body = silent_body(model, sample_rate_hz / 2)) refuse_rate(*body, sample_rate_hz);
  return arrays_of(model, sample_rate_hz / 2);
}

BodyArrays body_arrays(const Score& score, double sample_rate_hz) {
  const KeyboardResonators resonators{score.body, score.knock, score.bridge_places, score.ears};
  const auto modes = body_modes(resonators, sample_rate_hz / 2);
  if (modes.empty()) refuse_rate(score.body->name, sample_rate_hz);
  return {bare(modes),
          bridge_shapes_of(modes),
          each(modes, &BodyMode::knock_shape),
          each(modes, &BodyMode::left_shape),
          each(modes, &BodyMode::right_shape),
          radiation_at_ears(resonators, modes, sample_rate_hz),
          sample_rate_hz};
}

KeyboardParts keyboard_parts(const Score& score) {
  constexpr std::size_t kAllModes = 4096;
  KeyboardParts parts{.name = score.file,
                      .description = score.description,
                      .first_key = 0,
                      .keys = score.keys,
                      .body = [&score](double sample_rate_hz) { return body_arrays(score, sample_rate_hz); },
                      .listening = score.listening,
                      .has_ears = !score.ears.empty(),
                      .una_corda_stiffness_ratio = score.una_corda_stiffness_ratio,
                      .max_modes = kAllModes};
  for (KeyParts& key : parts.keys) key.felt = score.voices.front().contact;
  for (const Voice& voice : score.voices) {
    parts.keys[voice.key].felt = voice.contact;
    parts.keys[voice.key].memories = voice.memories;
  }
  return parts;
}

KeyboardParts keyboard_parts(const Keyboard& keyboard, std::shared_ptr<const Score> score) {
  KeyboardParts parts = keyboard_parts(*score);
  parts.name = keyboard.name;
  parts.description = keyboard.description;
  parts.first_key = keyboard.first_key;
  parts.body = [score = std::move(score)](double sample_rate_hz) { return body_arrays(*score, sample_rate_hz); };
  parts.min_speed_m_per_s = keyboard.min_speed_m_per_s;
  parts.max_speed_m_per_s = keyboard.max_speed_m_per_s;
  parts.felt_loss_s_per_m = keyboard.felt_loss_s_per_m;
  parts.max_modes = KeyboardParts{}.max_modes;
  return parts;
}

}  // namespace contactspline
