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
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
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

}  // namespace

std::vector<std::string> instrument_names() {
  std::vector<std::string> names;
  for (const NamedModel& model : kModels) names.emplace_back(model.name);
  for (std::string& name : shipped_names(Shipped::kInstruments)) names.push_back(std::move(name));
  return names;
}

InstrumentMaker maker_of_text(std::string_view text, const std::string& file) {
  return maker_of_text(text, file, [&](const std::string& path) {
    return read_input(std::filesystem::path(file).parent_path() / path);
  });
}

InstrumentMaker maker_of_name(const std::string& name) {
  if (is_path(name)) return maker_of_text(read_input(name), name);
  for (const NamedModel& model : kModels)
    if (name == model.name) return model.maker();
  auto shipped = maker_of_shipped(name);
  if (!shipped)
    refuse(shown(name), "INSTRUMENT", "no such instrument ships",
           fmt::format("a .json file, {}", fmt::join(instrument_names(), ", ")));
  return *std::move(shipped);
}

}  // namespace contactspline
