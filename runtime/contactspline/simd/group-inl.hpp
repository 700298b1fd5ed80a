// SPDX-License-Identifier: MIT
// Several hammers in flight side by side, a lane of a vector for each: a part of kernels-inl.hpp
// (docs/how-it-works/kernels.md).

/// A segment for each lane, from the tables of several voices.
template <typename T>
struct SegmentLanes {
  VoiceVector<T> knot, energy, force, half_curvature;
};

#if HWY_TARGET != HWY_SCALAR
/// The 128 bits at from[0] + offset in block 0, those at from[lanes of a block] + offset in block 1, and so on.
template <typename D, typename T = hn::TFromD<D>>
HWY_INLINE hn::Vec<D> load_blocks(D tag, const Segment<T>* const* from, std::size_t offset) {
  if constexpr (hn::MaxLanes(tag) * sizeof(T) == 16) {
    return hn::LoadU(tag, &from[0]->knot + offset);
  } else {
    const hn::Half<D> half;
    return hn::Combine(tag, load_blocks(half, from + hn::Lanes(half), offset), load_blocks(half, from, offset));
  }
}
#endif

/// Loads the segment from[i] into lane i: whole segments, transposed in registers.
template <typename T>
HWY_INLINE SegmentLanes<T> load_segments(const Segment<T>* const* from) {
  const VoiceTag<T> tag;
#if HWY_TARGET == HWY_SCALAR
  const Segment<T>& s = *from[0];
  return {hn::Set(tag, s.knot), hn::Set(tag, s.energy), hn::Set(tag, s.force), hn::Set(tag, s.half_curvature)};
#else
  const auto even_odd = [&](auto a, auto b) HWY_ATTR {
    return std::pair(hn::InterleaveLower(tag, a, b), hn::InterleaveUpper(tag, a, b));
  };
  if constexpr (sizeof(T) == sizeof(double)) {
    const auto [knot, energy] = even_odd(load_blocks(tag, from, 0), load_blocks(tag, from + 1, 0));
    const auto [force, half_curvature] = even_odd(load_blocks(tag, from, 2), load_blocks(tag, from + 1, 2));
    return {knot, energy, force, half_curvature};
  } else {
    const auto [a, b] = even_odd(load_blocks(tag, from, 0), load_blocks(tag, from + 2, 0));
    const auto [c, d] = even_odd(load_blocks(tag, from + 1, 0), load_blocks(tag, from + 3, 0));
    const auto [knot, energy] = even_odd(a, c);
    const auto [force, half_curvature] = even_odd(b, d);
    return {knot, energy, force, half_curvature};
  }
#endif
}

/// The contacts of as many voices as a vector has lanes, a lane each: contact_step (contact.hpp) side by side. Each
/// sample calls begin(), move() for each lane and finish(); modes of other voices may be advanced between.
template <typename T>
class ContactLanes {
  using V = VoiceVector<T>;
  using Knots = hn::RebindToSigned<VoiceTag<T>>;
  using Knot = hn::TFromD<Knots>;  // numbered as in ContactTable
  static constexpr std::size_t kLanes = hn::MaxLanes(VoiceTag<T>());
  static constexpr Knot kWindow = kKnotsAhead;
  static constexpr VoiceTag<T> tag() { return {}; }

