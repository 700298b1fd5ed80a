// SPDX-License-Identifier: MIT
// One sample of a contact in vectors, for each instruction set (docs/how-it-works/kernels.md).
#if defined(CONTACTSPLINE_CONTACT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CONTACTSPLINE_CONTACT_INL
#undef CONTACTSPLINE_CONTACT_INL
#else
#define CONTACTSPLINE_CONTACT_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <type_traits>

#include "contactspline/simd/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace contactspline::detail {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#define CONTACTSPLINE_STEP_INLINE [[nodiscard]] HWY_INLINE
#include "contactspline/step/step_coefficients-inl.hpp"
#undef CONTACTSPLINE_STEP_INLINE

/// The arithmetic of step_coefficients for the vectors of a tag.
template <typename D, typename V = hn::Vec<D>>
struct VectorArithmetic {
  static HWY_INLINE V number(hn::TFromD<D> value) { return hn::Set(D(), value); }
  static HWY_INLINE V add(V a, V b) { return hn::Add(a, b); }
  static HWY_INLINE V sub(V a, V b) { return hn::Sub(a, b); }
  static HWY_INLINE V mul(V a, V b) { return hn::Mul(a, b); }
  static HWY_INLINE V mul_add(V a, V b, V c) { return hn::MulAdd(a, b, c); }
  static HWY_INLINE V neg_mul_add(V a, V b, V c) { return hn::NegMulAdd(a, b, c); }
};

/// A contact under load. The compression is kept as the distance beyond a knot at one end of its segment, the entry
/// knot. All distances below count from the compression.
/// kVaries: does the admittance change from step to step (contact loss), or is it that of prepare()?
template <bool kVaries, typename T>
class ContactUnderLoad {
  using Knot = std::ptrdiff_t;  // numbered as in ContactTable
  static constexpr Knot kWindow = kKnotsPerWindow<T>;
  /// Sign of a motion by a number of segments, from -kWindow on.
  static constexpr auto kSigns = [] {
    std::array<T, 2 * kWindow + 1> signs{};
    for (Knot crossed = 1; crossed <= kWindow; ++crossed) signs[kWindow + crossed] = 1, signs[kWindow - crossed] = -1;
    return signs;
  }();

  /// The step coefficients for each knot of the window as the last one crossed, and the step within the segment.
  struct Steps {
    HWY_ALIGN T discriminant[kWindow];
    HWY_ALIGN T b[kWindow];
    HWY_ALIGN T g[kWindow];
    HWY_ALIGN T p[kWindow];
    HWY_ALIGN T q[kWindow];
    T force_within, distance_within;
  };

 public:
  HWY_INLINE ContactUnderLoad(const ContactTable<T>& table, const HammerState<T>& hammer) : table_(table) {
    put(hammer.compression_m, hammer.segment);
    recentre_window(hammer.crossed[1]);
    recentre_window(hammer.crossed[0]);
  }
  HWY_INLINE void store_to(HammerState<T>& hammer) const {
    hammer.compression_m = compression();
    hammer.segment = static_cast<std::size_t>(segment_);
    hammer.crossed[0] = crossed_;
    hammer.crossed[1] = crossed_before_;
  }

  /// The load of a step: a free increment xf = before - per_force * last [m], of which `last` is known last, and the
  /// admittance.
  struct Load {
    T before;              ///< [m]
    T per_force, last;     ///< [m/N], [N]
    T xi;                  ///< admittance times stiffness ratio [m/N]
    T inverse_admittance;  ///< 1/admittance, without the ratio [N/m]
  };

  /// Computes the table's products with xi, if it is not the xi they hold.
  static HWY_INLINE void prepare(const ContactTable<T>& table, T xi) {
    if (*table.prepared_xi == xi) return;
    *table.prepared_xi = xi;
    for (std::size_t k = 0; k <= table.segments; ++k) {
      table.force_displacements[k] = xi * table.forces[k];
      table.stiffnesses[k] = xi * table.half_curvatures[k];
      table.inverse_slopes[k] = 1 / (1 + table.stiffnesses[k]);
    }
  }

  [[nodiscard]] HWY_INLINE T compression() const { return table_.knots[entry_] + beyond_; }
  /// Elastic force at this compression [N].
  [[nodiscard]] HWY_INLINE T force() const {
    return table_.forces[entry_] + 2 * table_.half_curvatures[segment_] * beyond_;
  }

