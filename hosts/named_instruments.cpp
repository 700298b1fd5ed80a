// SPDX-License-Identifier: MIT
#include "hosts/named_instruments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <utility>

#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/resonators/guitar_d3.hpp"
#include "contactspline/resonators/guitar_g3.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/input_file.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

// A model of the runtime, with the material and the resonator that the plug-in of its name has.
template <template <typename> typename I>
InstrumentMaker maker_of_class() {
  return InstrumentMaker::of([](auto precision, double) -> std::unique_ptr<AnyInstrument<decltype(precision)>> {
    return std::make_unique<InstrumentBehind<I<decltype(precision)>>>();
  });
}

template <typename T>
using Piano = KeyboardInstrument<keyboards::piano, T>;
template <typename T>
using PlainHammerString = HammerStringOf<materials::felt_c4, resonators::string_c4, T>;
template <typename T>
using PlainSlideString = SlideStringOf<materials::steel_on_steel, resonators::guitar_g3, T>;
template <typename T>
using PlainFretString = FretStringOf<materials::steel_on_steel, resonators::guitar_d3, T>;
template <typename T>
using PlainMassBarrier = MassBarrierOf<materials::felt_c4, T>;

struct NamedModel {
  const char* name;
  InstrumentMaker (*maker)();
};
constexpr NamedModel kModels[] = {{"piano", maker_of_class<Piano>},
                                  {"hammer_string", maker_of_class<PlainHammerString>},
                                  {"slide_string", maker_of_class<PlainSlideString>},
                                  {"fret_string", maker_of_class<PlainFretString>},
                                  {"mass_barrier", maker_of_class<PlainMassBarrier>}};

InstrumentMaker maker_of_file(std::string_view text, const std::string& file, const ReadFile& read) {
  const auto kind = kind_of_file(text, file, "instrument");
  if (kind && *kind != Shipped::kInstruments)
    refuse(file, "file", fmt::format("is a {}", kind_name(*kind)), "an instrument");
  Voice voice;
  voice.name = file;
  voice.model = parse_instrument(text, file, read);
  return maker_of_voice(Model::kFile, std::move(voice));
}

}  // namespace

InstrumentMaker maker_of_voice(Model model, Voice voice) {
  return InstrumentMaker::of([model, voice = std::move(voice)](auto precision, double rate) {
    auto instrument = instrument_of<decltype(precision)>(model, voice, rate);
    for (std::size_t i = 0; i < voice.initial.size(); ++i) instrument->set(i, voice.initial[i]);
    return instrument;
  });
}

std::vector<std::string> instrument_names() {
  std::vector<std::string> names;
  for (const NamedModel& model : kModels) names.emplace_back(model.name);
  for (std::string& name : shipped_names(Shipped::kInstruments)) names.push_back(std::move(name));
  return names;
}

InstrumentMaker maker_of_text(std::string_view text, const std::string& file) {
  return maker_of_file(text, file, [&](const std::string& path) {
    return read_input(std::filesystem::path(file).parent_path() / path);
  });
}

InstrumentMaker maker_of_name(const std::string& name) {
  if (is_path(name)) return maker_of_text(read_input(name), name);
  for (const NamedModel& model : kModels)
    if (name == model.name) return model.maker();
  const auto* shipped = find_embedded(Shipped::kInstruments, name + ".json");
  if (shipped == nullptr)
    refuse(shown(name), "INSTRUMENT", "no such instrument ships",
           fmt::format("a .json file, {}", fmt::join(instrument_names(), ", ")));
  return maker_of_file(shipped->content, std::string(shipped->name), shipped_file);
}

}  // namespace contactspline
