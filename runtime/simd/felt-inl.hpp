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
/// kVaries: does the admittance change from step to step, or is it that of prepare()?
template <bool kVaries, typename T>
class Felt {
  using Knot = std::ptrdiff_t;  // numbered as in FeltArrays
  static constexpr Knot kWindow = kKnotsInAWindow<T>;
  /// Of a motion by so many segments, from -kWindow on: -1 downwards, 1 upwards.
  static constexpr auto kSigns = [] {
    std::array<T, 2 * kWindow + 1> signs{};
    for (Knot moved = 1; moved <= kWindow; ++moved) signs[kWindow + moved] = 1, signs[kWindow - moved] = -1;
    return signs;
  }();

  /// Of each knot of the window, as if it were passed last: with a = 1 + xi c, the quadratics a s^2 + b s + g of the
  /// way s beyond it and a m^2 - p m + q of what the force gives, m = xi f; their one discriminant, the square. And
  /// the step within the segment.
  struct Steps {
    HWY_ALIGN T square[kWindow];
    HWY_ALIGN T b[kWindow];
    HWY_ALIGN T g[kWindow];
    HWY_ALIGN T p[kWindow];
    HWY_ALIGN T q[kWindow];
    T within_force, within_way;
  };

 public:
  HWY_INLINE Felt(const FeltArrays<T>& arrays, const HammerFlight<T>& hammer) : felt_(arrays) {
    put(hammer.compression_m, hammer.segment);
    expect(hammer.moved[1]);
    expect(hammer.moved[0]);
  }
  HWY_INLINE void give_back(HammerFlight<T>& hammer) const {
    hammer.compression_m = compression();
    hammer.segment = static_cast<std::size_t>(segment_);
    hammer.moved[0] = moved_;
    hammer.moved[1] = moved_before_;
  }

  /// What a step is under: a free increment xf = before - per_force * last [m], of which `last` is known last, less
  /// xi times the felt's force.
  struct Load {
    T before;              ///< [m]
    T per_force, last;     ///< [m/N], [N]
    T xi;                  ///< admittance times stiffness ratio [m/N]
    T inverse_admittance;  ///< without the ratio [N/m]
  };

  /// Makes ready for a xi, if it is not the last one.
  static HWY_INLINE void prepare(const FeltArrays<T>& felt, T xi) {
    if (*felt.prepared_xi == xi) return;
    *felt.prepared_xi = xi;
    for (std::size_t k = 0; k <= felt.segments; ++k) {
      felt.gives[k] = xi * felt.forces[k];
      felt.stiffnesses[k] = xi * felt.half_curvatures[k];
      felt.inverse_slopes[k] = 1 / (1 + felt.stiffnesses[k]);
    }
  }

  [[nodiscard]] HWY_INLINE T compression() const { return felt_.knots[entry_] + beyond_; }
  /// Elastic force at this compression [N].
  [[nodiscard]] HWY_INLINE T force() const {
    return felt_.forces[entry_] + 2 * felt_.half_curvatures[segment_] * beyond_;
  }

  /// Moves to a compression [m] in a segment.
  HWY_INLINE void put(T compression, std::size_t segment) {
    segment_ = static_cast<Knot>(segment);
    entry_ = std::max<Knot>(segment_, 1);
    beyond_ = compression - felt_.knots[entry_];
    moved_ = 0;
    expect(0);
  }

  struct Landing {
    Knot below_root;  ///< so many knots of the window
    Knot last;        ///< the knot of the window that is passed last
  };

  /// What look() finds.
  struct Outlook {
    Load load;
    T xf;           ///< [m]
    bool is_apart;  ///< and stays so
    Landing landing;
    Steps steps;
  };

  /// contact_step without loss, first half: finds where the felt lands under a load, without moving it. One way for
  /// all steps, within a segment and across knots, without a branch that depends on the data but for flights apart
  /// and steps far away.
  HWY_INLINE void look(const Load& load, Outlook& outlook) const {
    outlook.load = load;
    outlook.xf = load.before - load.per_force * load.last;
    outlook.is_apart = segment_ == 0 && beyond_ + outlook.xf < 0;  // as for most of the time
    if (!outlook.is_apart) outlook.landing = look_around(load, outlook.xf, outlook.steps);
  }

