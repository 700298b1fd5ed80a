// SPDX-License-Identifier: MIT
// A felt hammer thrown at a string, or at any other modal resonator.
#pragma once

#include <utility>

#include "contactspline/contact.hpp"
#include "contactspline/kernels.hpp"
#include "contactspline/modal.hpp"

namespace contactspline {

/// Live controls of the hammer-string model. Those of the hammer are taken at the throw and hold until the next one:
/// a felt that hardens or a hammer that gains weight in the midst of a contact would add energy of its own.
template <std::floating_point T>
struct HammerStringControls {
  T hammer_mass_kg;              ///< > 0
  ContactControls<T> felt = {};  ///< stiffness ratio and loss
  T damping_per_s = 0;           ///< of the damper, at any time: extra decay of every mode, >= 0
};

namespace detail {

/// The arrays behind StrikeArrays.
template <std::floating_point T>
class StrikeTables {
 public:
  StrikeTables(SegmentTable<T> felt, std::size_t modes)
      : blocks_((felt.size() - 1 + kKnotsInABlock - 1) / kKnotsInABlock),
        knots_(blocks_ * kKnotsInABlock),
        energies_(knots_.size()),
        pivots_((blocks_ + kKnotsInABlock - 1) / kKnotsInABlock * kKnotsInABlock),
        pivot_energies_(pivots_.size()),
        give_(modes),
        free_give_(modes),
        workspace_(kStruckLines * (modes + ModalArray<T>::kLine)) {
    for (std::size_t k = 0; k < knots_.size(); ++k) {
      const bool is_there = k + 1 < felt.size();
      knots_[k] = is_there ? felt[k + 1].knot : kOutOfReach_m<T>;
      energies_[k] = is_there ? felt[k + 1].energy : T(0);
    }
    for (std::size_t block = 0; block < pivots_.size(); ++block) {
      pivots_[block] = block < blocks_ ? knots_[block * kKnotsInABlock] : kOutOfReach_m<T>;
      pivot_energies_[block] = block < blocks_ ? energies_[block * kKnotsInABlock] : T(0);
    }
  }

  /// For the next throw, at a place of these shapes.
  void strike_at(const ModalBank<T>& string, const ModeShapes<T>& shapes) {
    string.respond(shapes, give_, free_give_);
    free_admittance_ = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) free_admittance_ += shapes[i] * free_give_[i];
  }

  [[nodiscard]] StrikeArrays<T> arrays(const ModeShapes<T>& shapes) {
    return {shapes.data(),    give_.data(),   free_give_.data(),      free_admittance_, knots_.data(),
            energies_.data(), pivots_.data(), pivot_energies_.data(), blocks_,          workspace_.data()};
  }

 private:
  std::size_t blocks_;
  ModalArray<T> knots_, energies_, pivots_, pivot_energies_;
  ModalArray<T> give_, free_give_;
  ModalArray<T> workspace_;
  T free_admittance_ = 0;
};

}  // namespace detail

