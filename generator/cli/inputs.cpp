// SPDX-License-Identifier: MIT
#include "generator/cli/inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>
#include <vector>

#include "generator/cli/model_module.hpp"
#include "generator/cli/waiting_line.hpp"
#include "generator/emit/emit_instrument.hpp"
#include "generator/emit/emit_instrument_faust.hpp"
#include "generator/emit/emit_keyboard.hpp"
#include "generator/emit/emit_material.hpp"
#include "generator/emit/emit_resonator.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/player/instrument_score_reader.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design_impact.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/input_file.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/nearest_name.hpp"

namespace contactspline {
namespace {

constexpr std::string_view kAnyKind = "material, resonator, keyboard or instrument";
constexpr std::string_view kInspected = "material, friction, resonator, keyboard or instrument";

// Does an argument name a file, or standard input?
bool is_file(std::string_view argument) {
  return is_path(argument) || argument == kStandardInput;
}

std::string text_of(const std::string& argument) {
  return argument == kStandardInput ? read_standard_input() : read_input(argument);
}

Source material_source(const std::string& argument, Design design, double sample_rate_hz) {
  const std::string name = design.material.name;
  const std::string too_short = short_contact(design.material, sample_rate_hz);
  auto files = input_files(argument, design.material);
  return {name,
          [design = std::move(design)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, design, command);
          },
          std::move(files),
          {},
          too_short.empty() ? "" : name + ": " + too_short + "\n"};
}

// The modes, of which there must be one.
ModeSet sounding_modes(const Resonator& resonator, double max_frequency_hz) {
  ModeSet set = modes_of(resonator, max_frequency_hz);
  if (set.modes.empty())
    throw BadInput(
        fmt::format("{}: constant_loss_per_s: no mode below {} Hz sounds; allowed: losses below the frequencies",
                    resonator.name, max_frequency_hz));
  return set;
}

// Something must sound; where modes are left out, a line says so.
void check_modes(const Resonator& resonator, double max_frequency_hz) {
  if (!sounding_modes(resonator, max_frequency_hz).cut) return;
  const auto line = fmt::format("contactspline: {}: max_modes: {} leaves out modes below {} Hz\n", resonator.name,
                                resonator.max_modes, max_frequency_hz);
  std::fputs(line.c_str(), stderr);
}

Source resonator_source(Resonator resonator, double max_frequency_hz) {
  check_modes(resonator, max_frequency_hz);
  const std::string name = resonator.name;
  return {name,
          [=, resonator = std::move(resonator)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, resonator, max_frequency_hz, command);
          },
          {}};
}

// A keyboard and the body that it names; `read` reads what a file names.
Source keyboard_source(const NamedText& file, double max_frequency_hz, const ReadFile& read) {
  Keyboard keyboard = parse_keyboard(file.text, file.file);
  KeyboardResonators resonators = resonators_of(keyboard, file, read);
  for (const auto& named : {resonators.body, resonators.knock})
    if (named) (void)sounding_modes(*named, max_frequency_hz);
  const std::string name = keyboard.name;
  return {name,
          [=, keyboard = std::move(keyboard), resonators = std::move(resonators)](const Emitter& emitter,
                                                                                  std::string_view command) {
            const WaitingLine line("designing " + keyboard.name);
            return emit(emitter, keyboard, resonators, max_frequency_hz, command);
          },
          {}};
}

Source instrument_source(std::string_view file, InstrumentSource instrument, double max_frequency_hz) {
  const std::string name = instrument.model.name;
  if (const auto body = silent_body(instrument.model, max_frequency_hz))
    refuse(file, "bodies", fmt::format("body '{}' has no mode below {} Hz", *body, max_frequency_hz),
           "a higher --rate, a lower frequency, or losses below the frequencies");
  const InstrumentModel played = without_keys(instrument.model);
  auto obstacle = faust_obstacle(played, arrays_of(played, max_frequency_hz));
  return {name,
          [=, model = std::move(instrument.model)](const Emitter& emitter, std::string_view command) {
            return emit(emitter, model, max_frequency_hz, command);
          },
          std::move(instrument.files), std::move(obstacle)};
}

// An instrument file, with what it names beside it.
InstrumentSource read_instrument(const std::string& argument, std::string_view text) {
  const std::filesystem::path file = argument;
  InstrumentSource source;
  source.files.push_back(file);
  source.model = parse_instrument(text, argument, [&](const std::string& path) {
    source.files.push_back(file.parent_path() / path);
    return read_input(source.files.back());
  });
  return source;
}

