// SPDX-License-Identifier: MIT
// The kernels without vectors of their own: plain loops, which the compiler may vectorise.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>

#include "contactspline/simd/kernel_data.hpp"

namespace contactspline::detail {

/// Sum of term(i) over i < n. Eight partial sums let the compiler use vector registers.
template <std::floating_point T, typename Term>
[[nodiscard]] constexpr T sum_of(std::size_t n, Term term) {
  constexpr std::size_t kLanes = 8;
  T sums[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += term(i + lane);
  for (; i < n; ++i) sums[i % kLanes] += term(i);
  return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

/// Does T round the constants of a mode? Then the rest of its stiffness is kept beside it.
template <std::floating_point T>
inline constexpr bool kRoundsModes = std::numeric_limits<T>::digits < std::numeric_limits<double>::digits;

/// Ends a sample of modes: applies their changes. A separate function, because compilers respect __restrict on
/// parameters.
template <std::floating_point T>
void commit_modes(std::size_t modes, const T* __restrict stiffness, const T* __restrict stiffness_rest,
                  const T* __restrict loss, const T* __restrict change, T* __restrict displacement,
                  T* __restrict free_increment) {
  for (std::size_t i = 0; i < modes; ++i) {
    const T q = displacement[i] + change[i];
    T pull = loss[i] * change[i] + stiffness[i] * q;
    if constexpr (kRoundsModes<T>) pull += stiffness_rest[i] * q;
    displacement[i] = q;
    free_increment[i] = (change[i] - free_increment[i]) + (change[i] - pull);
  }
}

/// Ends a sample of modes that move over two samples at once (TwoStepMotion): their changes, and moved_by times
/// `motion`, move the displacements, and the changes of the next sample are free_increment.
template <std::floating_point T>
void commit_over_two_samples(std::size_t modes, const T* __restrict stiffness, const T* __restrict stiffness_rest,
                             const T* __restrict loss, const T* __restrict motion, T moved_by, T* __restrict change,
                             T* __restrict displacement, T* __restrict free_increment) {
  for (std::size_t i = 0; i < modes; ++i) {
    const T c = change[i] + moved_by * motion[i], q = displacement[i] + c;
    T pull = loss[i] * c + stiffness[i] * q;
    if constexpr (kRoundsModes<T>) pull += stiffness_rest[i] * q;
    change[i] = c;
    displacement[i] = q;
    free_increment[i] = c - pull;
  }
}

/// gradient = squares displacement, motion = receptance gradient.
template <std::floating_point T>
void multiply_squares(std::size_t modes, const T* __restrict squares, const T* __restrict displacement,
                      const T* __restrict receptance, T* __restrict gradient, T* __restrict motion) {
  for (std::size_t i = 0; i < modes; ++i) {
    gradient[i] = squares[i] * displacement[i];
    motion[i] = receptance[i] * gradient[i];
  }
}

/// to[from..n) += factor * column[from..n)
template <std::floating_point T>
void add_scaled(std::size_t from, std::size_t n, T factor, const T* __restrict column, T* __restrict to) {
  for (std::size_t i = from; i < n; ++i) to[i] += factor * column[i];
}

/// I + a positive semidefinite matrix of m rows becomes its Cholesky factor, with the inverse of its diagonal. Above
/// its diagonal it is scratch, so that all loops run on whole vectors. Columns as in
/// Kernels::solve_positive_definite.
template <std::floating_point T>
void factorise(std::size_t m, T* matrix, std::size_t stride) {
  const std::size_t padded = in_whole_lines<T>(m);
  for (std::size_t j = 0; j < m; ++j) {
    T* column = matrix + j * stride;
    const T inverse = 1 / std::sqrt((std::max)(column[j], T(1)));  // no diagonal of I + ... is below 1
    for (std::size_t i = j / kLineSize<T> * kLineSize<T>; i < padded; ++i) column[i] *= inverse;
    for (std::size_t k = j + 1; k < m; ++k)
      add_scaled(k / kLineSize<T> * kLineSize<T>, padded, -column[k], column, matrix + k * stride);
    column[j] = inverse;
  }
}

/// right becomes factor^-1 right. From row end_of(j) on, column j is 0.
template <std::floating_point T, typename EndOf>
void solve_forwards(std::size_t m, const T* factor, std::size_t stride, EndOf end_of, T* right) {
  for (std::size_t j = 0; j < m; ++j) {
    const T* column = factor + j * stride;
    right[j] *= column[j];
    for (std::size_t i = j + 1; i < end_of(j); ++i) right[i] -= right[j] * column[i];
  }
}

/// right becomes factor^-T right.
template <std::floating_point T, typename EndOf>
void solve_backwards(std::size_t m, const T* factor, std::size_t stride, EndOf end_of, T* right) {
  for (std::size_t j = m; j-- > 0;) {
    const T* column = factor + j * stride;
    T sum = right[j];
    for (std::size_t i = j + 1; i < end_of(j); ++i) sum -= column[i] * right[i];
    right[j] = sum * column[j];
  }
}

/// What the functions of Kernels do, by the same names, and their parts.
namespace portable {

template <std::floating_point T>
T inner_product(std::size_t modes, const T* a, const T* b) {
  return sum_of<T>(modes, [&](std::size_t i) { return a[i] * b[i]; });
}

/// Partial sums that let the compiler use vector registers. The arrays of strings on a bridge are padded to them.
inline constexpr std::size_t kSumsOnBridge = 8;

/// Advances the modes of a string by one sample on a bridge that has moved by change_m, and adds the forces on the
/// bridge to `forces`. A separate function, as commit_modes().
template <std::floating_point T>
void advance_modes_on_bridge(std::size_t modes, T change_m, T damping_gain, const T* __restrict stiffness,
                             const T* __restrict stiffness_rest, const T* __restrict loss, const T* __restrict shape,
                             const T* __restrict rest, T* __restrict displacement, T* __restrict free_increment,
                             T* __restrict forces) {
  for (std::size_t line = 0; line < modes; line += kSumsOnBridge)
    for (std::size_t lane = 0; lane < kSumsOnBridge; ++lane) {
      const std::size_t i = line + lane;
      const T by = rest[i] * (change_m / 2), pull_by = stiffness[i] * by;
      const T d = free_increment[i] + pull_by, c = damping_gain * d;
      const T q = displacement[i] - by + c, pull = loss[i] * c + stiffness[i] * q;
      displacement[i] = q - by;
      free_increment[i] = (c - d) + (c - (pull + stiffness_rest[i] * q)) + pull_by;
      forces[lane] += shape[i] * (q - by);
    }
}

template <std::floating_point T>
BridgeForces<T> advance_on_bridge(std::span<const StringsOnBridge<T>> strings, T change_m) {
  T all[kSumsOnBridge] = {}, output[kSumsOnBridge] = {};
  for (const auto& [modes, shape, rest, damping_gain, weight] : strings) {
    T forces[kSumsOnBridge] = {};
    advance_modes_on_bridge(modes.modes, change_m, damping_gain, modes.stiffness, modes.stiffness_rest, modes.loss,
                            shape, rest, modes.displacement, modes.free_increment, forces);
    for (std::size_t lane = 0; lane < kSumsOnBridge; ++lane) {
      all[lane] += forces[lane];
      output[lane] += weight * forces[lane];
    }
  }
  const auto sum = [](const T* f) { return ((f[0] + f[4]) + (f[2] + f[6])) + ((f[1] + f[5]) + (f[3] + f[7])); };
  return {sum(all), sum(output)};
}

template <std::floating_point T>
void sum_shifted_products(std::size_t count, const T* factors, const T* values, T* products, std::size_t shift,
                          std::span<T> sums) {
  for (std::size_t i = 0; i < count; ++i) products[i] = factors[i] * values[i];
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = inner_product<T>(count, products, products + k * shift);
}

template <std::floating_point T>
void solve_positive_definite(std::size_t size, T* matrix, std::size_t stride, T* right) {
  const auto end_of = [size](std::size_t) { return size; };
  factorise(size, matrix, stride);
  solve_forwards(size, matrix, stride, end_of, right);
  solve_backwards(size, matrix, stride, end_of, right);
}

/// Four sums of the modes' increments times shape.
template <std::floating_point T>
void sum_products(std::size_t modes, const T* increment, const T* a, const T* b, const T* c, const T* d, T* sums) {
  constexpr std::size_t kLanes = 16 / sizeof(T);
  T of_a[kLanes] = {}, of_b[kLanes] = {}, of_c[kLanes] = {}, of_d[kLanes] = {};
  for (std::size_t i = 0; i < modes; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const T moved = increment[i + lane];
      of_a[lane] += moved * a[i + lane];
      of_b[lane] += moved * b[i + lane];
      of_c[lane] += moved * c[i + lane];
      of_d[lane] += moved * d[i + lane];
    }
  for (std::size_t place = 0; place < 4; ++place) sums[place] = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    sums[0] += of_a[lane];
    sums[1] += of_b[lane];
    sums[2] += of_c[lane];
    sums[3] += of_d[lane];
  }
}

template <std::floating_point T>
T sum_free_increments(std::size_t modes, const T* free_increment, std::span<const T* const> at, T* increments) {
  if (modes == 1) {
    for (std::size_t p = 0; p < at.size(); ++p) increments[p] = at[p][0] * free_increment[0];
    return std::abs(free_increment[0]);
  }
  const std::size_t padded = in_whole_lines<T>(modes);
  std::size_t p = 0;
  for (; p + 4 <= at.size(); p += 4)
    sum_products(padded, free_increment, at[p], at[p + 1], at[p + 2], at[p + 3], increments + p);
  for (; p < at.size(); ++p) increments[p] = inner_product<T>(modes, at[p], free_increment);
  return sum_of<T>(modes, [&](std::size_t i) { return std::abs(free_increment[i]); });
}

/// The change of each mode by four forces.
template <std::floating_point T>
void add_products(std::size_t modes, T gain, const T* __restrict receptance, const T* __restrict a,
                  const T* __restrict b, const T* __restrict c, const T* __restrict d, const T* forces,
                  T* __restrict change) {
  const T f0 = gain * forces[0], f1 = gain * forces[1], f2 = gain * forces[2], f3 = gain * forces[3];
  for (std::size_t i = 0; i < modes; ++i)
    change[i] += receptance[i] * ((f0 * a[i] + f1 * b[i]) + (f2 * c[i] + f3 * d[i]));
}

/// The change of each mode by one force.
template <std::floating_point T>
void add_product(std::size_t modes, const T* __restrict receptance, const T* __restrict shape, T force,
                 T* __restrict change) {
  for (std::size_t i = 0; i < modes; ++i) change[i] += receptance[i] * shape[i] * force;
}

/// The change of each mode over a sample under damping_gain times the forces at the places `pushed`.
template <std::floating_point T>
void change_under_forces(const ModalArrays<T>& modes, T damping_gain, std::span<const T* const> pushed,
                         const T* forces) {
  T* __restrict change = modes.change;  // no other array of the loop overlaps this one
  const T* const free_increment = modes.free_increment;
  if (modes.modes == 1) {  // a free mass
    T force = 0;
    for (std::size_t p = 0; p < pushed.size(); ++p) force += pushed[p][0] * forces[p];
    change[0] = damping_gain * (free_increment[0] + modes.receptance[0] * force);
    return;
  }
  for (std::size_t i = 0; i < modes.modes; ++i) change[i] = damping_gain * free_increment[i];
  std::size_t p = 0;
  for (; p + 4 <= pushed.size(); p += 4)
    add_products(modes.modes, damping_gain, modes.receptance, pushed[p], pushed[p + 1], pushed[p + 2], pushed[p + 3],
                 forces + p, change);
  for (; p < pushed.size(); ++p)
    add_product(modes.modes, modes.receptance, pushed[p], damping_gain * forces[p], change);
}

template <std::floating_point T>
T advance_under_forces(const ModalArrays<T>& modes, T damping_gain, std::span<const T* const> pushed, const T* forces,
                       std::span<const T* const> at, T* increments) {
  change_under_forces(modes, damping_gain, pushed, forces);
  commit_modes(modes.modes, modes.stiffness, modes.stiffness_rest, modes.loss, modes.change, modes.displacement,
               modes.free_increment);
  return sum_free_increments<T>(modes.modes, modes.free_increment, at, increments);
}

/// product = matrix q.
template <std::floating_point T>
void multiply_form(const FormBlocks<T>& matrix, const T* __restrict q, T* __restrict product) {
  const FormColumns* run = matrix.runs;
  const T* __restrict factor = matrix.factors;
  for (const FormRows& rows : matrix.rows) {
    T sums[kRowsTogether] = {};
    for (const FormColumns* const end = run + rows.runs; run != end; ++run)
      for (std::size_t j = run->first; j < run->first + run->count; ++j, factor += kRowsTogether)
        for (std::size_t r = 0; r < kRowsTogether; ++r) sums[r] += factor[r] * q[j];
    for (std::size_t r = 0; r < rows.count; ++r) product[rows.first + r] = sums[r];
  }
}

/// Of a sample: decay_factor = |z|, decay_loss = 1 - |z|, without cancellation; see mode_constants().
inline void retune(RetunedModes& m) {
  const double dt = m.time_step_s;
  for (std::size_t i = 0; i < m.modes; ++i) {
    const double w = m.angular_frequency_rad_per_s[i], decay = m.decay_per_s[i], q = m.displacement[i];
    const double velocity = m.velocity_gain[i] * (m.free_increment[i] + (m.loss[i] + m.stiffness[i]) / 2 * q);
    const double decay_factor = std::sqrt(1 - m.loss[i]), decay_loss = m.loss[i] / (1 + decay_factor);
    const double sine = std::sin(w * dt / 2), cosine = std::cos(w * dt / 2);
    const double phase_square = (w * w + decay * decay) * dt * dt;
    m.stiffness[i] = decay_loss * decay_loss + 4 * decay_factor * sine * sine;
    m.averaging_factor[i] = phase_square > 0 ? m.stiffness[i] / phase_square : 1;
    m.receptance[i] = m.averaging_factor[i] * dt * dt / (2 * m.mass_kg[i]);
    m.one_plus_z_square[i] = decay_loss * decay_loss + 4 * decay_factor * cosine * cosine;
    m.velocity_gain[i] = (w > 0 ? w / (2 * sine * cosine) : 1 / dt) / decay_factor;
    m.free_increment[i] = velocity / m.velocity_gain[i] - (m.loss[i] + m.stiffness[i]) / 2 * q;
  }
}

template <std::floating_point T>
void advance_stretching(const ModalArrays<T>& modes, const SquareForm<T>& form, T* sums) {
  commit_over_two_samples(modes.modes, modes.stiffness, modes.stiffness_rest, modes.loss, form.motion, form.moved_by,
                          modes.change, modes.displacement, modes.free_increment);
  multiply_squares(modes.modes, form.squares, modes.displacement, modes.receptance, form.gradient, form.motion);
  const T* const factors[] = {modes.displacement, modes.free_increment, modes.change, form.motion};
  for (std::size_t k = 0; k < 4; ++k) sums[k] = inner_product<T>(modes.modes, form.gradient, factors[k]);
}

}  // namespace portable
}  // namespace contactspline::detail
