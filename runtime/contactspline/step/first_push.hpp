// SPDX-License-Identifier: MIT
// When an input begins to push.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>

#include "contactspline/step/controls.hpp"

namespace contactspline {

/// A weaker force wakes nothing that sleeps [N]: the input of a converter has noise far above it.
inline constexpr double kFaintPush_n = 1e-9;

/// The first sample of an input [N] that pushes by more; the length of the input where none does.
template <std::floating_point T>
[[nodiscard]] std::size_t first_push(std::span<const T> input) {
  const auto pushes = [](T force_n) {
    return is_number(force_n) && std::abs(force_n) > static_cast<T>(kFaintPush_n);
  };
  return static_cast<std::size_t>(std::ranges::find_if(input, pushes) - input.begin());
}

}  // namespace contactspline
