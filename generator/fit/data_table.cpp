// SPDX-License-Identifier: MIT
#include "generator/fit/data_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/text_encoding.hpp"
#include "generator/support/text_lines.hpp"

namespace contactspline {
namespace {

struct Unit {
  std::string_view name;  ///< as keys have it
  double size;
  std::string_view sign;  ///< as headers may have it, in lower case
};

/// A quantity, what headers call it, and its units.
struct Kind {
  Quantity quantity;
  std::vector<std::string_view> names;
  std::vector<Unit> units;
};

// The micro sign and the Greek letter.
const std::vector<Unit> kTimes = {
    {"s", 1, "s"}, {"ms", 1e-3, "ms"}, {"us", 1e-6, "\u00b5s"}, {"us", 1e-6, "\u03bcs"}};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {Quantity::kTime, {"time", "t"}, kTimes},
      {Quantity::kForce,
       {"force", "f", "load"},
       {{"n", 1, "n"},
        {"mn", 1e-3, "mn"},
        {"kn", 1e3, "kn"},
        {"lbf", 4.4482216152605, "lbf"},
        {"kgf", 9.80665, "kgf"}}},
      {Quantity::kVoltage, {"voltage", "force", "f", "load", "signal"}, {{"v", 1, "v"}, {"mv", 1e-3, "mv"}}},
      {Quantity::kAcceleration,
       {"acceleration", "acc", "a"},
       {{"m_per_s2", 1, "m/s^2"}, {"m_per_s2", 1, "m/s2"}, {"g", 9.80665, "g"}}},
      {Quantity::kSpeed,
       {"speed", "velocity", "v", "impact_speed"},
       {{"m_per_s", 1, "m/s"}, {"cm_per_s", 1e-2, "cm/s"}, {"mm_per_s", 1e-3, "mm/s"}}},
      {Quantity::kDuration, {"duration", "contact_duration", "contact_time"}, kTimes},
      {Quantity::kRestitution, {"restitution", "cor", "e"}, {{"1", 1, ""}, {"percent", 1e-2, "%"}}},
      {Quantity::kCompression,
       {"compression", "displacement", "deflection", "indentation", "y", "x"},
       {{"m", 1, "m"}, {"mm", 1e-3, "mm"}, {"um", 1e-6, "\u00b5m"}, {"um", 1e-6, "\u03bcm"}}},
      {Quantity::kFrequency, {"frequency", "freq", "f"}, {{"hz", 1, "hz"}, {"khz", 1e3, "khz"}}},
      {Quantity::kPartial, {"partial", "number", "n"}, {{"1", 1, ""}}},
      {Quantity::kLevel, {"level", "magnitude", "l"}, {{"db", 1, "db"}}}};
  return all;
}

const Kind& kind_of(Quantity quantity) {
  return *std::ranges::find(kinds(), quantity, &Kind::quantity);
}

constexpr std::string_view kBlanks = " \t\r\"";

std::string_view trimmed(std::string_view text) {
  return contactspline::trimmed(text, kBlanks);
}

std::optional<std::string_view> next_line(std::string_view& rest, LineOfFile& place) {
  return contactspline::next_line(rest, place, kBlanks, "#%");
}

// Blanks separate only where nothing else does: a header may have them in its names.
char separator_of(std::string_view line) {
  for (const char separator : {';', '\t', ','})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  if (separator == ' ') line = trimmed(line);
  while (true) {
    const auto end = line.find(separator);
    cells.emplace_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
    if (separator == ' ') line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  }
}