  /// Second half: moves there by x = xf - xi f; returns the force, f times the ratio [N], 0 also of what is no
  /// number.
  HWY_INLINE T land(const Outlook& outlook) {
    const Load& load = outlook.load;
    const Steps& steps = outlook.steps;
    if (outlook.is_apart) {
      beyond_ += outlook.xf;
      return 0;
    }
    const auto [below_root, last] = outlook.landing;
    if (HWY_UNLIKELY((below_root == 0) | (below_root == kWindow))) return far_step(below_root > 0, outlook.xf, load);
    const Knot moved = std::min(below_root - behind_, static_cast<Knot>(felt_.segments) - segment_);
    const T rebased = enter(moved);
    const Quadratics passed{steps.square[last], steps.b[last], steps.g[last], steps.p[last], steps.q[last]};
    return settle(kSigns[kWindow + moved], passed, load, rebased + steps.within_way, steps.within_force);
  }

 private:
  using One = hn::CappedTag<T, 1>;

  /// As in Steps, at the knot that is passed last.
  struct Quadratics {
    T square, b, g, p, q;
  };

  /// Moves into the segment `moved` from this one; returns how far this place lies beyond its entry [m].
  HWY_INLINE T enter(Knot moved) {
    segment_ += moved;
    expect(moved);
    const Knot entry = segment_ + ((moved < 0) | (segment_ == 0));
    const T rebased = beyond_ - (felt_.knots[entry] - felt_.knots[entry_]);
    entry_ = entry;
    return rebased;
  }

  /// Takes the place of the root and returns the force: way and force are roots of two quadratics of one discriminant
  /// (docs/contact-step.md). sign: of the motion, 0 within the segment, whose way and force are then taken.
  HWY_INLINE T settle(T sign, const Quadratics& passed, const Load& load, T within_way, T within_force) {
    const T half_slope = inverse_slope_in(segment_, load) / 2;
    const Side way{passed.b, passed.g, -2, half_slope * sign, within_way};
    const Side force{passed.p, passed.q, 2 * load.inverse_admittance, half_slope * load.inverse_admittance,
                     within_force};
    T elastic;
    solve(sign, passed.square, way, force, beyond_, elastic);
    return positive(elastic);
  }

  /// One of two quadratics of one discriminant: along the motion its root is sign of_g g/(root + |b|) where b has the
  /// sign of the motion, else of_sum (root + |b|), root that of the discriminant; within the segment a value of its
  /// own.
  struct Side {
    T b, g, of_g, of_sum, within;
  };
  /// The root, of one side or of both in two lanes; sign: of the motion, 0 within the segment.
  template <typename D, typename V = hn::Vec<D>>
  static HWY_INLINE V solve_in(D tag, T sign, T square, V b, V g, V of_g, V of_sum, V within) {
    const auto signs = hn::Set(tag, sign), zero = hn::Zero(tag);
    const auto sum = hn::Add(hn::Sqrt(hn::Set(tag, square)), hn::Abs(b));
    const auto quotient = hn::Div(hn::Mul(hn::Mul(signs, of_g), g), sum), product = hn::Mul(of_sum, sum);
    return hn::IfThenElse(hn::Gt(hn::Mul(signs, b), zero), quotient,
                          hn::IfThenElse(hn::Eq(signs, zero), within, product));
  }
  static HWY_INLINE void solve(T sign, T square, const Side& way, const Side& force, T& x, T& f) {
#if HWY_TARGET == HWY_SCALAR
    const auto one_of = [&](const Side& side) {
      const One tag;
      return hn::GetLane(solve_in(tag, sign, square, hn::Set(tag, side.b), hn::Set(tag, side.g),
                                  hn::Set(tag, side.of_g), hn::Set(tag, side.of_sum), hn::Set(tag, side.within)));
    };
    x = one_of(way), f = one_of(force);
#else
    const hn::CappedTag<T, 2> tag;
    const auto both = [&](T first, T second)
                          HWY_ATTR { return hn::InterleaveLower(hn::Set(tag, first), hn::Set(tag, second)); };
    const auto solution =
        solve_in(tag, sign, square, both(way.b, force.b), both(way.g, force.g), both(way.of_g, force.of_g),
                 both(way.of_sum, force.of_sum), both(way.within, force.within));
    x = hn::GetLane(solution), f = hn::ExtractLane(solution, 1);
#endif
  }

  /// 0 of what is no number.
  static HWY_INLINE T positive(T value) {
    return hn::GetLane(hn::Max(hn::Set(One(), value), hn::Zero(One())));
  }

  /// 1/(1 + xi c) in a segment.
  [[nodiscard]] HWY_INLINE T inverse_slope_in(Knot segment, const Load& load) const {
    return kVaries ? 1 / (1 + load.xi * felt_.half_curvatures[segment]) : felt_.inverse_slopes[segment];
  }

