// SPDX-License-Identifier: MIT
// The only file that sees CLI11: every option of every subcommand, and every failure as one line.
#include "generator/cli/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/validators.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/player/tuning.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"
#include "generator/support/nearest_name.hpp"
#include "generator/support/sample_rates.hpp"

namespace contactspline {
namespace {

constexpr int kStale = 1;
constexpr int kBadInput = 2;

int complain(const std::string& message, int exit_code) {
  print_error(message);
  return exit_code;
}

void add_version(CLI::App& command) {
  command.set_version_flag("--version", "contactspline " CONTACTSPLINE_VERSION, "Print the version and exit");
  for (CLI::App* subcommand : command.get_subcommands([](CLI::App*) { return true; })) add_version(*subcommand);
}

const CLI::App& innermost_given(const CLI::App& app) {
  const auto given = app.get_subcommands();
  return given.empty() ? app : innermost_given(*given.front());
}

std::vector<std::string> words_of(const CLI::App& command) {
  std::vector<std::string> words;
  for (const auto* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
    words.push_back(subcommand->get_name());
  for (const auto* option : command.get_options()) words.push_back(option->get_name());
  return words;
}

// As it stands in the usage of a command: MATERIAL rather than --material.
std::string usage_name_of(const CLI::Option& option) {
  const std::string positional = option.get_name(true);
  return positional.empty() ? option.get_name() : positional;
}

std::string unknown(const CLI::App& command, const std::string& word) {
  const std::vector<std::string> words = words_of(command);
  return fmt::format("{}: unknown; allowed: {}{}", word, fmt::join(words, ", "),
                     did_you_mean(words, word.substr(0, word.find('='))));
}

// CLI11 says what is wrong, but not what is allowed.
std::string explained(const CLI::App& app, const CLI::ParseError& error) {
  std::string wrong = error.what();
  const CLI::App& command = innermost_given(app);
  const bool is_value = dynamic_cast<const CLI::ValidationError*>(&error) != nullptr;
  for (const std::string& word : app.remaining(true))
    if (!is_value && word != "--") return unknown(command, word);
  auto options = command.get_options();
  std::ranges::sort(options, std::ranges::greater(), [](const auto* option) { return option->get_name().size(); });
  for (const auto* option : options) {  // --speeds before --speed
    const std::string name = option->get_name(), label = usage_name_of(*option);
    if (is_value && wrong.starts_with(name + ":")) return label + wrong.substr(name.size());
    if (is_value || wrong.find(name) == std::string::npos) continue;
    const std::string what = wrong == name + " is required" ? label + ": missing"
                             : wrong.starts_with(name)      ? label + wrong.substr(name.size())
                                                            : label + ": " + wrong;
    std::string allowed = option->get_description();
    std::ranges::replace(allowed, '\n', ' ');
    return fmt::format("{}; allowed: {}", what, allowed);
  }
  return wrong;
}

// CLI11 prints --help and --version here, whatever else is wrong but an unknown word; the text goes out through
// write_stdout(), which checks.
void parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) write_stdout(app.help());
  } catch (const CLI::Success& request) {
    if (const auto unknown = app.remaining(true); !unknown.empty()) throw CLI::ExtrasError(unknown);
    std::ostringstream text;
    app.exit(request, text);
    write_stdout(text.str());
  }
}

constexpr auto kMaterialHelp = "material file (.json), or the name of a material that ships; -: standard input";
constexpr auto kSourceHelp = "file (.json), or the name of something that `list` prints; -: standard input";
constexpr auto kScoreHelp = "score file (.json, .mid), or the name of a score that ships; -: standard input";

// In an option for an input file, - is standard input.
std::string named_input(const std::string& argument) {
  return argument == "-" ? std::string(kStandardInput) : argument;
}

// An argument or an option that is a text, or several texts.
template <typename Texts>
CLI::Option* add_text(CLI::App& command, const char* name, Texts& texts, const char* help) {
  return command.add_option(name, texts, help)->check(not_empty(help));
}

