// SPDX-License-Identifier: MIT
#include "bad_input.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace contactspline::testing {
namespace {

Words parts_of(std::string_view text, std::string_view separator) {
  Words parts;
  for (;;) {
    const auto at = text.find(separator);
    parts.emplace_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + separator.size());
  }
}

std::string without_escapes(std::string_view text) {
  static const std::map<char, char> kCharacters = {{'n', '\n'}, {'t', '\t'}, {'r', '\r'}, {'\\', '\\'}};
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      plain += text[i];
    } else if (text.at(++i) == 'x') {
      plain += static_cast<char>(std::stoi(std::string(text.substr(i + 1, 2)), nullptr, 16));
      i += 2;
    } else {
      plain += kCharacters.at(text[i]);
    }
  }
  return plain;
}

// The lines of a section, each with its continuations.
Words lines_of(const std::string& file, const std::string& section) {
  Words lines;
  std::istringstream stream(read_file(fs::path(SOURCE_FOLDER) / "tests/cli/cases" / (file + ".txt")));
  bool inside = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#') || line.empty()) continue;
    if (line.starts_with('[')) inside = line == "[" + section + "]";
    if (!inside || line.starts_with('[')) continue;
    if (line.starts_with(' '))
      lines.at(lines.size() - 1) += line.substr(line.find_first_not_of(' ') - 1);
    else
      lines.push_back(line);
  }
  if (lines.empty()) throw std::logic_error(file + " has no cases " + section);
  return lines;
}

// The four fields of each case, with escapes; ".." is the field of the case above.
std::vector<Words> rows_of(const std::string& file, const std::string& section) {
  std::vector<Words> rows;
  for (const std::string& line : lines_of(file, section)) {
    Words fields = parts_of(line, " |");
    if (fields.size() != 4) throw std::logic_error(line + " does not have four fields");
    for (std::size_t i = 1; i < fields.size(); ++i) {
      if (fields[i].starts_with(' ')) fields[i].erase(0, 1);
      if (fields[i] == "..") fields[i] = rows.at(rows.size() - 1)[i];
    }
    rows.push_back(std::move(fields));
  }
  return rows;
}

std::string text_of(const std::string& change, const Bases& bases) {
  if (change.starts_with('=')) return without_escapes(change.substr(std::min<std::size_t>(change.size(), 2)));
  const bool is_named = change.starts_with('@');
  const std::size_t end = is_named ? std::min(change.find(' '), change.size()) : 0;
  std::string text = bases.at(is_named ? change.substr(1, end - 1) : "");
  if (end == change.size()) return text;
  for (const std::string& one : parts_of(std::string_view(change).substr(is_named ? end + 1 : 0), " && ")) {
    const auto at = one.find(" =>");
    if (at == std::string::npos) throw std::logic_error(one + " is no change");
    text =
        changed(text, without_escapes(one.substr(0, at)), without_escapes(one.substr(std::min(at + 4, one.size()))));
  }
  return text;
}

// Words between blanks; '' holds one that is empty or has blanks.
Words words_of(const std::string& line) {
  Words words;
  std::string word;
  bool is_word = false, is_quoted = false;
  for (const char c : line + ' ') {
    if (c == '\'') {
      is_quoted = !is_quoted;
      is_word = true;
    } else if (c == ' ' && !is_quoted) {
      if (is_word) words.push_back(without_escapes(std::exchange(word, "")));
      is_word = false;
    } else {
      word += c;
      is_word = true;
    }
  }
  return words;
}

// A number of a good file, which reads "member": value.
struct NumberKey {
  std::string base, path;  // path with the member
  std::string value, allowed;
  Words out_of_range;
};

NumberKey number_of(const Words& fields) {
  NumberKey number{"", fields[0], fields[1], fields[2], words_of(fields[3])};
  if (number.path.starts_with('@')) {
    const auto at = number.path.find(' ');
    number.base = number.path.substr(1, at - 1);
    number.path.erase(0, at + 1);
  }
  return number;
}