  /// Moves to a compression [m] in a segment.
  HWY_INLINE void put(T compression, std::size_t segment) {
    segment_ = static_cast<Knot>(segment);
    entry_ = std::max<Knot>(segment_, 1);
    beyond_ = compression - table_.knots[entry_];
    crossed_ = 0;
    recentre_window(0);
  }

  struct CrossedKnots {
    Knot below_root;  ///< number of knots of the window below the root
    Knot last;        ///< the knot of the window that is crossed last
  };

  /// What prepare_step() finds.
  struct StepCandidates {
    Load load;
    T xf;           ///< [m]
    bool is_apart;  ///< and remains so
    CrossedKnots knots;
    Steps steps;
  };

  /// First half of contact_step without loss: counts the knots of the window that lie below the root, and prepares
  /// the step for each candidate. Does not move. The same instructions serve every step, within a segment or across
  /// knots: only flights apart and steps beyond the window branch.
  HWY_INLINE void prepare_step(const Load& load, StepCandidates& candidates) const {
    candidates.load = load;
    candidates.xf = load.before - load.per_force * load.last;
    candidates.is_apart = segment_ == 0 && beyond_ + candidates.xf < 0;  // true most of the time
    if (!candidates.is_apart) candidates.knots = judge_window(load, candidates.xf, candidates.steps);
  }

  /// Second half: moves by x = xf - xi f and returns the force, f times the ratio [N]; 0 for a load that is not a
  /// number.
  HWY_INLINE T finish_step(const StepCandidates& candidates) {
    const Load& load = candidates.load;
    const Steps& steps = candidates.steps;
    if (candidates.is_apart) {
      beyond_ += candidates.xf;
      return 0;
    }
    const auto [below_root, last] = candidates.knots;
    if (HWY_UNLIKELY((below_root == 0) | (below_root == kWindow)))
      return step_beyond_window(below_root > 0, candidates.xf, load);
    const Knot crossed = std::min(below_root - behind_, static_cast<Knot>(table_.segments) - segment_);
    const T rebased = enter(crossed);
    const StepCoefficients<T> chosen{steps.b[last], steps.g[last], steps.p[last], steps.q[last],
                                     steps.discriminant[last]};
    return solve(kSigns[kWindow + crossed], chosen, load, rebased + steps.distance_within, steps.force_within);
  }

 private:
  using One = hn::CappedTag<T, 1>;

  /// Moves into the segment `crossed` segments from this one. Returns how far this compression lies beyond its entry
  /// knot [m].
  HWY_INLINE T enter(Knot crossed) {
    segment_ += crossed;
    recentre_window(crossed);
    const Knot entry = segment_ + ((crossed < 0) | (segment_ == 0));
    const T rebased = beyond_ - (table_.knots[entry] - table_.knots[entry_]);
    entry_ = entry;
    return rebased;
  }

  /// Moves to the root and returns the force: distance and force are roots of two quadratics with one discriminant
  /// (docs/how-it-works/contact-step.md). sign: of the motion; 0 within the segment, where both are known already.
  HWY_INLINE T solve(T sign, const StepCoefficients<T>& step, const Load& load, T distance_within, T force_within) {
    const T half_slope = inverse_slope_in(segment_, load) / 2;
    const Side distance{step.b, step.g, -2, half_slope * sign, distance_within};
    const Side force{step.p, step.q, 2 * load.inverse_admittance, half_slope * load.inverse_admittance, force_within};
    T elastic;
    solve_both(sign, step.discriminant, distance, force, beyond_, elastic);
    return positive(elastic);
  }

