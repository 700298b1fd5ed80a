// SPDX-License-Identifier: MIT
#include "generator/player/instrument_maker.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

#include "contactspline/instrument/mass_barrier_instrument.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/player/own_keyboard.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

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
  return InstrumentMaker::of_class<MassBarrierInstrument>(made);
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
  const auto made = std::make_shared<const OwnKeyboardParts>(std::move(played), parse_score(score, file, read));
  return InstrumentMaker::of(
      [made](auto precision, double rate) -> std::unique_ptr<AnyInstrument<decltype(precision)>> {
        return std::make_unique<InstrumentBehind<OwnKeyboard<decltype(precision)>>>(made, rate);
      });
}

InstrumentMaker maker_of_text(std::string_view text, const std::string& file, const ReadFile& read) {
  const auto kind = kind_of_file(text, file, "instrument");
  if (kind && *kind != Shipped::kInstruments)
    refuse(file, "file", fmt::format("is a {}", kind_name(*kind)), "an instrument");
  Voice voice;
  voice.name = file;
  voice.model = parse_instrument(text, file, read);
  return maker_of_voice(Model::kFile, std::move(voice));
}

std::optional<InstrumentMaker> maker_of_shipped(const std::string& name) {
  const auto* shipped = find_embedded(Shipped::kInstruments, name + ".json");
  if (shipped == nullptr) return std::nullopt;
  return maker_of_text(shipped->content, std::string(shipped->name), shipped_file);
}

}  // namespace contactspline
