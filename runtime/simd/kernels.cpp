// SPDX-License-Identifier: MIT
// The kernels, compiled once for each instruction set; the best one that the machine has is taken at run time.
#include "contactspline/kernels.hpp"

#include "contactspline/flush_denormals.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/felt-inl.hpp"

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

/// What comes of a mode's change c over a sample, `share` of its free increment d: ModalBank::commit.
template <bool kDamped, typename T>
HWY_INLINE void move(Vector<T> stiffness, Vector<T> rest, Vector<T> loss, Vector<T> share, Vector<T>& q,
                     Vector<T>& d) {
  const auto c = kDamped ? hn::Mul(share, d) : d;
  q = hn::Add(q, c);
  if constexpr (kRounds<T>) {
    const auto pull = hn::MulAdd(stiffness, q, hn::MulAdd(rest, q, hn::Mul(loss, c)));
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
    loss[v] = hn::Load(tag, string.loss + at);
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

template <bool kDamped, typename T>
HWY_INLINE void play_free_of(const ModalArrays<T>& string, T share, const T* pickup, std::span<T> out) {
  const Tag<T> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const std::size_t vectors = (string.modes + lanes - 1) / lanes;
  const std::size_t groups = (vectors + kMostVectors - 1) / kMostVectors;
  HWY_ALIGN T sums[kBlock * HWY_MAX_BYTES / sizeof(T)];
  while (!out.empty()) {
    const std::size_t samples = std::min(out.size(), kBlock);
    for (std::size_t i = 0; i < samples; ++i) hn::Store(hn::Zero(tag), tag, sums + i * lanes);
    for (std::size_t group = 0, at = 0; group < groups; ++group) {
      const std::size_t many = (vectors - at + groups - group - 1) / (groups - group);
      run_free_group<kDamped>(many, string, at * lanes, share, pickup, samples, sums);
      at += many;
    }
    for (std::size_t i = 0; i < samples; ++i)
      out[i] = hn::GetLane(hn::SumOfLanes(tag, hn::Load(tag, sums + i * lanes)));
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
      : string_(string), lines_((string.modes + kLine - 1) / kLine), modes_(strike.workspace) {
    const T* const sources[kStruckLines] = {string.displacement, string.free_increment, strike.give,
                                            strike.free_give,    string.stiffness,      string.stiffness_rest,
                                            string.loss,         strike.shape,          pickup};
    for (std::size_t line = 0; line < lines_; ++line)
      for (std::size_t i = 0; i < kStruckLines; ++i) copy(sources[i] + line * kLine, at(line, static_cast<Row>(i)));
  }

  /// Sums over the modes of the strike's shape times free increment, and of the pickup's times displacement.
  struct Sums {
    T coming, heard;
  };

  [[nodiscard]] HWY_ATTR T coming() const { return sum(kShape, kFreeIncrement); }
  /// Displacement at the pickup per newton, once the force is applied.
  [[nodiscard]] HWY_ATTR T pickup_admittance() const { return sum(kPickup, kGive); }

  /// Applies the force of the sample before the last, `push` after the damper's share, to what the last sample did
  /// without it, and does the coming sample without its force, which is still missing in the sums.
  template <bool kDamped>
  HWY_INLINE Sums pass(T share, T push) {
    const auto pushes = hn::Set(tag(), push), shares = hn::Set(tag(), share);
    auto coming0 = hn::Zero(tag()), coming1 = coming0, heard0 = coming0, heard1 = coming0;
    std::size_t line = 0;
    for (; line + 1 < lines_; line += 2) {
      step<kDamped>(modes_ + line * kStride, shares, pushes, coming0, heard0);
      step<kDamped>(modes_ + (line + 1) * kStride, shares, pushes, coming1, heard1);
    }
    if (line < lines_) step<kDamped>(modes_ + line * kStride, shares, pushes, coming0, heard0);
    return {hn::GetLane(hn::SumOfLanes(tag(), hn::Add(coming0, coming1))),
            hn::GetLane(hn::SumOfLanes(tag(), hn::Add(heard0, heard1)))};
  }

  /// Applies the last force and gives the modes back.
  HWY_ATTR void give_back(T push) {
    const auto pushes = hn::Set(tag(), push);
    for (std::size_t line = 0; line < lines_; ++line)
      for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag())) {
        const T* const mode = modes_ + line * kStride + v;
        hn::Store(pushed(mode, kGive, kDisplacement, pushes), tag(), string_.displacement + line * kLine + v);
        hn::Store(pushed(mode, kFreeGive, kFreeIncrement, pushes), tag(), string_.free_increment + line * kLine + v);
      }
  }

 private:
  enum Row { kDisplacement, kFreeIncrement, kGive, kFreeGive, kStiffness, kRest, kLoss, kShape, kPickup };
  static constexpr std::size_t kLine = 64 / sizeof(T);
  static constexpr std::size_t kStride = kStruckLines * kLine;

  static constexpr Tag<T> tag() { return {}; }
  [[nodiscard]] T* at(std::size_t line, Row row) const { return modes_ + line * kStride + row * kLine; }

  HWY_ATTR static void copy(const T* from, T* to) {
    for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag())) hn::Store(hn::Load(tag(), from + v), tag(), to + v);
  }

  [[nodiscard]] HWY_ATTR T sum(Row a, Row b) const {
    auto sum = hn::Zero(tag());
    for (std::size_t line = 0; line < lines_; ++line)
      for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag()))
        sum = hn::MulAdd(hn::Load(tag(), at(line, a) + v), hn::Load(tag(), at(line, b) + v), sum);
    return hn::GetLane(hn::SumOfLanes(tag(), sum));
  }

  HWY_INLINE static Vector<T> pushed(const T* mode, Row give, Row state, Vector<T> pushes) {
    return hn::MulAdd(hn::Load(tag(), mode + give * kLine), pushes, hn::Load(tag(), mode + state * kLine));
  }

  template <bool kDamped>
  HWY_INLINE static void step(T* HWY_RESTRICT line, Vector<T> shares, Vector<T> pushes, Vector<T>& coming,
                              Vector<T>& heard) {
    for (std::size_t v = 0; v < kLine; v += hn::Lanes(tag())) {
      T* const mode = line + v;
      auto q = pushed(mode, kGive, kDisplacement, pushes);
      auto d = pushed(mode, kFreeGive, kFreeIncrement, pushes);
      const auto rest = kRounds<T> ? hn::Load(tag(), mode + kRest * kLine) : hn::Zero(tag());
      move<kDamped, T>(hn::Load(tag(), mode + kStiffness * kLine), rest, hn::Load(tag(), mode + kLoss * kLine),
                       shares, q, d);
      hn::Store(q, tag(), mode + kDisplacement * kLine);
      hn::Store(d, tag(), mode + kFreeIncrement * kLine);
      coming = hn::MulAdd(hn::Load(tag(), mode + kShape * kLine), d, coming);
      heard = hn::MulAdd(hn::Load(tag(), mode + kPickup * kLine), q, heard);
    }
  }

  ModalArrays<T> string_;
  std::size_t lines_;
  T* modes_;
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

  /// The furthest that the place of the strike can ever be without a force, whatever the phases of the modes: their
  /// amplitudes are sqrt(q^2 + p^2), p being (d + (loss + stiffness) q / 2) / sqrt(stiffness - (loss + stiffness)^2 /
  /// 4).
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
      move<kDamped, T>(hn::Load(tag, string_.stiffness + at), rest, hn::Load(tag, string_.loss + at), shares, q, d);
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

