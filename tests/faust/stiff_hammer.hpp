// SPDX-License-Identifier: MIT
// A stroke on C4 with a felt of any stiffness: by HammerString, and by fd.hammer of the Faust libraries.
#pragma once

#include <vector>

#include "cpp_program.hpp"
#include "runtime/energy.hpp"
#include "runtime/strings.hpp"

#define FAUSTFLOAT double
#include "fd_hammer.hpp"

namespace contactspline::testing {

constexpr int kStrokeRate = 44100;
constexpr double kStrokeSpeed = 2.5;  // m/s

/// How far a hammer of that speed can bend the string where it strikes, if all its energy E bends it and nothing else
/// [m]: u^2 / (2 C) = E with the compliance C = x (L - x)/(T L) of the string at rest, less than which any stiffness
/// leaves.
inline double largest_bend() {
  const auto& s = c4().string;
  const double x = c4().strike_m;
  const double energy = c4().hammer_kg * kStrokeSpeed * kStrokeSpeed / 2;
  return std::sqrt(2 * energy * x * (s.length_m - x) / (s.tension_n * s.length_m));
}

/// Displacement of the string where it is struck [m], by fd.hammer on 63 points.
inline std::vector<double> struck_by_fd(double stiffness_ratio, std::size_t samples) {
  CppProgram<fd_hammer, double> program(kStrokeRate);
  program.set("stiffness ratio", stiffness_ratio);
  program.set("strike", 1);
  return program.run({}, samples).front();
}

struct StruckByUs {
  std::vector<double> displacement;  ///< displacement of the string where it is struck [m]
  EnergyBooks books;
};

inline StruckByUs struck_by_us(double stiffness_ratio, std::size_t samples) {
  const auto modes = audible_modes(c4());
  const auto felt = felt_table(c4(), 64);
  const auto strike = shapes<double>(modes, &ResonatorMode::strike_shape);
  const HammerStringControls<double> controls{.hammer_mass_kg = c4().hammer_kg,
                                              .felt = {.stiffness_ratio = stiffness_ratio}};
  HammerBooks<double> hammer({felt, bare(modes), strike, kStrokeRate}, felt, kStrokeRate);
  hammer.strike(kStrokeSpeed, 1e-4, controls);
  StruckByUs struck;
  for (std::size_t n = 0; n < samples; ++n) {
    hammer.tick(controls);
    struck.displacement.push_back(hammer.model().string().displacement(strike));
  }
  struck.books = hammer.books();
  return struck;
}

}  // namespace contactspline::testing
