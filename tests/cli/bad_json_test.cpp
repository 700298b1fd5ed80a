// SPDX-License-Identifier: MIT
// All the ways in which a file is no JSON object: one line that names the place and what is allowed.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bad_input.hpp"
#include "bad_material.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

std::vector<BadFile> long_cases() {
  const std::string good = kGood;
  const std::string object = "is not an object; allowed: name, description, contact, impact, spline, compensation";
  std::string nested;
  for (int i = 0; i < 100'000; ++i) nested += R"({"a":)";
  return {
      {"array", "[" + good + "]", "material", object},
      {"truncated", good.substr(0, good.size() / 2), "line ", "the file ends; allowed: "},
      {"last_brace_gone", good.substr(0, good.size() - 1), "line ", "the file ends; allowed: "},
      {"two_materials", good + good, "line ", "; allowed: "},
      {"nested_arrays", std::string(400'000, '['), "file",
       "is not a JSON object; allowed: a file that begins with {"},
      {"nested_and_closed", std::string(400'000, '[') + std::string(400'000, ']'), "material", object},
      {"nested_objects", nested, "line ", "the file ends; allowed: "},
      {"large", good + std::string(1 << 20, ' '), "file", "is larger than 1 MiB; allowed: a file of at most 1 MiB"}};
}

class BadJson : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadJson, IsRefusedInOneLineAndNothingIsWritten) {
  expect_refused_without_a_trace(GetParam());
}

CONTACTSPLINE_CASES(Syntax, BadJson, bad_files("json", "Syntax", {{"", kGood}}));
CONTACTSPLINE_CASES(Long, BadJson, long_cases());

}  // namespace
}  // namespace contactspline::testing
