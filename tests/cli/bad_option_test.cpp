// SPDX-License-Identifier: MIT
// All the errors that a command line can have: one line that names option or file and what is allowed, nothing
// written.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "cases.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

constexpr auto kWithoutImpact = R"({
  "name": "bare",
  "contact": { "stiffness_n_per_m_alpha": 1e9, "exponent": 2 },
  "spline": { "knots": "uniform", "segments": 8, "max_compression_m": 1e-3 }
})";

constexpr auto kSoft = R"({
  "name": "soft",
  "contact": { "stiffness_n_per_m_alpha": 0.001, "exponent": 10 },
  "impact": { "mass_kg": 1e4, "max_speed_m_per_s": 1e-6, "min_speed_m_per_s": 1e-6 },
  "spline": { "knots": "uniform", "segments": 8, "max_compression_m": 1 }
})";

std::string score_of(const std::string& resonator, const std::string& material) {
  return R"({ "instrument": "hammer-string", "duration_s": 0.05, "voices": [ { "name": "a", "resonator": ")" +
         resonator + R"(", "material": ")" + material +
         R"(" } ], "events": [ { "time_s": 0, "speed_m_per_s": 2 } ] })";
}

struct BadLine {
  std::string test;
  Words words;
  std::string beginning;  ///< the message begins with it
  std::string says;
};

void PrintTo(const BadLine& bad, std::ostream* stream) {
  *stream << bad.test;
}

const std::string kShipped =
    "allowed: a .json file, felt_c2, felt_c4, felt_c7, felt_live, felt_over_wood, felt_stulov_c4, felt_synthetic, "
    "mb1, rubber_on_wood, steel_ball_on_plate, steel_on_steel";

