// SPDX-License-Identifier: MIT
// The books of a strike: what is stored in string, hammer and felt, what was dissipated, and the work of the throw.
#pragma once

#include "contactspline/models/hammer_string.hpp"
#include "contactspline/network/sample_law.hpp"

namespace contactspline::web {

/// The contact of a model after a sample, for its books: with its energy and what it dissipated.
template <typename T>
CoupledConnection<T> contact_of(SegmentTable<T> table, const ContactControls<T>& contact,
                                const ContactMemory<T>& memory, T compression_m, T force_n) {
  return {.table = table, .contact = contact, .memory = memory, .compression = compression_m, .force = force_n};
}

/// What it dissipated over the sample, which began at compression y0 [J].
template <typename T>
double contact_loss(const CoupledConnection<T>& contact, double sample_rate_hz, T y0) {
  return contact.dissipated_since(y0, static_cast<T>(1 / sample_rate_hz)) + contact.dissipated_by_memory();
}

/// The energies of a hammer-string [J].
struct StrikeEnergies {
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
    books_.dissipated +=
        contact_loss(contact(model, felt, controls), sample_rate_hz, y0) + model.string().dissipated();
  }

  /// Reads what is stored now.
  void close(const HammerString<T>& model, SegmentTable<T> felt, const HammerStringControls<T>& controls) {
    const double v = model.hammer_velocity();
    books_.hammer = double(controls.hammer_mass_kg) * v * v / 2;
    books_.felt = contact(model, felt, controls).energy_at(model.compression());
    books_.string = model.string().energy();
  }

  [[nodiscard]] const StrikeEnergies& books() const { return books_; }

 private:
  static CoupledConnection<T> contact(const HammerString<T>& model, SegmentTable<T> felt,
                                      const HammerStringControls<T>& controls) {
    return contact_of(felt, controls.felt, model.memory(), model.compression(), model.force());
  }

  StrikeEnergies books_;
};

}  // namespace contactspline::web
