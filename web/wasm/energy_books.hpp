// SPDX-License-Identifier: MIT
// The books of a strike: what is stored in string, hammer and felt, what was dissipated, and the work of the throw.
#pragma once

#include "contactspline/models/hammer_string.hpp"

namespace contactspline::web {

/// What a contact dissipated over the last sample [J], from its compression y0 [m] before: Hunt and Crossley's
/// lambda F(y0) x^2/dt; where the bodies part without force, all that the contact held beyond.
template <typename T>
double contact_loss(SegmentTable<T> table, const ContactControls<T>& contact, double sample_rate_hz, T y0, T y,
                    T force_n) {
  if (!(contact.loss_s_per_m > 0)) return 0;
  const double ratio = contact.stiffness_ratio;
  if (!(force_n > 0)) return ratio * (double(potential(table, y0)) - double(potential(table, y)));
  const double x = double(y) - double(y0);
  return double(contact.loss_s_per_m) * ratio * double(force(table, y0)) * x * x * sample_rate_hz;
}

/// The energies of a hammer-string [J].
struct Books {
  double hammer = 0, felt = 0, string = 0;
  double dissipated = 0, work = 0;

  /// Stored and dissipated energy: constant after the throw.
  [[nodiscard]] double total() const { return hammer + felt + string + dissipated; }
};

/// Keeps the books of one hammer-string from a strike on.
template <typename T>
class StrikeBooks {
 public:
  /// Call after the throw.
  void open(const HammerString<T>& model, SegmentTable<T> felt, const HammerStringControls<T>& controls) {
    books_.dissipated = 0;
    close(model, felt, controls);
    books_.work = books_.total();
  }

  /// Call after each sample: y0 is the compression before it.
  void add_loss(const HammerString<T>& model, SegmentTable<T> felt, const HammerStringControls<T>& controls,
                double sample_rate_hz, T y0) {
    books_.dissipated += contact_loss(felt, controls.felt, sample_rate_hz, y0, model.compression(), model.force()) +
                         model.string().dissipated();
  }

  /// Reads what is stored now.
  void close(const HammerString<T>& model, SegmentTable<T> felt, const HammerStringControls<T>& controls) {
    const double v = model.hammer_velocity();
    books_.hammer = double(controls.hammer_mass_kg) * v * v / 2;
    books_.felt = double(controls.felt.stiffness_ratio) * double(potential(felt, model.compression()));
    books_.string = model.string().energy();
  }

  [[nodiscard]] const Books& books() const { return books_; }

 private:
  Books books_;
};

}  // namespace contactspline::web
