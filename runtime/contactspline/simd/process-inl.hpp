// SPDX-License-Identifier: MIT
// A hammer and the string it strikes, block by block: a part of kernels-inl.hpp (docs/how-it-works/kernels.md).

/// A hammer in flight. Takes over its state for some samples; store_to() returns it.
template <bool kLossy, typename T>
class HammerUnderLoad {
 public:
  HWY_INLINE HammerUnderLoad(const StrikeConstants<T>& strike, const HammerState<T>& hammer)
      : segments_(strike.segments),
        contact_(strike.table, hammer),
        dt_(strike.time_step_s),
        velocity_per_force_(strike.time_step_s / hammer.mass_kg),
        receptance_(strike.time_step_s * velocity_per_force_ / 2 + strike.damping_gain * strike.receptance_of_string),
        inverse_receptance_(1 / receptance_),
        xi_(receptance_ * hammer.felt.stiffness_ratio),
        loss_(hammer.felt.loss_s_per_m * hammer.felt.stiffness_ratio / strike.time_step_s),
        velocity_(hammer.velocity_m_per_s),
        last_increment_(hammer.last_increment_m) {
    if constexpr (!kLossy) ContactUnderLoad<kLossy, T>::prepare(strike.table, xi_);
  }

  [[nodiscard]] HWY_INLINE T compression() const { return contact_.compression(); }
  /// Displacement of the hammer over the coming sample without force [m].
  [[nodiscard]] HWY_INLINE T free_displacement() const { return dt_ * velocity_; }
  /// Decrease of a free increment by a force in the sample before, through the hammer [m/N].
  [[nodiscard]] HWY_INLINE T free_receptance() const { return dt_ * velocity_per_force_; }

  /// First half of a sample, under a free increment of before - per_force * last.
  HWY_INLINE void prepare_step(T before, T per_force, T last) {
    if constexpr (kLossy) {
      free_increment_ = before - per_force * last;
      const std::size_t segment = contact_.segment();
      resistance_ = loss_ * force_midway(segments_, segment, contact_.compression(), last_increment_);
      inverse_ = 1 / (1 + receptance_ * resistance_);
      contact_.prepare_step({inverse_ * free_increment_, 0, 0, inverse_ * xi_, inverse_receptance_ + resistance_},
                            candidates_);
    } else {
      contact_.prepare_step({before, per_force, last, xi_, inverse_receptance_}, candidates_);
    }
  }

  /// Second half. Returns the force [N]; 0 for a load that is not a number.
  HWY_INLINE T finish_step() {
    force_ = kLossy ? finish_with_loss() : contact_.finish_step(candidates_);
    velocity_ -= velocity_per_force_ * force_;
    return force_;
  }

  HWY_INLINE void store_to(HammerState<T>& hammer) const {
    contact_.store_to(hammer);
    hammer.velocity_m_per_s = velocity_;
    hammer.last_increment_m = last_increment_;
    hammer.force_n = force_;
  }

 private:
  HWY_INLINE T finish_with_loss() {
    const T y0 = contact_.compression();
    const T elastic = contact_.finish_step(candidates_);
    const T force = inverse_ * (elastic + resistance_ * free_increment_);
    const bool pushes = force >= 0;
    if (!pushes) {
      const T y = y0 + free_increment_;
      contact_.put(y, segment_index(segments_, y));
    }
    last_increment_ = contact_.compression() - y0;
    return pushes ? force : 0;
  }

  SegmentTable<T> segments_;
  ContactUnderLoad<kLossy, T> contact_;
  T dt_, velocity_per_force_, receptance_, inverse_receptance_;
  T xi_, loss_;
  T velocity_;
  T last_increment_;  // of the compression over the last sample, with loss [m]
  T force_ = 0;
  // Of the current sample:
  typename ContactUnderLoad<kLossy, T>::StepCandidates candidates_;
  T free_increment_ = 0;
  T resistance_ = 0;  // of the loss [N/m]
  T inverse_ = 1;     // 1/(1 + receptance resistance)
};

