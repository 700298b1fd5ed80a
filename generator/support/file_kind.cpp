// SPDX-License-Identifier: MIT
#include "generator/support/file_kind.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr std::array kKinds = {Shipped::kMaterials, Shipped::kFrictions,   Shipped::kResonators,
                               Shipped::kKeyboards, Shipped::kInstruments, Shipped::kScores};

// Keys that only files of this kind have. A score of 0.1.0 also has the key "keyboard", so scores come first.
constexpr const char* kOfMaterials[] = {"contact", "impact", "spline"};
constexpr const char* kOfFrictions[] = {"bristles", "heat", "coefficient"};
constexpr const char* kOfResonators[] = {"string", "bar",    "membrane", "plate",    "round_plate",
                                         "modes",  "strike", "pickup",   "max_modes"};
constexpr const char* kOfScores[] = {"instrument", "duration_s", "voices", "events"};
constexpr const char* kOfInstruments[] = {"bodies",   "places",  "contacts", "springs", "links",
                                          "controls", "strikes", "outputs",  "keys",    "presets"};
constexpr const char* kOfKeyboards[] = {"keyboard"};
constexpr const char* kOfOutputs[] = {"written_by"};

}  // namespace

std::string_view kind_name(Shipped folder) {
  switch (folder) {
    case Shipped::kMaterials:
      return "material";
    case Shipped::kFrictions:
      return "friction";
    case Shipped::kResonators:
      return "resonator";
    case Shipped::kKeyboards:
      return "keyboard";
    case Shipped::kInstruments:
      return "instrument";
    case Shipped::kScores:
      return "score";
    case Shipped::kTemplates:
      break;
  }
  return "template";
}

std::string a_kind(Shipped folder) {
  return (folder == Shipped::kInstruments ? "an " : "a ") + std::string(kind_name(folder));
}

std::optional<Shipped> kind_of_file(std::string_view text, std::string_view file, std::string_view what) {
  if (text.starts_with("MThd")) return Shipped::kScores;
  const std::vector<std::string> found = json_keys(text, file, what);
  const auto has_any = [&](std::span<const char* const> keys) {
    return std::ranges::find_first_of(found, keys) != found.end();
  };
  if (has_any(kOfOutputs)) refuse(file, "file", "was written by this program", "the file that it was made from");
  if (has_any(kOfResonators)) return Shipped::kResonators;
  if (has_any(kOfScores)) return Shipped::kScores;
  if (has_any(kOfInstruments)) return Shipped::kInstruments;
  if (has_any(kOfKeyboards)) return Shipped::kKeyboards;
  if (has_any(kOfFrictions)) return Shipped::kFrictions;
  if (has_any(kOfMaterials)) return Shipped::kMaterials;
  return {};
}

std::optional<Shipped> kind_of_name(std::string_view name) {
  const auto ships = [&](Shipped folder) { return std::ranges::count(shipped_names(folder), name) > 0; };
  const auto found = std::ranges::find_if(kKinds, ships);
  return found == kKinds.end() ? std::nullopt : std::optional(*found);
}

}  // namespace contactspline