template <typename Texts>
CLI::Option* add_input(CLI::App& command, const char* name, Texts& inputs, const char* help) {
  return add_text(command, name, inputs, help)->transform(named_input);
}

CLI::Option* add_output_file(CLI::App& command, const char* name, std::string& file, const char* help) {
  return command.add_option(name, file, help)->check(file_name())->type_name("FILE");
}

CLI::Option* add_output_folder(CLI::App& command, const char* name, std::string& folder, const char* help,
                               const char* allowed = "a folder") {
  return command.add_option(name, folder, help)->check(folder_name(allowed))->type_name("DIR");
}

template <typename Numbers, typename Limit>
CLI::Option* add_number(CLI::App& command, const char* name, Numbers& numbers, const char* help, Limit min,
                        Limit max) {
  return command.add_option(name, numbers, help)->check(number_from(min, max));
}

void add_force(CLI::App& command, bool& force) {
  command.add_flag("--force", force,
                   "also replace files that this program did not write, and figures of another kind");
}

void add_jobs(CLI::App& command, int& jobs) {
  add_number(command, "--jobs", jobs, "files to work on at once (default: one for each core)", 1, 256);
}

void add_generate(CLI::App& app) {
  const auto options = std::make_shared<GenerateOptions>();
  CLI::App* command =
      app.add_subcommand("generate", "Write a material, a resonator, a keyboard or an instrument as source text");
  add_input(*command, "MATERIAL", options->materials, kSourceHelp)->required();
  std::vector<std::string> formats;
  for (const Emitter& emitter : emitters()) formats.emplace_back(emitter.name);
  command->add_option("--emit", options->formats, "format to write; may be repeated (default: all)")
      ->check(one_of(formats))
      ->type_name("FORMAT")
      ->allow_extra_args(false);
  add_output_folder(*command, "-o,--output", options->output, "folder to write to, or - for standard output",
                    "a folder, or - for standard output")
      ->capture_default_str();
  add_number(*command, "--rate", options->sample_rate_hz,
             "sample rate in Hz; resonators and instruments keep their modes below half of it", kSampleRates_hz.min,
             kSampleRates_hz.max)
      ->capture_default_str();
  command->add_flag("--all-forms", options->all_forms,
                    "C++ headers of materials: also the normalised and the regular form of the spline");
  command->add_flag("--check", options->check, "write nothing; exit 1 and name the files that are stale");
  command->add_flag("--watch", options->watch, "write again whenever a file has changed, until Ctrl-C");
  add_output_file(*command, "--depfile", options->depfile,
                  "also write a make rule with the files that the outputs depend on");
  add_jobs(*command, options->jobs);
  add_force(*command, options->force);
  command->footer(
      "Examples:\n"
      "  contactspline generate felt_c4 -o generated\n"
      "  contactspline generate my_felt.json --emit faust --emit cpp -o build\n"
      "  contactspline generate felt_c4 --emit json -o -\n"
      "  contactspline generate string_c4 --rate 96000 -o build\n"
      "  contactspline generate my_felt.json --emit faust --watch\n"
      "Each file has the name of its material, resonator, keyboard or instrument. An instrument is a Faust program\n"
      "too if its contacts, springs, links and modes are few. A file that would not change is not touched.\n"
      "A file that this program did not write is replaced only with --force.");
  command->callback([options] { generate(*options); });
}

void add_plugin(CLI::App& app) {
  const auto options = std::make_shared<PluginOptions>();
  CLI::App* command = app.add_subcommand("plugin", "Make CLAP, VST3 and LV2 plug-ins of an instrument");
  add_text(*command, "INSTRUMENT", options->instrument,
           "instrument file (.json), or the name of an instrument that ships")
      ->required();
  add_output_folder(*command, "-o,--output", options->output, "folder for the project and the plug-ins")->required();
  add_text(*command, "--vendor", options->vendor, "name of the maker that hosts show")
      ->type_name("NAME")
      ->capture_default_str();
  command->add_flag("--no-build", options->no_build, "write the project of CMake only, and build nothing");
  add_force(*command, options->force);
  command->footer(
      "Example:\n"
      "  contactspline plugin my_zither.json -o zither --vendor Me\n"
      "It needs cmake, a compiler of C++20, the installed package and the DISTRHO Plugin Framework; on Debian: "
      "cmake,\n"
      "g++ and dpf-source. The project can be built again, and changed, with cmake alone.");
  command->callback([options] { make_plugin(*options); });
}

