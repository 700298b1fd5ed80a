// SPDX-License-Identifier: MIT
#include "generator/cli/source_argument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"
#include "generator/embedded.hpp"
#include "generator/error.hpp"
#include "generator/json_input.hpp"

namespace contactspline {
namespace {

Source material_source(Design design) {
  const std::string name = design.material.name;
  return {name, [design = std::move(design)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, design, command);
          }};
}

// Something must sound; where modes are left out, a line says so.
void check_modes(const Resonator& resonator, double max_frequency_hz) {
  const ModeSet set = modes_of(resonator, max_frequency_hz);
  if (set.modes.empty())
    throw BadInput(
        fmt::format("{}: constant_loss_per_s: no mode below {} Hz sounds; allowed: losses below the frequencies",
                    resonator.name, max_frequency_hz));
  if (!set.cut) return;
  const auto line = fmt::format("contactspline: {}: max_modes: {} leaves out modes below {} Hz\n", resonator.name,
                                resonator.max_modes, max_frequency_hz);
  std::fputs(line.c_str(), stderr);
}

Source resonator_source(Resonator resonator, double max_frequency_hz) {
  check_modes(resonator, max_frequency_hz);
  const std::string name = resonator.name;
  return {name, [=, resonator = std::move(resonator)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, resonator, max_frequency_hz, command);
          }};
}

void require_shipped(const std::string& argument) {
  std::vector<std::string> names = shipped_names();
  if (std::ranges::find(names, argument) != names.end()) return;
  for (const auto& text : embedded_resonators())
    names.emplace_back(text.file_name.substr(0, text.file_name.find('.')));
  throw BadInput(fmt::format("{}: MATERIAL: no such material or resonator ships; allowed: a .json file, {}", argument,
                             fmt::join(names, ", ")));
}

// A resonator file has a body, a strike and a pickup where a material file has a contact and a spline.
bool is_resonator(std::string_view text, std::string_view file) {
  const auto json = parse_json(text, file, "material");
  const auto has = [&](const char* key) { return json.contains(key); };
  return std::ranges::any_of(std::array{"string", "bar", "membrane", "modes", "strike", "pickup", "max_modes"}, has);
}

}  // namespace

Source source_argument(const std::string& argument, double max_frequency_hz) {
  const auto shipped = embedded_resonators();
  const auto found = std::ranges::find(shipped, argument + ".json", &EmbeddedText::file_name);
  if (found != shipped.end())
    return resonator_source(parse_resonator(found->content, found->file_name), max_frequency_hz);
  if (is_path(argument)) {
    const std::string text = read_input(argument);
    if (is_resonator(text, argument)) return resonator_source(parse_resonator(text, argument), max_frequency_hz);
    return material_source(design_contact(text, argument));
  }
  require_shipped(argument);
  return material_source(design_argument(argument));
}

}  // namespace contactspline
