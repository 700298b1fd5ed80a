// SPDX-License-Identifier: MIT
#include "generator/support/json_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>

#include "generator/support/error.hpp"
#include "generator/support/json_syntax.hpp"
#include "generator/support/nearest_name.hpp"
#include "generator/support/reserved_names.hpp"
#include "generator/support/text_encoding.hpp"

namespace contactspline {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxNameLength = 64;
constexpr std::size_t kMaxDescriptionLength = 200;

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string allowed_numbers(Range range) {
  return fmt::format("a number from {} to {}", range.min, range.max);
}

/// Position of the parser: the keys read so far in each open object. `root` names the whole file.
class Position {
 public:
  explicit Position(std::string_view root) : root_(root) {}

  void open() { objects_.emplace_back(); }
  void close() { objects_.pop_back(); }

  /// Records the key. Returns false for a key that the object already has.
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

// Without this callback nlohmann would silently keep the last of two equal keys.
Json::parser_callback_t reject_duplicates(std::string_view file, Position& position) {
  return [file, &position](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) position.open();
    if (event == Json::parse_event_t::object_end) position.close();
    if (event == Json::parse_event_t::key && !position.enter(parsed.get<std::string>()))
      refuse(file, position.path(), "duplicate key", "once");
    return true;
  };
}

// What the library's message has in quotes.
std::string quoted_in(std::string_view message) {
  const auto begin = message.find('\'') + 1, end = message.rfind('\'');
  return end > begin ? shown(message.substr(begin, end - begin)) : "a number";
}

bool is_identifier(std::string_view name) {
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_part = [&](char c) { return is_lower(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= kMaxNameLength && is_lower(name.front()) &&
         std::ranges::all_of(name, is_part) && name.find("__") == std::string_view::npos;
}

}  // namespace

std::string shown(std::string_view text, std::size_t max) {
  std::string safe(text.substr(0, max));
  std::ranges::replace_if(
      safe, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return text.size() > max ? safe + "..." : safe;
}

std::size_t count_characters(std::string_view text) {
  std::size_t count = 0;
  bool after_letter = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = [&](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0; };
    if ((byte(i) & 0xc0) == 0x80) continue;
    // U+0300 to U+036F are accents of the letter before them.
    const bool is_accent = byte(i) == 0xcc || (byte(i) == 0xcd && byte(i + 1) < 0xb0);
    if (!is_accent || !after_letter) ++count;
    after_letter = !is_accent;
  }
  return count;
}

struct JsonObject::Value {
  std::shared_ptr<const Json> file;
  const Json& json;  // part of `file`

  [[nodiscard]] std::shared_ptr<const Value> part(const Json& part) const {
    return std::make_shared<const Value>(Value{file, part});
  }
};

namespace {

Json parsed(std::string_view text, std::string_view file, std::string_view what) {
  const std::string decoded = is_marked_utf_16(text) ? in_utf8(text) : std::string();
  if (!decoded.empty()) text = decoded;
  Position position(what);
  if (const auto nul = text.find('\0'); nul != text.npos) refuse_syntax(text, file, nul, "control character");
  try {
    return Json::parse(text, reject_duplicates(file, position), true, true);
  } catch (const Json::out_of_range& error) {
    refuse(file, position.path(), fmt::format("{} is too large", quoted_in(error.what())), "a finite number");
  } catch (const Json::parse_error& error) {
    refuse_syntax(text, file, error.byte == 0 ? 0 : error.byte - 1, error.what());
  }
}

// The value of a required key.
const Json& value_at(const JsonObject& object, const Json& json, const char* name, std::string_view allowed) {
  if (!json.contains(name)) object.fail(object.key(name), "missing", allowed);
  return json.at(name);
}

const Json& array_at(const JsonObject& object, const Json& json, const char* name, std::string_view allowed,
                     std::size_t max_count) {
  const Json& value = value_at(object, json, name, allowed);
  if (!value.is_array()) object.fail(object.key(name), "is not an array", allowed);
  if (value.empty() || value.size() > max_count)
    object.fail(object.key(name), fmt::format("has {} entries", value.size()), allowed);
  return value;
}

double checked(const JsonObject& object, const Json& value, const std::string& key, Range range) {
  if (!value.is_number()) object.fail(key, "is not a number", allowed_numbers(range));
  const double number = value.get<double>();
  if (!(number >= range.min && number <= range.max))
    object.fail(key, fmt::format("{} is out of range", number), allowed_numbers(range));
  return number;
}

}  // namespace

JsonObject parse_json(std::string_view text, std::string_view file, std::string_view what,
                      const std::vector<std::string>& allowed) {
  const auto json = std::make_shared<const Json>(parsed(text, file, what));
  return {std::make_shared<const JsonObject::Value>(JsonObject::Value{json, *json}), std::string(file), "", what,
          allowed};
}

std::vector<std::string> json_keys(std::string_view text, std::string_view file, std::string_view what) {
  const Json json = parsed(text, file, what);
  std::vector<std::string> keys;
  if (!json.is_object()) return keys;
  for (const auto& item : json.items()) keys.push_back(item.key());
  return keys;
}

std::string json_string(std::string_view text) {
  return Json(text).dump();
}

JsonObject::JsonObject(std::shared_ptr<const Value> value, std::string file, std::string path, std::string_view self,
                       const std::vector<std::string>& allowed)
    : value_(std::move(value)), file_(std::move(file)), path_(std::move(path)) {
  if (!value_->json.is_object()) fail(self, "is not an object", joined(allowed));
  for (const auto& item : value_->json.items())
    if (std::ranges::find(allowed, item.key()) == allowed.end())
      fail(key(shown(item.key())), "unknown key", joined(allowed) + did_you_mean(allowed, item.key()));
}

bool JsonObject::has(const char* name) const {
  return value_->json.contains(name);
}

bool JsonObject::has_object(const char* name) const {
  return has(name) && value_->json.at(name).is_object();
}

bool JsonObject::has_text(const char* name) const {
  return has(name) && value_->json.at(name).is_string();
}

std::string JsonObject::json(const char* name) const {
  return value_at(*this, value_->json, name, "any value").dump();
}

JsonObject JsonObject::object(const char* name, const std::vector<std::string>& allowed) const {
  const std::string path = key(name);
  return {value_->part(value_at(*this, value_->json, name, joined(allowed))), file_, path, path, allowed};
}

std::vector<JsonObject> JsonObject::objects(const char* name, const std::vector<std::string>& allowed,
                                            std::size_t max_count) const {
  std::vector<JsonObject> objects;
  const std::string an_array = fmt::format("an array of 1 to {} objects", max_count);
  for (const Json& value : array_at(*this, value_->json, name, an_array, max_count)) {
    const std::string path = fmt::format("{}[{}]", key(name), objects.size());
    objects.push_back({value_->part(value), file_, path, path, allowed});
  }
  return objects;
}

std::string JsonObject::text(const char* name, std::string_view allowed) const {
  const Json& value = value_at(*this, value_->json, name, allowed);
  if (!value.is_string()) fail(key(name), "is not a string", allowed);
  return value.get<std::string>();
}

std::vector<std::string> JsonObject::texts(const char* name, std::string_view allowed, std::size_t max_count) const {
  if (value_->json.contains(name) && value_->json.at(name).is_string()) return {text(name, allowed)};
  std::vector<std::string> texts;
  for (const Json& value : array_at(*this, value_->json, name, allowed, max_count)) {
    if (!value.is_string()) fail(fmt::format("{}[{}]", key(name), texts.size()), "is not a string", allowed);
    texts.push_back(value.get<std::string>());
  }
  return texts;
}

double JsonObject::number(const char* name, Range range) const {
  return checked(*this, value_at(*this, value_->json, name, allowed_numbers(range)), key(name), range);
}

std::vector<double> JsonObject::numbers(const char* name, Range range, std::size_t max_count) const {
  std::vector<double> numbers;
  const std::string an_array = fmt::format("an array of 1 to {} numbers", max_count);
  for (const Json& value : array_at(*this, value_->json, name, an_array, max_count))
    numbers.push_back(checked(*this, value, fmt::format("{}[{}]", key(name), numbers.size()), range));
  return numbers;
}

int JsonObject::integer(const char* name, int min, int max) const {
  const std::string allowed = fmt::format("an integer from {} to {}", min, max);
  const Json& value = value_at(*this, value_->json, name, allowed);
  if (!value.is_number_integer()) fail(key(name), "is not an integer", allowed);
  const double number = value.get<double>();
  if (!(number >= min && number <= max))
    fail(key(name), fmt::format("{} is out of range", shown(value.dump())), allowed);
  return value.get<int>();
}

void JsonObject::fail(std::string_view key, std::string_view wrong, std::string_view allowed) const {
  refuse(file_, key, wrong, allowed);
}

std::string JsonObject::key(std::string_view name) const {
  return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
}

std::string read_name(const JsonObject& object, std::span<const char* const> taken) {
  constexpr auto kAllowed =
      "a-z, 0-9 and single _, a letter first, at most 64 characters, no keyword, macro or library of C++ or Faust, "
      "no name of the emitted files";
  std::string name = object.text("name", kAllowed);
  if (!is_identifier(name) || is_reserved_name(name) || std::ranges::find(taken, name) != taken.end())
    object.fail(object.key("name"), fmt::format("'{}' is not a usable identifier", shown(name)), kAllowed);
  return name;
}

std::string read_local_name(const JsonObject& object, std::string_view taken) {
  constexpr auto kAllowed = "a-z, 0-9 and single _, a letter first, no _ at the end, at most 64 characters";
  std::string name = object.text("name", kAllowed);
  if (!is_identifier(name) || name.ends_with('_') || name == taken)  // a quantity follows behind another _
    object.fail(object.key("name"), fmt::format("'{}' is not a usable identifier", shown(name)), kAllowed);
  return name;
}

namespace {

// Does UTF-8 text have a character that prints nothing? The controls of ASCII and U+0080 to U+009F, ends of lines,
// and those that change the direction of writing, with which source code can be made to look like another.
bool has_control(std::string_view text) {
  constexpr std::array<std::string_view, 14> kControls = {"\u061c", "\u200e", "\u200f", "\u2028", "\u2029",
                                                          "\u202a", "\u202b", "\u202c", "\u202d", "\u202e",
                                                          "\u2066", "\u2067", "\u2068", "\u2069"};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    if (c < 0x20 || c == 0x7f || (c == 0xc2 && next >= 0x80 && next < 0xa0)) return true;
  }
  return std::ranges::any_of(kControls, [&](std::string_view control) { return text.find(control) != text.npos; });
}

}  // namespace

std::string read_line(const JsonObject& object, const char* name, int max_length) {
  const std::string allowed =
      fmt::format("one line of at most {} printable characters, no quote, no backslash", max_length);
  std::string text = object.text(name, allowed);
  const bool printable = text.find_first_of("\"\\") == text.npos && !has_control(text);
  if (!printable || count_characters(text) > static_cast<std::size_t>(max_length))
    object.fail(object.key(name), "is too long or has a quote, a backslash or a control character", allowed);
  return text;
}

std::string read_description(const JsonObject& object) {
  return object.has("description") ? read_line(object, "description", kMaxDescriptionLength) : std::string();
}

std::string read_license(const JsonObject& object) {
  if (!object.has("license")) return "MIT";
  constexpr auto kAllowed = "an SPDX identifier of at most 100 letters, digits and . + - ( ), such as \"CC-BY-4.0\"";
  std::string text = object.text("license", kAllowed);
  const auto is_usable = [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c)) || std::string_view(" .+-()").find(char(c)) != std::string_view::npos;
  };
  if (text.empty() || text.size() > 100 || !std::ranges::all_of(text, is_usable))
    object.fail(object.key("license"), fmt::format("'{}' is no identifier of a licence", shown(text)), kAllowed);
  return text;
}

std::string one_of_keys(const JsonObject& json, const std::vector<std::string>& keys, const char* what) {
  std::vector<std::string> given;
  std::ranges::copy_if(keys, std::back_inserter(given),
                       [&](const std::string& key) { return json.has(key.c_str()); });
  if (given.size() != 1)
    json.fail(json.key(given.empty() ? keys.front() : given[1]), fmt::format("{} {} are given", given.size(), what),
              fmt::format("just one of {}", fmt::join(keys, ", ")));
  return given.front();
}

}  // namespace contactspline