// All the errors that a number can have.
std::vector<BadFile> number_cases(const std::string& good, const NumberKey& number) {
  const auto text = [member = number.path.substr(number.path.rfind('.') + 1)](const std::string& value) {
    return fmt::format("\"{}\": {}", member, value);
  };
  std::string name = number.base.empty() ? number.path : number.base + "_" + number.path;
  std::ranges::replace_if(
      name, [](unsigned char c) { return !std::isalnum(c); }, '_');
  std::vector<BadFile> cases;
  const auto add = [&](const std::string& kind, const std::string& value, const std::string& where,
                       const std::string& says) {
    cases.push_back({name + "_" + kind, changed(good, text(number.value), text(value)), where, says});
  };
  const bool is_integer = number.allowed.starts_with("an integer");
  const std::string wrong =
      (is_integer ? "is not an integer; allowed: " : "is not a number; allowed: ") + number.allowed;
  std::vector<std::pair<std::string, std::string>> types = {{"null", "null"},
                                                            {"text", '"' + number.value + '"'},
                                                            {"bool", "true"},
                                                            {"array", "[" + number.value + "]"},
                                                            {"object", "{}"}};
  if (is_integer) types.insert(types.end(), {{"float", "8.0"}, {"huge", "1e30"}});
  for (const auto& [kind, value] : types) add("is_" + kind, value, number.path, wrong);
  for (std::size_t i = 0; i < number.out_of_range.size(); ++i)
    add("is_out_of_range_" + std::to_string(i), number.out_of_range[i], number.path,
        "is out of range; allowed: " + number.allowed);
  const std::string array = number.path.substr(0, number.path.find('['));
  add("overflows", "1e999", array, "1e999 is too large; allowed: a finite number");
  add("overflows_below", "-1e999", array, "-1e999 is too large; allowed: a finite number");
  add("is_nan", "NaN", "line ", "'NaN' is not expected; allowed: a value: a number");
  add("is_infinite", "Infinity", "line ", "'Infinity' is not expected; allowed: a value: a number");
  add("is_hexadecimal", "0x10", "line ", "'0x10' is not expected; allowed: a comma or }");
  add("is_twice", number.value + ", " + text(number.value), array, "duplicate key; allowed: once");
  return cases;
}

}  // namespace

void PrintTo(const BadFile& bad, std::ostream* stream) {
  *stream << bad.test;
}
void PrintTo(const BadLine& bad, std::ostream* stream) {
  *stream << bad.test;
}

std::vector<BadFile> bad_files(const std::string& file, const std::string& section, const Bases& bases) {
  std::vector<BadFile> cases;
  for (const Words& fields : rows_of(file, section))
    cases.push_back({fields[0], text_of(fields[1], bases), without_escapes(fields[2]), without_escapes(fields[3])});
  return cases;
}

std::vector<BadFile> bad_numbers(const std::string& file, const std::string& section, const Bases& bases) {
  std::vector<BadFile> cases;
  for (const Words& fields : rows_of(file, section)) {
    const NumberKey number = number_of(fields);
    cases = followed_by(std::move(cases), number_cases(bases.at(number.base), number));
  }
  return cases;
}

std::vector<BadLine> bad_lines(const std::string& file, const std::string& section) {
  std::vector<BadLine> cases;
  for (const Words& fields : rows_of(file, section))
    cases.push_back({fields[0], words_of(fields[1]), without_escapes(fields[2]), without_escapes(fields[3])});
  return cases;
}

std::string changed(const std::string& good, const std::string& from, const std::string& to) {
  std::string text = good;
  const auto at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos)
    throw std::logic_error(from + " does not occur just once");
  return text.replace(at, from.size(), to);
}

std::vector<BadFile> followed_by(std::vector<BadFile> cases, const std::vector<BadFile>& more) {
  cases.insert(cases.end(), more.begin(), more.end());
  return cases;
}

void expect_refused_by_generate(const BadFile& bad) {
  const Sandbox box;
  write_file(box / "probe.json", bad.text);
  const auto before = box.listing();
  expect_refused(run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()}),
                 "probe.json: " + bad.key, bad.says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

}  // namespace contactspline::testing
