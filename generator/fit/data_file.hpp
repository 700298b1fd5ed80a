// SPDX-License-Identifier: MIT
// The data files that a fit file names.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "generator/fit/data_table.hpp"
#include "generator/material/contact_reader.hpp"

namespace contactspline {

/// Speeds of impacts and blows [m/s]: wide enough for instruments, narrow enough to catch a wrong unit.
inline constexpr Range kFitSpeed{1e-3, 1e2};

/// A file of data as a fit file names it: its path, as messages name it, and its text.
struct DataFile {
  std::string path, text;
  ColumnNames names;
  int skip_lines = 0;
};

/// Reads the file and the columns that an entry of a fit file names, and adds the file to `files`. Throws BadInput.
[[nodiscard]] DataFile read_data(const JsonObject& entry, std::string_view fit_file, const ReadFile& read,
                                 std::vector<std::string>& files);

/// The wanted columns of the file. Throws BadInput.
[[nodiscard]] DataTable read_table(const DataFile& data, std::span<const Quantity> wanted);

/// Throws BadInput if the table lacks one of these columns.
void require(const DataFile& data, const DataTable& table, std::span<const Quantity> required);

/// Throws BadInput: no column holds `what`. Says what the header has; `allowed`: the names of columns that would do.
[[noreturn]] void refuse_missing(const DataFile& data, const DataTable& table, Quantity quantity,
                                 std::string_view what, std::string_view allowed);

}  // namespace contactspline
