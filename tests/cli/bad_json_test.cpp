// SPDX-License-Identifier: MIT
// All the ways in which a file is no JSON object: one line that names the place and what is allowed.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bad_input.hpp"
#include "bad_material.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

std::vector<BadFile> syntax_cases() {
  const std::string good = kGood;
  const std::string allowed = "; allowed: ";
  const std::string object = "is not an object; allowed: name, description, contact, impact, spline, compensation";
  std::string nested;
  for (int i = 0; i < 100'000; ++i) nested += R"({"a":)";
  return {
      {"line_and_column", "{\n  // a comment\n  \"name\" \"probe\" }", "line 3, column 10: '\"' is not expected",
       "allowed: a colon between key and value"},
      {"comma_before_the_end", "{ \"name\": \"probe\",\n}", "line 2, column 1: '}' is not expected",
       "allowed: a key in double quotes"},
      {"comma_missing", "{ \"name\": \"probe\"\n  \"contact\": {} }", "line 2, column 3: '\"' is not expected",
       "allowed: a comma or }"},
      {"number_missing", "{ \"name\": }", "line 1, column 11: '}' is not expected", "allowed: a value: a number"},
      {"word_for_a_value", "{ \"name\": probe_1 }", "line 1, column 11: 'probe_1' is not expected",
       "allowed: a value: a number"},
      {"digit_missing", "{ \"a\": 1. }", "line 1, column 10: ' ' is not expected", "allowed: a digit"},
      {"array_not_closed", "{ \"a\": [1 2] }", "line 1, column 11: '2' is not expected", "allowed: a comma or ]"},
      {"bad_escape", R"({ "a": "\q" })", "line 1, column 10: 'q' is not expected", "allowed: one of"},
      {"quote_missing", "{ \"a\": \"b }\n", "line 1, column 12: the line ends", "allowed: no line end"},
      {"quote_missing_at_end", "{ \"a\": \"b", "line 1, column 10: the file ends", "allowed: the double quote"},
      {"comment_not_closed", "{ /* a", "line 1, column 7: the file ends", "allowed: */, the end of the comment"},
      {"nul_after_the_end", good + std::string("\0 anything", 10), "line 7, column ", "a NUL byte"},
      {"empty", "", "line ", "the file ends; allowed: "},
      {"blank", " \n\t\n", "line ", "the file ends; allowed: "},
      {"comment_only", "// nothing\n", "line ", "the file ends; allowed: "},
      {"comment_open", good + "/* for ever", "line ", allowed},
      {"array", "[" + good + "]", "material", object},
      {"number", "1", "material", object},
      {"text", "\"material\"", "material", object},
      {"null", "null", "material", object},
      {"lone_overflow", "1e999", "material", "is too large"},
      {"truncated", good.substr(0, good.size() / 2), "line ", "the file ends; allowed: "},
      {"last_brace_gone", good.substr(0, good.size() - 1), "line ", "the file ends; allowed: "},
      {"trailing_garbage", good + "x", "line ", allowed},
      {"two_materials", good + good, "line ", allowed},
      {"trailing_comma", changed(R"("exponent": 2.5)", R"("exponent": 2.5,)"), "line ", allowed},
      {"single_quotes", changed(R"("name")", "'name'"), "line ", allowed},
      {"bare_key", changed(R"("name")", "name"), "line ", allowed},
      {"invalid_utf8", changed("a probe", "a \xff\xfe probe"), "line ", "characters in UTF-8"},
      {"overlong_utf8", changed("a probe", "a \xc0\xaf probe"), "line ", "characters in UTF-8"},
      {"lone_surrogate", changed("a probe", "a \\ud800 probe"), "line ", "a pair of surrogates"},
      {"utf16", std::string("\xff\xfe{\0}\0", 6), "line ", allowed},
      {"half_a_byte_order_mark", "\xef\xbb" + good, "line ", "characters in UTF-8"},
      {"null_byte", changed("a probe", std::string("a \0 probe", 9)), "line ", allowed},
      {"line_end_in_text", changed("a probe", "a\nprobe"), "line ", allowed},
      {"nested_arrays", std::string(400'000, '['), "file",
       "is not a JSON object; allowed: a file that begins with {"},
      {"nested_and_closed", std::string(400'000, '[') + std::string(400'000, ']'), "material", object},
      {"nested_objects", nested, "line ", "the file ends; allowed: "},
      {"binary",
       std::string("\x7f"
                   "ELF\x02\x01\x01\0\0",
                   9),
       "line ", allowed},
      {"large", good + std::string(1 << 20, ' '), "file", "is larger than 1 MiB; allowed: a file of at most 1 MiB"}};
}

class BadJson : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadJson, IsRefusedInOneLineAndNothingIsWritten) {
  expect_refused_without_a_trace(GetParam());
}

CONTACTSPLINE_CASES(Syntax, BadJson, syntax_cases());

}  // namespace
}  // namespace contactspline::testing
