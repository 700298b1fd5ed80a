// SPDX-License-Identifier: MIT
// contactspline fit: from measurements to a material file.
#include "generator/fit/fit.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/waiting_line.hpp"
#include "generator/fit/fitted_material.hpp"
#include "generator/support/input_file.hpp"

namespace contactspline {

void fit(const FitOptions& options) {
  const std::filesystem::path file = options.file;
  const Measurements measured = parse_measurements(
      read_input(file), options.file, [&](const std::string& path) { return read_input(file.parent_path() / path); });
  std::vector<std::filesystem::path> inputs{file};
  for (const std::string& path : measured.files) inputs.push_back(file.parent_path() / path);
  if (!options.output.empty()) {
    require_writable({{options.output}}, inputs, options.force);
    require_creatable({{options.output}});
  }
  std::optional<WaitingLine> line;
  const Fit found = fit_material(measured, options.file, [&](const std::string& what) { line.emplace(what); });
  line.reset();
  if (!options.output.empty()) write_files({{OutputFile{options.output, material_text(found, measured, mark())}}});
  write_stdout(options.json ? json_of(found, measured) : report_of(found, measured));
}

}  // namespace contactspline
