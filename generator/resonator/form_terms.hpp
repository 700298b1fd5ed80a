// SPDX-License-Identifier: MIT
// What the forms of all plates that stretch have in common.
#pragma once

#include <cstddef>
#include <span>

#include "contactspline/data/stretch_form.hpp"

namespace contactspline {

/// Rounds the terms of a form to so many digits of the largest: what should cancel is 0, and no product. Machines
/// whose rounding differs may find a last digit that differs by one.
void round_terms(StretchForm& form, int digits);

/// The least share that the first `count` forms hold of the energy by which one mode alone stretches; 0 to 1.
[[nodiscard]] double least_share(std::span<const StretchForm> forms, std::size_t count);

}  // namespace contactspline
