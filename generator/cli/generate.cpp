// SPDX-License-Identifier: MIT
// contactspline generate: materials to source files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"
#include "generator/error.hpp"

namespace contactspline {
namespace {

struct GenerateOptions {
  std::vector<std::string> materials;
  std::vector<std::string> formats;
  std::string output = ".";
  std::string depfile;
  bool check = false;
};

std::vector<Emitter> chosen_emitters(const std::vector<std::string>& formats) {
  const auto is_chosen = [&](const Emitter& emitter) {
    return formats.empty() || std::ranges::find(formats, emitter.name) != formats.end();
  };
  std::vector<Emitter> chosen;
  std::ranges::copy_if(emitters(), std::back_inserter(chosen), is_chosen);
  return chosen;
}

std::vector<OutputFile> emit_all(const GenerateOptions& options) {
  std::vector<OutputFile> files;
  std::set<std::string> names;
  for (const std::string& argument : options.materials) {
    const Design design = design_argument(argument);
    const std::string& name = design.material.name;
    if (!names.insert(name).second)
      throw BadInput(fmt::format("{}: name: '{}' is the name of two materials; allowed: once", argument, name));
    for (const Emitter& emitter : chosen_emitters(options.formats)) {
      const std::string command = fmt::format("contactspline generate {}.json --emit {}", name, emitter.name);
      files.push_back({std::filesystem::path(options.output) / fmt::format("{}.{}", name, emitter.extension),
                       emit(emitter, design, command)});
    }
  }
  return files;
}

void require_current(const std::vector<OutputFile>& files) {
  std::vector<std::string> stale;
  for (const OutputFile& file : files)
    if (!is_current(file)) stale.push_back(file.path.string());
  if (!stale.empty()) throw Stale(fmt::format("stale: {}; generate them again", fmt::join(stale, ", ")));
}

// What make and ninja need to know: the outputs follow from the material files.
OutputFile depfile_of(const GenerateOptions& options, const std::vector<OutputFile>& files) {
  const auto escaped = [](const std::string& path) {
    std::string text;
    for (const char c : path)
      text += c == ' ' || c == '#' || c == '\\' ? std::string{'\\', c} : c == '$' ? "$$" : std::string(1, c);
    return text;
  };
  std::string rule;
  for (const OutputFile& file : files) rule += escaped(file.path.string()) + " ";
  rule.back() = ':';
  for (const std::string& material : options.materials)
    if (std::filesystem::exists(material)) rule += " " + escaped(material);
  return {options.depfile, rule + "\n"};
}

void require_folder(const std::string& output) {
  const std::filesystem::path folder = output;
  if (output.empty() || (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder)))
    throw BadInput(fmt::format("{}: -o: is not a folder; allowed: a folder, or - for standard output", output));
}

void write_one_to_stdout(const std::vector<OutputFile>& files) {
  if (files.size() != 1)
    throw BadInput(fmt::format("-o: {} outputs do not fit on standard output; allowed: one MATERIAL and one --emit",
                               files.size()));
  write_stdout(files.front().bytes);
}

void generate(const GenerateOptions& options) {
  std::vector<OutputFile> files = emit_all(options);
  if (options.output == "-") return write_one_to_stdout(files);
  require_folder(options.output);
  if (options.check) return require_current(files);
  const std::size_t sources = files.size();
  if (!options.depfile.empty()) files.push_back(depfile_of(options, files));
  const auto written = write_files(files);
  for (const auto& path : written) fmt::print("wrote {}\n", path.string());
  if (written.empty()) fmt::print("{} files are current\n", sources);
}

}  // namespace

void add_generate(CLI::App& app) {
  const auto options = std::make_shared<GenerateOptions>();
  CLI::App* command = app.add_subcommand("generate", "Write a material's spline as Faust, C++ or JSON");
  command->add_option("MATERIAL", options->materials, kMaterialHelp)->required();
  std::set<std::string> names;
  for (const Emitter& emitter : emitters()) names.emplace(emitter.name);
  command->add_option("--emit", options->formats, "what to write; may be given again (default: all)")
      ->check(CLI::IsMember(names))
      ->type_name("FORMAT")
      ->allow_extra_args(false);
  CLI::Option* output =
      command->add_option("-o,--output", options->output, "folder to write to, or - for standard output")
          ->type_name("DIR")
          ->capture_default_str();
  CLI::Option* check =
      command->add_flag("--check", options->check, "write nothing; exit 1 and name the files that are stale");
  command->add_option("--depfile", options->depfile, "also write the make rule of what the outputs follow from")
      ->type_name("FILE")
      ->excludes(check);
  command->footer(
      "Examples:\n"
      "  contactspline generate felt_c4 -o generated\n"
      "  contactspline generate my_felt.json --emit faust --emit cpp -o build\n"
      "  contactspline generate felt_c4 --emit json -o -\n"
      "Files are named after the material; one whose bytes would not change is not touched.");
  command->callback([options, output, check] {
    if (options->check && output->count() > 0 && options->output == "-")
      throw BadInput("--check: needs files to compare with; allowed: -o DIR");
    generate(*options);
  });
}

}  // namespace contactspline
