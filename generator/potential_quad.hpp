// SPDX-License-Identifier: MIT
// Contact potentials in 113 bits: what is emitted follows from these.
#pragma once

#include "generator/potential.hpp"
#include "generator/quad.hpp"

namespace contactspline {

/// V(y) [J] at a compression [m].
[[nodiscard]] Quad exact_energy(const Potential& potential, const Quad& compression_m);

/// Compression [m] at which an energy (> 0) [J] is stored.
[[nodiscard]] Quad exact_max_compression(const Potential& potential, const Quad& energy_j);

}  // namespace contactspline
