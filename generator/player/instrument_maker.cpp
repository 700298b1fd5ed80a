// SPDX-License-Identifier: MIT
#include "generator/player/instrument_maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/host/engine.hpp"
#include "contactspline/host/model_module.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/player/instrument_parts.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

namespace {

template <std::floating_point T>
Handle<T> of_module(const ModelModule& module) {
  if constexpr (std::same_as<T, float>)
    if (module.make_single != nullptr) return module.make_single();
  if constexpr (std::same_as<T, double>)
    if (module.make_double != nullptr) return module.make_double();
  throw std::logic_error("of_module: the module computes in the other precision");
}

// What plays a voice. Throws BadInput where it has no mode below half the rate.
template <std::floating_point T>
Handle<T> instrument_of(const Voice& voice, double sample_rate_hz) {
  if (!voice.model) return Engine<T>::hammer_string(hammer_string_parts(voice, sample_rate_hz));
  if (voice.model->module != nullptr) return of_module<T>(*voice.model->module);
  const auto arrays = std::make_shared<const InstrumentArrays>(instrument_arrays(*voice.model, sample_rate_hz));
  return Engine<T>::network(arrays->view(), arrays);
}

// A hammer of a material on a resonator, and its damper.
InstrumentMaker hammer_string_of(const JsonObject& parts, const ReadFile& read) {
  using Control = HammerStringParameter;
  Voice voice;
  voice.name = "hammer_string";
  const NamedText resonator = read_named(parts, "resonator", Shipped::kResonators, read);
  voice.resonator = parse_resonator(resonator.text, resonator.file);
  if (parts.has("tuning_cents")) {
    auto* string = std::get_if<StiffString>(&voice.resonator.body);
    if (string == nullptr) parts.fail(parts.key("tuning_cents"), "is not for this resonator", "beside strings");
    for (double& cents : string->detuning_cents) cents += parts.number("tuning_cents", kTuningCents);
  }
  DesignedMaterials materials(read);
  const auto& [material, table] = materials.of(parts);
  voice.contact = table;
  voice.memories = material.memories;
  if (!parts.has("hammer_mass_kg") && !material.impact)
    parts.fail(parts.key("hammer_mass_kg"), "missing, and the material has no impact", "a number");
  for (const Parameter& parameter : Control::kList) voice.initial.push_back(parameter.initial);
  voice.initial[Control::kHammerMass] =
      parts.has("hammer_mass_kg") ? parts.number("hammer_mass_kg", {1e-6, 100}) : material.impact->mass_kg;
  voice.initial[Control::kLoss] = material.loss_s_per_m;
  voice.initial[Control::kPlace] = voice.resonator.strike.position_m;
  if (parts.has("damper_per_s")) voice.damper.damping_per_s = parts.number("damper_per_s", {0, 1e5});
  return maker_of_voice(std::move(voice));
}

// A mass before a rigid barrier, of the material's impact, or of 3 g where it has none.
InstrumentMaker mass_barrier_of(const JsonObject& parts, const ReadFile& read) {
  constexpr double kAnyMass_kg = 0.003;
  const NamedText named = read_named(parts, "material", Shipped::kMaterials, read);
  const Design design = design_material(named.text, named.file, reader_beside(named, read));
  const MassBarrierParts made{segment_table(design.spline),
                              design.material.impact ? design.material.impact->mass_kg : kAnyMass_kg,
                              design.material.loss_s_per_m, design.material.memories};
  return InstrumentMaker::of(
      [made](auto precision, double) { return Engine<decltype(precision)>::mass_barrier(made); });
}

// A keyboard on its body, with all its keys, whose felts it designs.
InstrumentMaker maker_of_keyboard(const Keyboard& played, const NamedText& named, const ReadFile& read) {
  if (!played.body) refuse(named.file, "keyboard.body", "missing", "one such as that of the piano that ships");
  const auto made = std::make_shared<const KeyboardParts>(
      keyboard_parts(played, std::make_shared<const Score>(score_of_all_keys(played, named, read))));
  return InstrumentMaker::of([made](auto precision, double) { return Engine<decltype(precision)>::keyboard(made); });
}

// All keys of a keyboard; takes some seconds.
InstrumentMaker keyboard_of(const JsonObject& parts, const ReadFile& read) {
  const NamedText named = read_named(parts, "keyboard", Shipped::kKeyboards, read);
  return maker_of_keyboard(parse_keyboard(named.text, named.file), named, read);
}

const std::vector<MadeOfParts> kMadeOfParts = {
    {"hammer_string", {"resonator", "material", "tuning_cents", "hammer_mass_kg", "damper_per_s"}, hammer_string_of},
    {"mass_barrier", {"material"}, mass_barrier_of},
    {"piano", {"keyboard"}, keyboard_of}};

}  // namespace

InstrumentMaker maker_of_voice(Voice voice) {
  return InstrumentMaker::of([voice = std::move(voice)](auto precision, double rate) {
    auto instrument = instrument_of<decltype(precision)>(voice, rate);
    for (std::size_t i = 0; i < voice.initial.size(); ++i) instrument->set(i, voice.initial[i]);
    return instrument;
  });
}

std::span<const MadeOfParts> all_made_of_parts() {
  return kMadeOfParts;
}

const MadeOfParts* made_of_parts(std::string_view name) {
  const auto found = std::ranges::find(kMadeOfParts, name, &MadeOfParts::name);
  return found == kMadeOfParts.end() ? nullptr : &*found;
}

InstrumentMaker maker_of_text(std::string_view text, const std::string& file, const ReadFile& read) {
  DesignedMaterials materials(read);
  return maker_of_text(text, file, read, materials);
}

InstrumentMaker maker_of_text(std::string_view text, const std::string& file, const ReadFile& read,
                              DesignedMaterials& materials) {
  const auto kind = kind_of_file(text, file, "instrument");
  if (kind && *kind != Shipped::kInstruments) refuse(file, "file", "is " + a_kind(*kind), "an instrument");
  Voice voice;
  voice.name = file;
  voice.model = parse_instrument(text, file, read, materials);
  return maker_of_voice(std::move(voice));
}

InstrumentMaker maker_of_key(std::string_view text, const std::string& file, const ReadFile& read, int key) {
  const NamedText named{std::string(text), file, false, false, Shipped::kKeyboards};
  Keyboard keyboard = parse_keyboard(text, file);
  if (key < keyboard.first_key || key > keyboard.last_key)
    refuse(file, "keyboard", fmt::format("key {} is not on it", key),
           fmt::format("keys {} to {}", keyboard.first_key, keyboard.last_key));
  keyboard.first_key = keyboard.last_key = key;
  return maker_of_keyboard(keyboard, named, read);
}

std::optional<InstrumentMaker> maker_of_shipped(const std::string& name) {
  const auto* shipped = find_embedded(Shipped::kInstruments, name + ".json");
  if (shipped == nullptr) return std::nullopt;
  return maker_of_text(shipped->content, std::string(shipped->name), shipped_file);
}

}  // namespace contactspline
