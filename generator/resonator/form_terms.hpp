// SPDX-License-Identifier: MIT
// What the forms of all plates that stretch have in common.
#pragma once

#include <cstddef>
#include <span>

#include "contactspline/data/stretch_form.hpp"

namespace contactspline {

/// Rounds the terms of a form to eleven digits of the largest, which all machines find: small ones are what cancels.
void round_terms(StretchForm& form);

/// The least share that the first `count` forms hold of the energy by which one mode alone stretches; 0 to 1.
[[nodiscard]] double least_share(std::span<const StretchForm> forms, std::size_t count);

}  // namespace contactspline
