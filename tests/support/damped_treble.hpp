// SPDX-License-Identifier: MIT
// Keys of a piano without dampers ring in sympathy with every note. Tests of what dampers do damp them, too.
#pragma once

#include <fmt/format.h>

#include <string>

namespace contactspline::testing {

inline constexpr double kTrebleDamping_per_s = 60;  ///< as much as a damper of the piano that ships

/// Events of a score that damp these keys from the beginning, each with a comma before it.
[[nodiscard]] inline std::string damped_treble(int first_key, int last_key) {
  std::string events;
  for (int key = first_key; key <= last_key; ++key)
    events += fmt::format(R"(, {{ "time_s": 0, "key": {}, "damping_per_s": {} }})", key, kTrebleDamping_per_s);
  return events;
}

}  // namespace contactspline::testing
