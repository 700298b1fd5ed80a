// SPDX-License-Identifier: MIT
// Tables of the errors that a JSON file can have.
#pragma once

#include <fmt/format.h>

#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {

struct BadFile {
  std::string test;
  std::string text;  ///< text of the file
  std::string key;   ///< the message begins with "file: key: "
  std::string says;
};

inline void PrintTo(const BadFile& bad, std::ostream* stream) {
  *stream << bad.test;
}

/// `good` with its one `from` replaced.
inline std::string changed(const std::string& good, const std::string& from, const std::string& to) {
  std::string text = good;
  const auto at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos)
    throw std::logic_error(from + " does not occur just once");
  return text.replace(at, from.size(), to);
}

/// The bad file, as probe.json, is refused by `generate` in one line, and nothing is written.
inline void expect_refused_by_generate(const BadFile& bad) {
  const Sandbox box;
  write_file(box / "probe.json", bad.text);
  const auto before = box.listing();
  expect_refused(run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()}),
                 "probe.json: " + bad.key, bad.says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

/// A number of a good file, which reads "member": value.
struct NumberKey {
  std::string path;  ///< path of the object it is in, with its point; may be empty
  std::string member, value, allowed;
  std::vector<std::string> out_of_range;
  bool is_integer = false;

  [[nodiscard]] std::string text(const std::string& other) const { return fmt::format("\"{}\": {}", member, other); }
};

/// All the errors that a number can have. `name` begins the tests' names.
inline std::vector<BadFile> number_cases(const std::string& name, const std::string& good, const NumberKey& number) {
  std::vector<BadFile> cases;
  const std::string key = number.path + number.member;
  const auto add = [&](const std::string& kind, const std::string& value, const std::string& where,
                       const std::string& says) {
    cases.push_back({name + "_" + number.member + "_" + kind,
                     changed(good, number.text(number.value), number.text(value)), where, says});
  };
  const std::string wrong = number.is_integer ? "is not an integer; allowed: " : "is not a number; allowed: ";
  std::vector<std::pair<std::string, std::string>> types = {{"null", "null"},
                                                            {"text", '"' + number.value + '"'},
                                                            {"bool", "true"},
                                                            {"array", "[" + number.value + "]"},
                                                            {"object", "{}"}};
  if (number.is_integer) types.insert(types.end(), {{"float", "8.0"}, {"huge", "1e30"}});
  for (const auto& [kind, value] : types) add("is_" + kind, value, key, wrong + number.allowed);
  for (std::size_t i = 0; i < number.out_of_range.size(); ++i)
    add("is_out_of_range_" + std::to_string(i), number.out_of_range[i], key,
        "is out of range; allowed: " + number.allowed);
  add("overflows", "1e999", key.substr(0, key.find('[')), "1e999 is too large; allowed: a finite number");
  add("overflows_below", "-1e999", key.substr(0, key.find('[')), "-1e999 is too large; allowed: a finite number");
  add("is_nan", "NaN", "line ", "'NaN' is not expected; allowed: a value: a number");
  add("is_infinite", "Infinity", "line ", "'Infinity' is not expected; allowed: a value: a number");
  add("is_hexadecimal", "0x10", "line ", "'0x10' is not expected; allowed: a comma or }");
  add("is_twice", number.value + ", " + number.text(number.value), key.substr(0, key.find('[')),
      "duplicate key; allowed: once");
  return cases;
}

}  // namespace contactspline::testing

/// A suite of bad files that `generate` refuses; CONTACTSPLINE_CASES lists them.
#define CONTACTSPLINE_REFUSED_BY_GENERATE(Suite)             \
  class Suite : public ::testing::TestWithParam<BadFile> {}; \
  TEST_P(Suite, IsRefusedInOneLineAndNothingIsWritten) {     \
    expect_refused_by_generate(GetParam());                  \
  }                                                          \
  static_assert(true)