 public:
  /// Takes over the hammers of at most kLanes voices; store() returns them. In lanes without a voice the hammer of
  /// the first rests at its string.
  HWY_ATTR void take(std::span<StruckVoice<T>* const> voices) {
    voices_ = voices;
    is_lossy_ = has_stopped_ = false, force_ = hn::Zero(tag());
    const auto load = [&](auto value_of) HWY_ATTR {
      HWY_ALIGN T values[kLanes];
      for (std::size_t lane = 0; lane < kLanes; ++lane) values[lane] = value_of(voice(lane));
      return hn::Load(tag(), values);
    };
    using Voice = const StruckVoice<T>&;
    const auto has_voice = hn::FirstN(tag(), voices.size());
    y_ = hn::IfThenElseZero(has_voice, load([](Voice voice) { return voice.hammer->compression_m; }));
    velocity_ = hn::IfThenElseZero(has_voice, load([](Voice voice) { return voice.hammer->velocity_m_per_s; }));
    last_increment_ = hn::IfThenElseZero(has_voice, load([](Voice voice) { return voice.hammer->last_increment_m; }));
    ratio_ = load([](Voice voice) { return voice.hammer->felt.stiffness_ratio; });
    dt_ = load([](Voice voice) { return voice.strike.time_step_s; });
    gain_ = load([](Voice voice) { return voice.strike.damping_gain; });
    const V mass = load([](Voice voice) { return voice.hammer->mass_kg; });
    const V of_string = load([](Voice voice) { return voice.strike.receptance_of_string; });
    const V loss = load([](Voice voice) { return voice.hammer->felt.loss_s_per_m; });
    velocity_per_force_ = hn::Div(dt_, mass);
    receptance_ = hn::MulAdd(gain_, of_string, hn::Mul(hn::Mul(dt_, velocity_per_force_), hn::Set(tag(), T(0.5))));
    xi_ = hn::Mul(receptance_, ratio_);
    loss_ = hn::Div(hn::Mul(loss, ratio_), dt_);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const ContactTable<T>& table = voice(lane).strike.table;
      rows_[lane] = table.rows, knots_[lane] = table.knots, energies_[lane] = table.energies;
      segment_[lane] = lane < voices.size() ? static_cast<Knot>(voice(lane).hammer->segment) : 1;
      is_lossy_ |= voice(lane).hammer->felt.loss_s_per_m != 0;
    }
    load_segments_here();
  }

  HWY_ATTR void store() const {
    HWY_ALIGN T compression[kLanes], velocity[kLanes], last_increment[kLanes], force[kLanes];
    hn::Store(y_, tag(), compression), hn::Store(velocity_, tag(), velocity), hn::Store(force_, tag(), force);
    hn::Store(last_increment_, tag(), last_increment);
    for (std::size_t lane = 0; lane < voices_.size(); ++lane) {
      HammerState<T>& hammer = *voices_[lane]->hammer;
      hammer.compression_m = compression[lane];
      hammer.velocity_m_per_s = velocity[lane];
      hammer.last_increment_m = last_increment[lane];
      hammer.force_n = force[lane];
      hammer.segment = static_cast<std::size_t>(segment_[lane]);
      std::fill_n(hammer.crossed, 2, 0);
    }
  }

  /// Finds which lanes leave their segments. predicted: the free increments of the strings without damper [m].
  HWY_INLINE void begin(V predicted) {
    const V one = hn::Set(tag(), T(1)), two = hn::Set(tag(), T(2)), half = hn::Set(tag(), T(0.5));
    const V beyond = hn::Sub(y_, here_.knot), above = hn::Sub(next_.knot, y_);
    const V force = hn::MulAdd(hn::Mul(two, here_.half_curvature), beyond, here_.force);
    free_increment_ = hn::NegMulAdd(gain_, predicted, hn::Mul(dt_, velocity_));
    xf_ = free_increment_, lossy_xi_ = xi_;
    if (is_lossy_) {
      resistance_ = hn::Mul(loss_, forces_midway()), divisor_ = hn::MulAdd(receptance_, resistance_, one);
      xf_ = hn::Div(xf_, divisor_), lossy_xi_ = hn::Div(xi_, divisor_);
    }
    const V xi = lossy_xi_;
    slope_ = hn::MulAdd(xi, here_.half_curvature, one);
    free_ = hn::NegMulAdd(xi, force, xf_), elastic_ = hn::MulAdd(here_.half_curvature, xf_, force);
    const auto down = hn::Lt(free_, hn::Neg(hn::Mul(slope_, beyond))), up = hn::Ge(free_, hn::Mul(slope_, above));
    up_ = hn::VecFromMask(tag(), up), crosses_ = hn::VecFromMask(tag(), hn::Or(up, down));

    first_energy_ = hn::IfThenElse(up, next_.energy, here_.energy);
    const V mean_force = hn::Mul(half, hn::Add(force, hn::IfThenElse(up, next_.force, here_.force)));
    first_gain_ = hn::Mul(hn::IfThenElse(up, above, hn::Neg(beyond)), mean_force);

    hn::Store(y_, tag(), search_.from), hn::Store(hn::Add(y_, xf_), tag(), search_.to);
    hn::Store(xi, tag(), search_.xi);
    hn::Store(hn::Mul(xi, hn::Sub(first_gain_, first_energy_)), tag(), search_.work);
    const Knots knots;
    const auto ups = hn::RebindMask(knots, up), downs = hn::RebindMask(knots, down);
    hn::Store(hn::IfThenElse(ups, hn::Set(knots, 2), hn::Set(knots, -kWindow)), knots, search_.window);
    hn::Store(hn::IfThenElse(ups, hn::Set(knots, 1), hn::IfThenElseZero(downs, hn::Set(knots, -1))), knots,
              search_.direction);
  }

  /// Moves a lane that leaves its segment by the first knot, and by as many more of the kWindow knots beyond as have
  /// g < 0 (docs/how-it-works/contact-step.md), here rounded as a whole: finish() notices a knot too many or too few.
  HWY_INLINE void move(std::size_t lane) {
    const WindowTag window;
    const Knot first = segment_[lane] + search_.window[lane];
    const auto from = hn::Set(window, search_.from[lane]), to = hn::Set(window, search_.to[lane]);
    const auto xi = hn::Set(window, search_.xi[lane]), work = hn::Set(window, search_.work[lane]);
    Knot crossed = 1;
    for (Knot k = first; k < first + kWindow; k += static_cast<Knot>(hn::Lanes(window))) {
      const auto knot = hn::LoadU(window, knots_[lane] + k);
      const auto further = hn::MulAdd(xi, hn::LoadU(window, energies_[lane] + k), work);
      const auto g = hn::MulAdd(hn::Sub(knot, from), hn::Sub(knot, to), further);
      crossed += static_cast<Knot>(hn::CountTrue(window, hn::Lt(g, hn::Zero(window))));
    }
    left_[lane] = segment_[lane];
    segment_[lane] += search_.direction[lane] * crossed;
  }

  /// Moves all compressions and returns the forces times the damping gains [N].
  HWY_INLINE V finish() {
    load_segments_here();
    const V two = hn::Set(tag(), T(2)), zero = hn::Zero(tag());
    const auto up = hn::MaskFromVec(up_), crosses = hn::MaskFromVec(crosses_);
    const auto along = [&](V value) HWY_ATTR { return hn::IfThenElse(up, value, hn::Neg(value)); };
    // The last knot crossed, and the segment entered:
    const V knot = hn::IfThenElse(up, here_.knot, next_.knot);
    const V energy = hn::IfThenElse(up, here_.energy, next_.energy);
    const V force = hn::IfThenElse(up, here_.force, next_.force);
    const V xi = lossy_xi_, c = here_.half_curvature;
    const V distance = hn::Sub(knot, y_), remaining = hn::Sub(xf_, distance);
    const V gain = hn::Add(first_gain_, hn::Sub(energy, first_energy_));
    const VectorArithmetic<VoiceTag<T>> math;
    const auto step =
        step_coefficients(math, distance, hn::Mul(xi, gain), hn::Mul(xi, force), remaining, hn::Mul(xi, c));
    const V b = along(step.b), p = along(step.p), q = along(force_coefficient(math, gain, force, remaining, c));
    const V root = hn::Sqrt(hn::Abs(step.discriminant));
    const V b_and_root = hn::Add(root, hn::Abs(b)), p_and_root = hn::Add(root, hn::Abs(p));
    const V two_a = hn::MulAdd(hn::Mul(two, xi), c, two);
    const auto b_adds = hn::Le(b, zero), p_adds = hn::Le(p, zero);
    // Distance and force are fractions, within the segment left as across knots.
    const auto fraction = [&](V above, V below, V above_within) HWY_ATTR {
      return hn::Div(hn::IfThenElse(crosses, above, above_within), hn::IfThenElse(crosses, below, slope_));
    };
    const V s = hn::IfThenElse(b_adds, b_and_root, hn::Mul(hn::Set(tag(), T(-2)), step.g));
    const V moved = fraction(along(s), hn::IfThenElse(b_adds, two_a, b_and_root), free_);
    V f = fraction(hn::IfThenElse(p_adds, p_and_root, hn::Mul(two, q)),
                   hn::IfThenElse(p_adds, hn::Mul(xi, two_a), p_and_root), elastic_);
    f = hn::Mul(ratio_, hn::Max(f, zero));
    if (is_lossy_) f = hn::Div(hn::MulAdd(resistance_, free_increment_, f), divisor_);
    V y = hn::Add(hn::IfThenElse(crosses, knot, y_), moved);
    // False for NaN.
    const V lowest = hn::Max(here_.knot, hn::Set(tag(), kHammerStop_m<T>));
    const auto is_right = hn::And(hn::And(hn::Ge(y, lowest), hn::Lt(y, next_.knot)), hn::Ge(f, zero));
    if (HWY_UNLIKELY(!hn::AllTrue(tag(), is_right))) step_alone(is_right, y, f);
    last_increment_ = hn::Sub(y, y_);
    y_ = y, force_ = f;
    velocity_ = hn::NegMulAdd(velocity_per_force_, f, velocity_);
    return hn::Mul(gain_, f);
  }

  [[nodiscard]] HWY_INLINE bool any_apart() const { return !hn::AllFalse(tag(), hn::Lt(y_, hn::Zero(tag()))); }
  /// Has finish() moved a hammer beyond kHammerStop_m, or to what is no number?
  [[nodiscard]] HWY_INLINE bool has_stopped() const { return has_stopped_; }

 private:
  using WindowTag = std::remove_cv_t<decltype(hn::CappedTag<T, kWindow>())>;

  /// What a lane's search among knots needs.
  struct Search {
    HWY_ALIGN T from[kLanes];          ///< this compression [m]
    HWY_ALIGN T to[kLanes];            ///< that without force [m]
    HWY_ALIGN T xi[kLanes];            ///< [m/N]
    HWY_ALIGN T work[kLanes];          ///< xi times (energy gained up to the first knot - energy there)
    HWY_ALIGN Knot window[kLanes];     ///< first knot of the window, from the segment on
    HWY_ALIGN Knot direction[kLanes];  ///< 1, -1 or 0
  };

  [[nodiscard]] const StruckVoice<T>& voice(std::size_t lane) const {
    return *voices_[lane < voices_.size() ? lane : 0];
  }

  /// contact_step for lanes whose root does not lie in the segment found, because it is beyond the window or because
  /// of rounding, for those that would pull and for those that stop.
  HWY_NOINLINE HWY_ATTR void step_alone(hn::Mask<VoiceTag<T>> is_right, V& y, V& f) {
    HWY_ALIGN T right[kLanes], y0[kLanes], last[kLanes], xf[kLanes], xi[kLanes], ys[kLanes], fs[kLanes];
    hn::Store(hn::IfThenElseZero(is_right, hn::Set(tag(), T(1))), tag(), right);
    hn::Store(y_, tag(), y0), hn::Store(last_increment_, tag(), last);
    hn::Store(free_increment_, tag(), xf), hn::Store(receptance_, tag(), xi);
    hn::Store(y, tag(), ys), hn::Store(f, tag(), fs);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (right[lane] == 1) continue;
      const auto& [strike, hammer, out, force, written] = voice(lane);
      const auto step =
          contact_step(strike.segments, hammer->felt, strike.time_step_s, Approach<T>{y0[lane], xf[lane], xi[lane]},
                       static_cast<std::size_t>(left_[lane]), last[lane]);
      ys[lane] = step.compression, segment_[lane] = static_cast<Knot>(step.segment);
      fs[lane] = step.force >= 0 ? step.force : 0;  // 0 for a load that is not a number
      has_stopped_ |= !(step.compression >= kHammerStop_m<T>);
    }
    y = hn::Load(tag(), ys), f = hn::Load(tag(), fs);
    load_segments_here();
  }

  /// force_midway of each lane [N].
  [[nodiscard]] HWY_INLINE V forces_midway() const {
    HWY_ALIGN T y0[kLanes], last[kLanes], forces[kLanes];
    hn::Store(y_, tag(), y0), hn::Store(last_increment_, tag(), last);
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      forces[lane] =
          force_midway(voice(lane).strike.segments, static_cast<std::size_t>(segment_[lane]), y0[lane], last[lane]);
    return hn::Load(tag(), forces);
  }

  HWY_INLINE void load_segments_here() {
    const Segment<T>*here[kLanes], *next[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      here[lane] = rows_[lane] + segment_[lane];
      next[lane] = here[lane] + 1;
    }
    here_ = load_segments<T>(here), next_ = load_segments<T>(next);
  }

  std::span<StruckVoice<T>* const> voices_;
  const Segment<T>* rows_[kLanes];
  const T *knots_[kLanes], *energies_[kLanes];
  bool is_lossy_, has_stopped_;  // any of them
  V dt_, gain_, ratio_, velocity_per_force_, receptance_, xi_, loss_;
  // State:
  V y_, velocity_, last_increment_, force_;
  Knot segment_[kLanes];
  SegmentLanes<T> here_, next_;  // the segments of the compressions and those above
  // Of the current sample:
  V free_increment_, resistance_, divisor_;
  V xf_, lossy_xi_;  // divided by the divisor
  V slope_, free_, elastic_;
  V up_, crosses_;  // masks
  V first_gain_, first_energy_;
  Search search_;
  Knot left_[kLanes];  // the segments left
};