std::vector<BadLine> command_cases() {
  const std::string commands = "generate, inspect, list, show, impact, fit, render, plugin, dataset";
  return {
      {"nothing", {}, "SUBCOMMAND: missing", "allowed: " + commands},
      {"unknown", {"generte"}, "generte: unknown", "allowed: " + commands},
      {"unknown_option", {"--verbose"}, "--verbose: unknown", "allowed: " + commands + ", --help, --version"},
      {"unknown_with_control_characters", {"a\nb\t\033[31m"}, "a?b??[31m: unknown", "allowed: "},
      {"two_commands", {"list", "inspect"}, "KIND: 'inspect' is refused", "allowed: materials, resonators"},
      {"upper_case", {"Generate", "probe.json"}, "Generate: unknown", "allowed: " + commands},
      {"list_of_no_kind",
       {"list", "felt_c4"},
       "KIND: 'felt_c4' is refused",
       "allowed: materials, resonators, keyboards, instruments, scores"},
      {"list_of_two", {"list", "scores", "materials"}, "materials: unknown", "allowed: --help, KIND, --version"},
      {"list_with_option", {"list", "--json"}, "--json: unknown", "allowed: --help, KIND, --version"},
      {"show_nothing", {"show"}, "NAME: missing", "allowed: name of something that ships"},
      {"show_unknown", {"show", "felt_c5"}, "felt_c5: NAME: nothing of this name ships", "felt_c4, "},
      {"show_file", {"show", "./probe.json"}, "./probe.json: NAME: nothing of this name ships", "string_c4, "},
      {"show_template", {"show", "material.hpp.in"}, "material.hpp.in: NAME: nothing of this name", "piano, "},
      {"old_commands", {"materials"}, "materials: unknown", "allowed: " + commands},
      {"impact_of_resonator", {"impact", "string_c4"}, "string_c4: MATERIAL: is a resonator", "allowed: a material"},
      {"impact_of_resonator_file",
       {"impact", "my_string.json"},
       "my_string.json: file: is a resonator",
       "allowed: a material"},
      {"inspect_score",
       {"inspect", "dulcimer"},
       "dulcimer: MATERIAL: is a score",
       "allowed: a material, resonator, keyboard or instrument"},
      {"inspect_unknown",
       {"inspect", "felt_c5"},
       "felt_c5: MATERIAL: no such material, resonator, keyboard or instrument ships",
       "allowed: a .json file, felt_c2, "},
      {"inspect_misspelt",
       {"inspect", "tricord_c4"},
       "tricord_c4: MATERIAL: no such material, resonator, keyboard or instrument ships",
       "allowed: a .json file, trichord_c4, felt_c2, "},
      {"inspect_score_file",
       {"inspect", "my_score.json"},
       "my_score.json: file: is a score",
       "allowed: a material, resonator, keyboard or instrument"},
      {"inspect_keyboard_drawn",
       {"inspect", "piano", "--figure", "a.svg"},
       "piano: --figure: cannot be used with a keyboard",
       "allowed: with a material, a resonator or an instrument"},
      {"inspect_keyboard_compared",
       {"inspect", "piano", "--compare"},
       "piano: --compare: cannot be used with a keyboard",
       "allowed: with a material"},
      {"render_score_of_instrument",
       {"render", "instrument", "--score", "dulcimer", "-o", "a.wav"},
       "dulcimer: instrument: the score is for a hammer-string",
       "allowed: render hammer-string"},
      {"generate_score",
       {"generate", "dulcimer"},
       "dulcimer: MATERIAL: is a score",
       "allowed: a material, resonator, keyboard or instrument"},
      {"generate_score_file",
       {"generate", "my_score.json"},
       "my_score.json: file: is a score",
       "allowed: a material, resonator, keyboard or instrument"},
      {"generate_midi", {"generate", "my.mid"}, "my.mid: file: is a score", "allowed: a material, resonator,"},
      {"generate_output",
       {"generate", "my_output.json"},
       "my_output.json: file: was written by this program",
       "allowed: the file that it was made from"},
      {"render_material_as_score",
       {"render", "hammer-string", "--score", "felt_c4", "-o", "a.wav"},
       "felt_c4: SCORE: is a material",
       "allowed: a score"},
      {"render_instrument_as_score",
       {"render", "tanpura", "-o", "a.wav"},
       "tanpura: SCORE: is an instrument",
       R"(allowed: a score with "instrument": "tanpura", or, if it has keys, a MIDI file with --instrument tanpura)"},
      {"render_material_file_as_score",
       {"render", "hammer-string", "--score", "probe.json", "-o", "a.wav"},
       "probe.json: file: is a material",
       "allowed: a score"},
      {"render_score_with_material_as_resonator",
       {"render", "hammer-string", "--score", "mixed.json", "-o", "a.wav"},
       "mixed.json: voices[0].resonator: 'felt_c4' is a material",
       "allowed: a .json file, drum_head"},
      {"render_score_with_resonator_file_as_material",
       {"render", "hammer-string", "--score", "mixed_files.json", "-o", "a.wav"},
       "mixed_files.json: voices[0].material: 'my_string.json' is a resonator",
       "allowed: a .json file, felt_c2"},
      {"inspect_two",
       {"inspect", "felt_c4", "mb1", "--figure", "a.svg"},
       "--figure: draws one file, not 2",
       "allowed: one MATERIAL"},
      {"inspect_no_jobs",
       {"inspect", "felt_c4", "--jobs", "0"},
       "--jobs: '0' is refused",
       "allowed: an integer from 1"},
      {"inspect_unknown_option",
       {"inspect", "felt_c4", "--jbos", "2"},
       "--jbos: unknown",
       "allowed: --help, MATERIAL, --figure, --compare, --json, --rate, --jobs, --force, --version"},
      {"inspect_material_at_rate",
       {"inspect", "felt_c4", "--rate", "48000"},
       "felt_c4: --rate: cannot be used with a material",
       "allowed: with a resonator"},
      {"inspect_resonators_compared",
       {"inspect", "string_c4", "--compare"},
       "string_c4: --compare: cannot be used with a resonator",
       "allowed: with a material"},
      {"inspect_resonator_at_low_rate",
       {"inspect", "string_c4", "--rate", "999"},
       "--rate: '999' is refused",
       "allowed: a number from 1000 to 100000000"},
      {"render_nothing", {"render"}, "SCORE: missing", "allowed: score file"},
      {"render_without_score", {"render", "slide-string", "-o", "a.wav"}, "--score: missing", "allowed: score file"},
      {"render_unknown_signal",
       {"render", "hammer-string", "--score", "dulcimer", "--signal", "heat", "-o", "a.wav"},
       "--signal: 'heat' is no output",
       "allowed: displacement, contact_force, velocity, bridge_force"},
      {"render_unknown_precision",
       {"render", "hammer-string", "--score", "dulcimer", "--precision", "half", "-o", "a.wav"},
       "--precision: 'half' is refused",
       "allowed: single, double"},
      {"render_at_a_low_rate",
       {"render", "fret-string", "--score", "fret_buzz", "--rate", "999", "-o", "a.wav"},
       "--rate: '999' is refused",
       "allowed: an integer from 1000 to 768000"},
      {"render_unknown",
       {"render", "hammer-strings", "-o", "a.wav"},
       "hammer-strings: SCORE: no such score ships",
       "allowed: a .json or .mid file, bach_prelude"},
  };
}

