// SPDX-License-Identifier: MIT
#include "generator/fit/models.hpp"

namespace contactspline {
namespace {

std::vector<std::string> names_of(const std::vector<ModelRow>& rows) {
  std::vector<std::string> names;
  for (const ModelRow& row : rows) names.emplace_back(row.name);
  return names;
}

}  // namespace

const std::vector<ModelRow>& laws() {
  static const std::vector<ModelRow> rows = {
      {"power", "power law", {kLogForce, kExponent}},
      {"hertz", "Hertz contact", {kLogForce}},
      {kLayers, "power law over a core", {kLogForce, kExponent, kLogCore, kDepth}}};
  return rows;
}

const std::vector<ModelRow>& losses() {
  static const std::vector<ModelRow> rows = {{"none", "without loss", {}},
                                             {"hunt_crossley", "with Hunt-Crossley loss", {kHuntCrossley}},
                                             {"memory", "with memory", {kWeight, kLogTime}}};
  return rows;
}

std::vector<std::string> names_of_laws() {
  return names_of(laws());
}

std::vector<std::string> names_of_losses() {
  return names_of(losses());
}

}  // namespace contactspline