/// Samples between two checks whether a hammer apart from the string is out of its reach.
inline constexpr std::size_t kCheckInterval = 32;

/// Voices with hammers in flight in vectors of lanes. The voices of one vector have their contacts while the modes of
/// those of another advance: neither waits for the other, so the processor computes both at the same time. Modes are
/// one vector behind the contacts: those of the last vector advance in the next sample.
template <typename T>
class VoicesSideBySide {
 public:
  explicit VoicesSideBySide(std::span<StruckVoice<T>* const> voices)
      : voices_(voices), vectors_((voices.size() + kLanes - 1) / kLanes) {
    for (std::size_t i = 0; i < voices.size(); ++i) {
      const auto& [strike, hammer, out, force, written] = *voices[i];
      modes_[i] = ModesUnderLoad<T>(strike);
      modes_[i].take();
      predicted_[i * kLanes] = modes_[i].predicted();
      samples_ = std::min(samples_, out.size() - written);
      may_be_out_of_reach_ |= strike.damping_gain == 1;
    }
    for (std::size_t v = 0; v < vectors_; ++v)
      contacts_[v].take(voices.subspan(v * kLanes, std::min(kLanes, voices.size() - v * kLanes)));
  }

  /// Sample n.
  HWY_INLINE void play(std::size_t n) {
    for (std::size_t v = 0; v < vectors_; ++v) {
      const bool is_first = v == 0 && n == 0;
      const std::size_t other = v > 0 ? v - 1 : vectors_ - 1;
      if (vectors_ == 1 || is_first) {
        collide(v, [](std::size_t) {});
        if (vectors_ == 1) advance_all(v, n);
      } else {
        collide(v, [&](std::size_t lane) HWY_ATTR { advance(other * kLanes + lane); });
        write(other, v > 0 ? n : n - 1);
      }
    }
  }

