// SPDX-License-Identifier: MIT
// Bad input, answered with one line.
#pragma once

#include <stdexcept>

namespace contactspline {

/// Input that cannot be used. what() is one line: file, key, what is wrong, what is allowed.
struct BadInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace contactspline
