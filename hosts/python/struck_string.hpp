// SPDX-License-Identifier: MIT
// A hammer's strike on a string as a function of its parameters, with derivatives, for Python.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "contactspline/tangent/strike.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/design.hpp"

namespace contactspline::python {

/// A felt's design, a string and a sample rate. Everything that a parameter may change is computed from the values of
/// all parameters, in the order of parameters().
class StruckString {
 public:
  struct Row {
    std::string name, unit;
    double initial, min, max;
  };

  /// The resonator must be a string.
  StruckString(Design felt, Resonator resonator, double sample_rate_hz);

  [[nodiscard]] const std::vector<Row>& parameters() const { return rows_; }

  /// Displacement at the pickup [m] and force [N] in each sample. Throws BadInput, as all that follow, if a value is
  /// out of its range or a place is beyond the string. watch: called now and then; it stops the work by an exception.
  void play(std::span<const double> values, std::span<double> displacement, std::span<double> force,
            const std::function<void()>& watch) const;

  /// Their derivatives with respect to some parameters, by their indices: one row of samples for each.
  void tangents(std::span<const double> values, std::span<const std::size_t> parameters,
                std::span<double> displacements, std::span<double> forces, const std::function<void()>& watch) const;

  /// The derivatives of sum(displacement_weights displacement) + sum(force_weights force) with respect to all
  /// parameters.
  [[nodiscard]] std::vector<double> gradient(std::span<const double> values,
                                             std::span<const double> displacement_weights,
                                             std::span<const double> force_weights) const;

 private:
  struct Made;
  [[nodiscard]] Made make(std::span<const double> values) const;

  Design felt_;
  Resonator resonator_;
  double rate_;
  std::vector<Row> rows_;
};

}  // namespace contactspline::python
