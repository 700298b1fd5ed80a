// SPDX-License-Identifier: MIT
// The modes of a string in vectors, under the force of a hammer: a part of kernels-inl.hpp
// (docs/how-it-works/kernels.md).

/// The modes of a struck string, line by line: all that a pass reads and writes of one cache line of modes lies side
/// by side. A pass then reads one stream of memory, and no store has the page offset of a later load.
template <typename T>
class ModesUnderLoad {
 public:
  ModesUnderLoad() = default;
  explicit ModesUnderLoad(const StrikeConstants<T>& strike)
      : strike_(strike), lines_((strike.modes.modes + kLine - 1) / kLine) {}

  /// Takes the modes over; store() returns them.
  HWY_INLINE void take() {
    each([&](std::size_t i, T* mode) HWY_ATTR {
      const auto per_unit = hn::Load(tag(), strike_.per_unit + i);
      hn::Store(hn::Mul(per_unit, hn::Load(tag(), strike_.modes.displacement + i)), tag(),
                row(mode, ModeRow::displacement));
      hn::Store(hn::Mul(per_unit, hn::Load(tag(), strike_.modes.free_increment + i)), tag(),
                row(mode, ModeRow::free_increment));
      hn::Store(hn::Mul(hn::Load(tag(), strike_.unit + i), hn::Load(tag(), strike_.pickup + i)), tag(),
                row(mode, ModeRow::pickup));
    });
  }

  /// Number of cache lines of a row.
  [[nodiscard]] std::size_t lines() const { return lines_; }

  /// Sums over the modes: the place's free increment over the coming sample, and the displacement at the pickup.
  struct Sums {
    T predicted, output;
  };

  [[nodiscard]] HWY_ATTR T predicted() const {
    auto sum = hn::Zero(tag());
    each([&](std::size_t, const T* mode)
             HWY_ATTR { sum = hn::MulAdd(load(mode, ModeRow::shape), load(mode, ModeRow::free_increment), sum); });
    return hn::GetLane(hn::SumOfLanes(tag(), sum));
  }
  /// Displacement at the pickup per newton, once the force is applied.
  [[nodiscard]] HWY_ATTR T pickup_receptance() const {
    auto sum = hn::Zero(tag());
    each([&](std::size_t, const T* mode) HWY_ATTR { sum = hn::Add(sum, load(mode, ModeRow::pickup)); });
    return hn::GetLane(hn::SumOfLanes(tag(), sum));
  }

  /// Applies the force of the last sample, damping_gain times, and advances the modes by the next sample without its
  /// force, which the sums therefore lack.
  template <bool kDamped>
  HWY_INLINE Sums pass(T damping_gain, T push) {
    const auto pushes = hn::Set(tag(), push), gains = hn::Set(tag(), damping_gain);
    auto predicted0 = hn::Zero(tag()), predicted1 = predicted0, output0 = predicted0, output1 = predicted0;
    std::size_t line = 0;
    for (; line + 1 < lines_; line += 2) {
      step<kDamped>(strike_.workspace + line * kStride, gains, pushes, predicted0, output0);
      step<kDamped>(strike_.workspace + (line + 1) * kStride, gains, pushes, predicted1, output1);
    }
    if (line < lines_) step<kDamped>(strike_.workspace + line * kStride, gains, pushes, predicted0, output0);
    return {hn::GetLane(hn::SumOfLanes(tag(), hn::Add(predicted0, predicted1))),
            hn::GetLane(hn::SumOfLanes(tag(), hn::Add(output0, output1)))};
  }