#ifdef CONTACTSPLINE_DATASETS
void add_dataset(CLI::App& app) {
  const auto options = std::make_shared<DatasetOptions>();
  CLI::App* command = app.add_subcommand("dataset", "Render thousands of samples of an instrument into HDF5 files");
  add_text(*command, "PLAN", options->plan, "plan file (.json): what is played, over which values, and what is kept")
      ->required();
  add_output_folder(*command, "-o,--output", options->output, "folder for the files")->required();
  CLI::Option* all =
      add_number(*command, "--shards", options->shards, "number of files; a further one joins them", 1, 99999)
          ->capture_default_str();
  const auto one = [options](const std::string& text) {
    options->only = std::stoul(text);
    options->shards = std::stoul(text.substr(text.find('/') + 1));
  };
  command->add_option_function<std::string>("--shard", one, "write shard I of N only, such as 3/64")
      ->check(part_of_whole(99999))
      ->type_name("I/N")
      ->excludes(all);
  add_number(*command, "--threads", options->threads, "number of threads (default: one for each core)", 1, 1024);
  command->add_flag("--join", options->join, "write no sample: join the --shards that are there");
  command->add_flag("--force", options->force,
                    "also replace shards of other plans, and files that this program did not write");
  command->footer(
      "Examples:\n"
      "  contactspline dataset strikes.json -o strikes\n"
      "  contactspline dataset strikes.json -o strikes --shards 64\n"
      "  contactspline dataset strikes.json -o strikes --shard 3/64\n"
      "  contactspline dataset strikes.json -o strikes --shards 64 --join\n"
      "A sample depends on the plan alone: not on shards and threads. A shard is written as a whole or not at all.\n"
      "One that is there and whose checksums agree is kept, so the same command goes on where it was stopped.");
  command->callback([options] { make_dataset(*options); });
}
#endif

void add_inspect(CLI::App& app) {
  const auto options = std::make_shared<InspectOptions>();
  CLI::App* command = app.add_subcommand(
      "inspect", "Show a material, a friction, a resonator's modes, a keyboard's keys, an instrument");
  add_input(*command, "MATERIAL", options->materials, kSourceHelp)->required();
  add_output_file(*command, "--figure", options->figure,
                  "also draw the spline, the law, the modes or the instrument (.svg, .png, .pdf)");
  command->add_flag("--compare", options->compare,
                    "compare uniform, graded and optimal knots, in the table and in the figure");
  command->add_flag("--json", options->json, "print all numbers as JSON; errors as fractions, not in %");
  add_number(*command, "--rate", options->sample_rate_hz,
             "of a resonator's, keyboard's or instrument's simulation in Hz (default: 44100)", 1e3, 1e8);
  add_jobs(*command, options->jobs);
  add_force(*command, options->force);
  command->footer(
      "Examples:\n"
      "  contactspline inspect felt_c4 --figure felt_c4.svg\n"
      "  contactspline inspect my_felts/*.json --jobs 2\n"
      "  contactspline inspect felt_c4 --compare --figure families.svg\n"
      "  contactspline inspect string_c4 --rate 48000\n"
      "  contactspline inspect tanpura --figure tanpura.svg");
  command->callback([options] { inspect(*options); });
}

void add_list(CLI::App& app) {
  const auto kind = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "list", "List materials, frictions, resonators, keyboards, instruments and scores that ship");
  command->add_option("KIND", *kind, "what to list (default: all)")->check(one_of(kinds_that_ship()));
  command->callback([kind] { list(*kind); });
}

