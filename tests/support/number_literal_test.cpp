// SPDX-License-Identifier: MIT
// Number literals: bit-exact, in the grammar that C++, Faust and JSON share.
#include "generator/support/number_literal.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

using Limits = std::numeric_limits<double>;

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value);
}

double read_back(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  EXPECT_EQ(*end, '\0') << text;
  return value;
}

// JSON's number grammar, narrowed: lower-case e only, and a point or an exponent always.
bool is_shared_literal(const std::string& text) {
  return whole_match(text, R"(-?(0|[1-9][0-9]*)(\.[0-9]+(e[+-]?[0-9]+)?|e[+-]?[0-9]+))").has_value();
}

std::vector<double> edge_values() {
  std::vector<double> values = {0.0,
                                -0.0,
                                1.0,
                                -1.0,
                                10.0,
                                123456789.0,
                                1e15,
                                1e16,
                                1e17,
                                1e22,
                                1e23,
                                1e-4,
                                1e-5,
                                0.1,
                                1.0 / 3,
                                4503599627370497.5,
                                9007199254740993.0,
                                Limits::min(),
                                Limits::max(),
                                Limits::lowest(),
                                Limits::denorm_min(),
                                Limits::epsilon(),
                                std::nextafter(1.0, 2.0),
                                std::nextafter(1.0, 0.0)};
  for (int exponent = -1074; exponent <= 1023; ++exponent) values.push_back(std::ldexp(1.0, exponent));
  for (int exponent = -300; exponent <= 300; ++exponent)
    values.push_back(std::strtod(("1e" + std::to_string(exponent)).c_str(), nullptr));
  return values;
}

// Uniform over bit patterns: every exponent and subnormals alike.
std::vector<double> random_bit_patterns(int count) {
  std::mt19937_64 random(5);
  std::vector<double> values;
  while (values.size() < static_cast<std::size_t>(count))
    if (const double value = std::bit_cast<double>(random()); std::isfinite(value)) values.push_back(value);
  return values;
}

void expect_exact_and_shared(double value) {
  const std::string text = literal(value);
  ASSERT_EQ(bits(read_back(text)), bits(value)) << text;
  ASSERT_TRUE(is_shared_literal(text)) << text;
}

TEST(Literal, ReadsBackToTheSameBits) {
  for (const double value : random_bit_patterns(100000)) expect_exact_and_shared(value);
}

TEST(Literal, ReadsBackToTheSameBitsAtTheEdges) {
  for (const double value : edge_values()) expect_exact_and_shared(value);
}

TEST(Literal, KeepsTheSignOfZero) {
  EXPECT_EQ(literal(0.0), "0.0");
  EXPECT_EQ(literal(-0.0), "-0.0");
}

// waveform{1,2} is an integer table in Faust, and 1 an int in C++.
TEST(Literal, OfAWholeNumberHasAPoint) {
  EXPECT_EQ(literal(1), "1.0");
  EXPECT_EQ(literal(-48000), "-48000.0");
}

int digits(const std::string& text) {
  const std::string mantissa = text.substr(0, text.find('e'));
  std::string found;
  for (const char c : mantissa)
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) found += c;
  const auto first = found.find_first_not_of('0');
  const auto last = found.find_last_not_of('0');
  return first == std::string::npos ? 1 : static_cast<int>(last - first) + 1;
}

// The standard library's own shortest form is a second implementation.
TEST(Literal, HasNoMoreDigitsThanNeeded) {
  for (const double value : random_bit_patterns(20000)) {
    std::array<char, 64> shortest{};
    const auto end =
        std::to_chars(shortest.data(), shortest.data() + shortest.size(), value, std::chars_format::scientific).ptr;
    ASSERT_EQ(digits(literal(value)), digits(std::string(shortest.data(), end))) << literal(value);
  }
}

TEST(Literal, OfNanAndInfinityThrows) {
  for (const double value : {Limits::quiet_NaN(), -Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()})
    EXPECT_THROW(static_cast<void>(literal(value)), std::domain_error);
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> split;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) split.push_back(line);
  return split;
}

std::vector<double> numbers(const std::string& rows) {
  std::vector<double> values;
  std::istringstream stream(rows);
  for (std::string item; std::getline(stream, item, ',');) values.push_back(read_back(item));
  return values;
}

TEST(LiteralRows, HoldEveryValueInOrderSeparatedByCommas) {
  const std::vector<double> values = random_bit_patterns(1000);
  const std::vector<double> read = numbers(literal_rows(values, 4));
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(bits(read[i]), bits(values[i]));
}

// Literals of 3 to 24 characters, so that lines end at every column.
std::vector<double> values_of_every_length(int count) {
  std::mt19937_64 random(6);
  std::vector<double> values;
  for (const double value : random_bit_patterns(count)) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*e", static_cast<int>(random() % 17), value);
    values.push_back(std::strtod(text.data(), nullptr));
  }
  return values;
}

// No line is longer than 110 columns, and none so short that the next value would have fitted.
TEST(LiteralRows, WrapAtOneHundredAndTenColumns) {
  const std::vector<double> values = values_of_every_length(5000);
  for (const int indent : {0, 2, 4, 6}) {
    const auto rows = lines(literal_rows(values, indent));
    ASSERT_GT(rows.size(), 100U);
    const std::string margin(static_cast<std::size_t>(indent), ' ');
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_LE(rows[i].size(), 110U) << rows[i];
      EXPECT_TRUE(rows[i].starts_with(margin)) << rows[i];
      EXPECT_NE(rows[i].at(margin.size()), ' ') << rows[i];
      EXPECT_NE(rows[i].back(), ' ') << rows[i];
      if (i + 1 == rows.size()) continue;
      EXPECT_EQ(rows[i].back(), ',');
      const std::string next = rows[i + 1].substr(margin.size(), rows[i + 1].find(',') + 1 - margin.size());
      EXPECT_GT(rows[i].size() + 1 + next.size(), 110U) << rows[i] << " leaves room for " << next;
    }
  }
}

TEST(LiteralRows, OfOneValueAreOneLiteral) {
  EXPECT_EQ(literal_rows(std::vector{2.5}, 3), "   2.5");
}

TEST(LiteralRows, WithANanThrow) {
  EXPECT_THROW(static_cast<void>(literal_rows(std::vector{1.0, Limits::quiet_NaN()}, 2)), std::domain_error);
}

}  // namespace
}  // namespace contactspline::testing
