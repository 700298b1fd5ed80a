// SPDX-License-Identifier: MIT
#include "generator/player/instrument_maker.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

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

// What plays a voice of a model. Throws BadInput where it has no mode below half the rate.
template <std::floating_point T>
Handle<T> instrument_of(Model model, const Voice& voice, double sample_rate_hz) {
  switch (model) {
    case Model::kHammerString:
      return Engine<T>::hammer_string(hammer_string_parts(voice, sample_rate_hz));
    case Model::kSlideString:
      return Engine<T>::slide_string(plucked_string_parts(voice, sample_rate_hz));
    case Model::kFretString:
      return Engine<T>::fret_string(plucked_string_parts(voice, sample_rate_hz));
    case Model::kFile:
      break;
  }
  if (voice.model->module != nullptr) return of_module<T>(*voice.model->module);
  const auto arrays = std::make_shared<const InstrumentArrays>(instrument_arrays(*voice.model, sample_rate_hz));
  return Engine<T>::network(arrays->view(), arrays);
}

}  // namespace

InstrumentMaker maker_of_voice(Model model, Voice voice) {
  return InstrumentMaker::of([model, voice = std::move(voice)](auto precision, double rate) {
    auto instrument = instrument_of<decltype(precision)>(model, voice, rate);
    for (std::size_t i = 0; i < voice.initial.size(); ++i) instrument->set(i, voice.initial[i]);
    return instrument;
  });
}

InstrumentMaker maker_of_mass_barrier(const JsonObject& parts, const ReadFile& read) {
  constexpr double kAnyMass_kg = 0.003;
  const NamedText named = read_named(parts, "material", Shipped::kMaterials, read);
  const Design design = design_material(named.text, named.file, reader_beside(named, read));
  const MassBarrierParts made{segment_table(design.spline),
                              design.material.impact ? design.material.impact->mass_kg : kAnyMass_kg,
                              design.material.loss_s_per_m, design.material.memories};
  return InstrumentMaker::of(
      [made](auto precision, double) { return Engine<decltype(precision)>::mass_barrier(made); });
}

// A score plays all keys once, so that its reader designs their felts.
InstrumentMaker maker_of_keyboard(const std::string& keyboard, const std::string& file, const ReadFile& read) {
  const JsonObject parts =
      parse_json(fmt::format(R"({{"keyboard": {}}})", keyboard), file, "instrument", {"keyboard"});
  const NamedText named = read_named(parts, "keyboard", Shipped::kKeyboards, read);
  Keyboard played = parse_keyboard(named.text, named.file);
  if (!played.body) refuse(named.file, "keyboard.body", "missing", "one such as that of the piano that ships");
  std::vector<std::string> events;
  for (int key = played.first_key; key <= played.last_key; ++key)
    events.push_back(fmt::format(R"({{"time_s": 0, "key": {}, "hold_s": 0}})", key));
  const std::string score =
      fmt::format(R"({{"instrument": "hammer-string", "duration_s": 1, "keyboard": {}, "events": [{}]}})", keyboard,
                  fmt::join(events, ", "));
  const auto made = std::make_shared<const KeyboardParts>(
      keyboard_parts(played, std::make_shared<const Score>(parse_score(score, file, read))));
  return InstrumentMaker::of([made](auto precision, double) { return Engine<decltype(precision)>::keyboard(made); });
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
  return maker_of_voice(Model::kFile, std::move(voice));
}

std::optional<InstrumentMaker> maker_of_shipped(const std::string& name) {
  const auto* shipped = find_embedded(Shipped::kInstruments, name + ".json");
  if (shipped == nullptr) return std::nullopt;
  return maker_of_text(shipped->content, std::string(shipped->name), shipped_file);
}

}  // namespace contactspline