void add_show(CLI::App& app) {
  const auto name = std::make_shared<std::string>(), own_name = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("show", "Print a file that ships, to start a file of your own from");
  add_text(*command, "NAME", *name, "name of something that ships, as `list` prints it")->required();
  add_text(*command, "--name", *own_name, "name that the printed file states instead of its own");
  command->footer(
      "Examples:\n"
      "  contactspline show felt_c4 --name my_felt > my_felt.json\n"
      "  contactspline show felt_synthetic.csv > felt_synthetic.csv");
  command->callback([name, own_name] { show(*name, *own_name); });
}

void add_impact(CLI::App& app) {
  const auto options = std::make_shared<ImpactOptions>();
  CLI::App* command = app.add_subcommand("impact", "Compare exact, spline and simulated impacts on a rigid barrier");
  add_input(*command, "MATERIAL,--material", options->materials, kMaterialHelp)->required();
  add_number(*command, "--speed", options->speeds,
             "impact speed in m/s; may be repeated (default: the material's largest)", 1e-6, 1e3)
      ->allow_extra_args(false);
  add_number(*command, "--rate", options->rates, "sample rate in Hz; may be repeated", 1e3, 1e8)
      ->allow_extra_args(false)
      ->capture_default_str();
  command
      ->add_option("--speeds", options->speed_range,
                   "lowest and highest speed in m/s and their number: a table of speeds at equal ratios")
      ->expected(3)
      ->type_name("MIN MAX COUNT");
  command->add_flag("--csv", options->csv, "print all numbers as CSV; errors as fractions, not in %");
  command->add_flag("--json", options->json, "print all numbers as JSON; errors as fractions, not in %");
  add_output_file(*command, "--figure", options->figure,
                  "also draw impacts over --speeds or time, or errors over --rate (.svg, .png, .pdf)");
  command
      ->add_option("--over", options->over,
                   "what the figure is over (default: speed with --speeds, time with one\n"
                   "--rate, else rate)")
      ->check(one_of({"speed", "rate", "time"}))
      ->type_name("");
  add_output_file(*command, "--trace", options->trace,
                  "also write time, compression and force of each impact as a table (.csv)");
  add_force(*command, options->force);
  command->footer(
      "Examples:\n"
      "  contactspline impact mb1 felt_c4 --speed 2\n"
      "  contactspline impact felt_c4 --speeds 0.1 6 20 --rate 44100\n"
      "  contactspline impact felt_c4 felt_c2 --speeds 0.1 6 200 --rate 44100 --figure impacts.svg\n"
      "  contactspline impact felt_c4 --speed 1 --speed 5 --figure errors.svg\n"
      "  contactspline impact felt_c4 --speed 2 --rate 44100 --over time --figure blow.svg\n"
      "  contactspline impact felt_c4 felt_c2 --speed 2 --trace blows.csv\n"
      "Errors are relative to the exact motion under the contact law with the material's loss. Where the time step\n"
      "dominates, they fall by 4 with each doubling of the rate; with loss by 2. samples: duration of the exact\n"
      "contact in samples. A table of speeds states the errors of the contact duration at each rate.");
  command->callback([options] { compare_impacts(*options); });
}

void add_fit(CLI::App& app) {
  const auto options = std::make_shared<FitOptions>();
  CLI::App* command =
      app.add_subcommand("fit", "Make a material file from measurements, or an instrument file from recordings");
  add_text(*command, "FILE", options->file, "fit file (.json), which names the data")->required();
  add_output_file(*command, "-o,--output", options->output, "material or instrument file to write (.json)");
  add_output_file(*command, "--figure", options->figure, "also draw data, model and residuals (.svg, .png, .pdf)");
  command->add_flag("--json", options->json, "print all numbers as JSON; of a material, scatter in parts, not in %");
  add_force(*command, options->force);
  command->footer(
      "Example:\n"
      "  contactspline fit my_felt.fit.json -o my_felt.json --figure my_felt.svg\n"
      "The data are force pulses over time, or contact durations, largest forces and restitution over the speed,\n"
      "of a known mass that meets a rigid wall, or levels of the partials of a resonator that it strikes.\n"
      "The law and its loss are chosen by an information criterion. Or the data are recordings of an instrument, "
      "and\n"
      "an instrument file in which numbers are left open as {\"fit\": [min, max]}.");
  command->callback([options] { fit(*options); });
}