/// What a hammer and a string on its way over a block of samples are told by.
template <typename T>
struct Strike {
  const ModalArrays<T>& string;
  const StrikeArrays<T>& arrays;
  SegmentTable<T> felt;
  T dt, share, string_admittance;
  const T* pickup;
};

/// A hammer in flight, taken over for some samples; land() returns it.
template <bool kLossy, typename T>
class Flight {
 public:
  HWY_INLINE Flight(const Strike<T>& strike, const HammerFlight<T>& hammer)
      : table_(strike.felt),
        felt_(strike.arrays.felt, hammer.compression_m, hammer.segment),
        dt_(strike.dt),
        give_(strike.dt / hammer.mass_kg),
        admittance_(strike.dt * give_ / 2 + strike.share * strike.string_admittance),
        ratio_(hammer.felt.stiffness_ratio),
        loss_(hammer.felt.loss_s_per_m * ratio_ / strike.dt),
        velocity_(hammer.velocity_m_per_s) {
    if constexpr (!kLossy) Felt<T>::prepare(strike.arrays.felt, ratio_ * admittance_);
  }

  [[nodiscard]] HWY_INLINE T compression() const { return felt_.compression(); }
  /// Of the hammer over the coming sample without force [m].
  [[nodiscard]] HWY_INLINE T way() const { return dt_ * velocity_; }
  /// What a force takes from a free increment by the hammer's giving way in the sample before [m/N].
  [[nodiscard]] HWY_INLINE T give_way() const { return dt_ * give_; }

