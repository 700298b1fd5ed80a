// SPDX-License-Identifier: MIT
#include "generator/material.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "generator/error.hpp"
#include "generator/quad.hpp"

namespace contactspline {
namespace {

using Json = nlohmann::json;

struct Range {
  double least, most;
};

// Wide enough for every collision in an instrument, narrow enough to catch a wrong unit.
constexpr Range kStiffness{1e-3, 1e18};
constexpr Range kExponent{0.1, 10};
constexpr Range kMass{1e-9, 1e4};
constexpr Range kSpeed{1e-6, 1e3};
constexpr Range kCompression{1e-9, 1};
constexpr int kMaxSegments = 65536;
constexpr std::size_t kMaxNameLength = 64;
constexpr std::size_t kMaxDescriptionLength = 200;

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

/// One JSON object with the file and the path to name in messages. Knows which keys are allowed.
class Object {
 public:
  Object(const Json& json, std::string_view file, std::string path, std::vector<std::string> allowed)
      : json_(json), file_(file), path_(std::move(path)) {
    if (!json.is_object()) fail(path_.empty() ? "material" : path_, "is not an object", keys(allowed));
    for (const auto& item : json.items())
      if (std::ranges::find(allowed, item.key()) == allowed.end())
        fail(key(item.key()), "unknown key", keys(allowed));
  }

  [[nodiscard]] bool has(const char* name) const { return json_.contains(name); }

  [[nodiscard]] Object object(const char* name, std::vector<std::string> allowed) const {
    return {at(name, keys(allowed)), file_, name, std::move(allowed)};
  }

  [[nodiscard]] std::string text(const char* name, std::string_view allowed) const {
    const Json& value = at(name, allowed);
    if (!value.is_string()) fail(key(name), "is not a string", allowed);
    return value.get<std::string>();
  }

  [[nodiscard]] double number(const char* name, Range range) const {
    const std::string allowed = fmt::format("a number from {} to {}", range.least, range.most);
    const Json& value = at(name, allowed);
    if (!value.is_number()) fail(key(name), "is not a number", allowed);
    const double number = value.get<double>();
    if (!(number >= range.least && number <= range.most))
      fail(key(name), fmt::format("{} is out of range", number), allowed);
    return number;
  }

  [[nodiscard]] int integer(const char* name, int least, int most) const {
    const std::string allowed = fmt::format("an integer from {} to {}", least, most);
    const Json& value = at(name, allowed);
    if (!value.is_number_integer()) fail(key(name), "is not an integer", allowed);
    const double number = value.get<double>();
    if (!(number >= least && number <= most))
      fail(key(name), fmt::format("{} is out of range", value.dump()), allowed);
    return value.get<int>();
  }

  [[noreturn]] void fail(std::string_view key, std::string_view wrong, std::string_view allowed) const {
    throw BadInput(fmt::format("{}: {}: {}; allowed: {}", file_, key, wrong, allowed));
  }

  [[nodiscard]] std::string key(std::string_view name) const {
    return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
  }