void add_outputs(CLI::App& command, RenderOutput& output) {
  add_number(command, "--rate", output.sample_rate_hz, "sample rate in Hz", static_cast<int>(kSampleRates_hz.min),
             static_cast<int>(kSampleRates_hz.max))
      ->capture_default_str();
  command
      .add_option("--oversample", output.oversampling,
                  "run the models at so many times the rate, for short contacts\n"
                  "(default: 1, or as a score says)")
      ->check(one_of({"1", "2", "4", "8"}))
      ->type_name("FACTOR");
  command.add_option("--bits", output.bits, "of a sample: 16, 24, or 32 for numbers of single precision")
      ->check(one_of({"16", "24", "32"}))
      ->type_name("BITS")
      ->capture_default_str();
  add_output_file(command, "-o,--output", output.sound,
                  "sound file to write (.wav, .flac, .ogg, .aiff;\n"
                  "default: NAME.wav in the working folder, of the score or material)");
  add_output_file(command, "--figure", output.figure,
                  "figure to write (.svg, .png, .pdf; default: the sound file's name with .svg)");
  command.add_flag("--no-figure", output.no_figure, "draw no figure");
  CLI::Option* level = add_number(command, "--level", output.level_db,
                                  "level of the peak in dB of full scale (default: that of the score, or -1)",
                                  kLevel_db.min, kLevel_db.max);
  command
      .add_option_function<std::string>(
          "--gain", [&output](const std::string& gain) { output.gain_db = gain == "off" ? 0 : std::stod(gain); },
          "instead of --level: full scale is 1 N, m, m/s or Pa, DB lower; off: 0 dB")
      ->check(number_or("off", -300, 300))
      ->type_name("DB")
      ->excludes(level);
  add_force(command, output.force);
}

void add_mass_barrier(CLI::App& render) {
  const auto options = std::make_shared<MassBarrierOptions>();
  CLI::App* command =
      render.add_subcommand("mass-barrier", "A mass thrown at a rigid barrier; with gravity it bounces");
  const auto number = [&](const char* name, auto& value, const char* help, double min, double max) {
    return add_number(*command, name, value, help, min, max);
  };
  add_input(*command, "MATERIAL,--material", options->material, kMaterialHelp)->capture_default_str();
  number("--mass", options->mass_kg, "mass in kg (default: the material's)", 1e-9, 1e4);
  number("--speed", options->speed_m_per_s, "speed of the throw in m/s (default: the material's largest)", 0.0, 1e3);
  number("--start", options->start_m, "displacement at the throw in m, into the barrier", -1e3, 1.0)
      ->capture_default_str();
  number("--gravity", options->gravity_m_per_s2, "gravity towards the barrier in m/s^2", 0.0, 1e3)
      ->capture_default_str();
  number("--stiffness-ratio", options->stiffness_ratio, "multiplies the material's stiffness", 1e-6, 1e6)
      ->capture_default_str();
  number("--loss", options->loss_s_per_m, "Hunt-Crossley loss in s/m (default: the material's)", 0.0, 1e3);
  number("--duration", options->duration_s, "duration in s", 1e-3, 3600.0)->capture_default_str();
  command->add_option("--signal", options->signal, "the signal in the sound file")
      ->check(one_of({"force", "displacement"}))
      ->capture_default_str();
  add_outputs(*command, options->output);
  command->footer(
      "Example:\n"
      "  contactspline render mass-barrier rubber_on_wood --loss 0.08 -o bounce.wav");
  command->callback([options] { render_mass_barrier(*options); });
}

void add_tuning(CLI::App& command, ScoreOptions& options) {
  command
      .add_option("--tuning", options.tuning, "scale of the keys, a file of Scala (.scl; default: equal temperament)")
      ->check(not_empty("a file"))
      ->type_name("FILE");
  command.add_option("--keymap", options.keymap, "which key plays which tone of the scale, a file of Scala (.kbm)")
      ->check(not_empty("a file"))
      ->type_name("FILE");
  add_number(command, "--a4", options.a4_hz, "pitch of A4, key 69, in Hz", kA4_hz.min, kA4_hz.max);
}

