// SPDX-License-Identifier: MIT
// contactspline plugin: an instrument as a project of CMake that makes CLAP, VST3 and LV2 plug-ins of it, and builds
// it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/plugin_build.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/nearest_name.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {
namespace {

namespace fs = std::filesystem;

// All bytes of a file, or of the files in a bundle.
std::uintmax_t size_of(const fs::path& plugin) {
  if (!fs::is_directory(plugin)) return fs::file_size(plugin);
  std::uintmax_t bytes = 0;
  for (const auto& file : fs::recursive_directory_iterator(plugin))
    if (file.is_regular_file()) bytes += file.file_size();
  return bytes;
}

std::string project_text(const std::string& name, const std::string& vendor, bool has_input) {
  return fill_template(emitted_template("plugin_project", "cmake"),
                       {{"NAME", name},
                        {"VENDOR", vendor},
                        {"INPUTS", has_input ? "1" : "0"},
                        {"VERSION", CONTACTSPLINE_VERSION},
                        {"COMMAND", fmt::format("contactspline plugin {}.json", name)}});
}

}  // namespace

void make_plugin(const PluginOptions& options) {
  if (options.vendor.find_first_of("\"\\;$@\n") != std::string::npos)
    throw BadInput("--vendor: has a character that CMake reads; allowed: a name without \" \\ ; $ and @");
  const auto instrument = instrument_argument(options.instrument);
  if (!instrument)
    refuse(options.instrument, "INSTRUMENT", "is no instrument",
           fmt::format("an instrument file (.json), or a name of `contactspline list instruments`{}",
                       did_you_mean(shipped_names(Shipped::kInstruments), options.instrument)));
  if (!options.no_build) require_compiler();
  const Source source = source_argument(options.instrument, GenerateOptions().sample_rate_hz / 2);
  const fs::path project = options.output;
  const auto is_class = [](const Emitter& emitter) { return emitter.name == "cpp"; };
  const std::vector<OutputFile> files = {
      {project / "CMakeLists.txt",
       project_text(source.name, options.vendor, !instrument->model.input.places.empty())},
      {project / (source.name + ".hpp"), source.emit(*std::ranges::find_if(emitters(), is_class),
                                                     fmt::format("contactspline plugin {}.json", source.name))}};
  const std::vector<fs::path> paths = {files[0].path, files[1].path};
  require_writable(paths, source.files, options.force);
  create_folders_of(paths);
  std::string report;
  for (const fs::path& path : write_files(files)) report += fmt::format("wrote {}\n", path.string());
  if (options.no_build) return write_stdout(report);
  build_plugin(project, source.name);
  for (const char* format : {"clap", "vst3", "lv2"}) {
    const fs::path plugin = project / format / fmt::format("{}.{}", source.name, format);
    report += fmt::format("built {}, {} kB: for ~/.{}\n", plugin.string(), size_of(plugin) / 1000, format);
  }
  write_stdout(report);
}

}  // namespace contactspline
