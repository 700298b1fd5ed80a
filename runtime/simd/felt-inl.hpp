// SPDX-License-Identifier: MIT
// The felt of a hammer in vectors: one sample of a contact for each instruction set (docs/kernels.md).
#if defined(CONTACTSPLINE_FELT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CONTACTSPLINE_FELT_INL
#undef CONTACTSPLINE_FELT_INL
#else
#define CONTACTSPLINE_FELT_INL
#endif

#include <hwy/highway.h>

#include "contactspline/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace contactspline::detail {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// A felt under load. Where it stands is kept as the way beyond a knot at one end of its segment, the origin of all
/// ways below.
template <typename T>
class Felt {
 public:
  HWY_INLINE Felt(const FeltArrays<T>& arrays, T compression, std::size_t segment) : felt_(arrays) {
    put(compression, segment);
  }

  /// Makes ready for an admittance, if it is not the last one.
  static HWY_INLINE void prepare(const FeltArrays<T>& felt, T xi) {
    if (*felt.admittance == xi) return;
    *felt.admittance = xi;
    for (std::size_t k = 0; k <= felt.segments; ++k) {
      const T stiffness = xi * felt.half_curvatures[k];
      felt.gives[k] = xi * felt.forces[k];
      felt.stiffnesses[k] = 2 * stiffness;
      felt.weights[k] = T(0.5) / (xi * (1 + stiffness));
    }
  }

  [[nodiscard]] HWY_INLINE T compression() const { return felt_.knots[entry_] + beyond_; }
  [[nodiscard]] HWY_INLINE std::size_t segment() const { return static_cast<std::size_t>(segment_); }
  /// Elastic force at this compression [N].
  [[nodiscard]] HWY_INLINE T force() const {
    return felt_.forces[entry_] + 2 * felt_.half_curvatures[segment_] * beyond_;
  }

  /// Moves to a compression [m] in a segment.
  HWY_INLINE void put(T compression, std::size_t segment) {
    segment_ = static_cast<Knot>(segment);
    entry_ = std::max<Knot>(segment_, 1);
    beyond_ = compression - felt_.knots[entry_];
  }

  /// contact_step without loss, its force [N] rounded to either side of 0: moves by x = xf - xi f. One way for all
  /// steps, within a segment and across knots, without a branch that depends on the data but for steps far away.
  /// kVaries: is the admittance xi another one than at prepare()?
  template <bool kVaries>
  HWY_INLINE T press(T xf, T xi) {
    if (segment_ == 0 && beyond_ + xf < 0) {  // apart, as for most of the time
      beyond_ += xf;
      return 0;
    }
    Steps steps;
    const Knot below = look_around<kVaries>(xf, xi, steps);
    Knot moved = below - kFar;
    if (HWY_UNLIKELY((below == 0) | (below == 2 * kFar))) {
      moved = search(below > 0, xf, xi) - segment_;
      return far_step(moved, xf, xi);
    }
    // Way and force are roots of two quadratics of one discriminant (docs/contact-step.md).
    const std::size_t i = static_cast<std::size_t>(below);
    const T sign = kSigns[i], w = weight<kVaries>(segment_ + moved, xi);
    const T root = hn::GetLane(hn::Sqrt(hn::Set(One(), steps.square[i])));
    const T p = steps.p[i], b = steps.b[i], p_and_root = root + std::abs(p), b_and_root = root + std::abs(b);
    const T crossing = choose_if_positive(p, 2 * steps.q[i] / p_and_root, p_and_root * w);
    const T way = sign * choose_if_positive(b, -2 * steps.g[i] / b_and_root, b_and_root * (w * xi));
    segment_ += moved;
    const Knot entry = segment_ + ((moved < 0) | (segment_ == 0));
    const T rebased = beyond_ - (felt_.knots[entry] - felt_.knots[entry_]);
    entry_ = entry;
    const hn::RebindToSigned<One> whole;
    const auto stays = hn::RebindMask(
        One(), hn::Eq(hn::Set(whole, static_cast<hn::TFromD<decltype(whole)>>(moved)), hn::Zero(whole)));
    beyond_ = choose(stays, rebased + steps.within_way, way);
    return choose(stays, steps.within_force, crossing);
  }