  /// One of two quadratics with one discriminant. Its root is sign of_g g/(root + |b|) if b has the sign of the
  /// motion, else of_sum (root + |b|), with the root of the discriminant; `within` if no knot is crossed.
  struct Side {
    T b, g, of_g, of_sum, within;
  };
  /// The root of one side, or of both in two lanes. sign: of the motion, 0 within the segment.
  template <typename D, typename V = hn::Vec<D>>
  static HWY_INLINE V root_of(D tag, T sign, T discriminant, V b, V g, V of_g, V of_sum, V within) {
    const auto signs = hn::Set(tag, sign), zero = hn::Zero(tag);
    const auto sum = hn::Add(hn::Sqrt(hn::Set(tag, discriminant)), hn::Abs(b));
    const auto quotient = hn::Div(hn::Mul(hn::Mul(signs, of_g), g), sum), product = hn::Mul(of_sum, sum);
    return hn::IfThenElse(hn::Gt(hn::Mul(signs, b), zero), quotient,
                          hn::IfThenElse(hn::Eq(signs, zero), within, product));
  }
  static HWY_INLINE void solve_both(T sign, T discriminant, const Side& distance, const Side& force, T& s, T& f) {
#if HWY_TARGET == HWY_SCALAR
    const auto one_of = [&](const Side& side) {
      const One tag;
      return hn::GetLane(root_of(tag, sign, discriminant, hn::Set(tag, side.b), hn::Set(tag, side.g),
                                 hn::Set(tag, side.of_g), hn::Set(tag, side.of_sum), hn::Set(tag, side.within)));
    };
    s = one_of(distance), f = one_of(force);
#else
    const hn::CappedTag<T, 2> tag;
    const auto both = [&](T first, T second)
                          HWY_ATTR { return hn::InterleaveLower(hn::Set(tag, first), hn::Set(tag, second)); };
    const auto solution = root_of(tag, sign, discriminant, both(distance.b, force.b), both(distance.g, force.g),
                                  both(distance.of_g, force.of_g), both(distance.of_sum, force.of_sum),
                                  both(distance.within, force.within));
    s = hn::GetLane(solution), f = hn::ExtractLane(solution, 1);
#endif
  }

  /// The value if positive, else 0; also for NaN.
  static HWY_INLINE T positive(T value) {
    return hn::GetLane(hn::Max(hn::Set(One(), value), hn::Zero(One())));
  }

  /// 1/(1 + xi c) in a segment.
  [[nodiscard]] HWY_INLINE T inverse_slope_in(Knot segment, const Load& load) const {
    return kVaries ? 1 / (1 + load.xi * table_.half_curvatures[segment]) : table_.inverse_slopes[segment];
  }

  /// After a step across a number of segments: expects the next step to change by as much as this one did, and
  /// centres the window there.
  HWY_INLINE void recentre_window(Knot crossed) {
    behind_ = std::min(std::clamp<Knot>(kWindow / 2 - 2 * crossed + crossed_, 1, kWindow - 1), segment_ + 1);
    crossed_before_ = crossed_;
    crossed_ = crossed;
  }

  /// Counts the knots of the window that lie below the root, and prepares the step for each candidate. The first
  /// behind_ knots lie below the compression. The two nearest are judged by h, the others by g = distance h
  /// (docs/how-it-works/contact-step.md). The energy gained is an area up to the nearest knot and differences of the
  /// table beyond: nothing cancels. Few operations depend on the compression or on the last force, because the modes
  /// of the string compete for the same units.
  HWY_INLINE CrossedKnots judge_window(const Load& load, T xf, Steps& steps) const {
    const T stiffness = kVaries ? load.xi * table_.half_curvatures[segment_] : table_.stiffnesses[segment_];
    CrossedKnots found{};
    for (Knot v = 0; v < kWindow; v += static_cast<Knot>(hn::Lanes(WindowTag())))
      judge_knots(v, load, stiffness, steps, found);
    const T here = force_displacement_at(entry_, load) + 2 * stiffness * beyond_;
    const T inverse_slope = inverse_slope_in(segment_, load);
    steps.distance_within = (xf - here) * inverse_slope;
    steps.force_within = (here + stiffness * xf) * (inverse_slope * load.inverse_admittance);
    return found;
  }

  using WindowTag = std::remove_cv_t<decltype(hn::CappedTag<T, kWindow>())>;
  using Knots = hn::Vec<WindowTag>;  // a value for each of some knots of the window

  /// xi times the force at a knot [m].
  [[nodiscard]] HWY_INLINE T force_displacement_at(Knot k, const Load& load) const {
    return kVaries ? load.xi * table_.forces[k] : table_.force_displacements[k];
  }