std::vector<BadLine> material_cases() {
  std::vector<BadLine> cases;
  for (const std::string command : {"generate", "inspect", "impact"}) {
    cases.push_back({command + "_missing", {command}, "MATERIAL: missing", "file (.json), or the name of"});
    cases.push_back({command + "_unknown", {command, "felt_c5"}, "felt_c5: MATERIAL: no such material", kShipped});
    cases.push_back({command + "_empty", {command, ""}, "MATERIAL: '' is refused", "file (.json), or the name of"});
    cases.push_back({command + "_path_without_suffix",
                     {command, "./felt_c4"},
                     "./felt_c4: file: does not exist",
                     "allowed: a file"});
    cases.push_back(
        {command + "_template", {command, "material.hpp.in"}, "material.hpp.in: MATERIAL: no such", kShipped});
    cases.push_back({command + "_upper_case",
                     {command, "Felt_C4"},
                     "Felt_C4: MATERIAL: no such",
                     "allowed: a .json file, felt_c4, felt_c2, "});
  }
  cases.push_back(
      {"render_unknown", {"render", "mass-barrier", "--material", "x", "-o", "a.wav"}, "x: MATERIAL", kShipped});
  cases.push_back(
      {"impact_without_impact", {"impact", "bare.json"}, "bare.json: impact: missing", "allowed: an object"});
  cases.push_back({"impact_too_long_to_simulate",
                   {"impact", "felt_c4", "soft.json", "--speed", "1e-6", "--rate", "1e8"},
                   "soft.json: --rate: at 1e-06 m/s and 100000000 Hz the contact lasts",
                   "allowed: at most 1e+08"});
  cases.push_back({"render_without_impact",
                   {"render", "mass-barrier", "--material", "bare.json", "-o", "a.wav"},
                   "bare.json: --mass: missing, and the material has no impact",
                   "allowed: a number"});
  cases.push_back({"render_without_impact_but_mass",
                   {"render", "mass-barrier", "--material", "bare.json", "--mass", "1", "-o", "a.wav"},
                   "bare.json: --speed: missing",
                   "allowed: a number"});
  return cases;
}