  /// After n samples: is no block full, no hammer stopped, and none found apart that may be out of reach?
  [[nodiscard]] HWY_INLINE bool goes_on(std::size_t n) const {
    bool goes_on = n < samples_;
    const bool looks = may_be_out_of_reach_ && n % kCheckInterval == 0;
    for (std::size_t v = 0; v < vectors_; ++v)
      goes_on = goes_on && !contacts_[v].has_stopped() && !(looks && contacts_[v].any_apart());
    return goes_on;
  }

  /// Lets the modes catch up with the contacts and puts all back into the voices, which have played n samples.
  HWY_INLINE void finish(std::size_t n) {
    if (vectors_ > 1) advance_all(vectors_ - 1, n - 1);
    for (std::size_t v = 0; v < vectors_; ++v) contacts_[v].store();
    for (std::size_t i = 0; i < voices_.size(); ++i) {
      modes_[i].store(0);
      voices_[i]->written += n;
    }
  }

 private:
  using Tag = VoiceTag<T>;
  static constexpr std::size_t kLanes = hn::MaxLanes(Tag()), kVectors = kMaxTogether / kLanes;

  /// The contacts of a vector; between(lane) runs while a lane looks for its segment.
  template <typename Between>
  HWY_INLINE void collide(std::size_t v, Between between) {
    contacts_[v].begin(sums_over_lanes<kLanes>(Tag(), predicted_ + v * kLanes * kLanes));
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      contacts_[v].move(lane);
      between(lane);
    }
    hn::Store(contacts_[v].finish(), Tag(), pushes_ + v * kLanes);
  }
  HWY_INLINE void advance(std::size_t i) {
    if (i >= voices_.size()) return;
    const T gain = voices_[i]->strike.damping_gain;
    if (gain == 1)
      modes_[i].template advance<false>(gain, pushes_[i], predicted_ + i * kLanes, output_ + i * kLanes);
    else
      modes_[i].template advance<true>(gain, pushes_[i], predicted_ + i * kLanes, output_ + i * kLanes);
  }
  HWY_INLINE void write(std::size_t v, std::size_t n) {
    hn::Store(sums_over_lanes<kLanes>(Tag(), output_ + v * kLanes * kLanes), Tag(), outputs_ + v * kLanes);
    for (std::size_t i = v * kLanes; i < std::min(voices_.size(), (v + 1) * kLanes); ++i) {
      const auto& [strike, hammer, out, force, written] = *voices_[i];
      out[written + n] = outputs_[i];
      if (force != nullptr) force[written + n] = pushes_[i] / strike.damping_gain;
    }
  }
  HWY_INLINE void advance_all(std::size_t v, std::size_t n) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) advance(v * kLanes + lane);
    write(v, n);
  }

  // Parts of each voice's sums:
  HWY_ALIGN T predicted_[kMaxTogether * kLanes] = {};
  HWY_ALIGN T output_[kMaxTogether * kLanes] = {};
  HWY_ALIGN T pushes_[kMaxTogether];
  HWY_ALIGN T outputs_[kMaxTogether];
  ModesUnderLoad<T> modes_[kMaxTogether];
  ContactLanes<T> contacts_[kVectors];
  std::span<StruckVoice<T>* const> voices_;
  std::size_t vectors_, samples_ = ~std::size_t{0};
  bool may_be_out_of_reach_ = false;
};

/// Advances voices with hammers in flight, sample by sample, until a block is full, a hammer stops or, every
/// kCheckInterval samples, one is found apart while a voice has no damper: it may be out of reach.
template <typename T>
HWY_NOINLINE HWY_FLATTEN void process_side_by_side(std::span<StruckVoice<T>* const> voices) {
  VoicesSideBySide<T> together(voices);
  std::size_t n = 0;
  do together.play(n);
  while (together.goes_on(++n));
  together.finish(n);
}