  /// One sample of the contact; gives the force [N], rounded to either side of 0.
  HWY_INLINE T meet(T free_increment) {
    force_ = kLossy ? with_loss(free_increment)
                    : ratio_ * felt_.template press<false>(free_increment, ratio_ * admittance_);
    velocity_ -= give_ * force_;
    return force_;
  }

  HWY_INLINE void land(HammerFlight<T>& hammer) const {
    hammer.compression_m = felt_.compression();
    hammer.segment = felt_.segment();
    hammer.velocity_m_per_s = velocity_;
    hammer.force_n = std::max(T(0), force_);
  }

 private:
  HWY_INLINE T with_loss(T free_increment) {
    const T y0 = felt_.compression();
    const T resistance = loss_ * felt_.force();  // [N/m]
    const T inverse = 1 / (1 + admittance_ * resistance);
    const T elastic = felt_.template press<true>(inverse * free_increment, inverse * ratio_ * admittance_);
    const T force = inverse * (ratio_ * elastic + resistance * free_increment);
    if (force >= 0) return force;
    const T y = y0 + free_increment;
    felt_.put(y, segment_index(table_, y));
    return 0;
  }

  SegmentTable<T> table_;
  Felt<T> felt_;
  T dt_, give_, admittance_;
  T ratio_, loss_;
  T velocity_;
  T force_ = 0;
};

/// Samples after which it is looked whether a hammer that is apart is out of the string's reach.
constexpr std::size_t kLook = 64;
/// So many samples out of reach are worth the passes over the modes that tell of them.
constexpr std::size_t kWorthIt = 16;
/// Up to so many samples are played on the modes where they lie.
constexpr std::size_t kFew = 2;

/// The contact waits for a sum over the modes, which wait for its last force. But both are affine in that force: so
/// the sum is made one sample ahead without it, and what it adds is one product. Contact and modes then go on beside
/// each other in the machine. Returns the samples played: fewer where the hammer is caught or, after some, apart.
template <bool kDamped, bool kLossy, typename T>
HWY_INLINE std::size_t play_struck_of(const Strike<T>& strike, HammerFlight<T>& hammer, std::span<T> out, T* force) {
  const T share = strike.share;
  StruckModes<T> modes(strike.string, strike.arrays, strike.pickup);
  const T pickup_admittance = modes.pickup_admittance();
  Flight<kLossy, T> flight(strike, hammer);
  const T yields = flight.give_way() + share * share * strike.arrays.free_admittance;
  T before = flight.way() - share * modes.coming();  // free increment but for the last force
  T last = 0;  // force of the last sample, which the modes have not yet felt; earlier ones are in velocity and modes
  std::size_t n = 0;
  for (; n < out.size() && flight.compression() > kCaught_m<T>; ++n) {
    if (n % kLook == 0 && n > 0 && flight.compression() < 0) break;
    const T way = flight.way();
    const T now = flight.meet(before - yields * last);
    const auto sums = modes.template pass<kDamped>(share, share * last);
    out[n] = sums.heard + pickup_admittance * share * now;
    before = way - share * sums.coming;
    last = now;
    if (force != nullptr) force[n] = std::max(T(0), now);
  }
  flight.land(hammer);
  modes.give_back(share * last);
  return n;
}

template <bool kDamped, bool kLossy, typename T>
HWY_INLINE std::size_t play_few_of(const Strike<T>& strike, HammerFlight<T>& hammer, std::span<T> out, T* force) {
  ModesInPlace<T> modes(strike.string, strike.arrays, strike.pickup);
  Flight<kLossy, T> flight(strike, hammer);
  std::size_t n = 0;
  for (; n < out.size() && flight.compression() > kCaught_m<T>; ++n) {
    const T now = flight.meet(flight.way() - strike.share * modes.coming());
    out[n] = modes.template advance<kDamped>(strike.share, strike.share * now);
    if (force != nullptr) force[n] = std::max(T(0), now);
  }
  flight.land(hammer);
  return n;
}

/// A hammer that the string cannot reach for some time: the string is then played alone. Returns the samples played.
template <typename T>
HWY_INLINE std::size_t play_apart(const Strike<T>& strike, HammerFlight<T>& hammer, std::span<T> out, T* force) {
  const ModesInPlace<T> modes(strike.string, strike.arrays, strike.pickup);
  const T place = modes.place(), way = strike.dt * hammer.velocity_m_per_s;
  const T gap = -(hammer.compression_m + place) - modes.reach();
  if (!(gap > kWorthIt * way) || !(gap > 0)) return 0;
  const std::size_t samples =
      gap < way * static_cast<T>(out.size()) ? static_cast<std::size_t>(gap / way) : out.size();
  play_free_at(strike.string, strike.share, strike.pickup, out.first(samples));
  hammer.compression_m += static_cast<T>(samples) * way - (modes.place() - place);
  hammer.segment = segment_index(strike.felt, hammer.compression_m);
  hammer.force_n = 0;
  if (force != nullptr) std::fill_n(force, samples, T(0));
  return samples;
}

