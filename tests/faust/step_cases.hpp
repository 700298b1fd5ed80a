// SPDX-License-Identifier: MIT
// Random input for probe.dsp, what it should give, and errors counted in roundings.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <random>
#include <vector>

#include "material_under_test.hpp"
#include "runtime/exact_contact.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {

using Real = long double;
inline constexpr int kRate = 48000;
inline constexpr std::size_t kSamples = 5000;

/// One sample into probe.dsp.
template <typename T>
struct Input {
  T compression, free_increment, receptance, stiffness_ratio, loss, last_increment;
};

/// One sample out of it.
template <typename T>
struct Output {
  T potential, force, step, contact;
};

/// How close to a knot a compression may come without being on it.
enum class Closeness { kLength, kRepresentable };

/// Lengths from 10^lowest to 10 times max_compression, both signs; a fifth of the compressions on a knot, another
/// close to one: by a hundredth of such a length, or by one to four representable numbers. Receptances from 1e-6 to
/// 1e6 over the largest stiffness.
template <typename T>
class RandomInput {
 public:
  RandomInput(const MaterialUnderTest& material, double lowest, Closeness closeness)
      : table_(material.in<T>().table),
        length_m_(material.max_compression_m),
        lowest_(lowest),
        closeness_(closeness) {}

  std::vector<Input<T>> take(std::size_t count) {
    std::vector<Input<T>> inputs;
    while (inputs.size() < count)
      inputs.push_back({compression(), length(0.5),
                        static_cast<T>(decades(-6, 6) / (2 * table_.back().half_curvature)),
                        static_cast<T>(decades(-3, 3)), static_cast<T>(random_() % 3 ? decades(-4, 1) : 0),
                        random_() % 5 ? length(0.5) : T(0)});
    return inputs;
  }

 private:
  double uniform(double from, double to) { return std::uniform_real_distribution(from, to)(random_); }
  double decades(double from, double to) { return std::pow(10.0, uniform(from, to)); }
  T length(double positive_fraction) {
    const double sign = uniform(0, 1) < positive_fraction ? 1 : -1;
    return static_cast<T>(sign * decades(lowest_, 1) * length_m_);
  }
  T compression() {
    const auto kind = random_() % 5;
    if (kind > 1) return length(0.7);
    const T knot = table_[1 + random_() % (table_.size() - 1)].knot;
    if (kind == 0 || knot == 0) return knot;
    return closeness_ == Closeness::kLength ? knot + length(0.5) / 100 : beside(knot);
  }
  T beside(T value) {
    const T towards = random_() % 2 ? T(1) : T(0);
    for (auto steps = 1 + random_() % 4; steps > 0; --steps) value = std::nextafter(value, towards);
    return value;
  }

  SegmentTable<T> table_;
  double length_m_;
  double lowest_;
  Closeness closeness_;
  std::mt19937_64 random_{1};
};

template <typename T>
std::vector<Output<T>> run_probe(FaustProgram<T>& program, const std::vector<Input<T>>& inputs) {
  Signals<T> signals(6);
  for (const Input<T>& in : inputs) {
    signals[0].push_back(in.compression);
    signals[1].push_back(in.free_increment);
    signals[2].push_back(in.receptance);
    signals[3].push_back(in.stiffness_ratio);
    signals[4].push_back(in.loss);
    signals[5].push_back(in.last_increment);
  }
  const Signals<T> out = program.run(std::move(signals), inputs.size());
  std::vector<Output<T>> outputs;
  for (std::size_t i = 0; i < inputs.size(); ++i) outputs.push_back({out[0][i], out[1][i], out[2][i], out[3][i]});
  return outputs;
}

template <typename T>
Output<T> run_twin(SegmentTable<T> table, const Input<T>& in) {
  const Approach<T> approach{in.compression, in.free_increment, in.receptance};
  const ContactControls<T> controls{in.stiffness_ratio, in.loss};
  return {
      potential(table, in.compression), force(table, in.compression), contact_force(table, approach),
      contact_step(table, controls, 1 / T(kRate), approach, segment_index(table, in.compression), in.last_increment)
          .force};
}