  /// Advances the modes by one sample under a force, damping_gain times. Leaves the sums of pass(), of which none
  /// lacks a force, lane by lane.
  template <bool kDamped>
  HWY_INLINE void advance(T damping_gain, T push, T* HWY_RESTRICT predicted, T* HWY_RESTRICT output) {
    const auto pushes = hn::Set(tag(), push), gains = hn::Set(tag(), damping_gain);
    auto predicted_sum = hn::Zero(tag()), output_sum = predicted_sum;
    const auto vector = [&](T* HWY_RESTRICT mode) HWY_ATTR {
      const auto d = load(mode, ModeRow::free_increment);
      const auto c = kDamped ? hn::MulAdd(gains, d, pushes) : hn::Add(d, pushes);
      const auto q = hn::Add(load(mode, ModeRow::displacement), c);
      auto pull = hn::MulAdd(load(mode, ModeRow::stiffness), q, hn::Mul(load(mode, ModeRow::loss), c));
      if constexpr (kRounds<T>) pull = hn::MulAdd(load(mode, ModeRow::rest), q, pull);
      const auto next = hn::Add(kDamped ? hn::Sub(c, d) : pushes, hn::Sub(c, pull));
      hn::Store(q, tag(), row(mode, ModeRow::displacement));
      hn::Store(next, tag(), row(mode, ModeRow::free_increment));
      predicted_sum = hn::MulAdd(load(mode, ModeRow::shape), next, predicted_sum);
      output_sum = hn::MulAdd(load(mode, ModeRow::pickup), q, output_sum);
    };
    const std::size_t modes = strike_.modes.modes;
    T* line = strike_.workspace;
    for (T* const end = line + modes / kLine * kStride; line != end; line += kStride)
      for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag())) vector(line + v);
    for (std::size_t v = 0; v < modes % kLine; v += hn::Lanes(tag())) vector(line + v);
    store_folded(predicted_sum, predicted);
    store_folded(output_sum, output);
  }

  /// Applies the last force and returns the modes.
  HWY_ATTR void store(T push) {
    const auto pushes = hn::Set(tag(), push);
    each([&](std::size_t i, T* mode) HWY_ATTR {
      const auto unit = hn::Load(tag(), strike_.unit + i);
      hn::Store(hn::Mul(unit, pushed_displacement(mode, pushes)), tag(), strike_.modes.displacement + i);
      hn::Store(hn::Mul(unit, pushed_increment(mode, pushes)), tag(), strike_.modes.free_increment + i);
    });
  }

 private:
  static constexpr std::size_t kLine = kLineSize<T>;
  static constexpr std::size_t kStride = kRowsPerLine * kLine;

  static constexpr Tag<T> tag() { return {}; }
  static HWY_INLINE T* row(T* mode, std::size_t which) { return mode + which * kLine; }
  static HWY_INLINE Vector<T> load(const T* mode, std::size_t which) { return hn::Load(tag(), mode + which * kLine); }

  static HWY_INLINE void store_folded(Vector<T> sum, T* to) {
    const VoiceTag<T> voices;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(voices) < hn::MaxLanes(tag()))
      hn::Store(hn::Add(hn::LowerHalf(voices, sum), hn::UpperHalf(voices, sum)), voices, to);
    else
#endif
      hn::Store(sum, voices, to);
  }

  /// Calls act(first mode, its rows) for each vector of modes.
  template <typename Act>
  HWY_INLINE void each(Act act) const {
    for (std::size_t line = 0; line < lines_; ++line)
      for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag()))
        act(line * kLine + v, strike_.workspace + line * kStride + v);
  }

  static HWY_INLINE Vector<T> pushed_displacement(const T* mode, Vector<T> pushes) {
    return hn::Add(load(mode, ModeRow::displacement), pushes);
  }
  static HWY_INLINE Vector<T> pushed_increment(const T* mode, Vector<T> pushes) {
    return hn::MulAdd(load(mode, ModeRow::free_increment_gain), pushes, load(mode, ModeRow::free_increment));
  }

  template <bool kDamped>
  HWY_INLINE static void step(T* HWY_RESTRICT line, Vector<T> gains, Vector<T> pushes, Vector<T>& predicted,
                              Vector<T>& output) {
    for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag())) {
      T* const mode = line + v;
      auto q = pushed_displacement(mode, pushes), d = pushed_increment(mode, pushes);
      const auto rest = kRounds<T> ? load(mode, ModeRow::rest) : hn::Zero(tag());
      move<kDamped, T>(load(mode, ModeRow::stiffness), rest, load(mode, ModeRow::loss), gains, q, d);
      hn::Store(q, tag(), row(mode, ModeRow::displacement));
      hn::Store(d, tag(), row(mode, ModeRow::free_increment));
      predicted = hn::MulAdd(load(mode, ModeRow::shape), d, predicted);
      output = hn::MulAdd(load(mode, ModeRow::pickup), q, output);
    }
  }

  StrikeConstants<T> strike_;
  std::size_t lines_;
};

