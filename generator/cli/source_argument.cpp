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

Source material_source(const std::string& argument, Design design) {
  const std::string name = design.material.name;
  auto files = input_files(argument, design.material);
  return {name,
          [design = std::move(design)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, design, command);
          },
          std::move(files)};
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
  return {name,
          [=, resonator = std::move(resonator)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, resonator, max_frequency_hz, command);
          },
          {}};
}

Source keyboard_source(Keyboard keyboard) {
  const std::string name = keyboard.name;
  return {name,
          [keyboard = std::move(keyboard)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, keyboard, command);
          },
          {}};
}

// The text of what ships under a name, or nothing.
const EmbeddedText* shipped(std::span<const EmbeddedText> texts, const std::string& name) {
  const auto found = std::ranges::find(texts, name + ".json", &EmbeddedText::file_name);
  return found == texts.end() ? nullptr : &*found;
}

void require_shipped(const std::string& argument) {
  std::vector<std::string> names = shipped_names();
  if (std::ranges::find(names, argument) != names.end()) return;
  for (const auto& texts : {embedded_resonators(), embedded_keyboards()})
    for (const auto& text : texts) names.emplace_back(text.file_name.substr(0, text.file_name.find('.')));
  throw BadInput(fmt::format("{}: MATERIAL: no such material, resonator or keyboard ships; allowed: a .json file, {}",
                             argument, fmt::join(names, ", ")));
}

Source read_from(const std::string& file, Source source) {
  source.files = {file};
  return source;
}

// A resonator file has a body, a strike and a pickup, a keyboard file a keyboard, where a material file has a contact
// and a spline.
bool is_resonator(const nlohmann::json& json) {
  return std::ranges::any_of(std::array{"string", "bar", "membrane", "modes", "strike", "pickup", "max_modes"},
                             [&](const char* key) { return json.contains(key); });
}

Source file_source(const std::string& file, double max_frequency_hz) {
  const std::string text = read_input(file);
  const auto json = parse_json(text, file, "material");
  if (is_resonator(json)) return read_from(file, resonator_source(parse_resonator(text, file), max_frequency_hz));
  if (json.contains("keyboard")) return read_from(file, keyboard_source(parse_keyboard(text, file)));
  return material_source(file, design_contact(text, file, reader_beside(file)));
}

}  // namespace

Source source_argument(const std::string& argument, double max_frequency_hz) {
  if (const auto* text = shipped(embedded_resonators(), argument))
    return resonator_source(parse_resonator(text->content, text->file_name), max_frequency_hz);
  if (const auto* text = shipped(embedded_keyboards(), argument))
    return keyboard_source(parse_keyboard(text->content, text->file_name));
  if (is_path(argument)) return file_source(argument, max_frequency_hz);
  require_shipped(argument);
  return material_source(argument, design_argument(argument));
}

std::optional<Resonator> resonator_argument(const std::string& argument) {
  if (const auto* text = shipped(embedded_resonators(), argument))
    return parse_resonator(text->content, text->file_name);
  if (!is_path(argument)) return std::nullopt;
  const std::string text = read_input(argument);
  return is_resonator(parse_json(text, argument, "material")) ? std::optional(parse_resonator(text, argument))
                                                              : std::nullopt;
}

}  // namespace contactspline