// Reads what a material file names, from beside it.
ReadFile reader_beside(const std::filesystem::path& material_file) {
  return [folder = material_file.parent_path()](const std::string& path) { return read_input(folder / path); };
}

const EmbeddedFile* shipped(Shipped folder, const std::string& name) {
  return find_embedded(folder, name + ".json");
}

[[noreturn]] void refuse_kind(const std::string& argument, std::string_view key, Shipped kind,
                              std::string_view allowed) {
  refuse(argument, key, "is " + a_kind(kind), allowed);
}

// What prints the names in these folders.
std::string list_command(std::initializer_list<Shipped> folders) {
  return folders.size() > 1 ? "contactspline list"
                            : fmt::format("contactspline list {}s", kind_name(*folders.begin()));
}

// What an argument may be that is no name of what ships: the file of that name, if it is there.
std::string files_for(const std::string& argument, std::string_view files) {
  for (const char* ending : {".json", ".mid"}) {
    std::error_code error;
    const bool is_read = files.find(ending) != files.npos;
    if (is_read && !is_file(argument) && std::filesystem::is_regular_file(argument + ending, error))
      return fmt::format("{}{}, which is a file here", shown(argument), ending);
  }
  return std::string(files);
}

[[noreturn]] void refuse_name(const std::string& argument, std::string_view kinds,
                              std::initializer_list<Shipped> folders) {
  std::vector<std::string> names;
  if (const auto kind = kind_of_name(argument)) refuse_kind(argument, "MATERIAL", *kind, fmt::format("a {}", kinds));
  for (const Shipped folder : folders)
    for (std::string& name : shipped_names(folder)) names.push_back(std::move(name));
  throw BadInput(fmt::format("{}: MATERIAL: no such {} ships; allowed: {}, {}", argument, kinds,
                             files_for(argument, "a .json file"),
                             names_in_short(std::move(names), argument, list_command(folders))));
}

[[noreturn]] void refuse_any_name(const std::string& argument) {
  refuse_name(argument, kAnyKind,
              {Shipped::kMaterials, Shipped::kResonators, Shipped::kKeyboards, Shipped::kInstruments});
}

// A keyboard file, with the body that it names.
Source keyboard_file(const std::string& text, const std::string& file, double max_frequency_hz) {
  std::vector<std::filesystem::path> files;
  Source source = keyboard_source({text, file, false}, max_frequency_hz, [&](const std::string& path) {
    files.emplace_back(path);
    return read_input(path);
  });
  files.emplace(files.begin(), file);
  source.files = std::move(files);
  return source;
}

Source file_source(const std::string& file, double max_frequency_hz) {
  const WaitingLine line("designing " + file);
  const std::string text = text_of(file);
  const Shipped kind = kind_of_file(text, file, "material").value_or(Shipped::kMaterials);
  if (kind == Shipped::kScores || kind == Shipped::kFrictions)
    refuse_kind(file, "file", kind, fmt::format("a {}", kAnyKind));
  if (kind == Shipped::kInstruments) return instrument_source(file, read_instrument(file, text), max_frequency_hz);
  if (kind == Shipped::kMaterials)
    return material_source(file, design_material(text, file, reader_beside(file)), 2 * max_frequency_hz);
  if (kind == Shipped::kKeyboards) return keyboard_file(text, file, max_frequency_hz);
  Source source = resonator_source(parse_resonator(text, file), max_frequency_hz);
  source.files = {file};
  return source;
}

// What may stand in place of something that is no score.
std::string score_for(const std::string& argument, Shipped kind) {
  if (kind != Shipped::kInstruments && kind != Shipped::kKeyboards) return "a score";
  return fmt::format("a score with \"instrument\": \"{0}\", or a MIDI file with --instrument {0}", shown(argument));
}

// The text of a file, which may not be of another kind. `kinds`: what a message says is allowed.
std::string read_kind(const std::string& file, Shipped kind, std::string_view kinds) {
  std::string text = text_of(file);
  const auto found = kind_of_file(text, file, kind_name(kind));
  if (found && *found != kind)
    refuse_kind(file, "file", *found,
                kind == Shipped::kScores ? score_for(file, *found) : fmt::format("a {}", kinds));
  return text;
}

// The text of a file of this kind, or of one that ships, with its name; nothing for other files and names.
std::optional<NamedText> text_of_kind(const std::string& argument, Shipped kind) {
  if (const auto* file = shipped(kind, argument))
    return NamedText{std::string(file->content), std::string(file->name), true};
  if (!is_file(argument)) return std::nullopt;
  std::string text = text_of(argument);
  if (kind_of_file(text, argument, "material") != kind) return std::nullopt;
  return NamedText{std::move(text), argument, false};
}