  /// The knot nearest to the compression, below or above it.
  struct NearestKnots {
    Knots distance, energy;
    Knots mean_displacement;  ///< xi times the mean force up to there [m]
    Knots past;               ///< the motion that is left there [m]
  };
  template <typename Mask>
  HWY_INLINE NearestKnots nearest_knots(Mask lie_below, const Load& load, T stiffness) const {
    const WindowTag tag;
    const auto of_side = [&](T below, T above)
                             HWY_ATTR { return hn::IfThenElse(lie_below, hn::Set(tag, below), hn::Set(tag, above)); };
    const auto beyond = hn::Set(tag, beyond_), here = hn::Set(tag, force_displacement_at(entry_, load));
    const auto knot = of_side(table_.knots[segment_], table_.knots[segment_ + 1]);
    const auto energy = of_side(table_.energies[segment_], table_.energies[segment_ + 1]);
    const auto displacement =
        of_side(force_displacement_at(segment_, load), force_displacement_at(segment_ + 1, load));
    const auto distance = hn::Sub(hn::Sub(knot, hn::Set(tag, table_.knots[entry_])), beyond);
    const auto mean =
        hn::MulAdd(hn::Set(tag, stiffness), beyond, hn::Mul(hn::Set(tag, T(0.5)), hn::Add(here, displacement)));
    const auto left = hn::Sub(hn::Sub(hn::Set(tag, load.before), distance), mean);
    return {distance, energy, mean, hn::NegMulAdd(hn::Set(tag, load.per_force), hn::Set(tag, load.last), left)};
  }

  /// judge_window for one vector of knots, from the window's knot v on. stiffness: xi c of the segment.
  HWY_INLINE void judge_knots(Knot v, const Load& load, T stiffness, Steps& steps, CrossedKnots& found) const {
    const WindowTag tag;
    const Knot at = segment_ + 1 - behind_ + v;
    const auto first = [&](Knot n) HWY_ATTR {
      return hn::FirstN(tag, static_cast<std::size_t>(std::clamp<Knot>(n - v, 0, static_cast<Knot>(hn::Lanes(tag)))));
    };
    const auto lie_below = first(behind_);
    const auto nearest_below = hn::AndNot(first(behind_ - 1), lie_below),
               nearest_above = hn::AndNot(lie_below, first(behind_ + 1));
    const NearestKnots near = nearest_knots(lie_below, load, stiffness);

    const auto xis = hn::Set(tag, load.xi);
    const auto force_displacement =
        kVaries ? hn::Mul(xis, hn::LoadU(tag, table_.forces + at)) : hn::LoadU(tag, table_.force_displacements + at);
    const auto of_segment_entered = [&](const T* column) HWY_ATTR {
      return hn::IfThenElse(lie_below, hn::LoadU(tag, column + at - 1), hn::LoadU(tag, column + at));
    };
    const auto entered =
        kVaries ? hn::Mul(xis, of_segment_entered(table_.half_curvatures)) : of_segment_entered(table_.stiffnesses);
    const auto distance = hn::Sub(hn::Sub(hn::LoadU(tag, table_.knots + at), hn::Set(tag, table_.knots[entry_])),
                                  hn::Set(tag, beyond_));
    const auto remaining = hn::NegMulAdd(hn::Set(tag, load.per_force), hn::Set(tag, load.last),
                                         hn::Sub(hn::Set(tag, load.before), distance));
    const auto further = hn::Mul(xis, hn::Sub(hn::LoadU(tag, table_.energies + at), near.energy));
    const auto work = hn::MulAdd(near.distance, near.mean_displacement, further);
    const auto step =
        step_coefficients(VectorArithmetic<WindowTag>(), distance, work, force_displacement, remaining, entered);
    const auto test =
        hn::IfThenElse(nearest_above, hn::Neg(near.past), hn::IfThenElse(nearest_below, near.past, step.g));
    // A comparison with NaN is false: the compression then stays where it is.
    const auto below_root = hn::Xor(lie_below, hn::Lt(test, hn::Zero(tag)));
    found.below_root += static_cast<Knot>(hn::CountTrue(tag, below_root));
    found.last += static_cast<Knot>(hn::CountTrue(tag, hn::AndNot(nearest_above, below_root)));

    hn::Store(hn::Abs(step.discriminant), tag, steps.discriminant + v);
    hn::Store(step.b, tag, steps.b + v);
    hn::Store(step.g, tag, steps.g + v);
    hn::Store(step.p, tag, steps.p + v);
    hn::Store(step.q, tag, steps.q + v);
  }

  /// A knot at an end of the segment, and the energy gained up to it [J].
  struct NearestKnot {
    Knot knot;
    T gain;
  };
  [[nodiscard]] HWY_INLINE NearestKnot nearest(bool up) const {
    const Knot knot = segment_ + up;
    const T distance = (table_.knots[knot] - table_.knots[entry_]) - beyond_;
    return {knot, distance * (force() + table_.forces[knot]) / 2};
  }