std::vector<BadLine> generate_cases() {
  const auto line = [](const Words& more) { return followed_by({"generate", "probe.json"}, more); };
  const std::string formats = "allowed: faust, cpp, json";
  const std::string folder = "allowed: folder to write to, or - for standard output";
  return {
      {"emit_unknown", line({"--emit", "rust"}), "--emit: 'rust' is refused", formats},
      {"emit_upper_case", line({"--emit", "JSON"}), "--emit: 'JSON' is refused", formats},
      {"emit_empty", line({"--emit", ""}), "--emit: '' is refused", formats},
      {"emit_list", line({"--emit", "cpp,json"}), "--emit: 'cpp,json' is refused", formats},
      {"emit_second_unknown", line({"--emit", "json", "--emit", "lua"}), "--emit: 'lua' is refused", formats},
      {"emit_without_value", line({"--emit"}), "--emit: 1 required", "allowed: format to write"},
      {"output_without_value", line({"-o"}), "--output: 1 required", folder},
      {"output_empty", line({"-o", ""}), "--output: '' is refused", "allowed: a folder, or - for standard output"},
      {"output_twice", line({"-o", "a", "-o", "b"}), "--output: ", folder},
      {"output_is_file", line({"-o", "file.txt"}), "file.txt: -o: is not a folder", "allowed: a folder, or -"},
      {"output_is_device", line({"-o", "/dev/null"}), "/dev/null: -o: is not a folder", "allowed: a folder, or -"},
      {"output_below_file", line({"-o", "file.txt/x"}), "file.txt/x/probe.lib: file: ", "Not a directory"},
      {"output_nowhere", line({"-o", "/proc/x"}), "/proc/x/probe.lib: file: its folder cannot be created", ""},
      {"output_long", line({"-o", std::string(300, 'o')}), "--output: the name has 300 bytes",
       "allowed: a name of at most"},
      {"output_is_folder_of_folders", line({"-o", "taken"}), "taken/probe.hpp: file: is not a regular file", ""},
      {"output_link_dangles", line({"-o", "links"}), "links/probe.json: file: is a broken link", ""},
      {"output_stdout_of_three", line({"-o", "-"}), "-o: standard output takes one output, not 3",
       "allowed: one MATERIAL and one --emit"},
      {"output_stdout_of_two_materials", line({"mb1", "--emit", "json", "-o", "-"}),
       "-o: standard output takes one output, not 2", "allowed: one MATERIAL and one --emit"},
      {"check_stdout", line({"--check", "--emit", "json", "-o", "-"}), "--check: needs files",
       "allowed: with -o DIR"},
      {"check_value", line({"--check=perhaps"}), "--check", "allowed: write nothing"},
      {"check_depfile", line({"--check", "--depfile", "d"}), "--depfile: cannot be combined",
       "allowed: one of the two"},
      {"depfile_stdout", line({"--emit", "json", "-o", "-", "--depfile", "d"}), "--depfile: needs files",
       "allowed: with -o DIR"},
      {"depfile_without_value", line({"--depfile"}), "--depfile: 1 required", "allowed: also write a make rule"},
      {"depfile_empty", line({"--depfile", ""}), "--depfile: '' is refused", "allowed: a file name"},
      {"depfile_dash", line({"--depfile", "-"}), "--depfile: '-' is refused", "allowed: a file name"},
      {"depfile_nowhere", line({"-o", "out", "--depfile", "/proc/x"}), "/proc/x: file: cannot be written", ""},
      {"depfile_is_folder", line({"-o", "out", "--depfile", "taken"}), "taken: file: is not a regular file", ""},
      {"depfile_is_material", line({"-o", "out", "--depfile", "probe.json"}), "probe.json: file: is already an input",
       "allowed: another folder or file name"},
      {"depfile_is_output", line({"-o", "out", "--depfile", "out/../out/probe.lib"}),
       "out/../out/probe.lib: file: is already an input", "allowed: another folder or file name"},
      {"depfile_of_unspeakable_path",
       {"generate", "line\nend/probe.json", "-o", "out", "--depfile", "d"},
       "line?end/probe.json: --depfile: this path cannot stand in a make rule",
       "allowed: a path without tab or line end"},
      {"replaces_material", line({}), "./probe.json: file: is already an input", "allowed: another folder"},
      {"replaces_material_by_link",
       {"generate", "link.json", "--emit", "json"},
       "./probe.json: file: is already an input",
       "allowed: another folder"},
      {"replaces_later_material",
       {"generate", "felt_c4", "other.json", "probe.json", "-o", "out/.."},
       "probe.json: name: 'probe'",
       "allowed: once"},
      {"rate_is_nan", line({"--rate", "nan"}), "--rate: 'nan' is refused", "allowed: a number from 1000 to 768000"},
      {"rate_too_low", line({"--rate", "999"}), "--rate: '999' is refused", "allowed: a number from 1000 to 768000"},
      {"unknown_option", line({"--format", "json"}), "--format: unknown",
       "allowed: --help, MATERIAL, --emit, --output"},
      {"unknown_letter", line({"-x"}), "-x: unknown", "allowed: --help"},
      {"same_material_twice",
       {"generate", "felt_c4", "felt_c4", "-o", "out"},
       "felt_c4: name: 'felt_c4' is the name of two materials",
       "allowed: once"},
      {"same_name_twice",
       {"generate", "mb1", "probe.json", "other.json", "-o", "out"},
       "other.json: name: 'probe' is the name of two materials",
       "allowed: once"},
      {"one_of_many_missing",
       {"generate", "mb1", "probe.json", "gone.json", "-o", "out"},
       "gone.json: file: ",
       "allowed: a file"},
  };
}

