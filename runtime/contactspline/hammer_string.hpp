// SPDX-License-Identifier: MIT
// A felt hammer thrown at a string, or at any other modal resonator.
#pragma once

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

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

/// The arrays behind FeltArrays.
template <std::floating_point T>
class FeltTables {
 public:
  explicit FeltTables(SegmentTable<T> felt)
      : felt_(felt.begin(), felt.end()),
        segments_(felt.size() - 1),
        blocks_((segments_ + kKnotsInABlock - 1) / kKnotsInABlock),
        knots_(kBefore + blocks_ * kKnotsInABlock + kLine),
        energies_(knots_.size()),
        forces_(knots_.size()),
        half_curvatures_(knots_.size()),
        pivots_((blocks_ + kKnotsInABlock - 1) / kKnotsInABlock * kKnotsInABlock),
        pivot_energies_(pivots_.size()),
        gives_(knots_.size()),
        stiffnesses_(knots_.size()),
        inverse_slopes_(knots_.size()) {
    fill();
  }

  /// Takes what has become of the felt since: no work where nothing has.
  void follow(SegmentTable<T> felt) {
    if (std::memcmp(felt_.data(), felt.data(), felt.size_bytes()) == 0) return;
    std::ranges::copy(felt, felt_.begin());
    fill();
  }

  [[nodiscard]] FeltArrays<T> arrays() {
    return {segments_,
            knots_.data() + kEntry0,
            energies_.data() + kEntry0,
            forces_.data() + kEntry0,
            half_curvatures_.data() + kEntry0,
            pivots_.data(),
            pivot_energies_.data(),
            blocks_,
            &prepared_xi_,
            gives_.data() + kEntry0,
            stiffnesses_.data() + kEntry0,
            inverse_slopes_.data() + kEntry0};
  }

 private:
  static constexpr std::size_t kLine = ModalArray<T>::kLine;
  // The kernels read entries -1, of the segment below knot 0, to N + kKnotsInAWindow - 1.
  static constexpr std::size_t kBefore = kLine;
  static_assert(kLine >= kKnotsInAWindow<T>);
  static constexpr std::size_t kEntry0 = kBefore - 1;

  void fill() {
    prepared_xi_ = -1;
    for (std::size_t i = 0; i < knots_.size(); ++i) knots_[i] = i < kBefore ? -kOutOfReach_m<T> : kOutOfReach_m<T>;
    for (std::size_t i = 0; i < pivots_.size(); ++i) pivots_[i] = kOutOfReach_m<T>;
    for (std::size_t k = 1; k <= segments_; ++k) {
      knots_[kEntry0 + k] = felt_[k].knot;
      energies_[kEntry0 + k] = felt_[k].energy;
      forces_[kEntry0 + k] = felt_[k].force;
      half_curvatures_[kEntry0 + k] = felt_[k].half_curvature;
    }
    for (std::size_t block = 0; block < blocks_; ++block) {
      pivots_[block] = knots_[kEntry0 + 1 + block * kKnotsInABlock];
      pivot_energies_[block] = energies_[kEntry0 + 1 + block * kKnotsInABlock];
    }
  }

  std::vector<Segment<T>> felt_;
  std::size_t segments_, blocks_;
  ModalArray<T> knots_, energies_, forces_, half_curvatures_, pivots_, pivot_energies_;
  T prepared_xi_ = -1;
  ModalArray<T> gives_, stiffnesses_, inverse_slopes_;
};

/// The arrays behind StrikeArrays.
template <std::floating_point T>
class StrikeTables {
 public:
  StrikeTables(SegmentTable<T> felt, std::size_t modes)
      : felt_(felt),
        give_(modes),
        free_give_(modes),
        swing_(modes),
        unit_(modes),
        per_unit_(modes),
        workspace_(kStruckLines * (modes + ModalArray<T>::kLine)) {}

  /// For the next throw, at a place of these shapes.
  void strike_at(ModalBank<T>& string, const ModeShapes<T>& shapes) {
    string.respond(shapes, give_, free_give_, swing_);
    free_admittance_ = 0;
    const ModalArrays<T> modes = string.arrays();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      free_admittance_ += shapes[i] * free_give_[i];
      unit_[i] = std::abs(give_[i]) > kLeastUnit ? give_[i] : kLeastUnit;
      per_unit_[i] = 1 / unit_[i];
      set(i, StruckRow::free_give, free_give_[i] * per_unit_[i]);
      set(i, StruckRow::stiffness, modes.stiffness[i]);
      set(i, StruckRow::rest, modes.stiffness_rest[i]);
      set(i, StruckRow::loss, modes.loss[i] + modes.stiffness_rest[i]);
      set(i, StruckRow::shape, shapes[i] * unit_[i]);
    }
  }

  /// As FeltTables.
  void follow(SegmentTable<T> felt) { felt_.follow(felt); }

  [[nodiscard]] StrikeArrays<T> arrays(const ModeShapes<T>& shapes) {
    return {shapes.data(), give_.data(),     free_give_.data(), free_admittance_, swing_.data(),
            unit_.data(),  per_unit_.data(), felt_.arrays(),    workspace_.data()};
  }

 private:
  // Of a mode that the force does not move: so small that what the force adds is nothing, and still a divisor [m/N].
  static constexpr T kLeastUnit = 10000 * std::numeric_limits<T>::min();

  void set(std::size_t mode, std::size_t row, T value) {
    constexpr std::size_t kLine = ModalArray<T>::kLine;
    workspace_[(mode / kLine * kStruckLines + row) * kLine + mode % kLine] = value;
  }

  FeltTables<T> felt_;
  ModalArray<T> give_, free_give_, swing_, unit_, per_unit_;
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

  /// Throws the hammer at the string, from a distance [m] of 0 to 0.05, with a velocity [m/s]; the string may be
  /// sounding. From further away it is caught at once.
  void strike(T velocity_m_per_s, T distance_m) {
    if (std::exchange(has_moved_, false)) {
      strike_ = next_strike_;
      string_admittance_ = string_.admittance(strike_, strike_);
      tables_.strike_at(string_, strike_);
    }
    hammer_.compression_m = -distance_m;
    hammer_.segment = segment_index(felt_, hammer_.compression_m);
    hammer_.velocity_m_per_s = velocity_m_per_s;
    std::ranges::fill(hammer_.moved, 0);
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
      tables_.follow(felt_);
      const detail::Strike<T> strike{
          string_.arrays(), tables_.arrays(strike_), felt_, time_step_, share, string_admittance_, pickup.data()};
      const std::size_t samples = detail::play_struck(strike, hammer_, out, forces);
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
