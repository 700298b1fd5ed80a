// SPDX-License-Identifier: MIT
// The modes of a resonator in vectors: alone, and under the force of a hammer (docs/kernels.md).
#if defined(CONTACTSPLINE_MODES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CONTACTSPLINE_MODES_INL
#undef CONTACTSPLINE_MODES_INL
#else
#define CONTACTSPLINE_MODES_INL
#endif

#include <hwy/highway.h>

#include "contactspline/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace contactspline::detail {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

template <typename T>
using Tag = hn::ScalableTag<T>;
template <typename T>
using Vector = hn::Vec<Tag<T>>;

/// Is T so coarse that the rest of the stiffness is kept beside it? As in ModalBank.
template <typename T>
constexpr bool kRounds = sizeof(T) < sizeof(double);

/// What a mode loses of a change c: its loss, and what the rest of the stiffness makes of c (see move).
template <typename T>
HWY_INLINE Vector<T> loss_with(Vector<T> rest, Vector<T> loss) {
  return kRounds<T> ? hn::Add(loss, rest) : loss;
}

/// What comes of a mode's change c over a sample, `share` of its free increment d: ModalBank::commit, its pull summed
/// in the order in which its parts are known. loss: loss_with(rest, loss).
template <bool kDamped, typename T>
HWY_INLINE void move(Vector<T> stiffness, Vector<T> rest, Vector<T> loss, Vector<T> share, Vector<T>& q,
                     Vector<T>& d) {
  const auto c = kDamped ? hn::Mul(share, d) : d;
  const auto q_before = q;
  q = hn::Add(q, c);
  if constexpr (kRounds<T>) {
    const auto pull = hn::MulAdd(stiffness, q, hn::MulAdd(loss, c, hn::Mul(rest, q_before)));
    d = kDamped ? hn::Add(hn::Sub(c, d), hn::Sub(c, pull)) : hn::Sub(c, pull);
  } else {
    const auto kept = hn::NegMulAdd(stiffness, q, hn::NegMulAdd(loss, c, c));
    d = kDamped ? hn::Add(hn::Sub(c, d), kept) : kept;
  }
}

constexpr std::size_t kBlock = 64;  // samples

/// So many vectors of modes over a block of samples, in registers; adds shape times displacement to `sums`.
template <std::size_t kVectors, bool kDamped, typename T>
HWY_INLINE void run_free(const ModalArrays<T>& string, std::size_t first, T share, const T* pickup,
                         std::size_t samples, T* HWY_RESTRICT sums) {
  const Tag<T> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto shares = hn::Set(tag, share);
  Vector<T> stiffness[kVectors], rest[kVectors], loss[kVectors], q[kVectors], d[kVectors], shape[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    const std::size_t at = first + v * lanes;
    stiffness[v] = hn::Load(tag, string.stiffness + at);
    rest[v] = hn::Load(tag, string.stiffness_rest + at);
    loss[v] = loss_with<T>(rest[v], hn::Load(tag, string.loss + at));
    shape[v] = hn::Load(tag, pickup + at);
    q[v] = hn::Load(tag, string.displacement + at);
    d[v] = hn::Load(tag, string.free_increment + at);
  }
  for (std::size_t n = 0; n < samples; ++n) {
    auto sum = hn::Load(tag, sums + n * lanes);
    for (std::size_t v = 0; v < kVectors; ++v) {
      move<kDamped, T>(stiffness[v], rest[v], loss[v], shares, q[v], d[v]);
      sum = hn::MulAdd(shape[v], q[v], sum);
    }
    hn::Store(sum, tag, sums + n * lanes);
  }
  for (std::size_t v = 0; v < kVectors; ++v) {
    hn::Store(q[v], tag, string.displacement + first + v * lanes);
    hn::Store(d[v], tag, string.free_increment + first + v * lanes);
  }
}

/// As many vectors at once as it takes to hide how long each waits for itself.
constexpr std::size_t kMostVectors = 7;

