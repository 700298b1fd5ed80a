// SPDX-License-Identifier: MIT
// The motion of modes over two samples at once, under forces that depend on all of them.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/stretch_forms.hpp"

namespace contactspline::detail {

/// Moves the modes of a bank over two samples at once, from q- by q to q+:
///
///     c = (d - damping c- + 2 receptance F)/(1 + damping),    q+ = q + c,    d+ = c - (loss c + stiffness q+)
///
/// with c- = q - q- and the constants of ModalBank, so with exactly its poles and its compliance. F acts at q; it
/// does what a ModalBank does under half of it in the sample that ends at q and half in the one that begins there.
/// With the energy of StretchForms,
///
///     sum [|1 + z|^2 c^2 + |1 - z|^2 (q + q+)^2]/(16 receptance) + sum stiffness_k/4 (q' A_k q+)^2
///
/// changes by the work of the other forces, F (q+ - q-)/2, less (loss/2 + damping) (q+ - q-)^2/(4 receptance),
/// whatever the amplitude: multiply by q+ - q-. No term is negative. Without forms and forces the modes move as those
/// of ModalBank, to the bit.
///
/// The displacements are those of the bank, the changes this motion's own. For each sample begin(), then push() for
/// each force, then end(). Between samples the bank's free increments are those of its free motion, as ModalBank has
/// them: half of what the forms do at q included. No allocation after construction.
template <std::floating_point T>
class TwoStepMotion {
 public:
  /// Takes the springs of modes that stretch the body by themselves from the bank. Where such a mode is above 0.45
  /// times the sample rate, its form does not act: a string is as if the mode were infinitely fast.
  TwoStepMotion(std::span<const StretchForm> forms, ModalBank<T>& bank)
      : forms_(forms, bank.size()),
        free_increment_(bank.size()),
        change_(bank.size()),
        change_before_(bank.size()),
        moved_(forms.size()),
        force_(forms.size()),
        response_(forms.size()),
        own_springs_(bank.size()) {
    for (std::size_t k = 0; k < forms.size(); ++k) {
      const auto [mode, factor] = forms[k].linear;
      if (factor == 0) continue;
      own_springs_ = (std::min)(own_springs_, mode);
      if (can_give_away_spring(bank.constants(mode).stiffness, bank.constants(mode).receptance))
        bank.give_away_spring(mode, forms[k].stiffness_j * factor * factor / 2);
      else
        forms_.stop(k);
    }
    forms_.take(arrays(bank));
  }

  [[nodiscard]] const StretchForms<T>& forms() const { return forms_; }
  /// Number of modes whose springs are those of the bank: the first ones.
  [[nodiscard]] std::size_t own_springs() const { return own_springs_; }
  /// By how much of their receptances the modes move over two samples: 2 less what the damper takes.
  [[nodiscard]] double gain() const { return 2 * double(gain_); }
  /// q-'A_k q: how much form k was stretched by the displacements before the last sample.
  [[nodiscard]] double stretch_before(std::size_t k) const { return forms_.stretch(k) - forms_.stretch_by_change(k); }
  /// g_k'(q+ - q-) under the forces pushed so far, without those of the forms.
  [[nodiscard]] double stretch_increment(std::size_t k) const { return moved_[k] + forms_.stretch_by_change(k); }

  /// Begins a sample.
  void begin(ModalBank<T>& bank, T damping) {
    damping_ = damping;
    gain_ = 1 / (1 + damping);
    std::swap(change_before_, change_);
    std::swap(change_, free_increment_);  // which has served
    if (damping != 0) damp(bank.size(), gain_, damping, change_before_.data(), change_.data());
    for (std::size_t k = 0; k < forms_.size(); ++k)
      moved_[k] =
          double(gain_) * (forms_.stretch_by_free_increment(k) - double(damping) * forms_.stretch_by_change(k));
    is_factored_ = is_solved_ = false;
  }

  /// Adds a force [N] at a place for this sample.
  void push(ModalBank<T>& bank, const T* at, T force) {
    push_with_forms(bank, at, force);
    for (std::size_t k = 0; k < forms_.size(); ++k)
      moved_[k] += gain() * double(force) * double(product(at, forms_[k].motion()));
    is_solved_ = false;
  }

  /// The same of a force that is found together with those of the forms, before end().
  void push_with_forms(ModalBank<T>& bank, const T* at, T force) {
    portable::add_product(bank.size(), bank.arrays().receptance, at, 2 * gain_ * force, change_.data());
  }

  /// Change of displacement at a place [m] over the last sample and this one, with the forces pushed so far, without
  /// those of the forms. After end(): with all.
  [[nodiscard]] T increment_without_forms(const T* at) const {
    return product(at, change_) + product(at, change_before_);
  }
  /// Change of displacement at a place over the last sample, between two samples [m].
  [[nodiscard]] T last_change(const T* at) const { return product(at, change_); }

  /// increment_without_forms() and what the forms do.
  [[nodiscard]] T increment(const T* at) {
    solve();
    double increment = double(increment_without_forms(at));
    for (std::size_t k = 0; k < forms_.size(); ++k)
      increment -= gain() * double(product(at, forms_[k].motion())) * force_[k];
    return static_cast<T>(increment);
  }

  /// Change of that increment at place `at` per newton at place `of_force` [m/N].
  [[nodiscard]] T receptance(const ModalBank<T>& bank, const ModeShapes<T>& at, const ModeShapes<T>& of_force) {
    factorise_forms();
    for (std::size_t k = 0; k < forms_.size(); ++k)
      response_[k] = double(gain_) * double(product(of_force.data(), forms_[k].motion()));
    forms_.solve(response_);
    double receptance = double(bank.receptance(at, of_force));
    for (std::size_t k = 0; k < forms_.size(); ++k)
      receptance -= double(product(at.data(), forms_[k].motion())) * response_[k];
    return static_cast<T>(gain() * receptance);
  }

