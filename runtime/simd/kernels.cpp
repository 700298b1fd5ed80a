// SPDX-License-Identifier: MIT
// The kernels, compiled once for each instruction set; the best one that the machine has is taken at run time.
#include "contactspline/kernels.hpp"

#include "contactspline/flush_denormals.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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
  auto pull = hn::Mul(loss, c);
  if constexpr (kRounds<T>) pull = hn::MulAdd(rest, q, pull);
  pull = hn::MulAdd(stiffness, q, pull);
  d = kDamped ? hn::Add(hn::Sub(c, d), hn::Sub(c, pull)) : hn::Sub(c, pull);
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

/// Of whole vectors of knots, how many the root of a crossing lies above: those where the way u to the knot and g = u
/// h(u) have different signs (docs/contact-step.md), whatever the direction. g is written so that little is left to
/// do once the free increment is known; rounding may only exchange segments beside a knot that the root lies on.
template <typename T>
HWY_INLINE std::size_t passed(const Crossing<T, std::dynamic_extent>& crossing, const T* knots, const T* energies,
                              std::size_t count) {
  const Tag<T> tag;
  const auto y0 = hn::Set(tag, crossing.y0);
  const auto xf = hn::Set(tag, crossing.xf);
  const auto xi = hn::Set(tag, crossing.xi);
  const auto energy = hn::Set(tag, crossing.table[crossing.start].energy_at(crossing.y0));
  const auto zero = hn::Zero(tag);
  std::size_t below = 0;
  for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
    const auto way = hn::Sub(hn::Load(tag, knots + k), y0);
    const auto gain = hn::Sub(hn::Load(tag, energies + k), energy);
    const auto g = hn::NegMulAdd(way, xf, hn::MulAdd(xi, gain, hn::Mul(way, way)));
    below += hn::CountTrue(tag, hn::Xor(hn::Lt(g, zero), hn::Lt(way, zero)));
  }
  return below;
}

/// As PlainMachine, without a branch that depends on the data: the landing is searched in two levels of whole
/// vectors.
template <typename T>
struct VectorMachine {
  const StrikeArrays<T>& felt;

  HWY_ATTR T choose(T test, T if_at_most_0, T otherwise) const {
    const hn::CappedTag<T, 1> tag;
    const auto is_at_most_0 = hn::Le(hn::Set(tag, test), hn::Zero(tag));
    return hn::GetLane(hn::IfThenElse(is_at_most_0, hn::Set(tag, if_at_most_0), hn::Set(tag, otherwise)));
  }

  // One step more of rounding, but what is divided by is known early.
  HWY_ATTR T quotient(T dividend, T divisor) const { return dividend * (1 / divisor); }

  HWY_ATTR std::size_t knots_below_root(const Crossing<T, std::dynamic_extent>& crossing) const {
    std::size_t block = 0;
    if (felt.blocks > 1) {
      const std::size_t pivots = (felt.blocks + kKnotsInABlock - 1) / kKnotsInABlock * kKnotsInABlock;
      const std::size_t below = passed(crossing, felt.pivots, felt.pivot_energies, pivots);
      block = below - (below > 0);
    }
    const std::size_t at = block * kKnotsInABlock;
    return at + passed(crossing, felt.knots + at, felt.energies + at, kKnotsInABlock);
  }
};

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

/// The contact waits for a sum over the modes, which wait for its last force. But both are affine in that force: so
/// the sum is made one sample ahead without it, and what it adds is one product. Contact and modes then go on beside
/// each other in the machine.
template <bool kDamped, typename T>
HWY_INLINE std::size_t play_struck_of(const ModalArrays<T>& string, const StrikeArrays<T>& strike,
                                      SegmentTable<T> felt, T dt, T share, T string_admittance,
                                      HammerFlight<T>& hammer, const T* pickup, std::span<T> out, T* force) {
  StruckModes<T> modes(string, strike, pickup);
  const T coming = modes.coming();
  const T pickup_admittance = modes.pickup_admittance();
  const T give = dt / hammer.mass_kg;
  const T admittance = dt * give / 2 + share * string_admittance;
  const StrikeArrays<T> place = strike;  // a copy, which no store below can change
  const VectorMachine<T> machine{place};
  HammerFlight<T> flight = hammer;
  const T yields = dt * give + share * share * place.free_admittance;
  T before = dt * flight.velocity_m_per_s - share * coming;  // free increment but for the last force
  flight.force_n = 0;                                        // what was before is in the velocity and the modes
  T push = 0;  // the last force that the modes have not yet felt, after the damper's share
  std::size_t n = 0;
  for (; n < out.size() && flight.compression_m > kCaught_m<T>; ++n) {
    const T free_increment = before - yields * flight.force_n;
    const auto step =
        contact_step(felt, flight.felt, dt, Approach<T>{flight.compression_m, free_increment, admittance},
                     flight.segment, machine);
    const auto sums = modes.template pass<kDamped>(share, push);
    push = share * step.force;
    out[n] = sums.heard + pickup_admittance * push;
    before = dt * flight.velocity_m_per_s - share * sums.coming;
    flight.velocity_m_per_s -= give * step.force;
    flight.force_n = step.force;
    if (force != nullptr) force[n] = step.force;
    flight.compression_m = step.compression;
    flight.segment = step.segment;
  }
  hammer = flight;
  modes.give_back(push);
  return n;
}

template <typename T>
HWY_INLINE std::size_t play_struck_at(const ModalArrays<T>& string, const StrikeArrays<T>& strike,
                                      SegmentTable<T> felt, T dt, T share, T string_admittance,
                                      HammerFlight<T>& hammer, const T* pickup, std::span<T> out, T* force) {
  return share == 1
             ? play_struck_of<false>(string, strike, felt, dt, share, string_admittance, hammer, pickup, out, force)
             : play_struck_of<true>(string, strike, felt, dt, share, string_admittance, hammer, pickup, out, force);
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
  return play_struck_at(string, strike, felt, dt, share, admittance, hammer, pickup, out, force);
}
HWY_FLATTEN std::size_t PlayStruckDouble(const ModalArrays<double>& string, const StrikeArrays<double>& strike,
                                         SegmentTable<double> felt, double dt, double share, double admittance,
                                         HammerFlight<double>& hammer, const double* pickup, std::span<double> out,
                                         double* force) {
  return play_struck_at(string, strike, felt, dt, share, admittance, hammer, pickup, out, force);
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