/// The modes of a struck string in their own arrays: for a sample or two, for which ModesUnderLoad does not pay.
template <typename T>
class ModesInPlace {
 public:
  HWY_ATTR explicit ModesInPlace(const StrikeConstants<T>& strike) : strike_(strike) {}

  /// Free increment of the place over the coming sample [m].
  [[nodiscard]] HWY_INLINE T predicted() const { return inner_product(strike_.shape, strike_.modes.free_increment); }
  /// Displacement of the place [m].
  [[nodiscard]] HWY_INLINE T displacement() const { return inner_product(strike_.shape, strike_.modes.displacement); }

  /// Upper bound of the displacement at the place without force or damper, for any phases of the modes [m]. The
  /// amplitude of a mode is sqrt(q^2 + r^2) with r = (d + (loss + stiffness) q / 2) / sqrt(stiffness - (loss +
  /// stiffness)^2 / 4).
  [[nodiscard]] HWY_INLINE T max_displacement() const {
    const Tag<T> tag;
    const ModalArrays<T>& modes = strike_.modes;
    const auto half = hn::Set(tag, T(0.5));
    auto sum = hn::Zero(tag);
    for (std::size_t at = 0; at < modes.modes; at += hn::Lanes(tag)) {
      const auto q = hn::Load(tag, modes.displacement + at), d = hn::Load(tag, modes.free_increment + at);
      const auto pull = hn::Mul(half, hn::Add(hn::Load(tag, modes.loss + at), hn::Load(tag, modes.stiffness + at)));
      const auto a = hn::Mul(hn::Load(tag, strike_.shape + at), q);
      const auto b = hn::Mul(hn::Load(tag, strike_.amplitude_gain + at), hn::MulAdd(pull, q, d));
      // sqrt(a^2 + b^2) is at most max + (sqrt(2) - 1) min
      const auto large = hn::Max(hn::Abs(a), hn::Abs(b)), small = hn::Min(hn::Abs(a), hn::Abs(b));
      sum = hn::Add(sum, hn::MulAdd(hn::Set(tag, T(0.4143)), small, large));
    }
    return T(1.001) * hn::GetLane(hn::SumOfLanes(tag, sum));
  }

  /// One sample under a force, damping_gain times. Returns the displacement at the pickup.
  template <bool kDamped>
  HWY_INLINE T advance(T damping_gain, T push) {
    const Tag<T> tag;
    const ModalArrays<T>& modes = strike_.modes;
    const auto gains = hn::Set(tag, damping_gain), pushes = hn::Set(tag, push);
    auto output = hn::Zero(tag);
    for (std::size_t at = 0; at < modes.modes; at += hn::Lanes(tag)) {
      auto q = hn::Load(tag, modes.displacement + at), d = hn::Load(tag, modes.free_increment + at);
      const auto rest = kRounds<T> ? hn::Load(tag, modes.stiffness_rest + at) : hn::Zero(tag);
      const auto loss = loss_with<T>(rest, hn::Load(tag, modes.loss + at));
      move<kDamped, T>(hn::Load(tag, modes.stiffness + at), rest, loss, gains, q, d);
      q = hn::MulAdd(hn::Load(tag, strike_.receptance + at), pushes, q);
      d = hn::MulAdd(hn::Load(tag, strike_.free_increment_gain + at), pushes, d);
      hn::Store(q, tag, modes.displacement + at);
      hn::Store(d, tag, modes.free_increment + at);
      output = hn::MulAdd(hn::Load(tag, strike_.pickup + at), q, output);
    }
    return hn::GetLane(hn::SumOfLanes(tag, output));
  }

 private:
  [[nodiscard]] HWY_INLINE T inner_product(const T* a, const T* b) const {
    return inner_product_here(strike_.modes.modes, a, b);
  }

  StrikeConstants<T> strike_;
};
