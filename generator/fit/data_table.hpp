// SPDX-License-Identifier: MIT
// Files of measured numbers in columns, as instruments, spreadsheets and scripts write them.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

/// What a column may hold.
enum class Quantity {
  kTime,
  kForce,
  kAcceleration,
  kVoltage,
  kSpeed,
  kDuration,
  kRestitution,
  kCompression,
  kFrequency,
  kPartial,
  kLevel
};

/// "time", "force" and so on.
[[nodiscard]] std::string_view name_of(Quantity quantity);

/// The name of a quantity with each of its units: "time_s, time_ms, time_us".
[[nodiscard]] std::string units_text(Quantity quantity);

/// The name of a quantity with each of its units, such as time_s and time_ms: the keys of `columns` in a fit file.
[[nodiscard]] std::vector<std::string> column_keys();

/// Columns that a fit file names: the key of each, and what the data file calls it or its number from 1.
using ColumnNames = std::map<std::string, std::string>;

/// The columns that were wanted and found, in SI units, with the line of each row; and the header, if there is one.
struct DataTable {
  std::map<Quantity, std::vector<double>> columns;
  std::vector<std::string> header;
  std::vector<std::size_t> lines;

  [[nodiscard]] bool has(Quantity quantity) const { return columns.contains(quantity); }
  [[nodiscard]] const std::vector<double>& at(Quantity quantity) const { return columns.at(quantity); }
};

/// Reads columns separated by semicolons, tabs, commas or blanks; with a decimal comma where commas do not separate.
/// The header names each quantity with its unit: `time_ms`, `t [ms]`, `Time (ms)` or `t/ms`, or the units stand in a
/// line of their own below it. Columns that nobody wants are left out. The first `skip_lines` lines are; and so is
/// what an instrument writes above the line with the wanted columns. Text is UTF-8, UTF-16 or Latin-1. Throws
/// BadInput with `file` and the line.
[[nodiscard]] DataTable read_table(std::string_view text, std::string_view file, std::span<const Quantity> wanted,
                                   const ColumnNames& names, int skip_lines = 0);

}  // namespace contactspline