bool is_midi(const std::string& argument) {
  if (argument == kStandardInput)
    return text_of(argument).starts_with("MThd") || text_of(argument).starts_with("RIFF");
  return is_midi_path(argument);
}

void require_no_channels(const std::string& score, const std::vector<int>& channels) {
  if (!channels.empty()) refuse(score, "--channel", "the score is not a MIDI file", "with a .mid file");
}

// A MIDI file on a keyboard of the user's choice.
ScoreSource midi_on_keyboard(const std::string& argument, const std::vector<int>& channels, const NamedText& keyboard,
                             const Tuning& tuning) {
  ScoreSource source;
  const auto* midi = find_embedded(Shipped::kScores, argument + ".mid");
  if (midi == nullptr && !is_midi(argument))
    refuse(argument, "--instrument", "a keyboard plays MIDI files, and the score names what plays it itself",
           "no --instrument, or a .mid file");
  if (midi == nullptr) source.files.emplace_back(argument);
  if (!keyboard.ships) source.files.emplace_back(keyboard.file);
  const auto read = [&](const std::string& path) {
    source.files.emplace_back(path);
    return read_input(path);
  };
  source.score = parse_midi_score(midi != nullptr ? std::string(midi->content) : text_of(argument), argument,
                                  channels, keyboard, read, tuning);
  return source;
}

// What ships and plays MIDI.
std::vector<std::string> players_that_ship() {
  std::vector<std::string> names = shipped_names(Shipped::kInstruments);
  std::ranges::copy(shipped_names(Shipped::kKeyboards), std::back_inserter(names));
  return names;
}

[[noreturn]] void refuse_player(const std::string& instrument) {
  std::optional<Shipped> kind = kind_of_name(instrument);
  if (is_file(instrument)) kind = kind_of_file(text_of(instrument), instrument, "instrument");
  refuse("--instrument", shown(instrument), kind ? "is " + a_kind(*kind) : "is no instrument and no keyboard",
         fmt::format("{}, a model of your own (.so), {}",
                     files_for(instrument, "a .json file of an instrument or a keyboard"),
                     names_in_short(players_that_ship(), instrument, "contactspline list instruments")));
}

// A MIDI file on an instrument of the user's choice.
ScoreSource score_on_instrument(const std::string& argument, const std::vector<int>& channels,
                                const std::string& instrument, const Tuning& tuning) {
  const bool is_module = instrument.ends_with(".so");
  if (const auto keyboard = is_module ? std::nullopt : text_of_kind(instrument, Shipped::kKeyboards))
    return midi_on_keyboard(argument, channels, *keyboard, tuning);
  auto played = is_module ? std::optional(InstrumentSource{load_model_module(instrument), {}})
                          : instrument_argument(instrument);
  if (!played) refuse_player(instrument);
  const auto* midi = find_embedded(Shipped::kScores, argument + ".mid");
  ScoreSource source{{}, std::move(played->files)};
  if (midi == nullptr) source.files.emplace_back(argument);
  if (midi == nullptr && !is_midi(argument)) {
    if (!is_module)
      refuse(argument, "--instrument", "the score is not a MIDI file and names its instrument itself",
             "no --instrument, a .mid file, or an instrument that is a model of your own (.so)");
    require_no_channels(argument, channels);
    source.score =
        parse_score(read_kind(argument, Shipped::kScores, "score"), argument, read_input, &played->model, tuning);
    return source;
  }
  source.score = parse_midi_on_instrument(midi != nullptr ? std::string(midi->content) : text_of(argument), argument,
                                          channels, played->model, tuning);
  return source;
}

ScoreSource shipped_score(const std::string& name, const std::vector<int>& channels, const Tuning& tuning) {
  if (const auto* midi = find_embedded(Shipped::kScores, name + ".mid"))
    return {parse_midi_score(midi->content, midi->name, channels, shipped_piano(), shipped_file, tuning), {}};
  require_no_channels(name, channels);
  const auto* score = shipped(Shipped::kScores, name);
  if (const auto kind = kind_of_name(name); kind && *kind != Shipped::kScores)
    refuse_kind(name, "SCORE", *kind, score_for(name, *kind));
  if (score == nullptr)
    throw BadInput(fmt::format("{}: SCORE: no such score ships; allowed: {}, {}", name,
                               files_for(name, "a .json or .mid file"),
                               names_in_short(shipped_names(Shipped::kScores), name, "contactspline list scores")));
  return {parse_score(score->content, score->name, read_input, nullptr, tuning), {}};
}

}  // namespace

