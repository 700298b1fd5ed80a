// SPDX-License-Identifier: MIT
#include "generator/fit/data_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "generator/support/error.hpp"

namespace contactspline {

DataFile read_data(const JsonObject& entry, std::string_view fit_file, const ReadFile& read,
                   std::vector<std::string>& files) {
  constexpr auto kAllowed = "the name of a CSV file, relative to the fit file";
  const std::string name = entry.text("file", kAllowed);
  const bool usable = !name.empty() && name.front() != '/' && name.size() <= 200 &&
                      std::ranges::all_of(name, [](unsigned char c) { return c >= 0x20 && c != 0x7f; });
  if (!usable) entry.fail(entry.key("file"), fmt::format("'{}' is not usable", shown(name)), kAllowed);
  DataFile data{(std::filesystem::path(fit_file).parent_path() / name).string(),
                read_for_key(fit_file, entry.key("file"), name, read),
                {}};
  files.push_back(name);
  constexpr int kMaxSkipped = 10000;
  if (entry.has("skip_lines")) data.skip_lines = entry.integer("skip_lines", 0, kMaxSkipped);
  if (!entry.has("columns")) return data;
  const auto keys = column_keys();
  const JsonObject columns = entry.object("columns", keys);
  for (const std::string& key : keys)
    if (columns.has(key.c_str()))
      data.names[key] = columns.text(key.c_str(), "the name of a column, or its number from 1, in quotes");
  return data;
}

DataTable read_table(const DataFile& data, std::span<const Quantity> wanted) {
  return read_table(data.text, data.path, wanted, data.names, data.skip_lines);
}

void require(const DataFile& data, const DataTable& table, std::span<const Quantity> required) {
  for (const Quantity quantity : required)
    if (!table.has(quantity)) refuse_missing(data, table, quantity, "it", units_text(quantity));
}

void refuse_missing(const DataFile& data, const DataTable& table, Quantity quantity, std::string_view what,
                    std::string_view allowed) {
  constexpr std::size_t kMost = 100;  // characters of the header
  const std::string header = shown(fmt::format("{}", fmt::join(table.header, ", ")), kMost);
  refuse(data.path, std::string(name_of(quantity)),
         fmt::format("no column holds {}{}{}", what, header.empty() ? "" : ": the header has ", header),
         fmt::format("a column {}, or the key columns beside file, such as \"columns\": {{ \"{}\": \"NAME\" }}",
                     allowed, allowed.substr(0, allowed.find(','))));
}

}  // namespace contactspline
