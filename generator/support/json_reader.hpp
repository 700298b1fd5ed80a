// SPDX-License-Identifier: MIT
// A strict reader for JSON input files. Every error names the file and the key.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

/// Range of a number; both bounds are allowed.
struct Range {
  double min, max;
};

/// Text from a file, made safe for a one-line message: at most `max` characters, of which only printable ASCII ones
/// stay; the others become '?'.
[[nodiscard]] std::string shown(std::string_view text, std::size_t max = 80);

/// The characters of UTF-8 as a reader counts them: a letter with an accent that follows as a character of its own is
/// one.
[[nodiscard]] std::size_t count_characters(std::string_view text);

/// The keys of the text's JSON object; none if it is not an object. Throws BadInput for wrong syntax, with `file` and
/// `what` as in parse_json().
[[nodiscard]] std::vector<std::string> json_keys(std::string_view text, std::string_view file, std::string_view what);

/// The text as a JSON string with quotes and escapes.
[[nodiscard]] std::string json_string(std::string_view text);

/// One JSON object, together with its file and its path in the file, which every message names. A key outside
/// `allowed` is an error. Every reader throws BadInput if the key is missing, has the wrong type or is out of range.
class JsonObject {
 public:
  [[nodiscard]] bool has(const char* name) const;
  [[nodiscard]] bool has_object(const char* name) const;  ///< is there such a key, with an object?
  [[nodiscard]] bool has_text(const char* name) const;    ///< the same, with text
  [[nodiscard]] JsonObject object(const char* name, const std::vector<std::string>& allowed) const;
  [[nodiscard]] std::string json(const char* name) const;  ///< the value's text
  [[nodiscard]] std::vector<JsonObject> objects(const char* name, const std::vector<std::string>& allowed,
                                                std::size_t max_count) const;  ///< 1 to max_count of them
  [[nodiscard]] std::string text(const char* name, std::string_view allowed) const;
  [[nodiscard]] std::vector<std::string> texts(const char* name, std::string_view allowed,
                                               std::size_t max_count) const;  ///< 1 to max_count, or one without []
  [[nodiscard]] double number(const char* name, Range range) const;
  [[nodiscard]] std::vector<double> numbers(const char* name, Range range,
                                            std::size_t max_count) const;  ///< 1 to max_count of them
  [[nodiscard]] int integer(const char* name, int min, int max) const;

  /// Throws BadInput: "file: key: wrong; allowed: allowed". `key` is a full path, as key() returns it.
  [[noreturn]] void fail(std::string_view key, std::string_view wrong, std::string_view allowed) const;

  /// The file, as messages name it.
  [[nodiscard]] const std::string& file() const { return file_; }

  /// The full path of a member of this object, such as `spline.knots`.
  [[nodiscard]] std::string key(std::string_view name) const;

 private:
  struct Value;  ///< the parsed file and a reference to this object in it
  friend JsonObject parse_json(std::string_view, std::string_view, std::string_view, const std::vector<std::string>&);
  JsonObject(std::shared_ptr<const Value> value, std::string file, std::string path, std::string_view self,
             const std::vector<std::string>& allowed);

  std::shared_ptr<const Value> value_;
  std::string file_;
  std::string path_;
};

/// Parses a whole file: one JSON object, comments allowed. `file` and `what`, the kind of the file, appear in
/// messages only. Throws BadInput for wrong syntax, duplicate keys, numbers beyond the range of double and keys
/// outside `allowed`.
[[nodiscard]] JsonObject parse_json(std::string_view text, std::string_view file, std::string_view what,
                                    const std::vector<std::string>& allowed);

/// The one key of several that an object has. what: what they are. Throws BadInput.
[[nodiscard]] std::string one_of_keys(const JsonObject& json, const std::vector<std::string>& keys, const char* what);

/// Reads the key `name`: a lower-case identifier for files and code. It must not be one of `taken`, the member names
/// of the emitted struct.
[[nodiscard]] std::string read_name(const JsonObject& object, std::span<const char* const> taken);

/// Reads the key `name` of an object within a file: as read_name(), but keywords and macros are allowed.
[[nodiscard]] std::string read_local_name(const JsonObject& object, std::string_view taken = {});

/// Reads a text of one line, as hosts and figures show it.
[[nodiscard]] std::string read_line(const JsonObject& object, const char* name, int max_length);

/// Reads the optional key `description`: one line; an empty string if it is missing.
[[nodiscard]] std::string read_description(const JsonObject& object);
/// Reads the optional key `license`, an SPDX identifier or expression; MIT if it is missing.
[[nodiscard]] std::string read_license(const JsonObject& object);

}  // namespace contactspline