Design design_argument(const std::string& argument, bool of_any_kind) {
  const std::string_view kinds = of_any_kind ? kInspected : "material";
  const WaitingLine line("designing " + argument);
  if (is_file(argument))
    return design_material(read_kind(argument, Shipped::kMaterials, kinds), argument, reader_beside(argument));
  const auto* material = shipped(Shipped::kMaterials, argument);
  if (material == nullptr)
    of_any_kind ? refuse_name(argument, kinds,
                              {Shipped::kMaterials, Shipped::kFrictions, Shipped::kResonators, Shipped::kKeyboards,
                               Shipped::kInstruments})
                : refuse_name(argument, kinds, {Shipped::kMaterials});
  return design_material(material->content, material->name);
}

std::vector<std::filesystem::path> input_files(const std::string& argument) {
  if (!is_file(argument)) return {};
  return {argument};
}

std::vector<std::filesystem::path> input_files(const std::string& argument, const Material& material) {
  auto files = input_files(argument);
  if (!files.empty() && material.measured) files.push_back(files.front().parent_path() / material.measured->file);
  return files;
}

std::optional<Resonator> resonator_argument(const std::string& argument) {
  const auto named = text_of_kind(argument, Shipped::kResonators);
  return named ? std::optional(parse_resonator(named->text, named->file)) : std::nullopt;
}

std::optional<RubbingSurfaces> friction_argument(const std::string& argument) {
  const auto named = text_of_kind(argument, Shipped::kFrictions);
  return named ? std::optional(parse_friction(named->text, named->file)) : std::nullopt;
}

std::optional<Keyboard> keyboard_argument(const std::string& argument) {
  const auto named = text_of_kind(argument, Shipped::kKeyboards);
  return named ? std::optional(parse_keyboard(named->text, named->file)) : std::nullopt;
}

std::optional<InstrumentSource> instrument_argument(const std::string& argument) {
  const auto named = text_of_kind(argument, Shipped::kInstruments);
  if (!named) return std::nullopt;
  if (named->ships) return InstrumentSource{parse_instrument(named->text, named->file), {}};
  return read_instrument(argument, named->text);
}

Source source_argument(const std::string& argument, double max_frequency_hz) {
  if (is_file(argument)) return file_source(argument, max_frequency_hz);
  if (const auto* file = shipped(Shipped::kResonators, argument))
    return resonator_source(parse_resonator(file->content, file->name), max_frequency_hz);
  if (const auto* file = shipped(Shipped::kKeyboards, argument))
    return keyboard_source({std::string(file->content), std::string(file->name), true}, max_frequency_hz,
                           shipped_file);
  if (auto instrument = instrument_argument(argument))
    return instrument_source(argument, std::move(*instrument), max_frequency_hz);
  if (shipped(Shipped::kMaterials, argument) == nullptr) refuse_any_name(argument);
  return material_source(argument, design_argument(argument), 2 * max_frequency_hz);
}

ScoreSource score_argument(const std::string& argument, const std::vector<int>& channels,
                           const std::string& instrument, const Tuning& tuning) {
  const WaitingLine line("designing the contacts of " + argument);
  if (!instrument.empty()) return score_on_instrument(argument, channels, instrument, tuning);
  if (!is_file(argument)) return shipped_score(argument, channels, tuning);
  if (!is_midi(argument)) require_no_channels(argument, channels);
  const std::filesystem::path file = argument;
  ScoreSource source;
  source.files.push_back(file);
  const auto read = [&](const std::string& path) {  // relative to the score
    source.files.push_back(file.parent_path() / path);
    return read_input(source.files.back());
  };
  source.score = is_midi(argument)
                     ? parse_midi_score(text_of(argument), argument, channels, shipped_piano(), shipped_file, tuning)
                     : parse_score(read_kind(argument, Shipped::kScores, "score"), argument, read, nullptr, tuning);
  return source;
}

std::optional<std::string> midi_bytes(const std::string& argument) {
  if (const auto* midi = find_embedded(Shipped::kScores, argument + ".mid")) return std::string(midi->content);
  return is_midi(argument) ? std::optional(text_of(argument)) : std::nullopt;
}

Tuning tuning_argument(const std::string& scale, const std::string& keymap, std::optional<double> a4_hz) {
  const auto text = [](const std::string& file) {
    return file.empty() ? std::nullopt : std::optional(TuningText{text_of(file), file});
  };
  return {text(scale), text(keymap), a4_hz};
}

}  // namespace contactspline
