// SPDX-License-Identifier: MIT
// contactspline generate: writes materials, resonators, keyboards and instruments as source files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/parallel.hpp"
#include "generator/cli/waiting_line.hpp"
#include "generator/cli/watched_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"

namespace contactspline {
namespace {

std::vector<Emitter> chosen_emitters(const GenerateOptions& options) {
  const auto is_chosen = [&](const Emitter& emitter) {
    return options.formats.empty() || std::ranges::find(options.formats, emitter.name) != options.formats.end();
  };
  std::vector<Emitter> chosen;
  std::ranges::copy_if(emitters(), std::back_inserter(chosen), is_chosen);
  for (Emitter& emitter : chosen) emitter.all_forms = options.all_forms;
  return chosen;
}

// The option --rate for the command that the output quotes; an empty text for the default rate.
std::string rate_option(const GenerateOptions& options) {
  const double rate = options.sample_rate_hz;
  return rate == GenerateOptions().sample_rate_hz ? "" : fmt::format(" --rate {}", rate);
}

/// The files to write, and the input files they depend on.
struct Emitted {
  std::vector<OutputFile> files;
  std::vector<std::filesystem::path> inputs;
  std::string remarks;  ///< a line for each file that cannot be written, and on what has too low a rate
};

/// What one material becomes, and the files that it was read from.
struct EmittedSource {
  std::string name;
  Emitted emitted;
};

EmittedSource emit_one(const std::string& argument, const GenerateOptions& options) {
  const Source source = source_argument(argument, options.sample_rate_hz / 2);
  const std::string& name = source.name;
  EmittedSource made{name, {{}, source.files, source.remark}};
  const WaitingLine line("emitting " + argument);
  for (const Emitter& emitter : chosen_emitters(options)) {
    if (emitter.name == "faust" && source.faust_obstacle) {
      if (!options.formats.empty())
        refuse(argument, "--emit", *source.faust_obstacle,
               "cpp, whose class hosts play (docs/reference/instruments.md), json");
      made.emitted.remarks += fmt::format("left out {}.{}: {}\n", name, emitter.extension, *source.faust_obstacle);
      continue;
    }
    const std::string command =
        fmt::format("contactspline generate {}.json --emit {}{}", name, emitter.name, rate_option(options));
    made.emitted.files.push_back(
        {std::filesystem::path(options.output) / fmt::format("{}.{}", name, emitter.extension),
         source.emit(emitter, command)});
  }
  return made;
}

Emitted emit_all(const GenerateOptions& options) {
  std::vector<EmittedSource> sources(options.materials.size());
  in_parallel(sources.size(), options.jobs, "emitted",
              [&](std::size_t i) { sources[i] = emit_one(options.materials[i], options); });
  Emitted all;
  std::set<std::string> names;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto& [name, emitted] = sources[i];
    if (!names.insert(name).second)
      refuse(options.materials[i], "name", fmt::format("'{}' is the name of two materials", name), "once");
    std::ranges::copy(emitted.files, std::back_inserter(all.files));
    std::ranges::copy(emitted.inputs, std::back_inserter(all.inputs));
    all.remarks += emitted.remarks;
  }
  return all;
}

void require_current(const std::vector<OutputFile>& files) {
  std::vector<std::string> stale;
  for (const OutputFile& file : files)
    if (!is_current(file)) stale.push_back(file.path.string());
  if (!stale.empty()) throw Stale(fmt::format("stale: {}; generate them again", fmt::join(stale, ", ")));
}

// A path with the escapes of make and ninja. Both double backslashes only before a space.
std::string in_make_rule(const std::string& path) {
  if (path.find_first_of("\r\n\t") != std::string::npos)
    refuse(path, "--depfile", "this path cannot stand in a make rule", "a path without tab or line end");
  std::string text;
  for (const char c : path) {
    if (c == ' ') text.append(text.size() - 1 - text.find_last_not_of('\\'), '\\');
    if (c == ' ' || c == '#') text += '\\';
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

// A make rule: all outputs depend on all input files.
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
    refuse(output, "-o", "is not a folder", "a folder, or - for standard output");
}

std::vector<std::filesystem::path> paths_of(const std::vector<OutputFile>& files) {
  std::vector<std::filesystem::path> paths;
  for (const OutputFile& file : files) paths.push_back(file.path);
  return paths;
}

// ninja reads no comment in a make rule, so a depfile cannot bear the mark. Its target is an emitted file.
bool is_own_depfile(const std::filesystem::path& path) {
  const std::string rule = beginning_of(path);
  const std::string_view targets = std::string_view(rule).substr(0, std::min(rule.find(": "), rule.find(":\n")));
  return std::ranges::any_of(emitters(), [&](const Emitter& emitter) {
    return targets.find('\n') == targets.npos && targets.ends_with(fmt::format(".{}", emitter.extension));
  });
}

void write_one_to_stdout(const std::vector<OutputFile>& files) {
  if (files.size() != 1)
    throw BadInput(fmt::format("-o: standard output takes one output, not {}; allowed: one MATERIAL and one --emit",
                               files.size()));
  write_stdout(files.front().bytes);
}

/// Returns the input files.
std::vector<std::filesystem::path> write_to_folder(const GenerateOptions& options, Emitted emitted) {
  require_folder(options.output);
  const std::size_t sources = emitted.files.size();
  require_writable(paths_of(emitted.files), emitted.inputs, options.force);
  if (!options.depfile.empty()) {
    emitted.files.push_back(depfile_of(options, emitted));
    require_distinct(paths_of(emitted.files), emitted.inputs);
    require_own(options.depfile, is_own_depfile, options.force);
  }
  create_folders_of({{emitted.files.front().path}});
  if (!options.depfile.empty()) create_folders_of({{options.depfile}});
  const auto written = write_files(emitted.files);
  std::string report = written.empty() ? fmt::format("{} files are current\n", sources) : "";
  for (const auto& path : written) report += fmt::format("wrote {}\n", path.string());
  report += emitted.remarks;
  write_stdout(report);
  return std::move(emitted.inputs);
}

// What is wrong with a changed file is said; what was written from the file before stays.
void write_whenever_changed(const GenerateOptions& options) {
  WatchedFiles watched;
  for (const std::string& argument : options.materials) watched.add(input_files(argument));
  watched.add(write_to_folder(options, emit_all(options)));
  for (;;) {
    watched.wait_for_change();
    try {
      watched.add(write_to_folder(options, emit_all(options)));
    } catch (const BadInput& error) {
      print_error(error.what());
    }
  }
}

void require_watchable(const GenerateOptions& options) {
  if (options.check || options.output == "-")
    throw BadInput(fmt::format("--watch: cannot be combined with {}; allowed: with -o DIR alone",
                               options.check ? "--check, which writes nothing" : "-o -"));
  for (const std::string& argument : options.materials)
    if (argument == kStandardInput || input_files(argument).empty())
      refuse(argument, "--watch", "is no file that can change", "a file, such as my_felt.json");
}

void require_compatible(const GenerateOptions& options) {
  if (options.watch) require_watchable(options);
  if (options.check && options.output == "-")
    throw BadInput("--check: needs files to compare with; allowed: with -o DIR");
  if (!options.depfile.empty() && options.output == "-")
    throw BadInput("--depfile: needs files to name; allowed: with -o DIR");
  if (!options.depfile.empty() && options.check)
    throw BadInput("--depfile: cannot be combined with --check, which writes nothing; allowed: one of the two");
  if (!options.depfile.empty() && std::ranges::find(options.materials, kStandardInput) != options.materials.end())
    throw BadInput("--depfile: standard input is no file to depend on; allowed: with material files");
}

}  // namespace

void generate(const GenerateOptions& options) {
  require_compatible(options);
  if (options.watch) return write_whenever_changed(options);
  const Emitted emitted = emit_all(options);
  if (options.output == "-") return write_one_to_stdout(emitted.files);
  if (options.check) return require_current(emitted.files);
  write_to_folder(options, emitted);
}

}  // namespace contactspline
