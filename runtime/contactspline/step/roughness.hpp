// SPDX-License-Identifier: MIT
// A rough surface: its height along the way that something slides on it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <concepts>
#include <cstdint>
#include <numbers>

namespace contactspline {

/// How rough a surface is. A speed v along it makes frequencies up to about v/length_m.
struct Roughness {
  double height_m = 0;       ///< >= 0: heights lie between -height_m and height_m; 0: smooth
  double length_m = 1e-3;    ///< > 0, of the wave if it is periodic, as windings are; of the shortest waves if not
  bool is_periodic = false;  ///< else random
};

/// The height of a rough surface along the way over it. Where the way begins it is 0. Random heights are those of
/// nodes at half a length from each other, and between them 3 u^2 - 2 u^3: no step, no bend, no node overshot.
template <std::floating_point T>
class RoughSurface {
 public:
  /// Smooth.
  constexpr RoughSurface() = default;
  /// number: surfaces with different numbers have other random heights.
  RoughSurface(const Roughness& roughness, std::uint32_t number)
      : height_m_(static_cast<T>(roughness.height_m)),
        nodes_per_m_((roughness.is_periodic ? 1 : 2) / roughness.length_m),
        is_periodic_(roughness.is_periodic),
        number_(number) {}

  [[nodiscard]] bool is_rough() const { return height_m_ > 0; }

  /// Goes a way along the surface, either direction [m].
  void go(T way_m) {
    part_ += double(way_m) * nodes_per_m_;
    const double whole = std::floor(part_);
    part_ -= whole;
    node_ += static_cast<std::uint32_t>(static_cast<std::int64_t>(whole));
  }
  void reset() { node_ = 0, part_ = 0; }

  /// Here [m].
  [[nodiscard]] T height() const {
    const T part = static_cast<T>(part_);
    if (is_periodic_) return height_m_ * std::sin(2 * std::numbers::pi_v<T> * part);
    const T from = at(node_), to = at(node_ + 1);
    return height_m_ * (from + (to - from) * part * part * (3 - 2 * part));
  }

 private:
  // -1 to 1. The multipliers of a hash of 32 bits are arbitrary, odd and large.
  [[nodiscard]] T at(std::uint32_t node) const {
    if (node == 0) return 0;
    std::uint32_t bits = node * 0xc2c063ffU ^ (number_ + 1) * 0x958507adU;
    bits = (bits ^ (bits >> 16)) * 0xf768064fU;
    bits = (bits ^ (bits >> 16)) * 0x55113dc3U;
    return T((bits ^ (bits >> 16)) >> 8) / T(1 << 23) - 1;
  }

  T height_m_ = 0;
  double nodes_per_m_ = 1;
  bool is_periodic_ = false;
  std::uint32_t number_ = 0, node_ = 0;
  double part_ = 0;  // of the way from this node to the next one, 0 to 1; slow ways are small beside it
};

}  // namespace contactspline
