// SPDX-License-Identifier: MIT
// Errors in the input, reported in one line.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace contactspline {

/// Input that cannot be used. what() is one line: "file: key: what is wrong; allowed: ...".
struct BadInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws BadInput with the four parts of its line.
[[noreturn]] inline void refuse(std::string_view file, std::string_view key, std::string_view wrong,
                                std::string_view allowed) {
  std::string line(file);
  throw BadInput(line.append(": ").append(key).append(": ").append(wrong).append("; allowed: ").append(allowed));
}

}  // namespace contactspline