  /// After a step by so many segments: the next step is expected to change as this one did, and the window lies
  /// around where that leads.
  HWY_INLINE void expect(Knot moved) {
    behind_ = std::min(std::clamp<Knot>(kWindow / 2 - 2 * moved + moved_, 1, kWindow - 1), segment_ + 1);
    moved_before_ = moved_;
    moved_ = moved;
  }

  /// Of a window of knots, the first behind_ of which lie below, how many the root lies above, and the step of each
  /// such number. The two nearest are judged by h, the others by g = u h (docs/contact-step.md). Gains of energy are
  /// areas up to the nearest knot and differences of the table from there: nothing cancels. What waits for the felt's
  /// place or for the last force is kept short, and few in operations: a string's modes want them at the same time.
  HWY_INLINE Landing look_around(const Load& load, T xf, Steps& steps) const {
    const hn::CappedTag<T, kWindow> tag;
    const Knot lanes = static_cast<Knot>(hn::Lanes(tag));
    const T xi = load.xi;
    const T stiffness_here = kVaries ? xi * felt_.half_curvatures[segment_] : felt_.stiffnesses[segment_];
    const auto set = [&](T value) HWY_ATTR { return hn::Set(tag, value); };
    const auto give_at = [&](Knot k) { return kVaries ? xi * felt_.forces[k] : felt_.gives[k]; };
    const auto origin = set(felt_.knots[entry_]), beyond = set(beyond_), before = set(load.before),
               per_force = set(load.per_force), last = set(load.last), xis = set(xi),
               stiffnesses = set(stiffness_here);
    const auto one = set(1), two = set(2), half = set(T(0.5));
    Landing found{};
    for (Knot v = 0; v < kWindow; v += lanes) {
      const Knot at = segment_ + 1 - behind_ + v;
      const auto first = [&](Knot n) HWY_ATTR {
        return hn::FirstN(tag, static_cast<std::size_t>(std::clamp<Knot>(n - v, 0, lanes)));
      };
      const auto lie_below = first(behind_);
      const auto nearest_below = hn::AndNot(first(behind_ - 1), lie_below),
                 nearest_above = hn::AndNot(lie_below, first(behind_ + 1));
      // To the nearest knot in each direction: way, xi times the mean force; past it by how much.
      const auto of_side = [&](T below, T above)
                               HWY_ATTR { return hn::IfThenElse(lie_below, set(below), set(above)); };
      const auto near_knot = of_side(felt_.knots[segment_], felt_.knots[segment_ + 1]);
      const auto near_energy = of_side(felt_.energies[segment_], felt_.energies[segment_ + 1]);
      const auto near_gives = of_side(give_at(segment_), give_at(segment_ + 1));
      const auto near_way = hn::Sub(hn::Sub(near_knot, origin), beyond);
      const auto near_give =
          hn::MulAdd(stiffnesses, beyond, hn::Mul(half, hn::Add(set(give_at(entry_)), near_gives)));
      const auto past = hn::NegMulAdd(per_force, last, hn::Sub(hn::Sub(before, near_way), near_give));

      const auto gives = kVaries ? hn::Mul(xis, hn::LoadU(tag, felt_.forces + at)) : hn::LoadU(tag, felt_.gives + at);
      const auto of_landing = [&](const T* column) HWY_ATTR {
        return hn::IfThenElse(lie_below, hn::LoadU(tag, column + at - 1), hn::LoadU(tag, column + at));
      };
      const auto stiffness =
          kVaries ? hn::Mul(xis, of_landing(felt_.half_curvatures)) : of_landing(felt_.stiffnesses);
      const auto way = hn::Sub(hn::Sub(hn::LoadU(tag, felt_.knots + at), origin), beyond);
      const auto free = hn::NegMulAdd(per_force, last, hn::Sub(before, way));
      const auto further = hn::Mul(xis, hn::Sub(hn::LoadU(tag, felt_.energies + at), near_energy));
      const auto gain = hn::MulAdd(near_way, near_give, further);
      const auto g = hn::NegMulAdd(way, free, gain);
      const auto test = hn::IfThenElse(nearest_above, hn::Neg(past), hn::IfThenElse(nearest_below, past, g));
      // What is no number stays.
      const auto below_root = hn::Xor(lie_below, hn::Lt(test, hn::Zero(tag)));
      found.below_root += static_cast<Knot>(hn::CountTrue(tag, below_root));
      found.last += static_cast<Knot>(hn::CountTrue(tag, hn::AndNot(nearest_above, below_root)));

      const auto slope = hn::MulAdd(two, stiffness, one);
      const auto way_and_gives = hn::Add(way, gives);
      const auto b = hn::Sub(way_and_gives, free);
      const auto square = hn::NegMulAdd(hn::MulAdd(two, slope, two), g, hn::Mul(b, b));
      hn::Store(hn::Abs(square), tag, steps.square + v);
      hn::Store(b, tag, steps.b + v);
      hn::Store(g, tag, steps.g + v);
      hn::Store(hn::MulAdd(slope, free, way_and_gives), tag, steps.p + v);
      hn::Store(hn::MulAdd(free, hn::MulAdd(stiffness, free, gives), gain), tag, steps.q + v);
    }
    const T give = give_at(entry_) + 2 * stiffness_here * beyond_, inverse_slope = inverse_slope_in(segment_, load);
    steps.within_way = (xf - give) * inverse_slope;
    steps.within_force = (give + stiffness_here * xf) * (inverse_slope * load.inverse_admittance);
    return found;
  }