std::vector<BadLine> impact_cases() {
  const auto line = [](const Words& more) { return followed_by({"impact", "probe.json"}, more); };
  std::vector<BadLine> cases = {
      {"speed_without_value", line({"--speed"}), "--speed: 1 required", "allowed: impact speed in m/s"},
      {"second_speed_bad", line({"--speed", "1", "--speed", "0"}), "--speed: '0' is refused", "from 1e-06 to 1000"},
      {"speeds_and_speed", line({"--speeds", "1", "2", "3", "--speed", "1"}), "--speeds: cannot be combined",
       "one of the two"},
      {"speeds_of_two", line({"--speeds", "1", "2"}), "--speeds: At least 3 required",
       "allowed: lowest and highest speed"},
      {"speeds_reversed", line({"--speeds", "2", "1", "3"}), "--speeds: these speeds are refused", "MIN below MAX"},
      {"speeds_nan", line({"--speeds", "nan", "1", "3"}), "--speeds: these speeds are refused", "MIN below MAX"},
      {"speeds_one", line({"--speeds", "1", "2", "1"}), "--speeds: 1 is refused", "allowed: a COUNT from 2 to 1000"},
      {"speeds_and_a_half", line({"--speeds", "1", "2", "2.5"}), "--speeds: 2.5 is refused", "a COUNT from 2"},
      {"csv_and_json", line({"--csv", "--json"}), "--csv: cannot be combined with --json", "one of the two"},
      {"impact_figure_over_nothing", line({"--rate", "48000", "--figure", "a.svg"}),
       "--figure: draws over speeds or over sample rates", "allowed: with --speeds"},
      {"impact_figure_of_too_many",
       line({"--speed", "1", "--speed", "2", "--speed", "3", "--speed", "4", "--speed", "5", "mb1", "felt_c4",
             "--figure", "a.svg"}),
       "--figure: its key has 15 entries", "allowed: at most 12"},
      {"impact_figure_of_no_format", line({"--speeds", "1", "2", "3", "--figure", "a.jpg"}),
       "a.jpg: figure: its ending names no format", "allowed: .svg, .png, .pdf"},
      {"impact_figure_is_material",
       {"impact", "./probe.svg", "--speeds", "1", "2", "3", "--figure", "probe.svg"},
       "probe.svg: file: is already an input",
       "allowed: another folder or file name"},
      {"figure_is_material",
       {"inspect", "./probe.svg", "--figure", "probe.svg"},
       "probe.svg: file: is already an input",
       "allowed: another folder or file name"},
      {"figure_of_no_format",
       {"inspect", "probe.json", "--figure", "a.jpg"},
       "a.jpg: figure: its ending names no format that can be drawn",
       "allowed: .svg, .png, .pdf"},
      {"figure_of_knots_of_no_format",
       {"inspect", "probe.json", "--compare", "--figure", "svg"},
       "svg: figure: its ending names no format",
       "allowed: .svg, .png, .pdf"},
      {"svg_empty", {"inspect", "probe.json", "--figure", ""}, "--figure: '' is refused", "allowed: a file name"},
      {"svg_dash", {"inspect", "probe.json", "--figure", "-"}, "--figure: '-' is refused", "allowed: a file name"},
      {"svg_nowhere", {"inspect", "probe.json", "--figure", "/proc/x/y.svg"}, "/proc/x/y.svg: file: its folder", ""},
      {"svg_is_folder",
       {"inspect", "probe.json", "--figure", "taken.svg"},
       "taken.svg: file: is not a regular file",
       ""},
      {"svg_without_value", {"inspect", "probe.json", "--figure"}, "--figure: 1 required", "allowed: also draw"}};
  for (const std::string value :
       {"0", "-1", "nan", "-nan", "inf", "1e999", "fast", "", " ", "1x", "1,2", "1001", "9e-7"})
    cases.push_back({"speed_" + std::to_string(cases.size()), line({"--speed", value}),
                     "--speed: '" + value + "' is refused", "allowed: a number from 1e-06 to 1000"});
  for (const std::string value : {"0", "-1", "nan", "inf", "999", "1.1e8", "44k"})
    cases.push_back({"rate_" + std::to_string(cases.size()), line({"--rate", value}),
                     "--rate: '" + value + "' is refused", "allowed: a number from 1000 to 100000000"});
  return cases;
}