/// A hammer in free flight before a resonator that it strikes at one place. Several strings under one hammer are one
/// resonator: their modes side by side, each shape divided by the number of strings.
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class HammerString {
 public:
  HammerString(SegmentTable<T, Extent> felt, std::span<const Mode> modes, ModeShapes<T> strike, double sample_rate_hz)
      : felt_(felt),
        string_(modes, sample_rate_hz),
        strike_(modes.size()),
        next_strike_(std::move(strike)),
        tables_(felt, modes.size()),
        time_step_(T(1 / sample_rate_hz)) {}

  /// Moves the place of the strike, from the next throw on.
  void strike_at(const ModeShapes<T>& strike) {
    next_strike_ = strike;
    has_moved_ = true;
  }

  /// Throws the hammer at the string, from a distance [m] >= 0, with a velocity [m/s]; the string may be sounding.
  void strike(T velocity_m_per_s, T distance_m) {
    if (std::exchange(has_moved_, false)) {
      strike_ = next_strike_;
      string_admittance_ = string_.admittance(strike_, strike_);
      tables_.strike_at(string_, strike_);
    }
    hammer_.compression_m = -distance_m;
    hammer_.segment = segment_index(felt_, hammer_.compression_m);
    hammer_.velocity_m_per_s = velocity_m_per_s;
    is_thrown_ = is_flying_ = true;
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const HammerStringControls<T>& controls) {
    const T damping = controls.damping_per_s * time_step_;
    if (!is_flying_) {
      hammer_.force_n = 0;
      return string_.advance(damping);
    }
    take(controls);
    string_.predict(damping);
    meet(1 / (1 + damping));
    string_.commit();
  }

  /// Advances out.size() samples and writes the displacement at a place [m] after each, and the contact forces [N] to
  /// `forces` where that is not null: what as many tick() do, but many times as fast where ContactSpline::simd is
  /// linked. Safe in an audio thread.
  void play(const HammerStringControls<T>& controls, const ModeShapes<T>& pickup, std::span<T> out,
            T* forces = nullptr) {
#ifdef CONTACTSPLINE_SIMD
    if (out.empty()) return;
    const T share = 1 / (1 + controls.damping_per_s * time_step_);
    if (is_flying_) {
      take(controls);
      const std::size_t samples =
          detail::play_struck(string_.arrays(), tables_.arrays(strike_), SegmentTable<T>(felt_), time_step_, share,
                              string_admittance_, hammer_, pickup.data(), out, forces);
      is_flying_ = hammer_.compression_m > detail::kCaught_m<T>;
      out = out.subspan(samples);
      if (forces != nullptr) forces += samples;
    }
    if (out.empty()) return;
    hammer_.force_n = 0;
    if (forces != nullptr) std::fill_n(forces, out.size(), T(0));
    detail::play_free(string_.arrays(), share, pickup.data(), out);
#else
    for (T& sample : out) {
      tick(controls);
      sample = string_.displacement(pickup);
      if (forces != nullptr) *forces++ = force();
    }
#endif
  }

  [[nodiscard]] T force() const {
    return hammer_.force_n;
  }  ///< contact force over the last sample [N]
  [[nodiscard]] T compression() const {
    return hammer_.compression_m;
  }  ///< of the felt [m], negative while apart
  [[nodiscard]] T hammer_velocity() const {
    return hammer_.velocity_m_per_s;
  }  ///< towards the string [m/s]
  [[nodiscard]] bool is_hammer_flying() const {
    return is_flying_;
  }  ///< from its throw until it is caught
  [[nodiscard]] const ModalBank<T>& string() const {
    return string_;
  }

 private:
  void take(const HammerStringControls<T>& controls) {
    if (!std::exchange(is_thrown_, false)) return;
    hammer_.mass_kg = controls.hammer_mass_kg;
    hammer_.felt = controls.felt;
  }

  void meet(T share) {
    const T give = time_step_ / hammer_.mass_kg;
    const T free_increment = time_step_ * hammer_.velocity_m_per_s - string_.increment(strike_);
    const T admittance = time_step_ * give / 2 + share * string_admittance_;
    const Approach<T> approach{hammer_.compression_m, free_increment, admittance};
    const auto step = contact_step(felt_, hammer_.felt, time_step_, approach, hammer_.segment);
    string_.push(strike_, share * step.force);
    hammer_.force_n = step.force;
    hammer_.compression_m = step.compression;
    hammer_.segment = step.segment;
    hammer_.velocity_m_per_s -= give * step.force;
    is_flying_ = hammer_.compression_m > detail::kCaught_m<T>;
  }

  SegmentTable<T, Extent> felt_;
  ModalBank<T> string_;
  ModeShapes<T> strike_, next_strike_;
  detail::StrikeTables<T> tables_;
  T time_step_;
  T string_admittance_ = 0;
  detail::HammerFlight<T> hammer_;
  bool has_moved_ = true;   // the place of the strike, since the last throw
  bool is_thrown_ = false;  // by strike(); the next sample takes the hammer's controls
  bool is_flying_ = false;
};

}  // namespace contactspline