 private:
  using Knot = std::ptrdiff_t;  // numbered as in FeltArrays
  using One = hn::CappedTag<T, 1>;
  static constexpr std::size_t kReach = kKnotsInReach;
  static constexpr Knot kFar = kReach;

  static HWY_INLINE T choose(hn::Mask<One> condition, T if_true, T if_false) {
    return hn::GetLane(hn::IfThenElse(condition, hn::Set(One(), if_true), hn::Set(One(), if_false)));
  }
  static HWY_INLINE T choose_if_positive(T test, T if_positive, T otherwise) {
    return choose(hn::Gt(hn::Set(One(), test), hn::Zero(One())), if_positive, otherwise);
  }

  /// Quadratics of way and force by the number of knots around that the root lies above, and the step within the
  /// segment.
  struct Steps {
    HWY_ALIGN T square[2 * kReach + 1];
    HWY_ALIGN T b[2 * kReach + 1];
    HWY_ALIGN T g[2 * kReach + 1];
    HWY_ALIGN T p[2 * kReach + 1];
    HWY_ALIGN T q[2 * kReach + 1];
    T within_force, within_way;
  };
  /// Of the motion: -1 downwards, 1 upwards.
  static_assert(kReach == 8);
  static constexpr T kSigns[2 * kReach + 1] = {-1, -1, -1, -1, -1, -1, -1, -1, 0, 1, 1, 1, 1, 1, 1, 1, 1};

  /// Stores lanes at to[at] and on, skipping to[kReach].
  template <typename Lanes, typename D>
  static HWY_INLINE void store(Lanes values, D tag, std::size_t at, T* to) {
    hn::StoreU(values, tag, to + at + (at + hn::Lanes(tag) > kReach));
    if constexpr (hn::MaxLanes(tag) > kReach) {
      const hn::Half<D> half;
      hn::StoreU(hn::LowerHalf(half, values), half, to);
    }
  }

  /// 1/(2 xi (1 + xi c)) in a segment [N/m].
  template <bool kVaries>
  [[nodiscard]] HWY_INLINE T weight(Knot segment, T xi) const {
    return kVaries ? T(0.5) / (xi * (1 + xi * felt_.half_curvatures[segment])) : felt_.weights[segment];
  }

