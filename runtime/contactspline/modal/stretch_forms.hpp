// SPDX-License-Identifier: MIT
// The forces by which a body that stretches pulls its modes back.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/form_matrix.hpp"
#include "contactspline/modal/mode.hpp"
#include "contactspline/simd/kernels.hpp"

namespace contactspline::detail {

/// A form as numbers of the precision in which it acts, at the displacements q of the modes.
template <std::floating_point T>
class StretchingForm {
 public:
  StretchingForm(const StretchForm& form, std::size_t modes)
      : stiffness_(form.stiffness_j),
        linear_mode_(form.linear.mode),
        half_linear_(static_cast<T>(form.linear.factor_per_m / 2)),
        squares_(modes),
        gradient_(modes),
        motion_(modes) {
    for (std::size_t i = 0; i < form.squares_per_m2.size(); ++i) squares_[i] = static_cast<T>(form.squares_per_m2[i]);
    if (!form.products.empty() || half_linear_ != 0) matrix_ = FormMatrix<T>(form, modes);
  }

  /// Computes the gradient g = A q, with half of what is linear at its mode [1/m], and motion().
  void take(const ModalArrays<T>& modes) {
    if (!has_products())
      return multiply_squares(modes.modes, squares_.data(), modes.displacement, modes.receptance, gradient_.data(),
                              motion_.data());
    kernels<T>.multiply_form(matrix_.blocks(), modes.displacement, gradient_.data());
    gradient_[linear_mode_] += half_linear_;
    multiply(modes.modes, gradient_.data(), modes.receptance, motion_.data());
  }

  [[nodiscard]] double stiffness() const { return stiffness_; }  ///< [J]
  [[nodiscard]] bool has_products() const { return !matrix_.empty(); }
  /// The gradient, after take().
  [[nodiscard]] const ModalArray<T>& gradient() const { return gradient_; }
  /// Receptance times gradient: the motion of each mode by a unit of the form's force.
  [[nodiscard]] const ModalArray<T>& motion() const { return motion_; }

  /// The same for Kernels::advance_stretching, which does what take() does.
  [[nodiscard]] SquareForm<T> without_products(T moved_by) {
    return {squares_.data(), gradient_.data(), motion_.data(), moved_by};
  }

  /// What of the stretch stands in no product with the gradient. The body may have no modes at all.
  [[nodiscard]] T stretch_beside_gradient(const T* q) const {
    return half_linear_ == 0 ? 0 : half_linear_ * q[linear_mode_];
  }
  /// The form acts no longer, and is not stretched.
  void stop() {
    stiffness_ = 0;
    half_linear_ = 0;
    squares_.clear();
    matrix_ = {};
    gradient_.clear();
    motion_.clear();
  }

  /// q'A p and half of what is linear in each, in double precision.
  [[nodiscard]] double stretch_of(auto q, auto p) const {
    double sum = 0;
    if (has_products())
      matrix_.for_each([&](std::size_t i, std::size_t j, T factor) { sum += double(factor) * q(i) * p(j); });
    else
      for (std::size_t i = 0; i < squares_.size(); ++i) sum += double(squares_[i]) * q(i) * p(i);
    return half_linear_ == 0 ? sum : sum + double(half_linear_) * (q(linear_mode_) + p(linear_mode_));
  }

 private:
  // A separate function, because compilers respect __restrict on parameters.
  static void multiply(std::size_t modes, const T* __restrict a, const T* __restrict b, T* __restrict product) {
    for (std::size_t i = 0; i < modes; ++i) product[i] = a[i] * b[i];
  }

  double stiffness_;
  std::size_t linear_mode_;
  T half_linear_;
  ModalArray<T> squares_, gradient_, motion_;
  FormMatrix<T> matrix_;  // with the squares; of a form with products or what is linear
};

/// The forms of a body. Over the two samples from q- by q to q+, form k of stiffness c_k acts by
///
///     -g_k f_k,    f_k = c_k g_k'(q+ + q-)/2,    g_k = A_k q
///
/// as a spring at a place whose shapes are g_k, so that the equations for q+ are linear. As A_k is symmetric, its
/// work (q+ - q-)/2 times this is -c_k/4 [(q' A_k q+)^2 - (q-' A_k q)^2], the change of an energy. Where the modes
/// move by gain receptance force, the forces solve
///
///     f_k/c_k + gain sum over l of g_k' receptance g_l f_l = g_k'(q+ + q-)/2 without the forms
///
/// The roots of the stiffnesses make of its matrix I + a positive semidefinite one. Where a mode u stretches the body
/// by b u, g_k has b/2 there, and q'A_k p is with b/2 times the sum of both displacements. No allocation after
/// construction.
template <std::floating_point T>
class StretchForms {
 public:
  StretchForms(std::span<const StretchForm> forms, std::size_t modes)
      : root_(forms.size()),
        factors_(kOwn + forms.size()),
        sums_(kOwn + forms.size(), forms.size()),
        stride_(in_whole_lines<double>(forms.size())),
        factor_(stride_ * forms.size()) {
    for (std::size_t k = 0; k < forms.size(); ++k) {
      forms_.emplace_back(forms[k], modes);
      root_[k] = std::sqrt(forms[k].stiffness_j);
    }
  }

  [[nodiscard]] std::size_t size() const { return forms_.size(); }
  [[nodiscard]] const StretchingForm<T>& operator[](std::size_t k) const { return forms_[k]; }
  /// Form k acts no longer, and is not stretched.
  void stop(std::size_t k) {
    forms_[k].stop();
    root_[k] = 0;
  }

