// SPDX-License-Identifier: MIT
// contactspline materials, contactspline scores: what ships.
#include <fmt/format.h>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/support/embedded_files.hpp"

namespace contactspline {

void list_materials() {
  std::string table = fmt::format("{:<16} {:>14} {:>9} {:>9} {:>15}  {}\n", "name", "k [N/m^a]", "exponent",
                                  "segments", "worst T error", "description");
  for (const std::string& name : shipped_names(Shipped::kMaterials)) {
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

void list_scores() {
  std::string table = fmt::format("{:<16} {:<14} {:>6}  {}\n", "name", "instrument", "s", "description");
  for (const std::string& name : shipped_names(Shipped::kScores)) {
    const Score score = score_argument(name).score;
    table += fmt::format("{:<16} {:<14} {:>6.4g}  {}\n", name, name_of(score.instrument), score.duration_s,
                         score.description);
  }
  write_stdout(table);
}

}  // namespace contactspline
