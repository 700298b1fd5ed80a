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
  T place_m;            ///< of the fret along the string, within its length (MovingPlace::move_to)
  T gap_m;              ///< from the string at rest to the fret; negative where the fret lifts the string
  T pluck_force_n = 0;  ///< pushes the string at the place of the pluck, towards the fret
  T damping_per_s = 0;  ///< of a hand on the string: extra decay of every mode, >= 0
  ContactControls<T> contact = {};
};

/// A modal string over a fret on a rigid neck. Displacements count towards the fret: compression = string - gap. The
/// contact follows place and gap exactly: who moves the fret does the work work_of_fret(), so that energy is balanced
/// to rounding (docs/fret-string.md).
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

  /// Puts the fret at a place [m] along the string, this far [m] from the string at rest.
  void place(T place_m, T gap_m) {
    place_.put(place_m);
    gap_ = gap_m;
    compression_ = string_.displacement(place_.after()) - gap_;
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const FretStringControls<T>& controls) {
    compression_ = anchored(compression_, string_.displacement(place_.after()) - gap_);
    place_.move_to(controls.place_m);
    const T lift = gap_ - controls.gap_m;
    gap_ = controls.gap_m;
    const T damping = controls.damping_per_s * time_step_;
    const T share = 1 / (1 + damping);
    if (damping > 0)
      string_.predict(damping);
    else
      string_.predict();
    string_.push(pluck_, share * controls.pluck_force_n);
    const T give = share * string_.admittance(place_.after(), place_.mean());
    const Approach<T> approach{compression_,
                               string_.increment(place_.after()) + string_.displacement(place_.change()) + lift,
                               std::max(give, kLeastAdmittance)};
    const auto step = contact_step(fret_, controls.contact, time_step_, approach);
    force_ = step.force;
    string_.push(place_.mean(), -share * force_);
    work_of_fret_ = force_ * (string_.middle(place_.change()) + lift);
    string_.commit();
    compression_ = step.compression;
  }

  [[nodiscard]] T force() const { return force_; }                ///< contact force over the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }    ///< of the contact, negative while apart [m]
  [[nodiscard]] T work_of_fret() const { return work_of_fret_; }  ///< on the string, over the last sample [J]
  [[nodiscard]] const ModalBank<T>& string() const { return string_; }

 private:
  // [m/N]; so that a fret below the very end, where the string does not give way at all, still has a solution.
  static constexpr T kLeastAdmittance = T(1e-18);

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
