// SPDX-License-Identifier: MIT
// From a material to its spline: knots of the family asked for, as many as it takes.
#pragma once

#include <functional>
#include <string_view>

#include "generator/knots.hpp"
#include "generator/material.hpp"
#include "generator/spline.hpp"

namespace contactspline {

/// What knots are fitted to: contact law and impacts of a material in pure numbers, its max_compression_m being 1.
/// Impacts whose speeds are closer than 2:1 are taken as half the fastest to the fastest. The material must have an
/// impact.
[[nodiscard]] FitTarget fit_target(const Material& material);

/// A law's force in parts of its largest one, beyond 1 the power law that goes on from there: guesses look a little
/// beyond, where layers that no impact reaches may begin.
[[nodiscard]] std::function<double(double)> continued(std::function<double(double)> force);

/// The spline a material asks for. Where that is by tolerance its `segments` are set to the least number that keeps
/// it, found by bisection and a look at some numbers below. Throws BadInput, naming `file`, where none does, where
/// the spline is not convex or leaves the range of double.
[[nodiscard]] Spline design_spline(Material& material, std::string_view file);

}  // namespace contactspline