std::optional<double> number_in(std::string cell, char separator) {
  if (separator != ',') std::ranges::replace(cell, ',', '.');
  const char* begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// A header's name and unit; the unit is empty where there is none.
struct Heading {
  std::string name, unit;
};

// "t [ms]", "t (ms)", "t/ms" or "time_ms".
Heading heading_of(const std::string& cell) {
  const std::string text = lower(cell);
  const auto bracket = text.find_first_of("[(");
  Heading heading{text, ""};
  if (bracket != std::string::npos) {
    const auto end = std::min(text.find_first_of("])", bracket), text.size());
    heading = {std::string(trimmed(text.substr(0, bracket))),
               std::string(trimmed(text.substr(bracket + 1, end - bracket - 1)))};
  } else if (const auto slash = text.find('/'); slash != std::string::npos) {
    heading = {std::string(trimmed(text.substr(0, slash))), std::string(trimmed(text.substr(slash + 1)))};
  }
  std::ranges::replace(heading.name, ' ', '_');
  return heading;
}

std::string units_text(const Kind& kind) {
  std::vector<std::string> keys;
  for (const Unit& unit : kind.units)
    if (const std::string key = fmt::format("{}_{}", kind.names.front(), unit.name);
        keys.empty() || keys.back() != key)
      keys.push_back(key);
  return fmt::format("{}", fmt::join(keys, ", "));
}

const Unit* unit_named(const Kind& kind, std::string_view name) {
  const auto found =
      std::ranges::find_if(kind.units, [&](const Unit& unit) { return name == unit.name || name == unit.sign; });
  return found == kind.units.end() ? nullptr : &*found;
}

// The size of the heading's unit if it names this kind: 0 if it names it without a unit.
std::optional<double> unit_size(const Heading& heading, const Kind& kind, const LineOfFile& place) {
  for (const std::string_view name : kind.names) {
    if (heading.name == name) {
      const Unit* unit = unit_named(kind, heading.unit);
      // A force may be in volts, and what else is called so is none of them.
      const bool is_voltage = unit_named(kind_of(Quantity::kVoltage), heading.unit) != nullptr;
      if (unit == nullptr &&
          (kind.quantity == Quantity::kVoltage || (kind.quantity == Quantity::kForce && is_voltage)))
        continue;
      if (unit == nullptr)
        place.fail(heading.unit.empty() ? fmt::format("the column '{}' has no unit", shown(heading.name, 40))
                                        : fmt::format("the unit '{}' of the column '{}' is unknown",
                                                      shown(heading.unit, 20), shown(heading.name, 40)),
                   fmt::format("{}, in the header or as a key of columns beside file", units_text(kind)));
      return unit->size;
    }
    if (heading.unit.empty() && heading.name.starts_with(fmt::format("{}_", name)))
      if (const Unit* unit = unit_named(kind, std::string_view(heading.name).substr(name.size() + 1)))
        return unit->size;
  }
  return std::nullopt;
}

/// A column of the file that is wanted.
struct Found {
  Quantity quantity;
  std::size_t index;
  double size;
};

std::size_t column_called(const std::string& name, const std::vector<std::string>& header, std::size_t count,
                          const LineOfFile& place) {
  const auto found = std::ranges::find(header, name);
  if (found != header.end()) return static_cast<std::size_t>(found - header.begin());
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error == std::errc() && end == name.data() + name.size() && number >= 1 && number <= count) return number - 1;
  place.fail(fmt::format("there is no column '{}'", shown(name, 40)),
             header.empty() ? fmt::format("a number from 1 to {}", count)
                            : fmt::format("{}, or a number from 1 to {}", fmt::join(header, ", "), count));
}

std::vector<Found> named_columns(const ColumnNames& names, const std::vector<std::string>& header, std::size_t count,
                                 std::span<const Quantity> wanted, const LineOfFile& place) {
  std::vector<Found> found;
  for (const auto& [key, name] : names)
    for (const Quantity quantity : wanted)
      if (const auto size = unit_size({key, ""}, kind_of(quantity), place))
        found.push_back({quantity, column_called(name, header, count, place), *size});
  return found;
}

void find_in_header(std::vector<Found>& found, const std::vector<std::string>& header,
                    std::span<const Quantity> wanted, const LineOfFile& place) {
  const std::vector<Found> named = found;
  for (const Quantity quantity : wanted) {
    if (std::ranges::find(named, quantity, &Found::quantity) != named.end()) continue;
    std::vector<Found> here;
    for (std::size_t i = 0; i < header.size(); ++i)
      if (std::ranges::find(named, i, &Found::index) != named.end())
        continue;
      else if (const auto size = unit_size(heading_of(header[i]), kind_of(quantity), place))
        here.push_back({quantity, i, *size});
    if (here.size() > 1)
      place.fail(fmt::format("two columns hold the {}: '{}' and '{}'", name_of(quantity),
                             shown(header[here[0].index], 40), shown(header[here[1].index], 40)),
                 fmt::format("one, or the key columns with {}", units_text(kind_of(quantity))));
    found.insert(found.end(), here.begin(), here.end());
  }
}

// Units in a line of their own: "(ms);(N)".
bool holds_units(const std::vector<std::string>& cells) {
  return std::ranges::all_of(cells, [](const std::string& cell) {
    return cell.size() > 2 &&
           ((cell.front() == '(' && cell.back() == ')') || (cell.front() == '[' && cell.back() == ']'));
  });
}

void read_row(DataTable& table, const std::vector<std::string>& cells, const std::vector<Found>& found,
              std::size_t count, char separator, const LineOfFile& place) {
  if (cells.size() != count)
    place.fail(fmt::format("has {} columns", cells.size()),
               fmt::format("{} columns, as in the first line{}", count,
                           table.lines.empty() ? ", or the key skip_lines for lines above the header" : ""));
  for (const auto& [quantity, index, size] : found) {
    const auto value = number_in(cells[index], separator);
    if (!value || !std::isfinite(*value))
      place.fail(fmt::format("'{}' is not a number", shown(cells[index], 40)), "finite numbers such as 1.5e-4");
    table.columns[quantity].push_back(*value * size);
  }
  table.lines.push_back(place.line);
}

bool names_one_of(const std::string& cell, std::span<const Quantity> wanted) {
  const Heading heading = heading_of(cell);
  return std::ranges::any_of(wanted, [&](Quantity quantity) {
    return std::ranges::any_of(kind_of(quantity).names, [&](std::string_view name) {
      return heading.name == name || heading.name.starts_with(fmt::format("{}_", name));
    });
  });
}

