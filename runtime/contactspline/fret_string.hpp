// SPDX-License-Identifier: MIT
// A plucked string that buzzes against a fret.
#pragma once

#include "contactspline/contact.hpp"
#include "contactspline/modal.hpp"
#include "contactspline/string_place.hpp"

namespace contactspline {

/// Live controls of the fret-string model.
template <std::floating_point T>
struct FretStringControls {
  T place_m;            ///< place of the fret on the string, 0 to its length (MovingPlace::move_to)
  T gap_m;              ///< distance from the string at rest to the fret; negative: the fret lifts the string
  T pluck_force_n = 0;  ///< pushes the string at the pluck, towards the fret
  T damping_per_s = 0;  ///< a hand that damps the string: extra decay of every mode, >= 0
  ContactControls<T> contact = {};
};

/// A modal string over a fret on a rigid neck. Displacements are positive towards the fret: compression = string -
/// gap. Moving the fret, along the string or towards it, does the work work_of_fret(). With this work the energy
/// balance is exact up to rounding (docs/fret-string.md).
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class FretString {
 public:
  FretString(SegmentTable<T, Extent> fret, std::span<const Mode> modes, const StringShapes<T>& shapes,
             T pluck_place_m, double sample_rate_hz)
      : fret_(fret),
        string_(modes, sample_rate_hz),
        place_(shapes, pluck_place_m, shapes.longest_step(modes, sample_rate_hz)),
        pluck_(shapes.size()),
        time_step_(T(1 / sample_rate_hz)) {
    shapes.at(pluck_place_m, pluck_);
  }

  /// Sets the fret at a place [m] along the string, at a distance [m] from the string at rest.
  void place(T place_m, T gap_m) {
    place_.put(place_m);
    gap_ = gap_m;
    compression_ = string_.displacement(place_.after()) - gap_;
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick(const FretStringControls<T>& controls) {
    compression_ = anchored(compression_, string_.displacement(place_.after()) - gap_);
    place_.move_to(controls.place_m);
    const T lift = gap_ - controls.gap_m;
    gap_ = controls.gap_m;
    const T damping = controls.damping_per_s * time_step_;
    const T damping_gain = 1 / (1 + damping);
    if (damping > 0)
      string_.predict(damping);
    else
      string_.predict();
    string_.push(pluck_, damping_gain * controls.pluck_force_n);
    const T admittance = damping_gain * string_.admittance(place_.after(), place_.mean());
    const Approach<T> approach{compression_,
                               string_.increment(place_.after()) + string_.displacement(place_.change()) + lift,
                               std::max(admittance, kMinAdmittance)};
    const auto step = contact_step(fret_, controls.contact, time_step_, approach);
    force_ = step.force;
    string_.push(place_.mean(), -damping_gain * force_);
    work_of_fret_ = force_ * (string_.middle(place_.change()) + lift);
    string_.commit();
    compression_ = step.compression;
  }

  [[nodiscard]] T force() const { return force_; }              ///< contact force over the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }  ///< of the contact, negative while apart [m]
  /// Work that the moving fret did on the string over the last sample [J].
  [[nodiscard]] T work_of_fret() const { return work_of_fret_; }
  [[nodiscard]] const ModalBank<T>& string() const { return string_; }

 private:
  // [m/N]. At the very end of the string the admittance is 0; the contact step needs one > 0.
  static constexpr T kMinAdmittance = T(1e-18);

  SegmentTable<T, Extent> fret_;
  ModalBank<T> string_;
  MovingPlace<T> place_;
  ModeShapes<T> pluck_;
  T time_step_;
  T gap_ = 0;
  T compression_ = 0;
  T force_ = 0;
  T work_of_fret_ = 0;
};

}  // namespace contactspline
