// SPDX-License-Identifier: MIT
// The materials whose Faust programs are linked into this test, with the tables emitted for C++.
#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "contactspline/step/contact.hpp"
#include "faust_program.hpp"

namespace contactspline::testing {

/// One material in one precision: the table emitted for C++ and the programs on the library emitted for Faust.
template <std::floating_point T>
struct Programs {
  using Maker = std::unique_ptr<FaustProgram<T>> (*)(int sample_rate_hz);
  SegmentTable<T> table;
  Maker mass_barrier;
  Maker probe;
};

struct MaterialUnderTest {
  std::string name;
  double max_compression_m;
  const char* length_scale_name;  ///< in Faust
  double length_scale_m;          ///< length scale of `normalised`
  double energy_scale_j;
  double loss_s_per_m;  ///< the material's own
  Programs<double> in_double;
  Programs<float> in_single;
  Programs<double> normalised;  ///< `normalised` passed as the material

  template <std::floating_point T>
  [[nodiscard]] const Programs<T>& in() const {
    if constexpr (std::same_as<T, double>)
      return in_double;
    else
      return in_single;
  }
};

inline std::ostream& operator<<(std::ostream& out, const MaterialUnderTest& material) {
  return out << material.name;
}

/// By rising name; filled before main.
[[nodiscard]] const std::vector<MaterialUnderTest>& materials_under_test();

// Uniform knots are normalised by their width, others by the whole range.
template <typename Emitted>
concept HasUniformKnots = requires {
  Emitted::segment_width_m;
};
template <typename Emitted>
inline constexpr double length_scale_m = [] {
  if constexpr (HasUniformKnots<Emitted>)
    return Emitted::segment_width_m;
  else
    return Emitted::length_scale_m;
}();
template <typename Emitted>
inline constexpr const char* length_scale_name = HasUniformKnots<Emitted> ? "segment_width" : "length_scale";

/// Adds one; to be called from the initialiser of a namespace-scope constant.
bool register_material(MaterialUnderTest material);

}  // namespace contactspline::testing