  /// A knot at an end of the segment, and the gain of energy up to it [J].
  struct Nearest {
    Knot knot;
    T gain;
  };
  [[nodiscard]] HWY_INLINE Nearest nearest(bool up) const {
    const Knot knot = segment_ + up;
    const T way = (felt_.knots[knot] - felt_.knots[entry_]) - beyond_;
    return {knot, way * (force() + felt_.forces[knot]) / 2};
  }

  /// One step to a landing anywhere.
  HWY_INLINE T far_step(bool up, T xf, const Load& load) {
    const Nearest near = nearest(up);
    const Knot landing = search(up, near, xf, load), moved = landing - segment_, passed = landing + !up;
    const T xi = load.xi, sign = T(up ? 1 : -1);
    const T gain = xi * ((felt_.energies[passed] - felt_.energies[near.knot]) + near.gain);
    const T way = (felt_.knots[passed] - felt_.knots[entry_]) - beyond_, free = xf - way;
    const T give = xi * felt_.forces[passed], stiffness = xi * felt_.half_curvatures[landing];
    const T b = way - free + give, g = gain - way * free;
    const T p = xf + give + 2 * stiffness * free, q = gain + free * (give + stiffness * free);
    enter(moved);
    return settle(sign, {std::abs(b * b - 4 * (1 + stiffness) * g), b, g, p, q}, load, 0, 0);
  }

  /// A step that leaves the segment, and how it is judged which knots lie between.
  struct Leaving {
    bool up;
    T origin, beyond;        // of all ways; this place from there
    T nearest;               // knot that is passed for certain
    T energy, gain, xi, xf;  // there; xi times the gain up to there
  };

  /// Of whole vectors of knots, how many the root lies above: upwards those up to the nearest and those further where
  /// g = u h(u) < 0; downwards those where neither this nor its mirror image holds.
  static HWY_INLINE Knot below_root(const T* knots, const T* energies, std::size_t count, const Leaving& leaving) {
    const hn::ScalableTag<T> tag;
    const T upwards = T(leaving.up ? 1 : -1);
    const auto sign = hn::Set(tag, upwards), nearest = hn::Set(tag, upwards * leaving.nearest);
    const auto origin = hn::Set(tag, leaving.origin), beyond = hn::Set(tag, leaving.beyond);
    const auto xf = hn::Set(tag, leaving.xf), xi = hn::Set(tag, leaving.xi);
    const auto energy = hn::Set(tag, leaving.energy), gain = hn::Set(tag, leaving.gain);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
      const auto knot = hn::Load(tag, knots + k);
      const auto way = hn::Sub(hn::Sub(knot, origin), beyond);
      const auto further = hn::Sub(hn::Load(tag, energies + k), energy);
      const auto g = hn::NegMulAdd(way, hn::Sub(xf, way), hn::MulAdd(xi, further, gain));
      found += hn::CountTrue(tag, hn::Or(hn::Lt(g, hn::Zero(tag)), hn::Le(hn::Mul(sign, knot), nearest)));
    }
    return static_cast<Knot>(leaving.up ? found : count - found);
  }

  /// The segment of the root among all: two levels of whole vectors.
  HWY_INLINE Knot search(bool up, const Nearest& near, T xf, const Load& load) const {
    const Leaving leaving{up,
                          felt_.knots[entry_],
                          beyond_,
                          felt_.knots[near.knot],
                          felt_.energies[near.knot],
                          load.xi * near.gain,
                          load.xi,
                          xf};
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
  Knot entry_;                         // the knot at an end of the segment
  T beyond_;                           // [m]
  Knot moved_ = 0, moved_before_ = 0;  // segments, by the last step and the one before
  Knot behind_;                        // so many knots of the window lie below
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#endif
