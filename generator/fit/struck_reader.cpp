// SPDX-License-Identifier: MIT
#include "generator/fit/struck_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>

#include "generator/fit/data_file.hpp"
#include "generator/fit/recorded_note.hpp"
#include "generator/material/named_file.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/text_lines.hpp"

namespace contactspline {
namespace {

constexpr double kMaxFrequency_hz = 20000;
constexpr std::size_t kMaxBlows = 64, kMinPartials = 3;
constexpr Range kLevel_db{-300, 300};
constexpr const char* kCommon = "common";
constexpr const char* kOfEachBlow = "of_each_blow";

/// What the levels may be of: what a metre of a mode's displacement adds to it.
struct OutputRow {
  const char* name;
  double (*per_m)(const ResonatorMode& mode, const StiffString* string);
};

double natural(const ResonatorMode& mode) {
  return std::hypot(mode.mode.angular_frequency_rad_per_s, mode.mode.decay_per_s);
}

const std::vector<OutputRow>& outputs() {
  static const std::vector<OutputRow> rows = {
      {"displacement_m", [](const auto& mode, auto) { return mode.pickup_shape; }},
      {"velocity_m_per_s", [](const auto& mode, auto) { return mode.pickup_shape * natural(mode); }},
      {"acceleration_m_per_s2",
       [](const auto& mode, auto) { return mode.pickup_shape * natural(mode) * natural(mode); }},
      {"bridge_force_n", [](const auto& mode, auto string) { return bridge_shape(*string, mode); }}};
  return rows;
}

// One of several words, which must be there.
std::string read_word(const JsonObject& object, const char* key, const std::vector<std::string>& words) {
  const std::string allowed = fmt::format("{}", fmt::join(words, ", "));
  std::string word = object.text(key, allowed);
  if (std::ranges::find(words, word) == words.end())
    object.fail(object.key(key), fmt::format("'{}' is unknown", shown(word)), allowed);
  return word;
}

Resonator read_resonator(const JsonObject& struck, const ReadFile& read, std::vector<std::string>& files) {
  const NamedText named = read_named(struck, "resonator", Shipped::kResonators, read);
  if (!named.ships) files.push_back(named.file);
  Resonator resonator = parse_resonator(named.text, named.file);
  const auto* string = std::get_if<StiffString>(&resonator.body);
  if (string != nullptr && string->detuning_cents.size() > 1)
    struck.fail(
        struck.key("resonator"),
        fmt::format("'{}' has {} strings, whose partials beat", resonator.name, string->detuning_cents.size()),
        "a resonator with one string");
  return resonator;
}

StruckResonator modes_for(const JsonObject& object, const Resonator& resonator) {
  StruckResonator struck{{}, {}, false, {}};
  const auto modes = modes_of(resonator, kMaxFrequency_hz).modes;
  for (const ResonatorMode& mode : modes) {
    const auto& [w, decay, mass] = mode.mode;
    struck.modes.push_back({w, decay, mass, mode.strike_shape});
  }
  if (struck.modes.empty())
    object.fail(object.key("resonator"),
                fmt::format("'{}' has no modes below {} Hz", resonator.name, kMaxFrequency_hz),
                "a resonator that sounds");
  if (!object.has("blows")) return struck;
  std::vector<std::string> names;
  const auto* string = std::get_if<StiffString>(&resonator.body);
  for (const OutputRow& row : outputs())
    if (string != nullptr || std::string_view(row.name) != "bridge_force_n") names.emplace_back(row.name);
  const std::string output = read_word(object, "output", names);
  const auto row = std::ranges::find(outputs(), output, &OutputRow::name);
  struck.has_common_gain = read_word(object, "gain", {kCommon, kOfEachBlow}) == kCommon;
  for (const ResonatorMode& mode : modes) struck.output_per_m.push_back(std::abs(row->per_m(mode, string)));
  return struck;
}

std::size_t mode_at(double frequency_hz, const StruckResonator& struck, const LineOfFile& place) {
  if (!(frequency_hz > 0)) place.fail(fmt::format("a frequency of {:.6g} Hz", frequency_hz), "positive frequencies");
  const auto nearest = std::ranges::min_element(struck.modes, {}, [&](const StruckMode& mode) {
    return std::abs(std::log(mode.frequency_hz() / frequency_hz));
  });
  if (std::abs(nearest->frequency_hz() / frequency_hz - 1) > StruckResonator::kMistuned)
    place.fail(fmt::format("no mode is within {} % of {:.6g} Hz: the nearest has {:.6g} Hz",
                           100 * StruckResonator::kMistuned, frequency_hz, nearest->frequency_hz()),
               "frequencies of the resonator's modes");
  return static_cast<std::size_t>(nearest - struck.modes.begin());
}

std::size_t mode_called(double number, const StruckResonator& struck, const LineOfFile& place) {
  const auto count = static_cast<double>(struck.modes.size());
  if (!(number >= 1 && number <= count && number == std::floor(number)))
    place.fail(fmt::format("there is no partial {:.6g}", number),
               fmt::format("1 to {}, the modes below {} Hz", count, kMaxFrequency_hz));
  return static_cast<std::size_t>(number) - 1;
}

std::vector<Blow::Level> levels_of(const DataFile& data, const StruckResonator& struck) {
  constexpr std::array kWanted = {Quantity::kFrequency, Quantity::kPartial, Quantity::kLevel};
  const DataTable table = read_table(data, kWanted);
  require(data, table, std::array{Quantity::kLevel});
  const bool is_numbered = table.has(Quantity::kPartial);
  if (is_numbered == table.has(Quantity::kFrequency))
    refuse(data.path, "columns",
           is_numbered ? "there are partials beside frequencies" : "no column names the partials",
           "a column partial or frequency_UNIT");
  std::vector<Blow::Level> levels;
  for (std::size_t i = 0; i < table.lines.size(); ++i) {
    const LineOfFile place{data.path, table.lines[i]};
    const std::size_t mode = is_numbered ? mode_called(table.at(Quantity::kPartial)[i], struck, place)
                                         : mode_at(table.at(Quantity::kFrequency)[i], struck, place);
    const double level = table.at(Quantity::kLevel)[i];
    if (!(level >= kLevel_db.min && level <= kLevel_db.max))
      place.fail(fmt::format("a level of {:.6g} dB", level), fmt::format("{} to {}", kLevel_db.min, kLevel_db.max));
    if (!struck.sounds(mode))
      place.fail(fmt::format("partial {} has a node under the hammer or at the pickup", mode + 1),
                 "partials that sound");
    if (std::ranges::find(levels, mode, &Blow::Level::mode) != levels.end())
      place.fail(fmt::format("partial {} of {:.6g} Hz comes twice", mode + 1, struck.modes[mode].frequency_hz()),
                 "each partial once");
    levels.push_back({mode, level});
  }
  return levels;
}

std::optional<std::vector<std::size_t>> read_partials(const JsonObject& entry, const StruckResonator& struck) {
  if (!entry.has("partials")) return std::nullopt;
  const auto count = struck.modes.size();
  std::vector<std::size_t> partials;
  for (const double number : entry.numbers("partials", {1, static_cast<double>(count)}, count)) {
    const auto mode = static_cast<std::size_t>(number) - 1;
    if (number != std::floor(number) || std::ranges::find(partials, mode) != partials.end())
      entry.fail(entry.key("partials"), fmt::format("{} is no number of a further partial", number),
                 fmt::format("integers from 1 to {}, each once", count));
    if (!struck.sounds(mode))
      entry.fail(entry.key("partials"),
                 fmt::format("partial {} has a node under the hammer or at the pickup", number),
                 "partials that sound");
    partials.push_back(mode);
  }
  return partials;
}

bool is_sound(const std::string& path) {
  constexpr std::array kEndings = {".wav", ".flac", ".aiff", ".aif", ".ogg"};
  std::string ending = std::filesystem::path(path).extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return std::ranges::find(kEndings, ending) != kEndings.end();
}

Blow read_blow(const JsonObject& entry, const ReadFile& read, const StruckResonator& struck,
               std::vector<std::string>& files) {
  const DataFile data = read_data(entry, entry.file(), read, files);
  const bool sounds = is_sound(data.path);
  if (entry.has(sounds ? "columns" : "partials"))
    entry.fail(entry.key(sounds ? "columns" : "partials"),
               sounds ? "stands beside a recording" : "stands beside a table", sounds ? "partials" : "columns");
  Blow blow{data.path, {}, {}};
  if (entry.has("speed_m_per_s")) blow.speed_m_per_s = entry.number("speed_m_per_s", kFitSpeed);
  blow.levels = sounds
                    ? levels_of(read_recording(data.text, data.path), data.path, struck, read_partials(entry, struck))
                    : levels_of(data, struck);
  if (blow.levels.size() < kMinPartials)
    refuse(data.path, "partials", fmt::format("{} of them can be used", blow.levels.size()),
           fmt::format("{} or more", kMinPartials));
  return blow;
}

}  // namespace

StruckResonator read_struck(const JsonObject& object, const ReadFile& read, std::vector<std::string>& files) {
  if (!object.has("blows") && !object.has("pulses")) object.fail("struck", "has no data", "blows, pulses or both");
  for (const char* key : {"output", "gain"})
    if (object.has(key) && !object.has("blows")) object.fail(object.key(key), "stands without blows", "pulses alone");
  StruckResonator struck = modes_for(object, read_resonator(object, read, files));
  if (!object.has("blows")) return struck;
  for (const JsonObject& entry :
       object.objects("blows", {"file", "speed_m_per_s", "columns", "partials", "skip_lines"}, kMaxBlows))
    struck.blows.push_back(read_blow(entry, read, struck, files));
  return struck;
}

// Speed, stiffness and gain change together without a trace: some speeds must be known.
void require_enough_levels(const JsonObject& fit, const Measurements& measured) {
  const StruckResonator& struck = *measured.struck;
  std::vector<double> speeds;
  for (const Blow& blow : struck.blows)
    if (blow.speed_m_per_s) speeds.push_back(*blow.speed_m_per_s);
  const bool lacks_speeds = speeds.size() < struck.blows.size();
  if (speeds.empty() || (lacks_speeds && !struck.has_common_gain))
    fit.fail("struck.blows", "the speeds of the blows are unknown",
             fmt::format("one known speed or more if the gain is {}, else all of them", kCommon));
  constexpr double kMinRatio = 1.2;
  const bool frees_exponent = std::ranges::count(measured.laws, "power") > 0;
  if (frees_exponent && measured.pulses.empty() && measured.rows.empty() && measured.curves.empty() &&
      !lacks_speeds && std::ranges::max(speeds) < kMinRatio * std::ranges::min(speeds))
    fit.fail("struck.blows",
             fmt::format("speeds from {:.4g} to {:.4g} m/s leave the exponent unknown", std::ranges::min(speeds),
                         std::ranges::max(speeds)),
             fmt::format("the fastest at least {} times as fast as the slowest, or \"laws\": \"hertz\"", kMinRatio));
}

}  // namespace contactspline
