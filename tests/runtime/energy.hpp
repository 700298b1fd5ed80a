// SPDX-License-Identifier: MIT
// The books of a model's energy: what is stored, what was dissipated, what work was done on it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contactspline/models/hammer_string.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {

/// Books over any number of samples; sums in long double, so that only the model's own rounding shows.
struct EnergyBooks {
  long double work = 0;        ///< done on the model so far [J]
  long double dissipated = 0;  ///< [J]
  double peak = 0;             ///< largest stored energy [J]
  double worst = 0;            ///< largest |stored + dissipated - work| [J]; infinite once anything is not finite

  /// Closes a sample with what is stored at its end.
  void close(double stored) {
    const double error = static_cast<double>(std::abs(stored + dissipated - work));
    worst = is_finite(error) ? std::max(worst, error) : std::numeric_limits<double>::infinity();
    peak = std::max(peak, stored);
  }
};

/// What a contact dissipated over the last sample of a model, from its compression y0 before and its increment over
/// the sample before that [m]: Hunt and Crossley's lambda min(F(y0 + last/2), 2 F(y0)) x^2/dt; where the bodies part
/// without force, all that the contact held beyond [J].
template <typename T, typename Model>
double contact_loss(SegmentTable<T> table, const ContactControls<T>& contact, double sample_rate_hz, T y0, T last,
                    const Model& model) {
  if (!(contact.loss_s_per_m > 0)) return 0;
  const double ratio = contact.stiffness_ratio;
  const T y = model.compression();
  if (!(model.force() > 0)) return ratio * (static_cast<double>(potential(table, y0)) - potential(table, y));
  const double x = static_cast<double>(y) - y0;
  const T midway = std::min(force(table, y0 + last / 2), 2 * force(table, y0));
  return contact.loss_s_per_m * ratio * midway * x * x * sample_rate_hz;
}

/// A hammer-string with its books kept: what hammer is in flight, and what each throw, string and felt take and give.
template <typename T>
class HammerBooks {
 public:
  HammerBooks(HammerString<T> model, SegmentTable<T> felt, double sample_rate_hz)
      : model_(std::move(model)), felt_(felt), sample_rate_hz_(sample_rate_hz) {}

  /// Throws a hammer; the work is its energy less that of the one taken away.
  void strike(T speed, T distance, const HammerStringControls<T>& hammer) {
    const double before = hammer_energy();
    model_.strike(speed, distance);
    hammer_ = hammer;
    books_.work += hammer_energy() - before;
  }

  void tick(const HammerStringControls<T>& controls) {
    const T y = model_.compression(), last = model_.memory().last_increment();
    model_.tick(controls);
    books_.dissipated += contact_loss(felt_, hammer_.felt, sample_rate_hz_, y, last, model_);
    books_.dissipated += model_.string().dissipated();
    books_.close(model_.string().energy() + hammer_energy());
  }

  [[nodiscard]] HammerString<T>& model() { return model_; }
  [[nodiscard]] const EnergyBooks& books() const { return books_; }

 private:
  [[nodiscard]] double felt_energy() const {
    return hammer_.felt.stiffness_ratio * potential(felt_, model_.compression());
  }
  [[nodiscard]] double hammer_energy() const {
    const double v = model_.hammer_velocity();
    return hammer_.hammer_mass_kg * v * v / 2 + felt_energy();
  }

  HammerString<T> model_;
  SegmentTable<T> felt_;
  double sample_rate_hz_;
  HammerStringControls<T> hammer_ = {.hammer_mass_kg = 1};
  EnergyBooks books_;
};

}  // namespace contactspline::testing