  /// Of the kReach knots below and as many above, how many the root lies above, and the step of each such number. The
  /// two nearest are judged by h, the others by g = u h (docs/contact-step.md). Gains of energy are areas up to the
  /// nearest knot and differences of the table from there: nothing cancels.
  template <bool kVaries>
  HWY_INLINE Knot look_around(T xf, T xi, Steps& steps) const {
    const hn::CappedTag<T, 2 * kReach> tag;
    const std::size_t lanes = hn::Lanes(tag);
    const T c = felt_.half_curvatures[segment_], origin = felt_.knots[entry_], now = force();
    const T below = (felt_.knots[segment_] - origin) - beyond_,
            above = (felt_.knots[segment_ + 1] - origin) - beyond_;
    const T mean_below = (now + felt_.forces[segment_]) / 2, mean_above = (now + felt_.forces[segment_ + 1]) / 2;
    const auto past_below = hn::Set(tag, (xf - below) - xi * mean_below);
    const auto past_above = hn::Set(tag, (above - xf) + xi * mean_above);
    const auto origins = hn::Set(tag, origin), beyonds = hn::Set(tag, beyond_), xfs = hn::Set(tag, xf),
               xis = hn::Set(tag, xi);
    const auto two = hn::Set(tag, T(2)), four = hn::Set(tag, T(4));
    std::size_t count = 0;
    for (std::size_t v = 0; v < 2 * kReach; v += lanes) {
      const Knot at = segment_ - kFar + 1 + static_cast<Knot>(v);
      const auto first = [&](std::size_t n) HWY_ATTR { return hn::FirstN(tag, n > v ? n - v : 0); };
      const auto of_landing = [&](const T* column) HWY_ATTR {
        if (v + lanes <= kReach) return hn::LoadU(tag, column + at - 1);
        if (v >= kReach) return hn::LoadU(tag, column + at);
        return hn::IfThenElse(first(kReach), hn::LoadU(tag, column + at - 1), hn::LoadU(tag, column + at));
      };
      const auto of_direction = [&](T downwards, T upwards) HWY_ATTR {
        if (v + lanes <= kReach) return hn::Set(tag, downwards);
        if (v >= kReach) return hn::Set(tag, upwards);
        return hn::IfThenElse(first(kReach), hn::Set(tag, downwards), hn::Set(tag, upwards));
      };
      const auto force = hn::LoadU(tag, felt_.forces + at);
      const auto gives = kVaries ? hn::Mul(xis, force) : hn::LoadU(tag, felt_.gives + at);
      const auto stiffness =
          kVaries ? hn::Mul(hn::Add(xis, xis), of_landing(felt_.half_curvatures)) : of_landing(felt_.stiffnesses);
      const auto curvature = of_landing(felt_.half_curvatures);
      const auto way = hn::Sub(hn::Sub(hn::LoadU(tag, felt_.knots + at), origins), beyonds);
      const auto further = hn::Sub(hn::LoadU(tag, felt_.energies + at),
                                   of_direction(felt_.energies[segment_], felt_.energies[segment_ + 1]));
      const auto gain = hn::Add(further, of_direction(below * mean_below, above * mean_above));
      const auto free = hn::Sub(xfs, way);
      const auto g = hn::NegMulAdd(way, free, hn::Mul(xis, gain));
      auto test = g;
      if (v < kReach && v + lanes >= kReach)
        test = hn::IfThenElse(hn::AndNot(first(kReach - 1), first(kReach)), past_below, test);
      if (v <= kReach && v + lanes > kReach)
        test = hn::IfThenElse(hn::AndNot(first(kReach), first(kReach + 1)), past_above, test);
      count += hn::CountTrue(tag, hn::Xor(first(kReach), hn::Lt(test, hn::Zero(tag))));  // what is no number stays

      const auto b = hn::Add(hn::Sub(way, free), gives);
      const auto four_a = hn::MulAdd(two, stiffness, four);
      store(hn::Abs(hn::NegMulAdd(four_a, g, hn::Mul(b, b))), tag, v, steps.square);
      const auto signs = of_direction(T(-1), T(1));
      store(hn::Mul(signs, b), tag, v, steps.b);
      store(g, tag, v, steps.g);
      store(hn::Mul(signs, hn::Add(hn::MulAdd(stiffness, free, gives), xfs)), tag, v, steps.p);
      store(hn::Mul(signs, hn::MulAdd(free, hn::MulAdd(curvature, free, force), gain)), tag, v, steps.q);
    }
    const T inverse_slope = 2 * xi * weight<kVaries>(segment_, xi);
    steps.within_way = (xf - xi * now) * inverse_slope;
    steps.within_force = (now + c * xf) * inverse_slope;
    return static_cast<Knot>(count);
  }

