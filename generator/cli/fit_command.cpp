// SPDX-License-Identifier: MIT
// contactspline fit: from measurements to a material file.
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/waiting_line.hpp"
#include "generator/fit/fit.hpp"
#include "generator/fit/fitted_material.hpp"
#include "generator/fit/measurements_reader.hpp"
#include "generator/support/input_file.hpp"

namespace contactspline {

void fit(const FitOptions& options) {
  if (!options.figure.empty()) (void)figure_format(options.figure);  // throws before the search
  const std::filesystem::path file = options.file;
  const Measurements measured = parse_measurements(
      read_input(file), options.file, [&](const std::string& path) { return read_input(file.parent_path() / path); });
  std::vector<std::filesystem::path> inputs{file};
  for (const std::string& path : measured.files) inputs.push_back(file.parent_path() / path);
  std::vector<std::filesystem::path> outputs;
  for (const std::string& output : {options.output, options.figure})
    if (!output.empty()) outputs.emplace_back(output);
  require_writable(outputs, inputs, options.force);
  if (!options.figure.empty()) require_kind(options.figure, FigureKind::kFit, options.force);
  require_creatable(outputs);
  std::optional<WaitingLine> line;
  const Fit found = fit_material(measured, options.file, [&](const std::string& what) { line.emplace(what); });
  line.reset();
  std::vector<OutputFile> files;
  if (!options.output.empty()) files.push_back({options.output, material_text(found, measured, mark())});
  if (!options.figure.empty())
    files.push_back(
        {options.figure, figure_of(found, measured.description.empty() ? measured.name : measured.description,
                                   figure_format(options.figure))});
  write_files(files);
  write_stdout(options.json ? json_of(found, measured) : report_of(found, measured));
}

}  // namespace contactspline
