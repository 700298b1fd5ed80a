// SPDX-License-Identifier: MIT
#include "generator/player/score.hpp"

#include <algorithm>
#include <array>

namespace contactspline {
namespace {

using Hammer = HammerStringParameter;
using Slide = SlideStringParameter;
using Fret = FretStringParameter;

constexpr const char* kHammerKeys[] = {"hammer_mass_kg", "damper_per_s"};
constexpr const char* kSlideKeys[] = {"pluck_m", "pickup_m", "height_m"};
constexpr const char* kFretKeys[] = {"pluck_m", "pickup_m"};

// In the order of Model.
constexpr std::array kRules = {
    ModelRules{"hammer-string", Hammer::kList, Hammer::kEvents, 0, kHammerKeys},
    ModelRules{"slide-string", Slide::kList, Slide::kEvents, Slide::kPluckForce, kSlideKeys},
    ModelRules{"fret-string", Fret::kList, Fret::kEvents, Fret::kPluckForce, kFretKeys},
    ModelRules{"instrument", {}, {}, 0, {}}};

}  // namespace

const ModelRules& rules_of(Model model) {
  return kRules[static_cast<std::size_t>(model)];
}

std::string identifier_of(Model model) {
  std::string name(name_of(model));
  std::ranges::replace(name, '-', '_');
  return name;
}

std::optional<Model> model_with_parts(std::string_view identifier) {
  const auto found = std::ranges::find(kModelsWithParts, identifier, identifier_of);
  return found != kModelsWithParts.end() ? std::optional(*found) : std::nullopt;
}

}  // namespace contactspline