  /// Ends the sample.
  void end(ModalBank<T>& bank) {
    solve();
    end(bank, force_);
  }

  /// The same under forces of the forms that were found together with others.
  void end(ModalBank<T>& bank, std::span<const double> forces) {
    forms_.advance(arrays(bank), gain(), forces);
    forms_.pull(arrays(bank), bank.arrays().free_increment);
  }

  /// Takes displacements and free increments of the bank, which were set between two samples. Modes at half the
  /// sample rate and above come to rest, and modes that decay by more than a tenth per sample lose their velocity.
  void take_motion(ModalBank<T>& bank) {
    constexpr double kMaxLoss = 0.19;  // 1 - 0.9^2, as in ModalBank
    const auto modes = bank.arrays();
    for (std::size_t i = 0; i < modes.modes; ++i)
      if (modes.receptance[i] == 0) modes.displacement[i] = modes.free_increment[i] = 0;
    forms_.take(arrays(bank));
    for (std::size_t i = 0; i < modes.modes; ++i) {
      const ModeConstants& mode = bank.constants(i);
      double d = double(modes.free_increment[i]);
      for (std::size_t k = 0; k < forms_.size(); ++k) d += forms_.pull(k) * double(forms_[k].motion()[i]);
      const double pull_back = mode.stiffness * double(modes.displacement[i]);
      const bool has_velocity = mode.loss <= kMaxLoss;
      free_increment_[i] = static_cast<T>(has_velocity ? d : -pull_back);
      change_[i] = static_cast<T>(has_velocity ? (d + pull_back) / (1 - mode.loss) : 0);
    }
    forms_.take(arrays(bank));
  }

  /// Energy that stretching stores [J].
  [[nodiscard]] double stretching_energy(const ModalBank<T>& bank) const {
    double energy = 0;
    const auto q = [&](std::size_t i) { return double(bank.displacement(i)); };
    const auto before = [&](std::size_t i) { return q(i) - double(change_[i]); };
    for (std::size_t k = 0; k < forms_.size(); ++k)
      energy += forms_[k].stiffness() / 4 * std::pow(forms_[k].stretch_of(q, before), 2);
    return energy;
  }

  /// Kinetic energy of the modes [J].
  [[nodiscard]] double kinetic_energy(const ModalBank<T>& bank) const {
    return sum_over(bank, [&](std::size_t i, const ModeConstants& mode) {
      return mode.one_plus_z_square / 16 * double(change_[i]) * double(change_[i]);
    });
  }

  /// All energy [J], of the last two displacements of the modes.
  [[nodiscard]] double energy(const ModalBank<T>& bank) const {
    const double potential = sum_over(bank, [&](std::size_t i, const ModeConstants& mode) {
      const double middle = double(bank.displacement(i)) - double(change_[i]) / 2;
      return mode.stiffness / 4 * middle * middle;
    });
    return kinetic_energy(bank) + potential + stretching_energy(bank);
  }

  /// Energy that the losses of the modes and the damper dissipated in the last sample [J].
  [[nodiscard]] double dissipated(const ModalBank<T>& bank) const {
    return sum_over(bank, [&](std::size_t i, const ModeConstants& mode) {
      const double change = double(change_[i]) + double(change_before_[i]);
      return (mode.loss / 2 + double(damping_)) / 4 * change * change;
    });
  }

 private:
  [[nodiscard]] static T product(const T* a, const ModalArray<T>& b) {
    return inner_product<T>(b.size(), a, b.data());
  }

  // Sum of term(i)/receptance over the modes that forces drive.
  template <typename Term>
  [[nodiscard]] static double sum_over(const ModalBank<T>& bank, Term term) {
    double sum = 0;
    for (std::size_t i = 0; i < bank.size(); ++i)
      if (const ModeConstants& mode = bank.constants(i); mode.receptance > 0) sum += term(i, mode) / mode.receptance;
    return sum;
  }

  // The arrays of the bank, with the changes and the free increments of this motion.
  [[nodiscard]] ModalArrays<T> arrays(ModalBank<T>& bank) {
    auto modes = bank.arrays();
    modes.change = change_.data();
    modes.free_increment = free_increment_.data();
    return modes;
  }

  // A separate function, because compilers respect __restrict on parameters.
  static void damp(std::size_t modes, T gain, T damping, const T* __restrict change_before, T* __restrict change) {
    for (std::size_t i = 0; i < modes; ++i) change[i] = gain * (change[i] - damping * change_before[i]);
  }

  void factorise_forms() {
    if (!std::exchange(is_factored_, true)) forms_.factorise(double(gain_));
  }

  // The forces of the forms under those that were pushed.
  void solve() {
    if (std::exchange(is_solved_, true)) return;
    factorise_forms();
    for (std::size_t k = 0; k < forms_.size(); ++k)
      force_[k] = forms_.stretch(k) + (moved_[k] - forms_.stretch_by_change(k)) / 2;
    forms_.solve(force_);
  }

  StretchForms<T> forms_;
  ModalArray<T> free_increment_;                  // d
  ModalArray<T> change_, change_before_;          // c and c-
  std::vector<double> moved_, force_, response_;  // of each form: g'c without forms, f, what it answers to a force
  std::size_t own_springs_;
  T damping_ = 0, gain_ = 1;  // of the current sample
  bool is_factored_ = false, is_solved_ = false;
};

}  // namespace contactspline::detail
