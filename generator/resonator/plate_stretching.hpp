// SPDX-License-Identifier: MIT
// How a simply supported rectangular plate stretches where it moves far.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "generator/resonator/plate.hpp"
#include "generator/resonator/ribbed_plate.hpp"

namespace contactspline {

/// How the edges of a plate are held in its plane: not at all, or at their distance from each other, each free to
/// slide along itself.
enum class PlateEdges { kFree, kFixed };

/// How a plate of one material without ribs stretches by von Karman's equations, one form for each of the `count`
/// lowest Airy functions P_k:
///
///     E h/8 sum over k of (integral of P_k L(w, w))^2/(integral of (laplacian P_k)^2)
///
/// with L as in round_plate.hpp. Free edges: P_k are the shapes of a clamped plate, as sums of polynomials (M.
/// Ducceschi, C. Touze, S. Bilbao and C. J. Webb, Acta Mechanica 225, 2014), found by Ritz's method. Fixed edges: P_k
/// are products of cosines, after two even tensions, exact (H. N. Chu and G. Herrmann, J. Applied Mechanics 23, 1956,
/// for one mode). Of functions with equal zeta, as a square plate has in pairs, all are kept or none, so that a
/// square plate stretches alike along both sides.
[[nodiscard]] std::vector<StretchForm> stretch_forms(const Plate& plate, PlateEdges edges,
                                                     std::span<const PlateSine> modes, std::size_t count);

/// How many forms that makes of the lowest `modes` modes.
[[nodiscard]] std::size_t form_count(const Plate& plate, PlateEdges edges, std::size_t modes, std::size_t count);

/// The least share of the energy by which one of the lowest `modes` modes alone stretches that the `count` lowest
/// Airy functions hold: of all there is with fixed edges, of what 1,000 or more hold with free ones; 0 to 1.
[[nodiscard]] double kept_of_stretching(const Plate& plate, PlateEdges edges, std::size_t modes, std::size_t count);

}  // namespace contactspline
