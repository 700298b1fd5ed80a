// SPDX-License-Identifier: MIT
// The outputs of instruments of one resonator and one contact.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <span>

#include "contactspline/data/string_parts.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/modal/modal.hpp"

namespace contactspline::detail {

/// Reads them from a bank of modes.
template <std::floating_point T>
class StringOutputs : public StringOutput {
 public:
  StringOutputs() = default;
  StringOutputs(const ResonatorParts& parts, const ModalBank<T>& string)
      : pickup_(string.sound_pickup(ModeShapes<T>(std::span<const double>(parts.pickup)))) {
    if (!parts.bridge.empty()) bridge_ = string.sound_pickup(ModeShapes<T>(std::span<const double>(parts.bridge)));
  }

  [[nodiscard]] const ModeShapes<T>& pickup() const { return pickup_; }
  [[nodiscard]] const ModeShapes<T>& bridge() const { return bridge_; }

  /// Writes sample n of the outputs that are asked for.
  void write(Outputs<T> outputs, std::size_t n, const ModalBank<T>& string, T force_n) const {
    for (std::size_t o = 0; o < outputs.size(); ++o)
      if (!outputs[o].empty()) outputs[o][n] = value(o, string, force_n);
  }

 private:
  [[nodiscard]] T value(std::size_t output, const ModalBank<T>& string, T force_n) const {
    switch (output) {
      case kDisplacement:
        return string.displacement(pickup_);
      case kVelocity:
        return string.velocity(pickup_);
      case kForce:
        return force_n;
      default:
        return string.displacement(bridge_);
    }
  }

  ModeShapes<T> pickup_, bridge_;
};

/// Length of a block: that of the first array that is not empty.
template <std::floating_point T>
[[nodiscard]] std::size_t block_length(Outputs<T> outputs, std::span<const T> force) {
  for (const std::span<T> output : outputs)
    if (!output.empty()) return output.size();
  return force.size();
}

/// The part of a block from a sample on.
template <std::floating_point T>
[[nodiscard]] std::span<T> part_of(std::span<T> block, std::size_t begin, std::size_t samples) {
  return block.empty() ? block : block.subspan(begin, samples);
}

}  // namespace contactspline::detail