std::vector<BadLine> render_cases() {
  const auto line = [](const Words& more) {
    return followed_by({"render", "mass-barrier", "--duration", "0.01"}, more);
  };
  const std::string another = "allowed: another folder or file name";
  std::vector<BadLine> cases = {
      {"output_missing", line({}), "--output: missing", "allowed: sound file to write"},
      {"output_without_value", line({"-o"}), "--output: 1 required", "allowed: sound file to write"},
      {"output_empty", line({"-o", ""}), "--output: '' is refused", "allowed: a file name"},
      {"output_dash", line({"-o", "-"}), "--output: '-' is refused", "allowed: a file name"},
      {"output_nowhere", line({"-o", "/proc/a.wav"}), "/proc/a.wav: file: cannot be written", ""},
      {"output_is_folder", line({"-o", "taken.wav"}), "taken.wav: file: is not a regular file", ""},
      {"output_mp3", line({"-o", "a.mp3"}), "a.mp3: sound: its ending names no format", "allowed: .wav, .flac, .ogg"},
      {"output_without_ending", line({"-o", "a"}), "a: sound: its ending names no format", "allowed: .wav, .flac"},
      {"output_is_hidden", line({"-o", ".wav"}), ".wav: sound: its ending names no format", "allowed: .wav, .flac"},
      {"output_at_a_rate_of_no_vorbis", line({"-o", "a.ogg", "--rate", "768000"}),
       "a.ogg: --rate: this format cannot have 768000 Hz", "allowed: another rate, or .wav"},
      {"output_at_a_rate_of_no_flac", line({"-o", "a.flac", "--rate", "768000"}),
       "a.flac: --rate: this format cannot have 768000 Hz", "allowed: another rate, or .wav"},
      {"output_below_file", line({"-o", "file.txt/a.wav"}), "file.txt/a.wav: file: ", "Not a directory"},
      {"output_is_figure", line({"-o", "a.svg"}), "a.svg: sound: its ending names no format", "allowed: .wav"},
      {"figure_is_sound", line({"-o", "a.wav", "--figure", "b.wav"}), "b.wav: figure: its ending names no format",
       "allowed: .svg, .png, .pdf"},
      {"figure_is_material", line({"-o", "a.wav", "--material", "./probe.svg", "--figure", "probe.svg"}),
       "probe.svg: file: is already an input", another},
      {"default_figure_is_material", line({"-o", "probe.wav", "--material", "./probe.svg", "--force"}),
       "probe.svg: file: is already an input", another},
      {"output_is_material", line({"-o", "out/../probe.aif", "--material", "./probe.aif"}),
       "out/../probe.aif: file: is already an input", another},
      {"figure_and_no_figure", line({"-o", "a.wav", "--figure", "a.png", "--no-figure"}),
       "--no-figure: cannot be combined with --figure", "allowed: one of the two"},
      {"figure_empty", line({"-o", "a.wav", "--figure", ""}), "--figure: '' is refused", "allowed: a file name"},
      {"figure_dash", line({"-o", "a.wav", "--figure", "-"}), "--figure: '-' is refused", "allowed: a file name"},
      {"figure_nowhere", line({"-o", "a.wav", "--figure", "/proc/a.svg"}), "/proc/a.svg: file: cannot be written",
       ""},
      {"default_figure_is_folder", line({"-o", "taken.flac"}), "taken.svg: file: is not a regular file", ""},
      {"signal_unknown", line({"-o", "a.wav", "--signal", "velocity"}), "--signal: 'velocity' is refused",
       "allowed: force, displacement"},
      {"signal_empty", line({"-o", "a.wav", "--signal", ""}), "--signal: '' is refused",
       "allowed: force, displacement"},
      {"many_samples",
       {"render", "mass-barrier", "-o", "a.wav", "--duration", "3600", "--rate", "768000"},
       "--duration: 3600 s at 768000 Hz are 2.765e+09 samples",
       "allowed: at most 206.7 s at this rate"},
      {"unknown_option", line({"-o", "a.wav", "--fast"}), "--fast: unknown", "allowed: --help, --material, --mass"},
      {"word_too_many", line({"-o", "a.wav", "b.wav"}), "b.wav: unknown", "allowed: --help, --material, --mass"}};
  const auto refuse = [&](const std::string& option, const Words& values, const std::string& allowed) {
    for (const std::string& value : values)
      cases.push_back({option.substr(2, option.find('-', 2) - 2) + "_" + std::to_string(cases.size()),
                       followed_by({"render", "mass-barrier", "-o", "a.wav"}, {option, value}),
                       option + ": '" + value + "' is refused", "allowed: " + allowed});
  };
  refuse("--mass", {"0", "-1", "nan", "inf", "1e5", "heavy"}, "a number from 1e-09 to 10000");
  refuse("--speed", {"-1", "nan", "1e4"}, "a number from 0 to 1000");
  refuse("--start", {"1.5", "nan", "-1e4"}, "a number from -1000 to 1");
  refuse("--gravity", {"-9.81", "nan", "inf"}, "a number from 0 to 1000");
  refuse("--stiffness-ratio", {"0", "-1", "nan", "1e7"}, "a number from 1e-06 to 1000000");
  refuse("--loss", {"-0.1", "nan", "1e4"}, "a number from 0 to 1000");
  refuse("--duration", {"0", "-1", "nan", "3601", "5 s"}, "a number from 0.001 to 3600");
  refuse("--gain", {"on", "301", "-301", "nan", "3dB", ""}, "off, or a number from -300 to 300");
  refuse("--rate", {"0", "-1", "999", "768001", "44100.5", "nan", "4294967296", "99999999999999999999", "44k"},
         "an integer from 1000 to 768000");
  return cases;
}

