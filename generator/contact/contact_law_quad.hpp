// SPDX-License-Identifier: MIT
// Contact laws in 113 bits. All emitted splines are computed from this function.
#pragma once

#include "generator/contact/contact_law.hpp"
#include "generator/support/quad.hpp"

namespace contactspline {

/// V(y) [J] at a compression [m], in 113 bits.
[[nodiscard]] Quad exact_energy(const ContactLaw& law, const Quad& compression_m);

}  // namespace contactspline