  /// Takes the displacements q of the modes, their changes d over the next sample if no force acts, and their changes
  /// c over the last sample. What the equations need are products with the gradients.
  void take(const ModalArrays<T>& modes) {
    factors_[0] = modes.displacement, factors_[1] = modes.free_increment, factors_[2] = modes.change;
    for (std::size_t k = 0; k < size(); ++k) {
      forms_[k].take(modes);
      factors_[kOwn + k] = forms_[k].motion().data();
      const auto sum =
          kernels<T>.are_vectorised() ? kernels<T>.sum_free_increments : portable::sum_free_increments<T>;
      sum(modes.modes, forms_[k].gradient().data(), std::span(factors_).first(kOwn + k + 1), sums_.of(k));
      sums_.of(k)[0] += forms_[k].stretch_beside_gradient(modes.displacement);
    }
  }

  /// Ends a sample of the modes under forces of the forms, and takes where they are then. The changes of the modes
  /// are those without forms. They move by `gain` of their receptances.
  void advance(const ModalArrays<T>& modes, double gain, std::span<const double> forces) {
    const auto moved_by = [&](std::size_t k) { return static_cast<T>(-gain * forces[k]); };
    if (size() == 1 && !forms_[0].has_products())
      return kernels<T>.advance_stretching(modes, forms_[0].without_products(moved_by(0)), sums_.of(0));
    for (std::size_t k = 1; k < size(); ++k)
      add_scaled(0, modes.modes, moved_by(k), forms_[k].motion().data(), modes.change);
    commit_over_two_samples(modes.modes, modes.stiffness, modes.stiffness_rest, modes.loss, first_motion(modes),
                            size() > 0 ? moved_by(0) : T(0), modes.change, modes.displacement, modes.free_increment);
    take(modes);
  }

  /// sum = free increments of the modes, pulled by the force of the potential at the displacements that were taken.
  void pull(const ModalArrays<T>& modes, T* sum) const {
    add(modes.modes, modes.free_increment, size() > 0 ? static_cast<T>(-pull(0)) : T(0), first_motion(modes), sum);
    for (std::size_t k = 1; k < size(); ++k)
      add_scaled(0, modes.modes, static_cast<T>(-pull(k)), forms_[k].motion().data(), sum);
  }
  /// The force of form k there.
  [[nodiscard]] double pull(std::size_t k) const { return forms_[k].stiffness() * stretch(k); }

  [[nodiscard]] double stretch(std::size_t k) const { return sums_(k, 0); }                    ///< s of StretchForm
  [[nodiscard]] double stretch_by_free_increment(std::size_t k) const { return sums_(k, 1); }  ///< g_k'd
  [[nodiscard]] double stretch_by_change(std::size_t k) const { return sums_(k, 2); }          ///< g_k'c
  /// g_k' receptance g_l, l <= k.
  [[nodiscard]] double coupling(std::size_t k, std::size_t l) const { return sums_(k, kOwn + l); }

  /// Makes the equations ready for solve().
  void factorise(double gain) {
    if (size() == 1) {
      factor_[0] = 1 / (1 + gain * forms_[0].stiffness() * coupling(0, 0));
      return;
    }
    for (std::size_t l = 0; l < size(); ++l) {
      double* column = factor_.data() + l * stride_;
      for (std::size_t k = l; k < size(); ++k) column[k] = gain * root_[k] * root_[l] * coupling(k, l);
      std::fill(column + size(), column + stride_, 0.0);
      column[l] += 1;
    }
    detail::factorise(size(), factor_.data(), stride_);
  }

  /// The right sides of the equations above become their solution f.
  void solve(std::span<double> right) const {
    if (size() == 1) {
      right[0] *= forms_[0].stiffness() * factor_[0];
      return;
    }
    const auto end_of = [this](std::size_t) { return size(); };
    for (std::size_t k = 0; k < size(); ++k) right[k] *= root_[k];
    solve_forwards(size(), factor_.data(), stride_, end_of, right.data());
    solve_backwards(size(), factor_.data(), stride_, end_of, right.data());
    for (std::size_t k = 0; k < size(); ++k) right[k] *= root_[k];
  }

 private:
  static constexpr std::size_t kOwn = 3;  // sums of a form beside those with motions

  // A row of sums for each form.
  class Sums {
   public:
    Sums(std::size_t length, std::size_t forms) : length_(length), values_(length * forms) {}
    [[nodiscard]] T* of(std::size_t k) { return values_.data() + k * length_; }
    [[nodiscard]] double operator()(std::size_t k, std::size_t i) const { return double(values_[k * length_ + i]); }

   private:
    std::size_t length_;
    std::vector<T> values_;
  };

  // What stands in the passes over all modes: the motion by the first form. Without forms 0 times any other array.
  [[nodiscard]] const T* first_motion(const ModalArrays<T>& modes) const {
    return size() > 0 ? forms_[0].motion().data() : modes.receptance;
  }
  // A separate function, because compilers respect __restrict on parameters.
  static void add(std::size_t modes, const T* __restrict a, T factor, const T* __restrict b, T* __restrict sum) {
    for (std::size_t i = 0; i < modes; ++i) sum[i] = a[i] + factor * b[i];
  }

  std::vector<StretchingForm<T>> forms_;
  std::vector<double> root_;
  std::vector<const T*> factors_;  // what gradients are multiplied by
  Sums sums_;
  std::size_t stride_;
  ModalArray<double> factor_;  // lower triangle, column by column
};

}  // namespace contactspline::detail
