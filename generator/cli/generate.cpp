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

#include "generator/cli/allowed.hpp"
#include "generator/cli/commands.hpp"
#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"
#include "generator/cli/source_argument.hpp"
#include "generator/error.hpp"

namespace contactspline {
namespace {

constexpr auto kSourceHelp = "material or resonator file (.json), or the name of one that ships";

struct GenerateOptions {
  std::vector<std::string> materials;
  std::vector<std::string> formats;
  std::string output = ".";
  std::string depfile;
  double sample_rate_hz = 44100;
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

// As it stands in the command quoted in the output: where it is not the default.
std::string rate_option(const GenerateOptions& options) {
  const double rate = options.sample_rate_hz;
  return rate == GenerateOptions().sample_rate_hz ? "" : fmt::format(" --rate {}", rate);
}

/// What is to be written, and the files it follows from.
struct Emitted {
  std::vector<OutputFile> files;
  std::vector<std::filesystem::path> inputs;
};

Emitted emit_all(const GenerateOptions& options) {
  Emitted emitted;
  std::set<std::string> names;
  for (const std::string& argument : options.materials) {
    const Source source = source_argument(argument, options.sample_rate_hz / 2);
    const std::string& name = source.name;
    if (!names.insert(name).second)
      throw BadInput(fmt::format("{}: name: '{}' is the name of two materials; allowed: once", argument, name));
    emitted.inputs.insert(emitted.inputs.end(), source.files.begin(), source.files.end());
    for (const Emitter& emitter : chosen_emitters(options.formats)) {
      const std::string command =
          fmt::format("contactspline generate {}.json --emit {}{}", name, emitter.name, rate_option(options));
      emitted.files.push_back({std::filesystem::path(options.output) / fmt::format("{}.{}", name, emitter.extension),
                               source.emit(emitter, command)});
    }
  }
  return emitted;
}

void require_current(const std::vector<OutputFile>& files) {
  std::vector<std::string> stale;
  for (const OutputFile& file : files)
    if (!is_current(file)) stale.push_back(file.path.string());
  if (!stale.empty()) throw Stale(fmt::format("stale: {}; generate them again", fmt::join(stale, ", ")));
}

// A path as make and ninja read it. Backslashes double before a space only: make's rule, and ninja's.
std::string in_make_rule(const std::string& path) {
  if (path.find_first_of("\r\n\t") != std::string::npos)
    throw BadInput(fmt::format("{}: --depfile: no make rule can hold this path; allowed: no tab or line end", path));
  std::string text;
  for (const char c : path) {
    if (c == ' ') text.append(text.size() - 1 - text.find_last_not_of('\\'), '\\');
    if (c == ' ' || c == '#') text += '\\';
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

// What make and ninja need to know: the outputs follow from the material files.
OutputFile depfile_of(const GenerateOptions& options, const Emitted& emitted) {
  std::string rule;
  for (const OutputFile& file : emitted.files) rule += in_make_rule(file.path.string()) + " ";
  rule.back() = ':';
  for (const auto& input : emitted.inputs) rule += " " + in_make_rule(input.string());
  return {options.depfile, rule + "\n"};
}

void require_folder(const std::string& output) {
  std::error_code error;
  if (std::filesystem::exists(output, error) && !std::filesystem::is_directory(output, error))
    throw BadInput(fmt::format("{}: -o: is not a folder; allowed: a folder, or - for standard output", output));
}

void require_distinct_files(const Emitted& emitted) {
  std::vector<std::filesystem::path> outputs;
  for (const OutputFile& file : emitted.files) outputs.push_back(file.path);
  require_distinct(outputs, emitted.inputs);
}

void write_one_to_stdout(const std::vector<OutputFile>& files) {
  if (files.size() != 1)
    throw BadInput(fmt::format("-o: {} outputs do not fit on standard output; allowed: one MATERIAL and one --emit",
                               files.size()));
  write_stdout(files.front().bytes);
}

void write_to_folder(const GenerateOptions& options, Emitted emitted) {
  const std::size_t sources = emitted.files.size();
  if (!options.depfile.empty()) emitted.files.push_back(depfile_of(options, emitted));
  require_distinct_files(emitted);
  const auto written = write_files(emitted.files);
  std::string report = written.empty() ? fmt::format("{} files are current\n", sources) : "";
  for (const auto& path : written) report += fmt::format("wrote {}\n", path.string());
  write_stdout(report);
}

// Standard output has no file to compare with or to name in a rule; a check writes no rule.
void require_compatible(const GenerateOptions& options) {
  if (options.check && options.output == "-")
    throw BadInput("--check: needs files to compare with; allowed: with -o DIR");
  if (!options.depfile.empty() && options.output == "-")
    throw BadInput("--depfile: needs files to name; allowed: with -o DIR");
  if (!options.depfile.empty() && options.check)
    throw BadInput("--depfile: would be written, and --check writes nothing; allowed: one of the two");
}

void generate(const GenerateOptions& options) {
  require_compatible(options);
  const Emitted emitted = emit_all(options);
  if (options.output == "-") return write_one_to_stdout(emitted.files);
  require_folder(options.output);
  if (options.check) return require_current(emitted.files);
  write_to_folder(options, emitted);
}

}  // namespace

void add_generate(CLI::App& app) {
  const auto options = std::make_shared<GenerateOptions>();
  CLI::App* command =
      app.add_subcommand("generate", "Write a material's spline or a resonator's modes as Faust, C++ or JSON");
  command->add_option("MATERIAL", options->materials, kSourceHelp)->check(not_empty(kSourceHelp))->required();
  std::vector<std::string> formats;
  for (const Emitter& emitter : emitters()) formats.emplace_back(emitter.name);
  command->add_option("--emit", options->formats, "what to write; may be given again (default: all)")
      ->check(one_of(formats))
      ->type_name("FORMAT")
      ->allow_extra_args(false);
  command->add_option("-o,--output", options->output, "folder to write to, or - for standard output")
      ->check(not_empty("a folder, or - for standard output"))
      ->type_name("DIR")
      ->capture_default_str();
  command
      ->add_option("--rate", options->sample_rate_hz,
                   "sample rate in Hz; modes of resonators are kept below half of it")
      ->check(number_from(1000.0, 768000.0))
      ->capture_default_str();
  command->add_flag("--check", options->check, "write nothing; exit 1 and name the files that are stale");
  command->add_option("--depfile", options->depfile, "also write the make rule of what the outputs follow from")
      ->check(file_name())
      ->type_name("FILE");
  command->footer(
      "Examples:\n"
      "  contactspline generate felt_c4 -o generated\n"
      "  contactspline generate my_felt.json --emit faust --emit cpp -o build\n"
      "  contactspline generate felt_c4 --emit json -o -\n"
      "  contactspline generate string_c4 --rate 96000 -o build\n"
      "Files are named after the material or resonator; one whose bytes would not change is not touched.");
  command->callback([options] { generate(*options); });
}

}  // namespace contactspline
