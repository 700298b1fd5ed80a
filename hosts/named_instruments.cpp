// SPDX-License-Identifier: MIT
#include "hosts/named_instruments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <memory>
#include <tuple>
#include <utility>

#include "contactspline/host/engine.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/nearest_name.hpp"
#include "hosts/named_models.hpp"

namespace contactspline {
namespace {

struct NamedModel {
  const char* (*name)();
  InstrumentMaker (*maker)();
};

template <std::size_t Index>
InstrumentMaker maker_of_model() {
  return InstrumentMaker::of([](auto precision, double) {
    return compiled<std::tuple_element_t<Index, NamedModels<decltype(precision)>>>();
  });
}

template <std::size_t... Indices>
constexpr std::array<NamedModel, sizeof...(Indices)> models_of(std::index_sequence<Indices...>) {
  return {{{&std::tuple_element_t<Indices, NamedModels<double>>::name, maker_of_model<Indices>}...}};
}

constexpr std::array kModels = models_of(std::make_index_sequence<std::tuple_size_v<NamedModels<double>>>());

}  // namespace

std::vector<std::string> instrument_names() {
  std::vector<std::string> names;
  for (const NamedModel& model : kModels) names.emplace_back(model.name());
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
    if (name == model.name()) return model.maker();
  auto shipped = maker_of_shipped(name);
  if (!shipped) {
    const std::vector<std::string> names = instrument_names();
    refuse(shown(name), "INSTRUMENT", "no such instrument ships",
           fmt::format("a .json file, {}{}", fmt::join(names, ", "), did_you_mean(names, name)));
  }
  return *std::move(shipped);
}

}  // namespace contactspline