std::shared_ptr<ScoreOptions> add_score_options(CLI::App& command) {
  auto options = std::make_shared<ScoreOptions>();
  command
      .add_option("--signal", options->signal,
                  "what the sound is: one of the outputs of the instrument, or of a keyboard:\n"
                  "body, bridge, velocity, displacement or force (default: what sounds best)")
      ->check(not_empty("an output"));
  command.add_option("--precision", options->precision, "floating-point precision of the model")
      ->check(one_of({"single", "double"}))
      ->capture_default_str();
  add_output_folder(command, "--stems", options->stems,
                    "folder for one file per voice, in the format and with the gain of the sound");
  add_number(command, "--channel", options->channels,
             "MIDI channel to play; may be repeated (default: all but 10, which is for drums)", 1, 16)
      ->allow_extra_args(false);
  command
      .add_option("--instrument", options->instruments,
                  "what plays a MIDI file (default: the piano): a keyboard or an instrument\n"
                  "with keys, or a model of your own (.so), which plays scores, too;\n"
                  "or several by channel, program or for the others: 1=piano,10=kit,p41=violin,*=cello")
      ->allow_extra_args(false)
      ->check(not_empty("an instrument"))
      ->type_name("FILE");
  add_number(command, "--tail", options->tail_s,
             "seconds behind the last note of a MIDI file, or the duration of a score\n"
             "(default: a MIDI file sounds until it is 60 dB down)",
             0.0, 600.0);
  add_tuning(command, *options);
  return options;
}

void add_render(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Play a score, or an instrument, to a sound file and a figure");
  command->require_subcommand(0, 1);
  const auto options = add_score_options(*command);
  add_input(*command, "SCORE,--score", options->scores, kScoreHelp);
  add_outputs(*command, options->output);
  command->footer(
      "Examples:\n  contactspline render fur_elise\n  contactspline render my_song.mid -o song.flac\n"
      "  contactspline render first.mid second.mid --bits 16\n"
      "  contactspline render my_song.mid --instrument my_zither.json -o zither.wav\n"
      "  contactspline render my_song.mid --instrument 1=piano,2=cello,10=kit\n"
      "The scores that ship: contactspline list scores");
  // As in 0.1.0, `render hammer-string --score SCORE`: the same, not listed.
  const CLI::App* hammers = command->add_subcommand("hammer-string")->group("")->fallthrough();
  command->callback([command, hammers, options] {
    if (const auto given = command->get_subcommands(); !given.empty() && given.front() != hammers) return;
    if (options->scores.empty()) throw CLI::RequiredError("--score");
    render_scores(*options);
  });
  add_mass_barrier(*command);
}

void add_all(CLI::App& app) {
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(34);
  app.footer(
      "First steps:\n"
      "  contactspline list\n"
      "  contactspline inspect felt_c4 --figure felt_c4.svg\n"
      "  contactspline generate felt_c4 -o generated\n"
      "  contactspline render mass-barrier --material rubber_on_wood -o bounce.wav\n"
      "Exit status: 0; 1 if --check finds stale files; 2 for bad input, with one line that names it.");
  add_generate(app);
  add_inspect(app);
  add_list(app);
  add_show(app);
  add_impact(app);
  add_fit(app);
  add_render(app);
  add_plugin(app);
#ifdef CONTACTSPLINE_DATASETS
  add_dataset(app);
#endif
  add_version(app);
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  CLI::App app(
      "Collisions in musical instruments without iteration: splines of contact potentials for Faust and C++.",
      "contactspline");
  add_all(app);
  try {
    parse(app, argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return complain(explained(app, error), kBadInput);
  } catch (const Stale& error) {
    return complain(error.what(), kStale);
  } catch (const BadInput& error) {
    return complain(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return complain("memory: not enough; allowed: a shorter duration, a lower rate or fewer segments", kBadInput);
  } catch (const std::exception& error) {
    return complain(fmt::format("internal error, please report: {}", error.what()), kBadInput);
  }
}

}  // namespace contactspline
