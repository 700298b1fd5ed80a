// SPDX-License-Identifier: MIT
// Figures that a test measures, kept with its result instead of on standard output.
#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace contactspline::testing {

/// Measured() << "worst error " << worst; keeps this line as a property of the test: measured_1, measured_2 and so
/// on.
/// `--gtest_output=xml:FILE` writes it.
class Measured {
 public:
  Measured() = default;
  Measured(const Measured&) = delete;
  Measured& operator=(const Measured&) = delete;
  ~Measured() { ::testing::Test::RecordProperty("measured_" + std::to_string(number()), line_.str()); }

  template <typename Value>
  Measured& operator<<(const Value& value) {
    line_ << value;
    return *this;
  }

 private:
  // Properties of one name would replace each other.
  static int number() {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    return info == nullptr ? 1 : info->result()->test_property_count() + 1;
  }

  std::ostringstream line_;
};

}  // namespace contactspline::testing
