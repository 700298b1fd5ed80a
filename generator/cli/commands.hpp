// SPDX-License-Identifier: MIT
// The subcommands: a structure of options and a function each. The command line fills the options and calls the
// function, which throws BadInput.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "generator/cli/render_output.hpp"
#include "generator/player/score.hpp"

namespace contactspline {

/// `generate --check` found files that differ from what would be written. what() names them.
struct Stale : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct GenerateOptions {
  std::vector<std::string> materials;
  std::vector<std::string> formats;  ///< empty: all
  std::string output = ".";
  std::string depfile;
  double sample_rate_hz = 44100;
  int jobs = 0;            ///< materials at once; 0: one for each core
  bool all_forms = false;  ///< headers of materials with all forms of the derivation
  bool check = false;
  bool force = false;  ///< replaces files that the program did not write
  bool watch = false;  ///< writes again whenever an input file has changed, until the program is ended
};
void generate(const GenerateOptions& options);

struct PluginOptions {
  std::string instrument;
  std::string output;  ///< folder of the project
  std::string vendor = "Contact Spline";
  bool no_build = false;
  bool force = false;  ///< as in GenerateOptions
};
/// Writes an instrument's project of plug-ins, and builds it.
void make_plugin(const PluginOptions& options);

struct DatasetOptions {
  std::string plan;                                ///< its file
  std::string text;                                ///< of the plan; empty: that of the file
  std::string output;                              ///< folder of the shards
  std::size_t shards = 1;                          ///< all of them are written, and joined
  std::size_t only = 0;                            ///< 1 to shards: this one alone; 0: all
  int threads = 0;                                 ///< 0: one for each core
  bool join = false;                               ///< joins shards that are there, and writes none
  bool force = false;                              ///< as in GenerateOptions; also replaces shards of other plans
  std::function<void(const std::string&)> report;  ///< takes lines; empty: standard output
  std::function<void()> watch = [] {};  ///< is called about once a second, and stops it all by an exception
};
/// Renders the samples of a plan into HDF5 files. Shards that are whole are kept. Returns the file that was written
/// last.
std::string make_dataset(const DatasetOptions& options);

struct InspectOptions {
  std::vector<std::string> materials;
  int jobs = 0;        ///< as in GenerateOptions
  std::string figure;  ///< file to draw, of one material only, or empty
  bool compare = false;
  bool json = false;
  bool force = false;  ///< as in GenerateOptions
  std::optional<double> sample_rate_hz = {};
};
void inspect(const InspectOptions& options);

struct ImpactOptions {
  std::vector<std::string> materials;
  std::vector<double> speeds;       ///< empty: the material's largest, unless there is a range
  std::vector<double> speed_range;  ///< empty, or lowest and highest speed and their number
  std::vector<double> rates = {44100, 88200, 176400, 352800};
  bool csv = false, json = false;
  std::string figure;  ///< file to draw, or empty
  std::string over;    ///< what it is over: speed, rate or time; empty: what the other options suggest
  std::string trace;   ///< file for each motion over time, or empty
  bool force = false;  ///< as in GenerateOptions
};
void compare_impacts(const ImpactOptions& options);

struct FitOptions {
  std::string file;
  std::string output;  ///< material or instrument file to write, or empty
  std::string figure;  ///< file to draw, or empty
  bool json = false;
  bool force = false;  ///< as in GenerateOptions
};
/// Fits a material to measurements or an instrument to recordings, and writes its file.
void fit(const FitOptions& options);

/// The words that `list` takes: materials, frictions, resonators, keyboards, instruments,
/// scores.
[[nodiscard]] std::vector<std::string> kinds_that_ship();

/// Prints tables of what ships: of one kind, or of all if `only` is empty.
void list(const std::string& only);

/// Prints a file that ships, byte by byte; with `own_name`, unless it is empty, in place of its name.
void show(const std::string& name, const std::string& own_name);

struct MassBarrierOptions {
  std::string material = "rubber_on_wood";
  std::optional<double> mass_kg;
  std::optional<double> speed_m_per_s;
  double start_m = -0.001;
  double gravity_m_per_s2 = 9.81;
  double stiffness_ratio = 1;
  std::optional<double> loss_s_per_m;
  double duration_s = 5;
  std::string signal = "force";
  RenderOutput output;
};
void render_mass_barrier(const MassBarrierOptions& given);

struct ScoreOptions {
  std::vector<std::string> scores;  ///< of which render_scores() plays each
  std::string score;
  std::string signal;  ///< an output or "body"; empty: what sounds best
  std::string precision = "double";
  std::string stems;                     ///< folder for the sound of each voice, or empty
  std::vector<int> channels;             ///< of a MIDI file, 1 to 16; empty: all but the tenth
  std::vector<std::string> instruments;  ///< that play a MIDI file, as parts_argument() reads them; empty: the piano
  std::string tuning, keymap;            ///< files of Scala, .scl and .kbm, or empty
  std::optional<double> tail_s;          ///< how long it sounds behind the last note; empty: until it has rung out
  std::optional<double> a4_hz;           ///< empty: what the key map or the instrument says
  RenderOutput output;
};
/// Reads all scores, then plays each.
void render_scores(const ScoreOptions& given);

}  // namespace contactspline
