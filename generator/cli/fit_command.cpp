// SPDX-License-Identifier: MIT
// contactspline fit: from measurements to a material file, and from recordings to an instrument file.
#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/unfinished_fit.hpp"
#include "generator/cli/waiting_line.hpp"
#include "generator/fit/fit.hpp"
#include "generator/fit/fitted_material.hpp"
#include "generator/fit/measurements_reader.hpp"
#include "generator/listen/fitted_instrument.hpp"
#include "generator/listen/instrument_fit.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"

namespace contactspline {
namespace {

/// What a fit makes: the file, a figure in a format, and what is printed.
struct FitOutputs {
  std::function<std::string()> text, printed;
  std::function<std::string(FigureFormat)> figure;
};

/// What a fit does, on the terminal.
class FitProgress {
 public:
  void set(const std::string& what) {
    const std::scoped_lock lock(mutex_);
    what_ = what;
  }

 private:
  std::mutex mutex_;
  std::string what_ = "fitting";
  WaitingLine line_{[this] {
    const std::scoped_lock lock(mutex_);
    return what_;
  }};
};

// Throws before the search where nothing could be written.
void require_fit_outputs(const FitOptions& options, const std::vector<std::string>& read) {
  const std::filesystem::path file = options.file;
  std::vector<std::filesystem::path> inputs{file}, outputs;
  if (!options.output.empty()) outputs.push_back(UnfinishedFit::file_of(options.output));
  for (const std::string& path : read) inputs.push_back(file.parent_path() / path);
  for (const std::string& output : {options.output, options.figure})
    if (!output.empty()) outputs.emplace_back(output);
  require_writable(outputs, inputs, options.force);
  if (!options.figure.empty()) require_kind(options.figure, FigureKind::kFit, options.force);
  require_creatable(outputs);
}

void write_fit(const FitOptions& options, const FitOutputs& made) {
  std::vector<OutputFile> files;
  if (!options.output.empty()) files.push_back({options.output, made.text()});
  if (!options.figure.empty()) files.push_back({options.figure, made.figure(figure_format(options.figure))});
  write_files(files);
  write_stdout(made.printed());
}

void fit_instrument(const FitOptions& options, const std::string& text, const ReadFile& read) {
  const RecordedInstrument recorded = parse_recorded_instrument(text, options.file, read);
  require_fit_outputs(options, recorded.files);
  std::optional<FitProgress> progress(std::in_place);
  UnfinishedFit unfinished(options.output, options.force, [&] {
    progress.reset();  // wipes its line
    print_error(fmt::format("{0}: goes on from what an interrupted fit has found; to begin anew, remove it",
                            UnfinishedFit::file_of(options.output).string()));
    progress.emplace();
  });
  StepsOnDisk disk;
  if (!options.output.empty())
    disk = {[&](const std::string& inputs) { return unfinished.read(inputs); },
            [&](const std::string& inputs, const StepResults& results) { unfinished.write(inputs, results); }};
  const auto found = [&] {
    try {
      return fit_instrument(
          recorded, read, [&](const std::string& what) { progress->set(what); }, disk);
    } catch (const BadInput&) {
      unfinished.remove();  // with nothing that the next fit could use
      throw;
    }
  }();
  progress.reset();
  write_fit(options, {[&] { return instrument_text(found, recorded, mark()); },
                      [&] { return options.json ? json_of(found, recorded) : report_of(found, recorded); },
                      [&](FigureFormat format) { return figure_of(found, recorded, format); }});
  unfinished.remove();
}

void fit_material(const FitOptions& options, const std::string& text, const ReadFile& read) {
  const Measurements measured = parse_measurements(text, options.file, read);
  require_fit_outputs(options, measured.files);
  std::optional<WaitingLine> line;
  const Fit found = fit_material(measured, options.file, [&](const std::string& what) { line.emplace(what); });
  line.reset();
  const std::string& title = measured.description.empty() ? measured.name : measured.description;
  write_fit(options, {[&] { return material_text(found, measured, mark()); },
                      [&] { return options.json ? json_of(found, measured) : report_of(found, measured); },
                      [&](FigureFormat format) { return figure_of(found, title, format); }});
}

}  // namespace

void fit(const FitOptions& options) {
  if (!options.figure.empty()) (void)figure_format(options.figure);  // throws before the search
  const std::filesystem::path file = options.file;
  const std::string text = read_input(file);
  constexpr int kMaxMib = 16;  // 10 s of two channels, 32 bit, 192 kHz
  const ReadFile read = [&](const std::string& path) { return read_large_input(file.parent_path() / path, kMaxMib); };
  if (is_recorded_instrument(text, options.file))
    fit_instrument(options, text, read);
  else
    fit_material(options, text, read);
}

}  // namespace contactspline