class BadCommandLine : public ::testing::TestWithParam<BadLine> {};

TEST_P(BadCommandLine, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, words, beginning, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.json", kProbeMaterial);
  write_file(box / "other.json", kProbeMaterial);
  write_file(box / "probe.svg", kProbeMaterial);
  write_file(box / "probe.aif", kProbeMaterial);
  write_file(box / "bare.json", kWithoutImpact);
  const std::string mixed = score_of("felt_c4", "string_c4"), mixed_files = score_of("string_c4", "my_string.json");
  for (const auto& [name, text] :
       {std::pair{"my_string.json", std::string(find_embedded(Shipped::kResonators, "string_c4.json")->content)},
        std::pair{"my_score.json", score_of("string_c4", "felt_c4")},
        std::pair{"my.mid", std::string(find_embedded(Shipped::kScores, "bach_prelude.mid")->content)},
        std::pair{"my_output.json", read_file(fs::path(SOURCE_FOLDER) / "generated/mb1.json")},
        std::pair{"mixed.json", mixed}, std::pair{"mixed_files.json", mixed_files}})
    write_file(box / name, text);
  write_file(box / "soft.json", kSoft);
  write_file(box / "file.txt", "text");
  for (const auto folder : {"tmp", "out", "links", "taken/probe.hpp", "taken.wav", "taken.svg", "line\nend"})
    fs::create_directories(box / folder);
  write_file(box / "line\nend/probe.json", kProbeMaterial);
  fs::create_symlink("probe.json", box / "link.json");
  fs::create_symlink("nowhere", box / "links/probe.json");
  const auto before = box.listing();
  const auto outcome =
      run({.arguments = words, .folder = box.path(), .environment = {{"TMPDIR", (box / "tmp").string()}}});
  expect_refused(outcome, beginning, says);
  EXPECT_EQ(names_in(box.listing()), names_in(before));
  EXPECT_TRUE(box.listing() == before);
}

CONTACTSPLINE_CASES(Command, BadCommandLine, command_cases());
CONTACTSPLINE_CASES(Material, BadCommandLine, material_cases());
CONTACTSPLINE_CASES(Generate, BadCommandLine, generate_cases());
CONTACTSPLINE_CASES(Impact, BadCommandLine, impact_cases());
CONTACTSPLINE_CASES(Render, BadCommandLine, render_cases());

}  // namespace
}  // namespace contactspline::testing