template <bool kDamped, std::size_t kVectors = kMostVectors, typename T>
HWY_INLINE void run_free_group(std::size_t vectors, const ModalArrays<T>& string, std::size_t first, T share,
                               const T* pickup, std::size_t samples, T* HWY_RESTRICT sums) {
  if (vectors == kVectors) return run_free<kVectors, kDamped>(string, first, share, pickup, samples, sums);
  if constexpr (kVectors > 1)
    run_free_group<kDamped, kVectors - 1>(vectors, string, first, share, pickup, samples, sums);
}

/// The sums over the lanes of each of so many vectors, a power of two and at most as many as lanes: with as many, one
/// a lane, in their order.
template <std::size_t kCount, typename T>
HWY_INLINE Vector<T> sums_over_lanes(const T* vectors) {
  const Tag<T> tag;
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kCount > 1) {
    const auto first = sums_over_lanes<kCount / 2>(vectors);
    const auto second = sums_over_lanes<kCount / 2>(vectors + kCount / 2 * hn::Lanes(tag));
    return hn::Add(hn::ConcatEven(tag, second, first), hn::ConcatOdd(tag, second, first));
  }
#endif
  return hn::Load(tag, vectors);
}

template <bool kDamped, typename T>
HWY_INLINE void play_free_of(const ModalArrays<T>& string, T share, const T* pickup, std::span<T> out) {
  const Tag<T> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const std::size_t vectors = (string.modes + lanes - 1) / lanes;
  const std::size_t groups = (vectors + kMostVectors - 1) / kMostVectors;
  HWY_ALIGN T sums[kBlock * HWY_MAX_BYTES / sizeof(T)];
  static_assert(kBlock % hn::MaxLanes(tag) == 0);
  while (!out.empty()) {
    const std::size_t samples = std::min(out.size(), kBlock), rounded = (samples + lanes - 1) / lanes * lanes;
    for (std::size_t i = 0; i < rounded; ++i) hn::Store(hn::Zero(tag), tag, sums + i * lanes);
    for (std::size_t group = 0, at = 0; group < groups; ++group) {
      const std::size_t many = (vectors - at + groups - group - 1) / (groups - group);
      run_free_group<kDamped>(many, string, at * lanes, share, pickup, samples, sums);
      at += many;
    }
    HWY_ALIGN T heard[kBlock];
    for (std::size_t i = 0; i < samples; i += lanes)
      hn::Store(sums_over_lanes<hn::MaxLanes(tag)>(sums + i * lanes), tag, heard + i);
    std::copy_n(heard, samples, out.data());
    out = out.subspan(samples);
  }
}

template <typename T>
HWY_INLINE void play_free_at(const ModalArrays<T>& string, T share, const T* pickup, std::span<T> out) {
  if (share == 1)
    play_free_of<false>(string, share, pickup, out);
  else
    play_free_of<true>(string, share, pickup, out);
}

/// The modes of a struck string: what a pass reads and writes of as many modes as fill a cache line lies side by
/// side. So no store lies at the same place of a page as a later load, and one stream of memory is read.
template <typename T>
class StruckModes {
 public:
  /// Takes the modes over; give_back() returns them.
  HWY_ATTR StruckModes(const ModalArrays<T>& string, const StrikeArrays<T>& strike, const T* pickup)
      : string_(string), strike_(strike), lines_((string.modes + kLine - 1) / kLine) {
    each([&](std::size_t i, T* mode) HWY_ATTR {
      const auto per_unit = hn::Load(tag(), strike.per_unit + i);
      hn::Store(hn::Mul(per_unit, hn::Load(tag(), string.displacement + i)), tag(), row(mode, Row::displacement));
      hn::Store(hn::Mul(per_unit, hn::Load(tag(), string.free_increment + i)), tag(), row(mode, Row::free_increment));
      hn::Store(hn::Mul(hn::Load(tag(), strike.unit + i), hn::Load(tag(), pickup + i)), tag(),
                row(mode, Row::pickup));
    });
  }

  /// Sums over the modes of the strike's shape times free increment, and of the pickup's times displacement.
  struct Sums {
    T coming, heard;
  };

