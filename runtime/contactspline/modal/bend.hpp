// SPDX-License-Identifier: MIT
// A string that sounds: what its bridge hears, and how its tension follows a bend.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// The shapes of a pickup whose signal is the force [N] of `strings` equal strings on that support. Row: as in
/// bridge_shape().
template <std::floating_point T, typename Row>
[[nodiscard]] ModeShapes<T> bridge_shapes(const StiffString& string, const std::vector<Row>& rows, double strings) {
  ModeShapes<T> shapes(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) shapes[i] = static_cast<T>(strings * bridge_shape(string, rows[i]));
  return shapes;
}

namespace detail {

/// Energy [J] that the tension stores in the first modes of a sounding string while it is not detuned: the sum of
/// m T beta^2/mu q^2/2. It is proportional to the tension. Row: as in bridge_shape(), not detuned.
template <typename Row, std::floating_point T, std::size_t Modes>
[[nodiscard]] double tension_energy(const StiffString& string, std::span<const Row> first,
                                    const ModalBank<T, Modes>& sounding) {
  double sum = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double q = double(sounding.displacement(i));
    sum += first[i].mode.mass_kg * square_by_tension(string, first[i]) * q * q / 2;
  }
  return sum;
}

/// The bend of a string that sounds. A tension that falls follows its control at once. One that rises does work: at
/// most that of kStiffeningPower_w, which may be saved up for 10 ms.
class Bend {
 public:
  [[nodiscard]] double cents() const { return cents_; }

  /// Follows a control of so many cents at the time now_s. energy_j: tension_energy(). Has the bend changed?
  bool follow(double control_cents, double energy_j, double now_s) {
    if (!all_finite(std::span<const double>(&energy_j, 1))) return false;
    const double tension = std::exp2(cents_ / 600), control = std::exp2(control_cents / 600);
    const double saved_s = std::clamp(now_s - used_s_, 0.0, kLongest_s);  // rounding may make it negative
    const double next = followed_stiffness(tension, control, energy_j, saved_s);
    if (next == tension) return false;
    used_s_ = now_s - saved_s + (std::max)(0.0, (next - tension) * energy_j / kStiffeningPower_w);
    cents_ = next == control ? control_cents : 600 * std::log2(next);
    return true;
  }

 private:
  static constexpr double kLongest_s = 0.01;

  double cents_ = 0;
  double used_s_ = 0;  // up to when the time has been worked
};

}  // namespace detail

}  // namespace contactspline
