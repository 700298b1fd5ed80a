// SPDX-License-Identifier: MIT
// The materials whose Faust programs are linked into this test, with the tables emitted for C++.
#pragma once

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "contactspline/contact.hpp"
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
  double segment_width_m;
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

/// Adds one; to be called from the initialiser of a namespace-scope constant.
bool register_material(MaterialUnderTest material);

}  // namespace contactspline::testing