  [[nodiscard]] HWY_ATTR T coming() const {
    auto sum = hn::Zero(tag());
    each([&](std::size_t, const T* mode)
             HWY_ATTR { sum = hn::MulAdd(load(mode, Row::shape), load(mode, Row::free_increment), sum); });
    return hn::GetLane(hn::SumOfLanes(tag(), sum));
  }
  /// Displacement at the pickup per newton, once the force is applied.
  [[nodiscard]] HWY_ATTR T pickup_admittance() const {
    auto sum = hn::Zero(tag());
    each([&](std::size_t, const T* mode) HWY_ATTR { sum = hn::Add(sum, load(mode, Row::pickup)); });
    return hn::GetLane(hn::SumOfLanes(tag(), sum));
  }

  /// Applies the force of the last sample, `push` after the damper's share, which that one was done without, and does
  /// the coming sample without its force, which is still missing in the sums.
  template <bool kDamped>
  HWY_INLINE Sums pass(T share, T push) {
    const auto pushes = hn::Set(tag(), push), shares = hn::Set(tag(), share);
    auto coming0 = hn::Zero(tag()), coming1 = coming0, heard0 = coming0, heard1 = coming0;
    std::size_t line = 0;
    for (; line + 1 < lines_; line += 2) {
      step<kDamped>(strike_.workspace + line * kStride, shares, pushes, coming0, heard0);
      step<kDamped>(strike_.workspace + (line + 1) * kStride, shares, pushes, coming1, heard1);
    }
    if (line < lines_) step<kDamped>(strike_.workspace + line * kStride, shares, pushes, coming0, heard0);
    return {hn::GetLane(hn::SumOfLanes(tag(), hn::Add(coming0, coming1))),
            hn::GetLane(hn::SumOfLanes(tag(), hn::Add(heard0, heard1)))};
  }

  /// Applies the last force and gives the modes back.
  HWY_ATTR void give_back(T push) {
    const auto pushes = hn::Set(tag(), push);
    each([&](std::size_t i, const T* mode) HWY_ATTR {
      const auto unit = hn::Load(tag(), strike_.unit + i);
      hn::Store(hn::Mul(unit, pushed_displacement(mode, pushes)), tag(), string_.displacement + i);
      hn::Store(hn::Mul(unit, pushed_increment(mode, pushes)), tag(), string_.free_increment + i);
    });
  }

 private:
  using Row = StruckRow;
  static constexpr std::size_t kLine = 64 / sizeof(T);
  static constexpr std::size_t kStride = kStruckLines * kLine;

  static constexpr Tag<T> tag() { return {}; }
  static HWY_INLINE T* row(T* mode, std::size_t which) { return mode + which * kLine; }
  static HWY_INLINE Vector<T> load(const T* mode, std::size_t which) { return hn::Load(tag(), mode + which * kLine); }

  /// Calls for each vector of modes, with its first mode and where its rows begin.
  template <typename Do>
  HWY_INLINE void each(Do act) const {
    for (std::size_t line = 0; line < lines_; ++line)
      for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag()))
        act(line * kLine + v, strike_.workspace + line * kStride + v);
  }

  static HWY_INLINE Vector<T> pushed_displacement(const T* mode, Vector<T> pushes) {
    return hn::Add(load(mode, Row::displacement), pushes);
  }
  static HWY_INLINE Vector<T> pushed_increment(const T* mode, Vector<T> pushes) {
    return hn::MulAdd(load(mode, Row::free_give), pushes, load(mode, Row::free_increment));
  }

  template <bool kDamped>
  HWY_INLINE static void step(T* HWY_RESTRICT line, Vector<T> shares, Vector<T> pushes, Vector<T>& coming,
                              Vector<T>& heard) {
    for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag())) {
      T* const mode = line + v;
      auto q = pushed_displacement(mode, pushes), d = pushed_increment(mode, pushes);
      const auto rest = kRounds<T> ? load(mode, Row::rest) : hn::Zero(tag());
      move<kDamped, T>(load(mode, Row::stiffness), rest, load(mode, Row::loss), shares, q, d);
      hn::Store(q, tag(), row(mode, Row::displacement));
      hn::Store(d, tag(), row(mode, Row::free_increment));
      coming = hn::MulAdd(load(mode, Row::shape), d, coming);
      heard = hn::MulAdd(load(mode, Row::pickup), q, heard);
    }
  }

  ModalArrays<T> string_;
  StrikeArrays<T> strike_;
  std::size_t lines_;
};

