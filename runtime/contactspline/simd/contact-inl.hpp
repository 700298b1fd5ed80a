// SPDX-License-Identifier: MIT
// One sample of a contact in vectors: a part of kernels-inl.hpp (docs/how-it-works/kernels.md).

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
/// kVaries: does the receptance change from step to step (contact loss), or is it that of prepare()?
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
    hammer.segment = segment();
    hammer.crossed[0] = crossed_;
    hammer.crossed[1] = crossed_before_;
  }

  /// The load of a step: a free increment xf = before - per_force * last [m], of which `last` is known last, and the
  /// receptance.
  struct Load {
    T before;              ///< [m]
    T per_force, last;     ///< [m/N], [N]
    T xi;                  ///< receptance times stiffness ratio [m/N]
    T inverse_receptance;  ///< 1/receptance, without the ratio [N/m]
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
  /// The segment that holds it.
  [[nodiscard]] HWY_INLINE std::size_t segment() const { return static_cast<std::size_t>(segment_); }

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
    if (HWY_UNLIKELY((below_root == 0) | (below_root == kWindow))) return step_beyond_window(below_root > 0, load);
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
    const Side force{step.p, step.q, 2 * load.inverse_receptance, half_slope * load.inverse_receptance, force_within};
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
    steps.force_within = (here + stiffness * xf) * (inverse_slope * load.inverse_receptance);
    return found;
  }

  using WindowTag = std::remove_cv_t<decltype(hn::CappedTag<T, kWindow>())>;
  using Knots = hn::Vec<WindowTag>;  // a value for each of some knots of the window

  /// xi times the force at a knot [m].
  [[nodiscard]] HWY_INLINE T force_displacement_at(Knot k, const Load& load) const {
    return kVaries ? load.xi * table_.forces[k] : table_.force_displacements[k];
  }

  /// The knot nearest to the compression, below or above it, for each of some knots on that side.
  template <typename V>
  struct NearestKnots {
    V distance, energy;
    V mean_displacement;  ///< xi times the mean force up to there [m]
    V past;               ///< the motion that is left there [m]
  };
  template <typename D, typename Mask>
  HWY_INLINE NearestKnots<hn::Vec<D>> nearest_knots(D tag, Mask lie_below, const Load& load, T stiffness) const {
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

  /// What a motion to each of some knots takes, in the terms of step_coefficients(). The same operations for knots of
  /// the window and for those beyond it: a step does not depend on where the window is.
  template <typename V>
  struct MotionToKnots {
    V distance, work, remaining;
  };
  template <typename D>
  HWY_INLINE MotionToKnots<hn::Vec<D>> motion_to(D tag, const T* knots, const T* energies,
                                                 const NearestKnots<hn::Vec<D>>& near, const Load& load) const {
    const auto distance =
        hn::Sub(hn::Sub(hn::LoadU(tag, knots), hn::Set(tag, table_.knots[entry_])), hn::Set(tag, beyond_));
    const auto remaining = hn::NegMulAdd(hn::Set(tag, load.per_force), hn::Set(tag, load.last),
                                         hn::Sub(hn::Set(tag, load.before), distance));
    const auto further = hn::Mul(hn::Set(tag, load.xi), hn::Sub(hn::LoadU(tag, energies), near.energy));
    return {distance, hn::MulAdd(near.distance, near.mean_displacement, further), remaining};
  }

  /// The step coefficients for each knot of a vector, from knot `at` on, as the last one crossed.
  template <typename D, typename Mask>
  HWY_INLINE StepCoefficients<hn::Vec<D>> coefficients(D tag, Knot at, Mask lie_below,
                                                       const NearestKnots<hn::Vec<D>>& near, const Load& load) const {
    const auto xis = hn::Set(tag, load.xi);
    const auto force_displacement =
        kVaries ? hn::Mul(xis, hn::LoadU(tag, table_.forces + at)) : hn::LoadU(tag, table_.force_displacements + at);
    const auto of_segment_entered = [&](const T* column) HWY_ATTR {
      return hn::IfThenElse(lie_below, hn::LoadU(tag, column + at - 1), hn::LoadU(tag, column + at));
    };
    const auto entered =
        kVaries ? hn::Mul(xis, of_segment_entered(table_.half_curvatures)) : of_segment_entered(table_.stiffnesses);
    const auto motion = motion_to(tag, table_.knots + at, table_.energies + at, near, load);
    return step_coefficients(VectorArithmetic<D>(), motion.distance, motion.work, force_displacement,
                             motion.remaining, entered);
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
    const auto near = nearest_knots(tag, lie_below, load, stiffness);
    const auto step = coefficients(tag, at, lie_below, near, load);
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

  /// A step across more knots than the window holds.
  HWY_INLINE T step_beyond_window(bool up, const Load& load) {
    const T stiffness = kVaries ? load.xi * table_.half_curvatures[segment_] : table_.stiffnesses[segment_];
    const Knot last = search(up, load, stiffness), crossed = last - segment_;
    const One tag;
    const auto lie_below = hn::FirstN(tag, up ? 0 : 1);
    const auto step = coefficients(tag, last + !up, lie_below, nearest_knots(tag, lie_below, load, stiffness), load);
    enter(crossed);
    const StepCoefficients<T> chosen{hn::GetLane(step.b), hn::GetLane(step.g), hn::GetLane(step.p),
                                     hn::GetLane(step.q), hn::GetLane(hn::Abs(step.discriminant))};
    return solve(T(up ? 1 : -1), chosen, load, 0, 0);
  }

  /// Counts, in whole vectors of knots, those below the root, which lies beyond the nearest knot.
  HWY_INLINE Knot below_root(bool up, const T* knots, const T* energies, std::size_t count,
                             const NearestKnots<hn::Vec<hn::ScalableTag<T>>>& near, const Load& load) const {
    const hn::ScalableTag<T> tag;
    const auto sign = hn::Set(tag, T(up ? 1 : -1)),
               nearest = hn::Set(tag, up ? table_.knots[segment_ + 1] : -table_.knots[segment_]);
    std::size_t crossed = 0;
    for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
      const auto motion = motion_to(tag, knots + k, energies + k, near, load);
      const auto g = hn::NegMulAdd(motion.distance, motion.remaining, motion.work);
      const auto is_nearer = hn::Le(hn::Mul(sign, hn::LoadU(tag, knots + k)), nearest);
      crossed += hn::CountTrue(tag, hn::Or(hn::Lt(g, hn::Zero(tag)), is_nearer));
    }
    return static_cast<Knot>(up ? crossed : count - crossed);
  }

  /// The segment of the root: among the knots next to the window, which few steps leave behind, then among all in two
  /// levels of whole vectors. In range for any increment, also an infinite one, for which g is not a number or the
  /// sentinel knots count as crossed.
  HWY_INLINE Knot search(bool up, const Load& load, T stiffness) const {
    const hn::ScalableTag<T> tag;
    const auto near = nearest_knots(tag, hn::FirstN(tag, up ? 0 : hn::Lanes(tag)), load, stiffness);
    const auto below = [&](const T* knots, const T* energies, std::size_t count)
                           HWY_ATTR { return below_root(up, knots, energies, count, near, load); };
    constexpr Knot kBeside = kKnotsAhead, kBlock = kKnotsPerBlock;
    const Knot window = segment_ + 1 - behind_, segments = static_cast<Knot>(table_.segments);
    const Knot beside = up ? std::min(window + kWindow, segments + 1) : std::max(window - kBeside, 1 - kBeside);
    const Knot found = below(table_.knots + beside, table_.energies + beside, kBeside);
    if (HWY_LIKELY(up ? found < kBeside : found > 0)) return in_range(beside - 1 + found, up);
    Knot first = 1;
    if (table_.blocks > 1) {
      const std::size_t padded = (table_.blocks + kKnotsPerBlock - 1) / kKnotsPerBlock * kKnotsPerBlock;
      const Knot block = below(table_.block_first_knots, table_.block_first_energies, padded) - 1;
      first += kBlock * std::clamp<Knot>(block, 0, static_cast<Knot>(table_.blocks) - 1);
    }
    return in_range(first - 1 + below(table_.knots + first, table_.energies + first, kKnotsPerBlock), up);
  }

  [[nodiscard]] HWY_INLINE Knot in_range(Knot found, bool up) const {
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