/// Fewest voices that are worth advancing side by side.
inline constexpr std::size_t kMinTogether = 4;
/// Cache lines of modes of voices side by side: their workspaces fit into the first cache.
inline constexpr std::size_t kMaxLinesTogether = 64;
/// Shortest run out of reach for which the check's passes over the modes pay.
inline constexpr std::size_t kMinFreeRun = 16;
/// Longest block that is advanced in the modes' own arrays.
inline constexpr std::size_t kMaxInPlace = 2;

/// The contact needs a sum over the modes, and the modes need its last force. Both are affine in that force: so the
/// sum is made one sample ahead without it, and one product adds its part. Contact and modes then overlap in the
/// processor. Returns the samples written: fewer if the hammer is stopped or, after some samples, apart.
template <bool kDamped, bool kLossy, typename T>
HWY_INLINE std::size_t process_in_lines(const StrikeConstants<T>& strike, HammerState<T>& state, std::span<T> out,
                                        T* force) {
  const T gain = strike.damping_gain;
  ModesUnderLoad<T> modes(strike);
  modes.take();
  const T pickup_receptance = modes.pickup_receptance();
  HammerUnderLoad<kLossy, T> hammer(strike, state);
  const T free_receptance = hammer.free_receptance() + gain * gain * strike.free_receptance;
  T before = hammer.free_displacement() - gain * modes.predicted();  // free increment without the last force
  T last = 0;  // force of the last sample, which the modes have not felt yet; earlier ones are in them
  std::size_t n = 0;
  for (; n < out.size() && hammer.compression() >= kHammerStop_m<T>; ++n) {
    if (!kDamped && n % kCheckInterval == 0 && n > 0 && hammer.compression() < 0) break;
    const T free_displacement = hammer.free_displacement();
    hammer.prepare_step(before, free_receptance, last);
    const auto sums = modes.template pass<kDamped>(gain, gain * last);
    const T now = hammer.finish_step();
    out[n] = sums.output + pickup_receptance * gain * now;
    before = free_displacement - gain * sums.predicted;
    last = now;
    if (force != nullptr) force[n] = now;
  }
  hammer.store_to(state);
  modes.store(gain * last);
  return n;
}

template <bool kDamped, bool kLossy, typename T>
HWY_INLINE std::size_t process_in_place(const StrikeConstants<T>& strike, HammerState<T>& state, std::span<T> out,
                                        T* force) {
  const T gain = strike.damping_gain;
  ModesInPlace<T> modes(strike);
  HammerUnderLoad<kLossy, T> hammer(strike, state);
  std::size_t n = 0;
  for (; n < out.size() && hammer.compression() >= kHammerStop_m<T>; ++n) {
    hammer.prepare_step(hammer.free_displacement() - gain * modes.predicted(), 0, 0);
    const T now = hammer.finish_step();
    out[n] = modes.template advance<kDamped>(gain, gain * now);
    if (force != nullptr) force[n] = now;
  }
  hammer.store_to(state);
  return n;
}

/// Advances the string alone while it cannot reach the hammer, without damper. Returns the samples written.
template <typename T>
HWY_INLINE std::size_t process_apart(const StrikeConstants<T>& strike, HammerState<T>& hammer, std::span<T> out,
                                     T* force) {
  const ModesInPlace<T> modes(strike);
  const T place = modes.displacement(), step = strike.time_step_s * hammer.velocity_m_per_s;
  const T reach = modes.max_displacement(), from_rest = hammer.compression_m + place;
  // Samples until the string may be reached or the hammer stopped, which is then checked sample by sample.
  const T gap = step > 0 ? -from_rest - reach : from_rest - reach - kHammerStop_m<T>, speed = std::abs(step);
  if (!(gap > kMinFreeRun * speed) || !(-from_rest > reach) || !(from_rest - reach > kHammerStop_m<T>)) return 0;
  const std::size_t samples =
      gap < speed * static_cast<T>(out.size()) ? static_cast<std::size_t>(gap / speed) : out.size();
  process_free_here(strike.modes, strike.damping_gain, strike.pickup, out.first(samples));
  hammer.compression_m += static_cast<T>(samples) * step - (modes.displacement() - place);
  hammer.segment = segment_index(strike.segments, hammer.compression_m);
  hammer.force_n = 0;
  if (force != nullptr) std::fill_n(force, samples, T(0));
  return samples;
}

