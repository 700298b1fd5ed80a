// SPDX-License-Identifier: MIT
// contactspline materials: what ships.
#include <fmt/format.h>

#include "generator/cli/commands.hpp"
#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"

namespace contactspline {
namespace {

void list_materials() {
  std::string table = fmt::format("{:<16} {:>14} {:>9} {:>9} {:>15}  {}\n", "name", "k [N/m^a]", "exponent",
                                  "segments", "worst T error", "description");
  for (const std::string& name : shipped_names()) {
    const auto [material, spline, quality] = design_argument(name);
    const PowerLaw* law = material.contact.power_law();
    const std::string stiffness =
        law == nullptr ? (material.measured ? "measured" : "sum") : fmt::format("{:.4g}", law->stiffness);
    const std::string exponent = law == nullptr ? "-" : fmt::format("{:.4g}", law->exponent);
    table += fmt::format("{:<16} {:>14} {:>9} {:>9} {:>13.2g} %  {}\n", name, stiffness, exponent,
                         spline.segments.size(), 100 * quality.impact.value().contact_duration, material.description);
  }
  write_stdout(table);
}

}  // namespace

void add_materials(CLI::App& app) {
  app.add_subcommand("materials", "List the materials that ship")
      ->footer("T is the contact duration on a rigid barrier, over the material's range of impact speed.")
      ->callback(list_materials);
}

}  // namespace contactspline
