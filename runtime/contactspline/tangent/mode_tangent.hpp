// SPDX-License-Identifier: MIT
// Derivatives of modes: of their constants at a sample rate, and of the modes of a string with respect to the string.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/modal.hpp"

namespace contactspline {

namespace detail {

/// The constants that advance a mode (ModeConstants), or their derivatives.
struct ModeStep {
  double stiffness = 0, loss = 0, receptance = 0;
};

/// As ModalBank sets them: no force drives a mode above half the sample rate.
[[nodiscard]] inline ModeStep step_of(const Mode& mode, double sample_rate_hz) {
  const ModeConstants constants = mode_constants(mode, sample_rate_hz);
  const bool sounds = mode.angular_frequency_rad_per_s < std::numbers::pi * sample_rate_hz;
  return {constants.stiffness, constants.loss, sounds ? constants.receptance : 0};
}

/// The derivative of step_of(mode) in a direction. With r = exp(-decay dt): stiffness 1 - 2 r cos(w dt) + r^2, loss 1
/// - r^2, receptance stiffness/(2 m (w^2 + decay^2)).
[[nodiscard]] inline ModeStep step_tangent(const Mode& mode, const Mode& direction, double sample_rate_hz) {
  const double w = mode.angular_frequency_rad_per_s, decay = mode.decay_per_s, dt = 1 / sample_rate_hz;
  const double dw = direction.angular_frequency_rad_per_s, ddecay = direction.decay_per_s;
  const double r = std::exp(-decay * dt);
  const ModeStep step = step_of(mode, sample_rate_hz);
  ModeStep tangent;
  const double half_sine = std::sin(w * dt / 2);
  const double by_decay =
      -std::expm1(-decay * dt) - 2 * half_sine * half_sine;  // cos(w dt) - r, without cancellation
  tangent.stiffness = 2 * r * dt * (std::sin(w * dt) * dw + by_decay * ddecay);
  tangent.loss = 2 * r * r * dt * ddecay;
  const double square = w * w + decay * decay;
  double relative = -direction.mass_kg / mode.mass_kg;
  if (square > 0) relative += tangent.stiffness / step.stiffness - 2 * (w * dw + decay * ddecay) / square;
  tangent.receptance = step.receptance * relative;
  return tangent;
}

}  // namespace detail

/// The derivatives of a string's modes if the string's numbers change by `direction`; its detuning stays. Rows: of
/// modes_below, or others with members `mode` and `wavenumber_per_m`.
template <typename Row>
[[nodiscard]] std::vector<Mode> modes_tangent(const StiffString& string, const std::vector<Row>& rows,
                                              const StiffString& direction) {
  const double length = direction.length_m / string.length_m, mass = direction.mass_kg / string.mass_kg;
  std::vector<Mode> tangents;
  for (const Row& row : rows) {
    const double beta = row.wavenumber_per_m, w = row.mode.angular_frequency_rad_per_s, decay = row.mode.decay_per_s;
    const double by_tension = square_by_tension(string, row);
    const double by_bending = w * w + decay * decay - by_tension;
    double square = by_tension * (direction.tension_n / string.tension_n - length - mass);
    if (string.bending_stiffness_n_m2 != 0)
      square += by_bending * (direction.bending_stiffness_n_m2 / string.bending_stiffness_n_m2 - 3 * length - mass);
    else
      square += direction.bending_stiffness_n_m2 * std::pow(beta, 4) * string.length_m / string.mass_kg;
    const double ddecay =
        direction.losses.decay_per_s(beta) - 2 * string.losses.quadratic_m2_per_s * beta * beta * length;
    tangents.push_back({(square / 2 - decay * ddecay) / w, ddecay, direction.mass_kg / 2});
  }
  return tangents;
}

/// The derivatives of the shapes sin(wavenumber place) if the place changes by `moved_m` [m].
template <std::floating_point T>
[[nodiscard]] ModeShapes<T> shapes_tangent(std::span<const double> wavenumbers_per_m, double place_m,
                                           double moved_m) {
  ModeShapes<T> tangents(wavenumbers_per_m.size());
  for (std::size_t i = 0; i < wavenumbers_per_m.size(); ++i) {
    const double beta = wavenumbers_per_m[i];
    tangents[i] = static_cast<T>(std::cos(beta * place_m) * beta * moved_m);
  }
  return tangents;
}

/// The same for a string of modes_below, or of rows as above, if its length changes by `longer_m` [m], too.
template <std::floating_point T, typename Row>
[[nodiscard]] ModeShapes<T> shapes_tangent(const StiffString& string, const std::vector<Row>& rows, double place_m,
                                           double moved_m, double longer_m) {
  std::vector<double> wavenumbers;
  for (const Row& row : rows) wavenumbers.push_back(row.wavenumber_per_m);
  return shapes_tangent<T>(wavenumbers, place_m, moved_m - place_m * longer_m / string.length_m);
}

}  // namespace contactspline
