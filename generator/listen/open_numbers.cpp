// SPDX-License-Identifier: MIT
#include "generator/listen/open_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr auto kFit = "fit";
const std::vector<std::string> kOpenKeys{kFit, "start"};

/// Walks through a text of JSON whose syntax is right, and knows the path of each object.
class OpenNumberFinder {
 public:
  OpenNumberFinder(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  std::vector<OpenNumber> find() {
    for (skip_blanks(); at_ < text_.size(); skip_blanks()) take();
    return std::move(found_);
  }

 private:
  struct Level {
    std::string key;
    int index = -1;  ///< of the next entry; -1: an object
  };

  void take() {
    const char c = text_[at_];
    if (c == '"') return take_string();
    ++at_;
    if (c == '{' && is_open()) return take_open(at_ - 1);
    if (c == '{' || c == '[') levels_.push_back({"", c == '[' ? 0 : -1});
    if (c == '}' || c == ']') levels_.pop_back();
    if (c == ',' && !levels_.empty() && levels_.back().index >= 0) ++levels_.back().index;
  }

  // A key or a value: of an object the last one before its colon counts.
  void take_string() {
    std::string content(skip_string());
    skip_blanks();
    if (at_ < text_.size() && text_[at_] == ':') levels_.back().key = std::move(content);
  }

  // Returns what stands between the quotes.
  std::string_view skip_string() {
    const std::size_t begin = ++at_;
    while (text_[at_] != '"') at_ += text_[at_] == '\\' ? 2 : 1;
    return text_.substr(begin, at_++ - begin);
  }

  // Behind a brace: does the object there have the key `fit` of its own?
  bool is_open() {
    if (levels_.empty()) return false;
    const std::size_t behind = at_;
    const bool is = skip_object();
    at_ = behind;
    return is;
  }

  // From behind a brace to behind the one that closes it. Returns whether it has the key `fit`.
  bool skip_object() {
    bool has_fit = false;
    for (int depth = 1; depth > 0;) {
      skip_blanks();
      const char c = text_[at_];
      if (c == '"') {
        const std::string_view content = skip_string();
        skip_blanks();
        has_fit |= depth == 1 && content == kFit && text_[at_] == ':';
        continue;
      }
      depth += (c == '{' || c == '[' ? 1 : 0) - (c == '}' || c == ']' ? 1 : 0);
      ++at_;
    }
    return has_fit;
  }

  void take_open(std::size_t begin) {
    (void)skip_object();
    const std::string key = path();
    const JsonObject open =
        parse_json(text_.substr(begin, at_ - begin), fmt::format("{}: {}", file_, key), "number", kOpenKeys);
    found_.push_back(read_open_number(open, key));
    found_.back().begin = begin;
    found_.back().end = at_;
  }

  void skip_blanks() {
    while (at_ < text_.size()) {
      if (text_.substr(at_).starts_with("//"))
        at_ = std::min(text_.find('\n', at_), text_.size());
      else if (text_.substr(at_).starts_with("/*"))
        at_ = text_.find("*/", at_) + 2;
      else if (std::string_view(" \t\r\n").find(text_[at_]) == std::string_view::npos)
        return;
      else
        ++at_;
    }
  }

  [[nodiscard]] std::string path() const {
    std::string path;
    for (const auto& [key, index] : levels_)
      path += index >= 0 ? fmt::format("[{}]", index) : (path.empty() ? "" : ".") + shown(key);
    return path;
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  std::vector<Level> levels_;
  std::vector<OpenNumber> found_;
};

}  // namespace

double OpenNumber::at(double part) const {
  if (bounds.min > 0)
    return std::clamp(std::exp(std::lerp(std::log(bounds.min), std::log(bounds.max), part)), bounds.min, bounds.max);
  return bounds.min + (bounds.max - bounds.min) * part;
}

double OpenNumber::part_of(double number) const {
  if (bounds.min > 0)
    return (std::log(number) - std::log(bounds.min)) / (std::log(bounds.max) - std::log(bounds.min));
  return (number - bounds.min) / (bounds.max - bounds.min);
}

OpenNumber read_open_number(const JsonObject& open, const std::string& key) {
  constexpr Range kAny{-1e100, 1e100};
  constexpr std::size_t kManyBounds = 64;
  constexpr auto kAllowed = "two rising numbers, such as [1, 2]";
  if (const std::string json = open.json("fit"); !json.starts_with('[') || json == "[]")
    open.fail(open.key("fit"), "is not two numbers", kAllowed);
  const std::vector<double> bounds = open.numbers("fit", kAny, kManyBounds);
  if (bounds.size() != 2)
    open.fail(open.key("fit"), fmt::format("has {} entr{}", bounds.size(), bounds.size() == 1 ? "y" : "ies"),
              kAllowed);
  if (!(bounds[0] < bounds[1]))
    open.fail(open.key("fit"), fmt::format("{} and {} do not rise", bounds[0], bounds[1]), kAllowed);
  OpenNumber number{key, {bounds[0], bounds[1]}, 0};
  number.start = open.has("start") ? open.number("start", number.bounds) : number.at(0.5);
  return number;
}

std::vector<OpenNumber> open_numbers(std::string_view text, const std::string& file) {
  (void)json_keys(text, file, "instrument");
  return OpenNumberFinder(text, file).find();
}

std::string filled(std::string_view text, std::span<const OpenNumber> open, std::span<const double> numbers) {
  std::string result;
  std::size_t behind = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    result += text.substr(behind, open[i].begin - behind);
    result += fmt::format("{}", numbers[i]);
    behind = open[i].end;
  }
  return result.append(text.substr(behind));
}

}  // namespace contactspline