template <bool kDamped, bool kLossy, typename T>
HWY_INLINE std::size_t play_struck_as(const Strike<T>& strike, HammerFlight<T>& hammer, std::span<T> out, T* force) {
  if (out.size() <= kFew) return play_few_of<kDamped, kLossy>(strike, hammer, out, force);
  std::size_t n = 0;
  while (n < out.size() && hammer.compression_m > kCaught_m<T>) {
    const std::span<T> rest = out.subspan(n);
    T* const forces = force == nullptr ? nullptr : force + n;
    std::size_t played = 0;
    if (!kDamped && rest.size() > kWorthIt && hammer.compression_m < 0)
      played = play_apart(strike, hammer, rest, forces);
    if (played == 0) played = play_struck_of<kDamped, kLossy>(strike, hammer, rest, forces);
    n += played;
  }
  return n;
}

template <typename T>
HWY_INLINE std::size_t play_struck_at(const Strike<T>& strike, HammerFlight<T>& hammer, std::span<T> out, T* force) {
  const bool is_damped = strike.share != 1;
  if (hammer.felt.loss_s_per_m == 0)
    return is_damped ? play_struck_as<true, false>(strike, hammer, out, force)
                     : play_struck_as<false, false>(strike, hammer, out, force);
  return is_damped ? play_struck_as<true, true>(strike, hammer, out, force)
                   : play_struck_as<false, true>(strike, hammer, out, force);
}

void PlayFreeFloat(const ModalArrays<float>& string, float share, const float* pickup, std::span<float> out) {
  play_free_at(string, share, pickup, out);
}
void PlayFreeDouble(const ModalArrays<double>& string, double share, const double* pickup, std::span<double> out) {
  play_free_at(string, share, pickup, out);
}
HWY_FLATTEN std::size_t PlayStruckFloat(const ModalArrays<float>& string, const StrikeArrays<float>& strike,
                                        SegmentTable<float> felt, float dt, float share, float admittance,
                                        HammerFlight<float>& hammer, const float* pickup, std::span<float> out,
                                        float* force) {
  return play_struck_at<float>({string, strike, felt, dt, share, admittance, pickup}, hammer, out, force);
}
HWY_FLATTEN std::size_t PlayStruckDouble(const ModalArrays<double>& string, const StrikeArrays<double>& strike,
                                         SegmentTable<double> felt, double dt, double share, double admittance,
                                         HammerFlight<double>& hammer, const double* pickup, std::span<double> out,
                                         double* force) {
  return play_struck_at<double>({string, strike, felt, dt, share, admittance, pickup}, hammer, out, force);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace contactspline::detail {

HWY_EXPORT(PlayFreeFloat);
HWY_EXPORT(PlayFreeDouble);
HWY_EXPORT(PlayStruckFloat);
HWY_EXPORT(PlayStruckDouble);

void play_free(const ModalArrays<float>& string, float share, const float* pickup, std::span<float> out) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(PlayFreeFloat)(string, share, pickup, out);
}
void play_free(const ModalArrays<double>& string, double share, const double* pickup, std::span<double> out) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(PlayFreeDouble)(string, share, pickup, out);
}
std::size_t play_struck(const ModalArrays<float>& string, const StrikeArrays<float>& strike, SegmentTable<float> felt,
                        float dt, float share, float string_admittance, HammerFlight<float>& hammer,
                        const float* pickup, std::span<float> out, float* force) {
  const FlushDenormals flushed;
  return HWY_DYNAMIC_DISPATCH(PlayStruckFloat)(string, strike, felt, dt, share, string_admittance, hammer, pickup,
                                               out, force);
}
std::size_t play_struck(const ModalArrays<double>& string, const StrikeArrays<double>& strike,
                        SegmentTable<double> felt, double dt, double share, double string_admittance,
                        HammerFlight<double>& hammer, const double* pickup, std::span<double> out, double* force) {
  const FlushDenormals flushed;
  return HWY_DYNAMIC_DISPATCH(PlayStruckDouble)(string, strike, felt, dt, share, string_admittance, hammer, pickup,
                                                out, force);
}

}  // namespace contactspline::detail
#endif
