// SPDX-License-Identifier: MIT
// Strict reading of JSON input files: whatever is not right is an error that names file and key.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

/// Bounds of a number, both allowed.
struct Range {
  double least, most;
};

/// Text from a file as part of a message: one line of printable characters, at most `most` of them.
[[nodiscard]] std::string shown(std::string_view text, std::size_t most = 80);

/// JSON with comments. Throws BadInput, naming `file` and the key: syntax, duplicate keys, numbers beyond double.
/// `what` says what the whole file is, for messages.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, std::string_view file, std::string_view what);

/// One JSON object with the file and the path to name in messages. Keys that are not `allowed` are errors. Every
/// reader throws BadInput where the key is missing, of the wrong type or out of range. Refers to the JSON it was made
/// of.
class JsonObject {
 public:
  /// The whole file; `what` says what it is, for messages.
  JsonObject(const nlohmann::json& json, std::string_view file, std::string_view what,
             const std::vector<std::string>& allowed);

  [[nodiscard]] bool has(const char* name) const { return json_.contains(name); }
  [[nodiscard]] JsonObject object(const char* name, const std::vector<std::string>& allowed) const;
  [[nodiscard]] std::vector<JsonObject> objects(const char* name, const std::vector<std::string>& allowed,
                                                std::size_t most) const;
  [[nodiscard]] std::string text(const char* name, std::string_view allowed) const;
  [[nodiscard]] double number(const char* name, Range range) const;
  [[nodiscard]] std::vector<double> numbers(const char* name, Range range, std::size_t most) const;
  [[nodiscard]] int integer(const char* name, int least, int most) const;

  [[noreturn]] void fail(std::string_view key, std::string_view wrong, std::string_view allowed) const;
  [[nodiscard]] std::string key(std::string_view name) const;

 private:
  JsonObject(const nlohmann::json& json, const JsonObject& parent, std::string path,
             const std::vector<std::string>& allowed);
  void require_keys(std::string_view self, const std::vector<std::string>& allowed) const;
  [[nodiscard]] const nlohmann::json& at(const char* name, std::string_view allowed) const;
  [[nodiscard]] const nlohmann::json& array(const char* name, std::string_view allowed, std::size_t most) const;
  [[nodiscard]] double checked(const nlohmann::json& value, const std::string& key, Range range) const;

  const nlohmann::json& json_;
  std::string file_;
  std::string path_;
};

/// Key `name`: a lower-case identifier that can name files and code; none of `taken`, the members of what is emitted.
[[nodiscard]] std::string read_name(const JsonObject& object, std::span<const char* const> taken);

/// Key `description`: one line, or nothing where it is left out.
[[nodiscard]] std::string read_description(const JsonObject& object);

}  // namespace contactspline