// Does a line name wanted columns, or hold those that have been named? Those that are called by number tell nothing.
bool is_header(std::string_view line, std::span<const Quantity> wanted, const ColumnNames& names) {
  const std::vector<std::string> cells = cells_of(line, separator_of(line));
  const auto is_number = [](const auto& name) { return number_in(name.second, ';').has_value(); };
  if (!names.empty())
    return !std::ranges::all_of(names, is_number) && std::ranges::all_of(names, [&](const auto& name) {
      return is_number(name) || std::ranges::count(cells, name.second) > 0;
    });
  const auto found = std::ranges::count_if(cells, [&](const auto& cell) { return names_one_of(cell, wanted); });
  return found >= std::min<std::ptrdiff_t>(2, std::ssize(wanted));
}

// Is a line text in columns, and the next two, or after one of units the two after that, a number in each?
bool stands_above_numbers(std::string_view text, std::string_view rest, LineOfFile place) {
  const char separator = separator_of(text);
  const auto is_number = [&](const std::string& cell) { return number_in(cell, separator).has_value(); };
  const std::vector<std::string> cells = cells_of(text, separator);
  const auto holds_numbers = [&](const std::optional<std::string_view>& line) {
    if (!line) return false;
    const std::vector<std::string> row = cells_of(*line, separator);
    return row.size() == cells.size() && std::ranges::all_of(row, is_number);
  };
  if (cells.size() < 2 || !std::ranges::none_of(cells, is_number)) return false;
  auto line = next_line(rest, place);
  if (line && holds_units(cells_of(*line, separator))) line = next_line(rest, place);
  return holds_numbers(line) && holds_numbers(next_line(rest, place));
}

// Above the header an instrument may tell what it is. The header is the first line that names columns, or else the
// first line of text with numbers alone below it. If there is none, the first line is taken.
void skip_preamble(std::string_view& text, LineOfFile& place, std::span<const Quantity> wanted,
                   const ColumnNames& names) {
  constexpr int kMaxPreamble = 200;
  std::string_view rest = text, header = text;
  LineOfFile place_of_rest = place, place_of_header = place;
  bool found = false;
  for (int i = 0; i < kMaxPreamble; ++i) {
    const std::string_view before = rest;
    const LineOfFile place_before = place_of_rest;
    const auto line = next_line(rest, place_of_rest);
    if (!line) break;
    const bool names_columns = is_header(*line, wanted, names);
    if (!names_columns && (found || !stands_above_numbers(*line, rest, place_of_rest))) continue;
    found = true, header = before, place_of_header = place_before;
    if (names_columns) break;
  }
  text = header, place = place_of_header;
}

}  // namespace

std::string_view name_of(Quantity quantity) {
  return kind_of(quantity).names.front();
}

std::string units_text(Quantity quantity) {
  return units_text(kind_of(quantity));
}

std::vector<std::string> column_keys() {
  std::vector<std::string> keys;
  for (const Kind& kind : kinds())
    for (const Unit& unit : kind.units) {
      std::string key = fmt::format("{}_{}", kind.names.front(), unit.name);
      if (keys.empty() || keys.back() != key) keys.push_back(std::move(key));
    }
  return keys;
}

DataTable read_table(std::string_view text, std::string_view file, std::span<const Quantity> wanted,
                     const ColumnNames& names, int skip_lines) {
  const std::string decoded = in_utf8(text);
  text = decoded;
  if (text.find('\0') != text.npos)
    refuse(file, "file", "is no text",
           "a table as text, such as .csv; a recording ends in .wav, .flac, .aiff or .ogg");
  LineOfFile place{file};
  for (; skip_lines > 0 && !text.empty(); --skip_lines, ++place.line)
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  skip_preamble(text, place, wanted, names);
  auto line = next_line(text, place);
  if (!line) refuse(file, "file", "is empty", "a header with quantities and units, then lines of numbers");
  const char separator = separator_of(*line);
  std::vector<std::string> header = cells_of(*line, separator);
  const std::size_t count = header.size();
  const LineOfFile first = place;
  if (std::ranges::any_of(header, [&](const auto& cell) { return number_in(cell, separator).has_value(); })) {
    header.clear();  // the first line is one of numbers
  } else {
    line = next_line(text, place);
    if (line && cells_of(*line, separator).size() == count && holds_units(cells_of(*line, separator))) {
      const auto units = cells_of(*line, separator);
      for (std::size_t i = 0; i < count; ++i)
        if (heading_of(header[i]).unit.empty()) header[i] += units[i];
      line = next_line(text, place);
    }
  }
  std::vector<Found> found = named_columns(names, header, count, wanted, first);
  if (header.empty() && found.empty())
    first.fail("there is no header", "a header such as time_s,force_n, or the key columns with their numbers");
  find_in_header(found, header, wanted, first);
  DataTable table;
  table.header = header;
  for (; line; line = next_line(text, place))
    read_row(table, cells_of(*line, separator), found, count, separator, place);
  if (table.lines.empty())
    refuse(file, "samples", "has a header and no numbers", "lines of numbers below the header");
  return table;
}

}  // namespace contactspline
