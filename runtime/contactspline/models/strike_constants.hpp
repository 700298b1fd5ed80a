// SPDX-License-Identifier: MIT
// The arrays behind the kernels' ContactTable and StrikeConstants.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/simd/kernels.hpp"

namespace contactspline::detail {

/// The arrays of a ContactTable.
template <std::floating_point T>
class ContactTableStorage {
 public:
  explicit ContactTableStorage(SegmentTable<T> table)
      : segments_(table.size() - 1),
        blocks_((segments_ + kKnotsPerBlock - 1) / kKnotsPerBlock),
        rows_(kEntry0 + table.size() + kBefore),
        knots_(kBefore + blocks_ * kKnotsPerBlock + kBefore),
        energies_(knots_.size()),
        forces_(knots_.size()),
        half_curvatures_(knots_.size()),
        block_first_knots_((blocks_ + kKnotsPerBlock - 1) / kKnotsPerBlock * kKnotsPerBlock),
        block_first_energies_(block_first_knots_.size()),
        force_displacements_(knots_.size()),
        stiffnesses_(knots_.size()),
        inverse_slopes_(knots_.size()) {
    fill(table);
  }

  /// Copies the table again if it has changed.
  void follow(SegmentTable<T> table) {
    const auto segments = table.subspan(1);
    if (std::memcmp(&rows_[kEntry0 + 1], segments.data(), segments.size_bytes()) != 0) fill(table);
  }

  [[nodiscard]] ContactTable<T> view() {
    return {segments_,
            knots_.data() + kEntry0,
            energies_.data() + kEntry0,
            forces_.data() + kEntry0,
            half_curvatures_.data() + kEntry0,
            block_first_knots_.data(),
            block_first_energies_.data(),
            blocks_,
            &rows_[kEntry0],
            &prepared_xi_,
            force_displacements_.data() + kEntry0,
            stiffnesses_.data() + kEntry0,
            inverse_slopes_.data() + kEntry0};
  }

 private:
  static constexpr std::size_t kLine = kLineSize<T>;
  // Sentinels on both sides. The kernels read entries -kKnotsAhead to N + kKnotsAhead + 2.
  static constexpr std::size_t kBefore = 32;
  static_assert(kBefore % kLine == 0 && kBefore > kKnotsAhead + 2 && kBefore > kKnotsPerWindow<T>);
  static constexpr std::size_t kEntry0 = kBefore - 1;

  void fill(SegmentTable<T> table) {
    prepared_xi_ = -1;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      rows_[i] = {i <= kEntry0 ? -kSentinelKnot<T> : kSentinelKnot<T>, 0, 0, 0};
    std::copy(table.begin() + 1, table.end(), rows_.begin() + kEntry0 + 1);
    for (std::size_t i = 0; i < knots_.size(); ++i) knots_[i] = i < kBefore ? -kSentinelKnot<T> : kSentinelKnot<T>;
    for (std::size_t i = 0; i < block_first_knots_.size(); ++i) block_first_knots_[i] = kSentinelKnot<T>;
    for (std::size_t k = 1; k <= segments_; ++k) {
      knots_[kEntry0 + k] = table[k].knot;
      energies_[kEntry0 + k] = table[k].energy;
      forces_[kEntry0 + k] = table[k].force;
      half_curvatures_[kEntry0 + k] = table[k].half_curvature;
    }
    for (std::size_t block = 0; block < blocks_; ++block) {
      block_first_knots_[block] = knots_[kEntry0 + 1 + block * kKnotsPerBlock];
      block_first_energies_[block] = energies_[kEntry0 + 1 + block * kKnotsPerBlock];
    }
  }

