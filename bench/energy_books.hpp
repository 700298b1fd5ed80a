// SPDX-License-Identifier: MIT
// The energy of the baselines: hammer, contact and string of a one-step and of a two-step scheme.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "runtime/energy.hpp"

namespace contactspline::bench {

/// The string of a OneStepHammerString driven once more by the same forces, as a ModalBank. Potential: the contact's
/// energy [J] at a compression [m].
template <typename Scheme, typename Potential>
class OneStepBook {
 public:
  OneStepBook(const Scheme& scheme, double hammer_kg, std::span<const Mode> modes,
              std::span<const double> strike_shapes, double sample_rate_hz, Potential potential)
      : scheme_(scheme),
        string_(modes, sample_rate_hz),
        strike_(strike_shapes),
        hammer_kg_(hammer_kg),
        potential_(std::move(potential)) {}

  /// Call it after each sample.
  void follow() {
    string_.predict();
    string_.push(strike_, scheme_.force());
    string_.commit();
  }
  [[nodiscard]] double hammer_energy() const {
    const double v = scheme_.hammer_velocity();
    return hammer_kg_ * v * v / 2 + potential_(scheme_.compression());
  }
  [[nodiscard]] double string_energy() const { return string_.energy(); }
  [[nodiscard]] double dissipated() const { return string_.dissipated(); }

 private:
  const Scheme& scheme_;
  ModalBank<double> string_;
  ModeShapes<double> strike_;
  double hammer_kg_;
  Potential potential_;
};

/// Energy of a two-step scheme between two samples. With u(n+1) = A u(n) - B u(n-1) + C f, A = 2 cos(w dt) exp(-s
/// dt), B = exp(-2 s dt) and C twice the receptance of ModalBank, multiplied by (u(n+1) - u(n-1))/(2 C): the work of
/// f is the change of ((1 + B)(u(n+1) - u(n))^2 + 2 (1 + B - A) u(n+1) u(n))/(4 C), and (1 - B)(u(n+1) - u(n-1))^2/(4
/// C) is dissipated.
template <typename Scheme>
class TwoStepBook {
 public:
  TwoStepBook(const Scheme& scheme, double hammer_kg, std::span<const Mode> modes, double sample_rate_hz)
      : scheme_(scheme), hammer_kg_(hammer_kg) {
    for (const Mode& mode : modes) {
      const auto c = contactspline::detail::mode_constants(mode, sample_rate_hz);
      const double four_c = 8 * c.receptance;
      modes_.push_back({(2 - c.loss) / four_c, 2 * c.stiffness / four_c, c.loss / four_c});
    }
  }

  /// Call it after each sample.
  void follow() {
    for (std::size_t i = 0; i < modes_.size(); ++i) {
      Displacements& mode = modes_[i];
      mode.last = std::exchange(mode.before, std::exchange(mode.now, scheme_.string().displacement(i)));
    }
  }
  [[nodiscard]] double hammer_energy() const {
    const double v = scheme_.hammer_velocity(), psi = scheme_.psi();
    return hammer_kg_ * v * v / 2 + psi * psi / 2;
  }
  [[nodiscard]] double string_energy() const {
    double energy = 0;
    for (const Displacements& mode : modes_)
      energy +=
          mode.inertia * (mode.now - mode.before) * (mode.now - mode.before) + mode.spring * mode.now * mode.before;
    return energy;
  }
  [[nodiscard]] double dissipated() const {
    double energy = 0;
    for (const Displacements& mode : modes_)
      energy += mode.resistance * (mode.now - mode.last) * (mode.now - mode.last);
    return energy;
  }

 private:
  struct Displacements {
    double inertia, spring, resistance;
    double now = 0, before = 0, last = 0;
  };
  const Scheme& scheme_;
  double hammer_kg_;
  std::vector<Displacements> modes_;
};

/// Keeps the books of a scheme over so many samples. throw_at(n) throws the hammer before sample n, or does not;
/// press_n: the constant force on it.
template <typename Scheme, typename Book, typename Throw>
testing::EnergyBooks balance(Scheme& scheme, Book book, int samples, double sample_rate_hz, double press_n,
                             Throw throw_at) {
  testing::EnergyBooks books;
  for (int n = 0; n < samples; ++n) {
    const double before = book.hammer_energy();
    throw_at(n);
    books.work += book.hammer_energy() - before;
    const double velocity = scheme.hammer_velocity();
    typename Scheme::Sample out[1];
    scheme.process(out);
    books.work += press_n * (velocity + scheme.hammer_velocity()) / (2 * sample_rate_hz);
    book.follow();
    books.dissipated += book.dissipated();
    books.close(book.string_energy() + book.hammer_energy());
  }
  return books;
}

}  // namespace contactspline::bench
