// SPDX-License-Identifier: MIT
#include "generator/cli/model_module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#if __has_include(<link.h>)
#include <link.h>
#endif

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "contactspline/host/model_module.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr double kUsualRate_hz = 44100;
constexpr const char* kAllowed = "a library of contactspline_model(), built with this program's version and compiler";

#if __has_include(<link.h>)
// A library that is cut off is mapped beyond its end: the first access there would end the program.
bool is_whole(const std::filesystem::path& file) {
  const auto size = std::filesystem::file_size(file);
  std::ifstream from(file, std::ios::binary);
  ElfW(Ehdr) head{};
  if (!from.read(reinterpret_cast<char*>(&head), sizeof head)) return true;  // dlopen says what it is
  if (std::string_view(reinterpret_cast<const char*>(head.e_ident), SELFMAG) != ELFMAG) return true;
  for (std::size_t i = 0; i < head.e_phnum; ++i) {
    ElfW(Phdr) part{};
    from.seekg(static_cast<std::streamoff>(head.e_phoff + i * sizeof part));
    if (!from.read(reinterpret_cast<char*>(&part), sizeof part)) return false;
    if (part.p_type == PT_LOAD && (part.p_offset > size || part.p_filesz > size - part.p_offset)) return false;
  }
  return true;
}
#else
bool is_whole(const std::filesystem::path&) {
  return true;
}
#endif

const ModelModule& module_in(const std::string& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (exists(status) && !is_regular_file(status))  // a pipe would wait for its writer
    refuse(file, "--instrument", "is no regular file", kAllowed);
  if (exists(status) && !is_whole(file)) refuse(file, "--instrument", "is cut off", kAllowed);
  void* const library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse(file, "--instrument", fmt::format("cannot be loaded ({})", dlerror()), kAllowed);
  auto* const get = reinterpret_cast<GetModelModule*>(dlsym(library, kModelModuleSymbol));
  if (get == nullptr) refuse(file, "--instrument", "is a library of something else", kAllowed);
  const ModelModule* const given = get();
  if (given == nullptr) refuse(file, "--instrument", "gives no model", kAllowed);
  const ModelModule& module = *given;
  if (!std::ranges::equal(module.version, std::array{kVersionMajor, kVersionMinor, kVersionPatch}))
    refuse(file, "--instrument",
           fmt::format("is built with version {}.{}.{}", module.version[0], module.version[1], module.version[2]),
           fmt::format("{}.{}.{}", kVersionMajor, kVersionMinor, kVersionPatch));
  if (module.layout != kModelModuleLayout || std::string_view(module.compiler) != __VERSION__)
    refuse(file, "--instrument", "is built with other headers or another compiler",
           fmt::format("those of this program, whose compiler says {}", __VERSION__));
  if ((module.make_single == nullptr) == (module.make_double == nullptr))
    refuse(file, "--instrument", "makes its class in both precisions or in none", kAllowed);
  return module;
}

bool is_range(const ControlRange<double>& range) {
  return range.min <= range.max;
}

// What is wrong in the lists of a class, and what is allowed; nothing where they can be played.
template <typename T>
std::optional<std::array<std::string, 2>> fault_of(const AnyInstrument<T>& played) {
  const std::size_t count = played.parameters().size();
  const auto fault = [](std::string wrong, std::string allowed) {
    return std::array<std::string, 2>{std::move(wrong), std::move(allowed)};
  };
  const auto is_text = [](const auto&... texts) { return (... && (texts != nullptr)); };
  const auto has_texts = [&](const auto& list, const auto&... texts) {
    return std::ranges::all_of(list, [&](const auto& one) { return is_text(one.*texts...); });
  };
  if (!is_text(played.name(), played.description()) ||
      !has_texts(played.parameters(), &Parameter::name, &Parameter::unit) ||
      !has_texts(played.events(), &Event::name) || !has_texts(played.outputs(), &Output::name, &Output::unit))
    return fault("a name, unit or description is a null pointer", "a text for each");
  for (const Parameter& p : played.parameters())
    if (!is_range(p.allowed) || !is_range(p.slider))
      return fault(fmt::format("parameters(): {}: a range is empty", p.name), "the smaller value first");
  for (const Event& e : played.events())
    if (e.parameter >= count)
      return fault(
          fmt::format("events(): {}: its parameter is {}, and there are {} parameters", e.name, e.parameter, count),
          count == 0 ? "a parameter that holds its speed or force" : fmt::format("0 to {}", count - 1));
  if (played.outputs().empty()) return fault("outputs(): is empty", "at least one output");
  for (const Output& o : played.outputs())
    if (!(o.full_scale > 0))
      return fault(fmt::format("outputs(): {}: full_scale is not above 0", o.name), "such as 1");
  return {};
}

template <typename T>
InstrumentModel lists_of(const AnyInstrument<T>& played) {
  InstrumentModel model;
  model.name = played.name();
  model.description = played.description();
  for (const Parameter& p : played.parameters())
    model.parameters.push_back(
        {p.name, p.unit, p.allowed, p.slider, p.initial, p.scale, p.acts, p.glide_s, p.controller, p.step_samples});
  for (const Event& e : played.events()) model.events.push_back({e.name, e.kind, e.number, e.parameter});
  for (const Output& o : played.outputs())
    model.outputs.push_back({.name = o.name, .quantity = {}, .targets = {}, .full_scale = o.full_scale});
  model.keys.ranges = {{.first = 0, .last = 127, .event = 0}};  // a key that it lacks does nothing
  for (std::size_t p = 0; p < model.parameters.size(); ++p) {   // as Hosted finds them
    if (model.parameters[p].name == "bend_cents") model.keys.bend = p;
    if (model.parameters[p].controller == 64) model.keys.sustain = p;
  }
  return model;
}

// One line, whatever the class says.
std::string line_of(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

template <typename T>
InstrumentModel checked_lists(const std::string& file, std::unique_ptr<AnyInstrument<T>> (*make)()) {
  const auto made = [&] {
    try {
      auto played = make();
      played->prepare(kUsualRate_hz);
      return played;
    } catch (const std::exception& error) {
      refuse(file, "--instrument", fmt::format("its class cannot be made ({})", line_of(error.what())),
             "a class whose constructor and prepare() throw nothing");
    }
  }();
  if (const auto fault = fault_of(*made)) refuse(file, "--instrument", (*fault)[0], (*fault)[1]);
  return lists_of(*made);
}

}  // namespace

InstrumentModel load_model_module(const std::string& file) {
  const ModelModule& module = module_in(file);
  InstrumentModel model = module.make_single != nullptr ? checked_lists(file, module.make_single)
                                                        : checked_lists(file, module.make_double);
  model.module = &module;
  return model;
}

}  // namespace contactspline