  std::size_t segments_, blocks_;
  std::vector<Segment<T>> rows_;
  ModalArray<T> knots_, energies_, forces_, half_curvatures_, block_first_knots_, block_first_energies_;
  T prepared_xi_ = -1;
  ModalArray<T> force_displacements_, stiffnesses_, inverse_slopes_;
};

/// The arrays of StrikeConstants.
template <std::floating_point T>
class StrikeConstantsStorage {
 public:
  StrikeConstantsStorage(SegmentTable<T> table, std::size_t modes)
      : table_(table),
        receptance_(modes),
        free_increment_gain_(modes),
        amplitude_gain_(modes),
        unit_(modes),
        per_unit_(modes),
        workspace_(kRowsPerLine * (modes + kLineSize<T>)) {}

  /// Prepares for a strike at the place of these shapes.
  void strike_at(ModalBank<T>& string, const ModeShapes<T>& shapes) {
    string.respond(shapes, receptance_, free_increment_gain_, amplitude_gain_);
    receptance_of_string_ = string.receptance(shapes, shapes);
    free_receptance_ = 0;
    const ModalArrays<T> modes = string.arrays();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      free_receptance_ += shapes[i] * free_increment_gain_[i];
      unit_[i] = std::abs(receptance_[i]) > kMinUnit ? receptance_[i] : kMinUnit;
      per_unit_[i] = 1 / unit_[i];
      set(i, ModeRow::free_increment_gain, free_increment_gain_[i] * per_unit_[i]);
      set(i, ModeRow::stiffness, modes.stiffness[i]);
      set(i, ModeRow::rest, modes.stiffness_rest[i]);
      set(i, ModeRow::loss, modes.loss[i] + modes.stiffness_rest[i]);
      set(i, ModeRow::shape, shapes[i] * unit_[i]);
    }
  }

  /// Copies the contact table again if it has changed.
  void follow(SegmentTable<T> table) { table_.follow(table); }

  [[nodiscard]] T receptance_of_string() const { return receptance_of_string_; }

  /// For one call of a kernel. Everything passed must outlive it.
  [[nodiscard]] StrikeConstants<T> view(const ModalArrays<T>& modes, SegmentTable<T> segments,
                                        const ModeShapes<T>& shapes, T time_step_s, T damping_gain,
                                        const ModeShapes<T>& pickup) {
    return {.modes = modes,
            .table = table_.view(),
            .segments = segments,
            .shape = shapes.data(),
            .receptance = receptance_.data(),
            .free_increment_gain = free_increment_gain_.data(),
            .amplitude_gain = amplitude_gain_.data(),
            .unit = unit_.data(),
            .per_unit = per_unit_.data(),
            .receptance_of_string = receptance_of_string_,
            .free_receptance = free_receptance_,
            .workspace = workspace_.data(),
            .time_step_s = time_step_s,
            .damping_gain = damping_gain,
            .pickup = pickup.data()};
  }

 private:
  // Unit of a mode that the force does not move [m/N]: the force adds practically nothing, and 1/unit is finite.
  static constexpr T kMinUnit = 10000 * (std::numeric_limits<T>::min)();

  void set(std::size_t mode, std::size_t row, T value) {
    constexpr std::size_t kLine = kLineSize<T>;
    workspace_[(mode / kLine * kRowsPerLine + row) * kLine + mode % kLine] = value;
  }

  ContactTableStorage<T> table_;
  ModalArray<T> receptance_, free_increment_gain_, amplitude_gain_, unit_, per_unit_;
  ModalArray<T> workspace_;
  T receptance_of_string_ = 0, free_receptance_ = 0;
};

/// What remains of StrikeConstantsStorage for a model that plays without the kernels.
template <std::floating_point T, std::size_t Modes>
class StrikeReceptance {
 public:
  constexpr StrikeReceptance(SegmentTable<T>, std::size_t) {}

  void strike_at(const ModalBank<T, Modes>& string, const ModeShapes<T, Modes>& shapes) {
    receptance_of_string_ = string.receptance(shapes, shapes);
  }
  [[nodiscard]] T receptance_of_string() const { return receptance_of_string_; }

 private:
  T receptance_of_string_ = 0;
};

}  // namespace contactspline::detail
