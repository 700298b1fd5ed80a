// SPDX-License-Identifier: MIT
// Two updates for OneStepHammerString on one piecewise quadratic potential: the contact step of the runtime, and a
// reconstruction of the update that the DAFx-24 paper proposes.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "contactspline/step/contact.hpp"

namespace contactspline::bench {

/// contact_step of the runtime, which a flight need not ask.
template <std::floating_point T>
class ContactStepUpdate {
 public:
  explicit ContactStepUpdate(std::vector<Segment<T>> table) : table_(std::move(table)) {}

  void begin(T compression, T) { segment_ = segment_index(SegmentTable<T>(table_), compression); }
  [[nodiscard]] ContactStep<T> meet(const Approach<T>& approach) {
    const T free = approach.compression + approach.free_increment;
    if (segment_ == 0 && free <= 0) return {0, free, 0};
    const auto step = contact_step(SegmentTable<T>(table_), approach, segment_);
    segment_ = step.segment;
    return step;
  }

 private:
  std::vector<Segment<T>> table_;
  std::size_t segment_ = 0;
};

/// One segment of the potential, V(y) = (a y + b) y + c: eq. (8) of the derivation, in powers of y itself.
template <std::floating_point T>
struct RegularSegment {
  T knot, a, b, c;
};

/// A reconstruction, since the abstract and the derivation of the coefficients are at hand, and the paper is not
/// (Bhanuprakash, van Walstijn and Chatziioannou, DAFx-24): the discrete gradient of the potential in its regular
/// coefficients turns the contact step into a quadratic of the increment x for each segment in which the step may
/// end,
///
///     (1 + xi a) x^2 + (xi (2 a y0 + b) - xf) x + xi (V(y0) in that segment's coefficients - V(y0)) = 0.
///
/// The textbook formula gives its root in the direction of motion, from segment to segment, until the root is in the
/// segment. Entry 0 is "out of contact", all zero.
template <std::floating_point T>
class RegularQuadraticUpdate {
 public:
  explicit RegularQuadraticUpdate(std::vector<RegularSegment<T>> segments) : segments_(std::move(segments)) {}

  void begin(T compression, T) {
    segment_ = 0;
    while (segment_ + 1 < segments_.size() && segments_[segment_ + 1].knot <= compression) ++segment_;
  }

  [[nodiscard]] ContactStep<T> meet(const Approach<T>& approach) {
    const auto [y0, xf, xi] = approach;
    if (segment_ == 0 && y0 + xf <= 0) return {0, y0 + xf, 0};
    const RegularSegment<T>& first = segments_[segment_];
    const T stored = (first.a * y0 + first.b) * y0 + first.c;
    const bool up = xf > xi * (2 * first.a * y0 + first.b);
    for (;;) {
      const RegularSegment<T>& s = segments_[segment_];
      const T a = 1 + xi * s.a, b = xi * (2 * s.a * y0 + s.b) - xf;
      const T c = xi * ((s.a * y0 + s.b) * y0 + s.c - stored);
      const T root = std::sqrt(std::max(T(0), b * b - 4 * a * c));
      const T x = (up ? root - b : -root - b) / (2 * a);
      if (up && segment_ + 1 < segments_.size() && y0 + x >= segments_[segment_ + 1].knot) {
        ++segment_;
      } else if (!up && segment_ > 0 && y0 + x < s.knot) {
        --segment_;
      } else {
        return {(xf - x) / xi, y0 + x, segment_};
      }
    }
  }

 private:
  std::vector<RegularSegment<T>> segments_;
  std::size_t segment_ = 0;
};

}  // namespace contactspline::bench