  /// A step across more knots than the window holds.
  HWY_INLINE T step_beyond_window(bool up, T xf, const Load& load) {
    const NearestKnot near = nearest(up);
    const Knot last = search(up, near, xf, load), crossed = last - segment_, knot = last + !up;
    const T xi = load.xi, sign = T(up ? 1 : -1);
    const T work = xi * ((table_.energies[knot] - table_.energies[near.knot]) + near.gain);
    const T distance = (table_.knots[knot] - table_.knots[entry_]) - beyond_;
    auto step = detail::step_coefficients(detail::ScalarArithmetic<T>(), distance, work, xi * table_.forces[knot],
                                          xf - distance, xi * table_.half_curvatures[last]);
    enter(crossed);
    return solve(sign, {step.b, step.g, step.p, step.q, std::abs(step.discriminant)}, load, 0, 0);
  }

  /// A step that leaves the segment, and what judges the knots ahead.
  struct Leaving {
    bool up;
    T origin, beyond;        // of all distances; this compression from there
    T nearest;               // knot that is crossed for certain
    T energy, work, xi, xf;  // there; xi times the energy gained up to there
  };

  /// Counts, in whole vectors of knots, those below the root. Upwards: the knots up to the nearest, and those beyond
  /// with g < 0. Downwards: those for which neither this nor its mirror image holds.
  static HWY_INLINE Knot below_root(const T* knots, const T* energies, std::size_t count, const Leaving& leaving) {
    const hn::ScalableTag<T> tag;
    const T upwards = T(leaving.up ? 1 : -1);
    const auto sign = hn::Set(tag, upwards), nearest = hn::Set(tag, upwards * leaving.nearest);
    const auto origin = hn::Set(tag, leaving.origin), beyond = hn::Set(tag, leaving.beyond);
    const auto xf = hn::Set(tag, leaving.xf), xi = hn::Set(tag, leaving.xi);
    const auto energy = hn::Set(tag, leaving.energy), work = hn::Set(tag, leaving.work);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
      const auto knot = hn::Load(tag, knots + k);
      const auto distance = hn::Sub(hn::Sub(knot, origin), beyond);
      const auto further = hn::Sub(hn::Load(tag, energies + k), energy);
      const auto g = hn::NegMulAdd(distance, hn::Sub(xf, distance), hn::MulAdd(xi, further, work));
      found += hn::CountTrue(tag, hn::Or(hn::Lt(g, hn::Zero(tag)), hn::Le(hn::Mul(sign, knot), nearest)));
    }
    return static_cast<Knot>(leaving.up ? found : count - found);
  }

  /// The segment of the root among all: two levels of whole vectors. In range for any increment, also an infinite
  /// one, for which g is not a number or the sentinel knots count as crossed.
  HWY_INLINE Knot search(bool up, const NearestKnot& near, T xf, const Load& load) const {
    const Leaving leaving{up,
                          table_.knots[entry_],
                          beyond_,
                          table_.knots[near.knot],
                          table_.energies[near.knot],
                          load.xi * near.gain,
                          load.xi,
                          xf};
    Knot at = 0;
    if (table_.blocks > 1) {
      constexpr Knot kBlock = kKnotsPerBlock;
      const Knot blocks = static_cast<Knot>(table_.blocks);
      const std::size_t padded = (table_.blocks + kKnotsPerBlock - 1) / kKnotsPerBlock * kKnotsPerBlock;
      const Knot block = below_root(table_.block_first_knots, table_.block_first_energies, padded, leaving) - 1;
      at = kBlock * std::clamp<Knot>(block, 0, blocks - 1);
    }
    const Knot found = at + below_root(table_.knots + 1 + at, table_.energies + 1 + at, kKnotsPerBlock, leaving);
    const Knot lowest = up * (segment_ + 1), highest = up * static_cast<Knot>(table_.segments) + !up * (segment_ - 1);
    return std::min(std::max(found, lowest), highest);
  }

  const ContactTable<T> table_;  // a copy, which no store can change
  Knot segment_;
  Knot entry_;                             // the knot at an end of the segment
  T beyond_;                               // compression beyond the entry knot [m]
  Knot crossed_ = 0, crossed_before_ = 0;  // segments, in the last step and in the one before
  Knot behind_;                            // number of knots of the window below the compression
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#endif