/// The force of the step; with the stiffness scaled and a viscous force loss F x/dt, where F is the force half a last
/// increment beyond y0, but at most twice that at y0, it is 0 where the sum would pull.
template <typename T>
Output<Real> solve_exactly(const ExactContact& exact, const Input<T>& in) {
  const Wide y0 = in.compression, xf = in.free_increment, xi = in.receptance, ratio = in.stiffness_ratio;
  const auto step = [&](Wide increment, Wide receptance) {
    return ExactApproach(exact, y0, increment, receptance).solve().force;
  };
  const Wide midway = std::min<Wide>(exact.force(y0 + Wide(in.last_increment) / 2), 2 * exact.force(y0));
  const Wide resistance = Wide(in.loss) * ratio * midway * kRate;
  const Wide divisor = 1 + xi * resistance;
  const Wide contact = (ratio * step(xf / divisor, ratio * xi / divisor) + resistance * xf) / divisor;
  return {Real(exact.energy(y0)), Real(exact.force(y0)), Real(step(xf, xi)), std::max(Real(0), Real(contact))};
}

/// The larger of increment and free increment as a force [N]: what the rounding of a step is measured by.
template <typename T>
Real momentum(const Input<T>& in, Real force) {
  const Real free_increment = in.free_increment;
  return std::max(std::abs(free_increment), std::abs(free_increment - in.receptance * force)) / in.receptance;
}

/// What rounding the table does to a contact force [N], in unit roundoffs: the forces at both ends, and, where more
/// than one knot is passed, the energies there divided by the distance between.
template <typename T>
Real table_rounding(const ExactContact& exact, const Input<T>& in, Real ratio, Real contact_force) {
  const Real y0 = in.compression, increment = in.free_increment - in.receptance * contact_force;
  const std::size_t from = exact.segment_of(y0), to = exact.segment_of(y0 + increment);
  const bool energies_differ = from + 1 < to || to + 1 < from;
  const Wide energies = exact.energy(y0) + exact.energy(y0 + increment);
  const Wide forces = exact.force(y0) + exact.force(y0 + increment);
  return contact_force + ratio * (Real(forces) + (energies_differ ? Real(energies) / std::abs(increment) : 0));
}

/// What one rounding amounts to in each output.
template <typename T>
Output<Real> roundings(const ExactContact& exact, const Input<T>& in, const Output<Real>& out) {
  constexpr Real kRoundoff = std::numeric_limits<T>::epsilon() / 2;
  // Roundings of the compression and of the knots move the force by two of y F'. That is less than eight of F, but
  // for laws steeper than the fourth power.
  const Real y = std::max(Real(0), Real(in.compression));
  const Real force = std::max(out.force, y * Real(exact.slope(exact.segment_of(y))) / 4);
  return {kRoundoff * out.potential, kRoundoff * force,
          kRoundoff * (momentum(in, out.step) + table_rounding(exact, in, 1, out.step)),
          kRoundoff * (momentum(in, out.contact) + table_rounding(exact, in, in.stiffness_ratio, out.contact))};
}

/// |actual - expected| in units; without bound where actual is not finite.
template <typename T>
double error_in(Real unit, T actual, Real expected) {
  if (!is_finite(actual)) return std::numeric_limits<double>::max();
  const Real error = std::abs(actual - expected);
  if (error == 0) return 0;
  return unit > 0 ? static_cast<double>(error / unit) : std::numeric_limits<double>::max();
}

struct Worst {
  double potential = 0, force = 0, step = 0, contact = 0;

  template <typename T, typename U>
  void widen(const Output<Real>& unit, const Output<T>& actual, const Output<U>& expected) {
    potential = std::max(potential, error_in(unit.potential, actual.potential, expected.potential));
    force = std::max(force, error_in(unit.force, actual.force, expected.force));
    step = std::max(step, error_in(unit.step, actual.step, expected.step));
    contact = std::max(contact, error_in(unit.contact, actual.contact, expected.contact));
  }
  [[nodiscard]] double largest() const { return std::max({potential, force, step, contact}); }
};

inline std::ostream& operator<<(std::ostream& out, const Worst& worst) {
  return out << "potential " << worst.potential << ", force " << worst.force << ", step " << worst.step
             << ", contact " << worst.contact;
}

// Half a dozen roundings reach the force undamped: those of the distances, of the quadratic and of the two
// expressions of the force. The error of the root cancels in their mean, and no term is larger than the momentum.
inline constexpr double kRoundings = 8;

/// The worst error of probe.dsp on a material, lengths down to 10^lowest.
template <typename T>
Worst worst_error(const MaterialUnderTest& material, FaustProgram<T>& program, double lowest) {
  const ExactContact exact(material.in<T>().table);
  const auto inputs = RandomInput<T>(material, lowest, Closeness::kRepresentable).take(kSamples);
  const auto outputs = run_probe(program, inputs);
  Worst worst;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto expected = solve_exactly(exact, inputs[i]);
    worst.widen(roundings(exact, inputs[i], expected), outputs[i], expected);
  }
  return worst;
}

}  // namespace contactspline::testing
