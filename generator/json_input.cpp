// SPDX-License-Identifier: MIT
#include "generator/json_input.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>

#include "generator/error.hpp"

namespace contactspline {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxNameLength = 64;
constexpr std::ptrdiff_t kMaxDescriptionLength = 200;

// Words that could not name the emitted C++ struct.
constexpr std::array kReserved = {
    "alignas",     "alignof",   "and",       "and_eq",    "asm",      "auto",         "bitand",
    "bitor",       "bool",      "break",     "case",      "catch",    "char",         "char8_t",
    "char16_t",    "char32_t",  "class",     "compl",     "concept",  "const",        "const_cast",
    "consteval",   "constexpr", "constinit", "continue",  "co_await", "co_return",    "co_yield",
    "decltype",    "default",   "delete",    "do",        "double",   "dynamic_cast", "else",
    "enum",        "explicit",  "export",    "extern",    "false",    "float",        "for",
    "friend",      "goto",      "if",        "inline",    "int",      "long",         "mutable",
    "namespace",   "new",       "noexcept",  "not",       "not_eq",   "nullptr",      "operator",
    "or",          "or_eq",     "private",   "protected", "public",   "register",     "reinterpret_cast",
    "requires",    "return",    "short",     "signed",    "sizeof",   "static",       "static_assert",
    "static_cast", "struct",    "switch",    "template",  "this",     "thread_local", "throw",
    "true",        "try",       "typedef",   "typeid",    "typename", "union",        "unsigned",
    "using",       "virtual",   "void",      "volatile",  "wchar_t",  "while",        "xor",
    "xor_eq"};

// Words that emitted code cannot be called by, though they are identifiers: libraries beside it, macros of C.
constexpr std::array kTakenElsewhere = {"contact", "modal",    "instruments", "std",   "linux",
                                        "unix",    "errno",    "assert",      "stdin", "stdout",
                                        "stderr",  "offsetof", "setjmp",      "major", "minor"};

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string allowed_numbers(Range range) {
  return fmt::format("a number from {} to {}", range.least, range.most);
}

/// Where the parser is: for each open object the keys so far and the last of them; `root` names the whole file.
class Position {
 public:
  explicit Position(std::string_view root) : root_(root) {}

  void open() { objects_.emplace_back(); }
  void close() { objects_.pop_back(); }

  /// Was the key not there before?
  [[nodiscard]] bool enter(const std::string& key) {
    objects_.back().last = key;
    return objects_.back().keys.insert(key).second;
  }

  [[nodiscard]] std::string path() const {
    std::string path;
    for (const auto& object : objects_) path += (path.empty() ? "" : ".") + object.last;
    return path.empty() ? root_ : shown(path);
  }

 private:
  struct OpenObject {
    std::set<std::string> keys;
    std::string last;
  };
  std::string root_;
  std::vector<OpenObject> objects_;
};

// nlohmann keeps the last of two equal keys; a reader could mean either.
Json::parser_callback_t reject_duplicates(std::string_view file, Position& position) {
  return [file, &position](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) position.open();
    if (event == Json::parse_event_t::object_end) position.close();
    if (event == Json::parse_event_t::key && !position.enter(parsed.get<std::string>()))
      throw BadInput(fmt::format("{}: {}: duplicate key; allowed: once", file, position.path()));
    return true;
  };
}

// The library's message begins with a bracketed identifier that means nothing to a user.
std::string without_identifier(std::string_view message) {
  const auto end = message.find("] ");
  return shown(end == std::string_view::npos ? message : message.substr(end + 2), 240);
}