 private:
  static std::string keys(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

  [[nodiscard]] const Json& at(const char* name, std::string_view allowed) const {
    if (!has(name)) fail(key(name), "missing", allowed);
    return json_.at(name);
  }

  const Json& json_;
  std::string file_;
  std::string path_;
};

// nlohmann keeps the last of two equal keys; a reader could mean either.
Json::parser_callback_t reject_duplicates(std::string_view file, std::vector<std::set<std::string>>& open_objects) {
  return [file, &open_objects](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) open_objects.emplace_back();
    if (event == Json::parse_event_t::object_end) open_objects.pop_back();
    if (event == Json::parse_event_t::key && !open_objects.back().insert(parsed.get<std::string>()).second)
      throw BadInput(fmt::format("{}: {}: duplicate key; allowed: once", file, parsed.get<std::string>()));
    return true;
  };
}

// The library's message begins with a bracketed identifier that means nothing to a user.
std::string without_identifier(std::string_view message) {
  const auto end = message.find("] ");
  return std::string(end == std::string_view::npos ? message : message.substr(end + 2));
}

Json parse_json(std::string_view text, std::string_view file) {
  std::vector<std::set<std::string>> open_objects;
  try {
    return Json::parse(text, reject_duplicates(file, open_objects), true, true);
  } catch (const Json::exception& error) {
    throw BadInput(fmt::format("{}: material: {}; allowed: a JSON object, comments included", file,
                               without_identifier(error.what())));
  }
}

bool is_identifier(std::string_view name) {
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_part = [&](char c) { return is_lower(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= kMaxNameLength && is_lower(name.front()) &&
         std::ranges::all_of(name, is_part) && name.find("__") == std::string_view::npos &&
         std::ranges::find(kReserved, name) == kReserved.end();
}

std::string read_name(const Object& material) {
  constexpr auto kAllowed = "a-z, 0-9 and single _, a letter first, at most 64 characters, no C++ keyword";
  std::string name = material.text("name", kAllowed);
  if (!is_identifier(name)) material.fail("name", fmt::format("'{}' is not a usable identifier", name), kAllowed);
  return name;
}

std::string read_description(const Object& material) {
  if (!material.has("description")) return {};
  constexpr auto kAllowed = "one line of at most 200 printable characters";
  std::string text = material.text("description", kAllowed);
  const bool printable =
      std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '"' || c == '\\'; });
  if (!printable || text.size() > kMaxDescriptionLength)
    material.fail("description", "is too long or has a quote, a backslash or a control character", kAllowed);
  return text;
}

Impact read_impact(const Object& impact) {
  const Impact read{impact.number("mass_kg", kMass), impact.number("max_speed_m_per_s", kSpeed),
                    impact.number("min_speed_m_per_s", kSpeed)};
  if (read.min_speed_m_per_s > read.max_speed_m_per_s)
    impact.fail("impact.min_speed_m_per_s", fmt::format("{} is above max_speed_m_per_s", read.min_speed_m_per_s),
                fmt::format("at most {}", read.max_speed_m_per_s));
  return read;
}

// PowerLaw::max_compression in 113 bits: what follows from it is emitted, and pow() differs between machines.
double max_compression_of(const PowerLaw& contact, const Impact& impact) {
  const Quad energy = Quad(impact.mass_kg) * impact.max_speed_m_per_s * impact.max_speed_m_per_s / 2;
  const Quad power = Quad(contact.exponent) + 1;
  return Quad(pow(Quad(power * energy / contact.stiffness), 1 / power)).convert_to<double>();
}

double read_max_compression(const Object& spline, const PowerLaw& contact, const std::optional<Impact>& impact) {
  if (spline.has("max_compression_m")) return spline.number("max_compression_m", kCompression);
  if (!impact) spline.fail("spline.max_compression_m", "missing", "a number, or an impact that gives it by energy");
  const double compression = max_compression_of(contact, *impact);
  if (!(compression >= kCompression.least && compression <= kCompression.most))
    spline.fail("spline.max_compression_m",
                fmt::format("follows from impact as {} m, which is out of range", compression),
                fmt::format("a number from {} to {}", kCompression.least, kCompression.most));
  return compression;
}

SplineDesign read_spline(const Object& spline, const PowerLaw& contact, const std::optional<Impact>& impact) {
  const std::string knots = spline.text("knots", "uniform");
  if (knots != "uniform") spline.fail("spline.knots", fmt::format("'{}' is unknown", knots), "uniform");
  return {spline.integer("segments", 1, kMaxSegments), read_max_compression(spline, contact, impact)};
}

}  // namespace

Material parse_material(std::string_view text, std::string_view file) {
  const Json json = parse_json(text, file);
  const Object material(json, file, "", {"name", "description", "contact", "impact", "spline"});
  const Object contact = material.object("contact", {"stiffness_n_per_m_alpha", "exponent"});
  Material read{read_name(material),
                read_description(material),
                {contact.number("stiffness_n_per_m_alpha", kStiffness), contact.number("exponent", kExponent)},
                {},
                {}};
  if (material.has("impact"))
    read.impact = read_impact(material.object("impact", {"mass_kg", "max_speed_m_per_s", "min_speed_m_per_s"}));
  read.spline =
      read_spline(material.object("spline", {"knots", "segments", "max_compression_m"}), read.contact, read.impact);
  return read;
}

}  // namespace contactspline