/// The modes of a struck string where they lie, for a sample or two: what StruckModes takes over and gives back is
/// then not worth its while.
template <typename T>
class ModesInPlace {
 public:
  HWY_ATTR ModesInPlace(const ModalArrays<T>& string, const StrikeArrays<T>& strike, const T* pickup)
      : string_(string), strike_(strike), pickup_(pickup) {}

  /// Sum of the strike's shape times free increment.
  [[nodiscard]] HWY_INLINE T coming() const { return inner_product(strike_.shape, string_.free_increment); }
  /// Sum of the strike's shape times displacement.
  [[nodiscard]] HWY_INLINE T place() const { return inner_product(strike_.shape, string_.displacement); }

  /// The furthest that the place of the strike can ever be without force or damper, whatever the phases of the modes:
  /// their amplitudes are sqrt(q^2 + p^2), p being (d + (loss + stiffness) q / 2) / sqrt(stiffness - (loss +
  /// stiffness)^2 / 4).
  [[nodiscard]] HWY_INLINE T reach() const {
    const Tag<T> tag;
    const auto half = hn::Set(tag, T(0.5));
    auto sum = hn::Zero(tag);
    for (std::size_t at = 0; at < string_.modes; at += hn::Lanes(tag)) {
      const auto q = hn::Load(tag, string_.displacement + at), d = hn::Load(tag, string_.free_increment + at);
      const auto pull =
          hn::Mul(half, hn::Add(hn::Load(tag, string_.loss + at), hn::Load(tag, string_.stiffness + at)));
      const auto a = hn::Mul(hn::Load(tag, strike_.shape + at), q);
      const auto b = hn::Mul(hn::Load(tag, strike_.swing + at), hn::MulAdd(pull, q, d));
      // sqrt(a^2 + b^2) is at most max + (sqrt(2) - 1) min
      const auto large = hn::Max(hn::Abs(a), hn::Abs(b)), small = hn::Min(hn::Abs(a), hn::Abs(b));
      sum = hn::Add(sum, hn::MulAdd(hn::Set(tag, T(0.4143)), small, large));
    }
    return T(1.001) * hn::GetLane(hn::SumOfLanes(tag, sum));
  }

  /// One sample under a force times the damper's share; gives the sum of the pickup's shape times displacement.
  template <bool kDamped>
  HWY_INLINE T advance(T share, T push) {
    const Tag<T> tag;
    const auto shares = hn::Set(tag, share), pushes = hn::Set(tag, push);
    auto heard = hn::Zero(tag);
    for (std::size_t at = 0; at < string_.modes; at += hn::Lanes(tag)) {
      auto q = hn::Load(tag, string_.displacement + at), d = hn::Load(tag, string_.free_increment + at);
      const auto rest = kRounds<T> ? hn::Load(tag, string_.stiffness_rest + at) : hn::Zero(tag);
      const auto loss = loss_with<T>(rest, hn::Load(tag, string_.loss + at));
      move<kDamped, T>(hn::Load(tag, string_.stiffness + at), rest, loss, shares, q, d);
      q = hn::MulAdd(hn::Load(tag, strike_.give + at), pushes, q);
      d = hn::MulAdd(hn::Load(tag, strike_.free_give + at), pushes, d);
      hn::Store(q, tag, string_.displacement + at);
      hn::Store(d, tag, string_.free_increment + at);
      heard = hn::MulAdd(hn::Load(tag, pickup_ + at), q, heard);
    }
    return hn::GetLane(hn::SumOfLanes(tag, heard));
  }

 private:
  [[nodiscard]] HWY_INLINE T inner_product(const T* a, const T* b) const {
    const Tag<T> tag;
    auto sum = hn::Zero(tag);
    for (std::size_t at = 0; at < string_.modes; at += hn::Lanes(tag))
      sum = hn::MulAdd(hn::Load(tag, a + at), hn::Load(tag, b + at), sum);
    return hn::GetLane(hn::SumOfLanes(tag, sum));
  }

  ModalArrays<T> string_;
  StrikeArrays<T> strike_;
  const T* pickup_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#endif
