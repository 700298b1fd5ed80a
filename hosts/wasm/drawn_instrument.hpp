// SPDX-License-Identifier: MIT
// What the bodies of an instrument look like: on its way from the generator's module, which knows their shapes, to
// the one that draws them, behind the instrument itself.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "hosts/wasm/packed_instrument.hpp"

namespace contactspline::web {

/// kTine: a bar with a clamped end.
enum class DrawnKind : int { kNothing, kMass, kString, kBar, kTine, kMembrane, kPlate, kFreePlate };

/// How many of its points are drawn.
struct DrawnBody {
  DrawnKind kind;
  std::size_t points;
};

/// The points of a string and of a bar from end to end.
inline constexpr std::size_t kStringPoints = 97, kBarPoints = 33;

/// Those of a disc: the middle, then so many rings of equal distance, within a fixed rim or up to a free one, each
/// with so many points from the angle 0 to pi. Below is the same: all shapes are even.
inline constexpr std::size_t kRings = 7, kRingPoints = 13;

/// Stands for a place on a body that has no length.
inline constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

struct DrawnInstrument {
  std::span<const DrawnBody> bodies;
  std::span<const double> shapes;  ///< of all points of all bodies: one for each mode of the body
  std::span<const double> places;  ///< of InstrumentData: part of the length or of a disc's diameter, or kNowhere
};

[[nodiscard]] inline Bytes packed(DrawnInstrument drawn) {
  packing::Packer packer;
  packing::take_all(packer, drawn.bodies, drawn.shapes, drawn.places);
  return std::move(packer).bytes();
}

/// What packed() has written: views of these bytes, which begin at a multiple of packing::kAlignment.
[[nodiscard]] inline DrawnInstrument unpacked_drawn(std::byte* bytes) {
  DrawnInstrument drawn;
  packing::Unpacker unpacker(bytes);
  packing::take_all(unpacker, drawn.bodies, drawn.shapes, drawn.places);
  return drawn;
}

}  // namespace contactspline::web