bool is_identifier(std::string_view name) {
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_part = [&](char c) { return is_lower(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= kMaxNameLength && is_lower(name.front()) &&
         std::ranges::all_of(name, is_part) && name.find("__") == std::string_view::npos &&
         std::ranges::find(kReserved, name) == kReserved.end() &&
         std::ranges::find(kTakenElsewhere, name) == kTakenElsewhere.end();
}

}  // namespace

// What a file says may be long or hold anything; a message is one readable line.
std::string shown(std::string_view text, std::size_t most) {
  std::string safe(text.substr(0, most));
  std::ranges::replace_if(
      safe, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return text.size() > most ? safe + "..." : safe;
}

Json parse_json(std::string_view text, std::string_view file, std::string_view what) {
  Position position(what);
  try {
    return Json::parse(text, reject_duplicates(file, position), true, true);
  } catch (const Json::out_of_range& error) {
    throw BadInput(
        fmt::format("{}: {}: {}; allowed: a finite number", file, position.path(), without_identifier(error.what())));
  } catch (const Json::exception& error) {
    throw BadInput(fmt::format("{}: {}: {}; allowed: a JSON object, comments included", file, what,
                               without_identifier(error.what())));
  }
}

JsonObject::JsonObject(const Json& json, std::string_view file, std::string_view what,
                       const std::vector<std::string>& allowed)
    : json_(json), file_(file) {
  require_keys(what, allowed);
}

JsonObject::JsonObject(const Json& json, const JsonObject& parent, std::string path,
                       const std::vector<std::string>& allowed)
    : json_(json), file_(parent.file_), path_(std::move(path)) {
  require_keys(path_, allowed);
}

void JsonObject::require_keys(std::string_view self, const std::vector<std::string>& allowed) const {
  if (!json_.is_object()) fail(self, "is not an object", joined(allowed));
  for (const auto& item : json_.items())
    if (std::ranges::find(allowed, item.key()) == allowed.end())
      fail(key(shown(item.key())), "unknown key", joined(allowed));
}

JsonObject JsonObject::object(const char* name, const std::vector<std::string>& allowed) const {
  return {at(name, joined(allowed)), *this, key(name), allowed};
}

std::vector<JsonObject> JsonObject::objects(const char* name, const std::vector<std::string>& allowed,
                                            std::size_t most) const {
  std::vector<JsonObject> objects;
  for (const Json& value : array(name, fmt::format("an array of 1 to {} objects", most), most))
    objects.push_back({value, *this, fmt::format("{}[{}]", key(name), objects.size()), allowed});
  return objects;
}

std::string JsonObject::text(const char* name, std::string_view allowed) const {
  const Json& value = at(name, allowed);
  if (!value.is_string()) fail(key(name), "is not a string", allowed);
  return value.get<std::string>();
}

double JsonObject::number(const char* name, Range range) const {
  return checked(at(name, allowed_numbers(range)), key(name), range);
}

std::vector<double> JsonObject::numbers(const char* name, Range range, std::size_t most) const {
  std::vector<double> numbers;
  for (const Json& value : array(name, fmt::format("an array of 1 to {} numbers", most), most))
    numbers.push_back(checked(value, fmt::format("{}[{}]", key(name), numbers.size()), range));
  return numbers;
}

int JsonObject::integer(const char* name, int least, int most) const {
  const std::string allowed = fmt::format("an integer from {} to {}", least, most);
  const Json& value = at(name, allowed);
  if (!value.is_number_integer()) fail(key(name), "is not an integer", allowed);
  const double number = value.get<double>();
  if (!(number >= least && number <= most))
    fail(key(name), fmt::format("{} is out of range", shown(value.dump())), allowed);
  return value.get<int>();
}

void JsonObject::fail(std::string_view key, std::string_view wrong, std::string_view allowed) const {
  throw BadInput(fmt::format("{}: {}: {}; allowed: {}", file_, key, wrong, allowed));
}

std::string JsonObject::key(std::string_view name) const {
  return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
}

const Json& JsonObject::at(const char* name, std::string_view allowed) const {
  if (!has(name)) fail(key(name), "missing", allowed);
  return json_.at(name);
}

const Json& JsonObject::array(const char* name, std::string_view allowed, std::size_t most) const {
  const Json& value = at(name, allowed);
  if (!value.is_array()) fail(key(name), "is not an array", allowed);
  if (value.empty() || value.size() > most) fail(key(name), fmt::format("has {} entries", value.size()), allowed);
  return value;
}

double JsonObject::checked(const Json& value, const std::string& key, Range range) const {
  if (!value.is_number()) fail(key, "is not a number", allowed_numbers(range));
  const double number = value.get<double>();
  if (!(number >= range.least && number <= range.most))
    fail(key, fmt::format("{} is out of range", number), allowed_numbers(range));
  return number;
}

std::string read_name(const JsonObject& object, std::span<const char* const> taken) {
  constexpr auto kAllowed =
      "a-z, 0-9 and single _, a letter first, at most 64 characters, no C++ keyword and no name of the emitted files";
  std::string name = object.text("name", kAllowed);
  if (!is_identifier(name) || std::ranges::find(taken, name) != taken.end())
    object.fail("name", fmt::format("'{}' is not a usable identifier", shown(name)), kAllowed);
  return name;
}

std::string read_description(const JsonObject& object) {
  if (!object.has("description")) return {};
  constexpr auto kAllowed = "one line of at most 200 printable characters, no quote, no backslash";
  std::string text = object.text("description", kAllowed);
  const bool printable =
      std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '"' || c == '\\'; });
  const auto begins_character = [](unsigned char c) { return (c & 0xc0) != 0x80; };  // of UTF-8
  if (!printable || std::ranges::count_if(text, begins_character) > kMaxDescriptionLength)
    object.fail("description", "is too long or has a quote, a backslash or a control character", kAllowed);
  return text;
}

}  // namespace contactspline