template <bool kDamped, bool kLossy, typename T>
HWY_INLINE std::size_t process_struck_as(const StrikeConstants<T>& strike, HammerState<T>& hammer, std::span<T> out,
                                         T* force) {
  if (out.size() <= kMaxInPlace) return process_in_place<kDamped, kLossy>(strike, hammer, out, force);
  std::size_t n = 0;
  while (n < out.size() && hammer.compression_m >= kHammerStop_m<T>) {
    const std::span<T> rest = out.subspan(n);
    T* const forces = force == nullptr ? nullptr : force + n;
    std::size_t written = 0;
    if (!kDamped && rest.size() > kMinFreeRun && hammer.compression_m < 0)
      written = process_apart(strike, hammer, rest, forces);
    if (written == 0) written = process_in_lines<kDamped, kLossy>(strike, hammer, rest, forces);
    n += written;
  }
  return n;
}

template <typename T>
HWY_INLINE std::size_t process_struck_block(const StrikeConstants<T>& strike, HammerState<T>& hammer,
                                            std::span<T> out, T* force) {
  // A hammer seldom strikes a damped string: one variant with and without loss will do.
  if (strike.damping_gain != 1) return process_struck_as<true, true>(strike, hammer, out, force);
  return hammer.felt.loss_s_per_m == 0 ? process_struck_as<false, false>(strike, hammer, out, force)
                                       : process_struck_as<false, true>(strike, hammer, out, force);
}

template <typename T>
[[nodiscard]] HWY_INLINE bool is_finished(const StruckVoice<T>& voice) {
  return voice.written == voice.out.size() || !(voice.hammer->compression_m >= kHammerStop_m<T>);
}

/// Advances a voice while its hammer is out of reach.
template <typename T>
HWY_INLINE void skip_apart(StruckVoice<T>& voice) {
  while (!is_finished(voice) && voice.strike.damping_gain == 1 && voice.hammer->compression_m < 0) {
    const std::span<T> rest = voice.out.subspan(voice.written);
    if (rest.size() <= kMinFreeRun) return;
    T* const forces = voice.force == nullptr ? nullptr : voice.force + voice.written;
    const std::size_t samples = process_apart(voice.strike, *voice.hammer, rest, forces);
    if (samples == 0) return;
    voice.written += samples;
  }
}

/// The rest of a voice's block alone.
template <typename T>
HWY_NOINLINE HWY_FLATTEN void finish_alone(StruckVoice<T>& voice) {
  T* const forces = voice.force == nullptr ? nullptr : voice.force + voice.written;
  voice.written += process_struck_block(voice.strike, *voice.hammer, voice.out.subspan(voice.written), forces);
}

/// Chooses voices for process_side_by_side: those that their hammers can reach, as many as fit into the first cache.
/// Advances the others that it meets by themselves. Returns the number of voices chosen.
template <typename T>
HWY_INLINE std::size_t choose_together(std::span<StruckVoice<T>> voices, StruckVoice<T>** together) {
  std::size_t count = 0, lines = 0;
  for (StruckVoice<T>& voice : voices) {
    if (count == kMaxTogether || lines >= kMaxLinesTogether) break;
    skip_apart(voice);
    if (!is_finished(voice) && voice.out.size() - voice.written <= kMaxInPlace) finish_alone(voice);
    if (is_finished(voice)) continue;
    lines += ModesUnderLoad<T>(voice.strike).lines();
    together[count++] = &voice;
  }
  constexpr std::size_t kLanes = hn::MaxLanes(VoiceTag<T>());
  return count > kLanes ? count / kLanes * kLanes : count;  // whole vectors
}

HWY_INLINE void process_struck_here(std::span<StruckVoice<Sample>> voices) {
  while (voices.size() >= kMinTogether) {
    StruckVoice<Sample>* together[kMaxTogether];
    const std::size_t count = choose_together(voices, together);
    if (count < kMinTogether) break;
    process_side_by_side<Sample>({together, count});
  }
  for (StruckVoice<Sample>& voice : voices)
    if (!is_finished(voice)) finish_alone(voice);
}
