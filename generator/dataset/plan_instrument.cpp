// SPDX-License-Identifier: MIT
#include "generator/dataset/plan_instrument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "generator/material/named_file.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/support/embedded_files.hpp"

namespace contactspline {
namespace {

constexpr auto kMassBarrier = "mass_barrier", kPiano = "piano";

PlanInstrument piano(const JsonObject& plan, const ReadFile& read) {
  const std::string keyboard =
      plan.has("parts") ? plan.object("parts", {"keyboard"}).json("keyboard") : json_string(kPiano);
  return {maker_of_keyboard(keyboard, plan.file(), read), {}};
}

}  // namespace

PlanInstrument read_plan_instrument(const JsonObject& plan, const ReadFile& read) {
  if (plan.has_object("instrument")) {
    if (plan.has("parts")) plan.fail("parts", "has no meaning here", "beside the name of a model");
    return {maker_of_text(plan.json("instrument"), plan.file(), read), {}};
  }
  std::vector<std::string> names;
  for (const Model model : kModelsWithParts) names.push_back(identifier_of(model));
  names.emplace_back(kMassBarrier);
  names.emplace_back(kPiano);
  for (const std::string& shipped : shipped_names(Shipped::kInstruments)) names.push_back(shipped);
  const std::string allowed = fmt::format("a .json file, an object with the keys of one, {}", fmt::join(names, ", "));
  const std::string name = plan.text("instrument", allowed);
  if (!is_path(name) && std::ranges::find(names, name) == names.end())
    plan.fail("instrument", fmt::format("'{}' is unknown", shown(name)), allowed);
  const auto model = model_with_parts(name);
  const bool has_parts = model || name == kMassBarrier || name == kPiano;
  if (!has_parts && plan.has("parts"))
    plan.fail("parts", fmt::format("has no meaning for {}", shown(name)), "no such key: set its parameters instead");
  if (name == kMassBarrier) return {maker_of_mass_barrier(plan.object("parts", {"material"}), read), {}};
  if (name == kPiano) return piano(plan, read);
  if (model) {
    Voice voice = read_voice_parts(plan, "parts", *model, read);
    std::vector<double> initial = voice.initial;
    return {maker_of_voice(*model, std::move(voice)), std::move(initial)};
  }
  const NamedText named = read_named(plan, "instrument", Shipped::kInstruments, read);
  return {maker_of_text(named.text, named.file, reader_beside(named, read)), {}};
}

}  // namespace contactspline
