// SPDX-License-Identifier: MIT
#include "generator/cli/model_module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "contactspline/host/model_module.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr const char* kAllowed = "a library of contactspline_model(), built with this program's version and compiler";

const ModelModule& module_in(const std::string& file) {
  void* const library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse(file, "--instrument", fmt::format("cannot be loaded ({})", dlerror()), kAllowed);
  auto* const get = reinterpret_cast<GetModelModule*>(dlsym(library, kModelModuleSymbol));
  if (get == nullptr) refuse(file, "--instrument", "is a library of something else", kAllowed);
  const ModelModule& module = *get();
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

}  // namespace

InstrumentModel load_model_module(const std::string& file) {
  const ModelModule& module = module_in(file);
  InstrumentModel model =
      module.make_single != nullptr ? lists_of(*module.make_single()) : lists_of(*module.make_double());
  model.module = &module;
  return model;
}

}  // namespace contactspline