  /// One step to a landing anywhere.
  HWY_INLINE T far_step(Knot moved, T xf, T xi) {
    const bool up = moved > 0;
    const T near = (felt_.knots[segment_ + up] - felt_.knots[entry_]) - beyond_;
    const T gain_near = near * (force() + felt_.forces[segment_ + up]) / 2;
    const T energy_near = felt_.energies[segment_ + up];
    const Knot landing = segment_ + moved, entry = landing + !up;
    const T way = (felt_.knots[entry] - felt_.knots[entry_]) - beyond_, free = xf - way;
    const T gain = (felt_.energies[entry] - energy_near) + gain_near, entry_force = felt_.forces[entry];
    const T c = felt_.half_curvatures[landing], a = 1 + xi * c, sign = T(2 * up - 1);
    const T b = sign * (way - free + xi * entry_force), g = xi * gain - way * free;
    const T p = sign * (xf + xi * entry_force + 2 * c * xi * free),
            q = sign * (gain + free * (entry_force + c * free));
    const T root = std::sqrt(std::abs(b * b - 4 * a * g));
    const T b_and_root = root + std::abs(b), p_and_root = root + std::abs(p);
    segment_ = landing;
    entry_ = entry;
    beyond_ = sign * choose_if_positive(b, -2 * g / b_and_root, b_and_root / (2 * a));
    return choose_if_positive(p, 2 * q / p_and_root, p_and_root / (2 * xi * a));
  }

  /// A step that leaves the segment, and how it is judged which knots lie between.
  struct Leaving {
    Knot down;  // 0 upwards, 1 downwards
    T nearest;  // knot that is passed for certain
    T y, xf, xi;
    T scaled_energy;  // xi times the energy at y
  };

  /// Of whole vectors of knots, how many the root lies above: upwards those up to the nearest and those further where
  /// g = u h(u) < 0; downwards those where neither this nor its mirror image holds.
  static HWY_INLINE Knot below_root(const T* knots, const T* energies, std::size_t count, const Leaving& leaving) {
    const hn::ScalableTag<T> tag;
    const T upwards = T(1 - 2 * leaving.down);
    const auto sign = hn::Set(tag, upwards), nearest = hn::Set(tag, upwards * leaving.nearest);
    const auto y = hn::Set(tag, leaving.y), xf = hn::Set(tag, leaving.xf), xi = hn::Set(tag, leaving.xi);
    const auto scaled_energy = hn::Set(tag, leaving.scaled_energy);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
      const auto knot = hn::Load(tag, knots + k);
      const auto way = hn::Sub(knot, y);
      const auto g = hn::NegMulAdd(way, xf, hn::MulAdd(way, way, hn::Mul(xi, hn::Load(tag, energies + k))));
      found += hn::CountTrue(tag, hn::Or(hn::Lt(g, scaled_energy), hn::Le(hn::Mul(sign, knot), nearest)));
    }
    return leaving.down * static_cast<Knot>(count) + (1 - 2 * leaving.down) * static_cast<Knot>(found);
  }

  /// The segment of the root among all: two levels of whole vectors.
  HWY_INLINE Knot search(bool up, T xf, T xi) const {
    const T energy =
        felt_.energies[entry_] + beyond_ * (felt_.forces[entry_] + beyond_ * felt_.half_curvatures[segment_]);
    const Leaving leaving{!up, felt_.knots[segment_ + up], compression(), xf, xi, xi * energy};
    Knot at = 0;
    if (felt_.blocks > 1) {
      constexpr Knot kBlock = kKnotsInABlock;
      const std::size_t pivots = (felt_.blocks + kKnotsInABlock - 1) / kKnotsInABlock * kKnotsInABlock;
      at = kBlock * std::max<Knot>(below_root(felt_.pivots, felt_.pivot_energies, pivots, leaving) - 1, 0);
    }
    const Knot found = at + below_root(felt_.knots + 1 + at, felt_.energies + 1 + at, kKnotsInABlock, leaving);
    const Knot lowest = up * (segment_ + 1), highest = up * static_cast<Knot>(felt_.segments) + !up * (segment_ - 1);
    return std::min(std::max(found, lowest), highest);
  }

  const FeltArrays<T> felt_;  // a copy, which no store can change
  Knot segment_;
  Knot entry_;  // the knot at an end of the segment
  T beyond_;    // [m]
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#endif
