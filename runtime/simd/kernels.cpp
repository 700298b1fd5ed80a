// SPDX-License-Identifier: MIT
// The kernels, compiled once for each instruction set; the best one that the machine has is taken at run time.
#include "contactspline/kernels.hpp"

#include "contactspline/flush_denormals.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/felt-inl.hpp"
#include "simd/modes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace contactspline::detail {
namespace HWY_NAMESPACE {
namespace {

/// A hammer in flight, taken over for some samples; give_back() returns it.
template <bool kLossy, typename T>
class Flight {
 public:
  HWY_INLINE Flight(const Strike<T>& strike, const HammerFlight<T>& hammer)
      : table_(strike.felt),
        felt_(strike.place.felt, hammer),
        dt_(strike.time_step_s),
        give_(strike.time_step_s / hammer.mass_kg),
        admittance_(strike.time_step_s * give_ / 2 + strike.share * strike.string_admittance),
        inverse_admittance_(1 / admittance_),
        xi_(admittance_ * hammer.felt.stiffness_ratio),
        loss_(hammer.felt.loss_s_per_m * hammer.felt.stiffness_ratio / strike.time_step_s),
        velocity_(hammer.velocity_m_per_s) {
    if constexpr (!kLossy) Felt<kLossy, T>::prepare(strike.place.felt, xi_);
  }

  [[nodiscard]] HWY_INLINE T compression() const { return felt_.compression(); }
  /// Of the hammer over the coming sample without force [m].
  [[nodiscard]] HWY_INLINE T way() const { return dt_ * velocity_; }
  /// What a force in the sample before takes from a free increment by way of the hammer [m/N].
  [[nodiscard]] HWY_INLINE T free_admittance() const { return dt_ * give_; }

  /// One sample of the contact, first half: what comes of a free increment of before - per_force * last.
  HWY_INLINE void look(T before, T per_force, T last) {
    if constexpr (kLossy) {
      free_increment_ = before - per_force * last;
      resistance_ = loss_ * felt_.force();
      inverse_ = 1 / (1 + admittance_ * resistance_);
      felt_.look({inverse_ * free_increment_, 0, 0, inverse_ * xi_, inverse_admittance_ + resistance_}, outlook_);
    } else {
      felt_.look({before, per_force, last, xi_, inverse_admittance_}, outlook_);
    }
  }

  /// Second half; gives the force [N], 0 also of what is no number.
  HWY_INLINE T meet() {
    force_ = kLossy ? with_loss() : felt_.land(outlook_);
    velocity_ -= give_ * force_;
    return force_;
  }

  HWY_INLINE void give_back(HammerFlight<T>& hammer) const {
    felt_.give_back(hammer);
    hammer.velocity_m_per_s = velocity_;
    hammer.force_n = force_;
  }

 private:
  HWY_INLINE T with_loss() {
    const T y0 = felt_.compression();
    const T elastic = felt_.land(outlook_);
    const T force = inverse_ * (elastic + resistance_ * free_increment_);
    if (force >= 0) return force;
    const T y = y0 + free_increment_;
    felt_.put(y, segment_index(table_, y));
    return 0;
  }

  SegmentTable<T> table_;
  Felt<kLossy, T> felt_;
  T dt_, give_, admittance_, inverse_admittance_;
  T xi_, loss_;
  T velocity_;
  T force_ = 0;
  // Of the sample under way:
  typename Felt<kLossy, T>::Outlook outlook_;
  T free_increment_ = 0;
  T resistance_ = 0;  // of the loss [N/m]
  T inverse_ = 1;     // 1/(1 + admittance resistance)
};

/// Samples after which it is looked whether a hammer that is apart is out of the string's reach.
constexpr std::size_t kLook = 32;
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
  StruckModes<T> modes(strike.string, strike.place, strike.pickup);
  const T pickup_admittance = modes.pickup_admittance();
  Flight<kLossy, T> flight(strike, hammer);
  const T free_admittance = flight.free_admittance() + share * share * strike.place.free_admittance;
  T before = flight.way() - share * modes.coming();  // free increment but for the last force
  T last = 0;  // force of the last sample, which the modes have not yet felt; what was before is in them
  std::size_t n = 0;
  for (; n < out.size() && flight.compression() >= kCaught_m<T>; ++n) {
    if (!kDamped && n % kLook == 0 && n > 0 && flight.compression() < 0) break;
    const T way = flight.way();
    flight.look(before, free_admittance, last);
    const auto sums = modes.template pass<kDamped>(share, share * last);
    const T now = flight.meet();
    out[n] = sums.heard + pickup_admittance * share * now;
    before = way - share * sums.coming;
    last = now;
    if (force != nullptr) force[n] = now;
  }
  flight.give_back(hammer);
  modes.give_back(share * last);
  return n;
}

template <bool kDamped, bool kLossy, typename T>
HWY_INLINE std::size_t play_few_of(const Strike<T>& strike, HammerFlight<T>& hammer, std::span<T> out, T* force) {
  ModesInPlace<T> modes(strike.string, strike.place, strike.pickup);
  Flight<kLossy, T> flight(strike, hammer);
  std::size_t n = 0;
  for (; n < out.size() && flight.compression() >= kCaught_m<T>; ++n) {
    flight.look(flight.way() - strike.share * modes.coming(), 0, 0);
    const T now = flight.meet();
    out[n] = modes.template advance<kDamped>(strike.share, strike.share * now);
    if (force != nullptr) force[n] = now;
  }
  flight.give_back(hammer);
  return n;
}

/// A hammer that a string without damper cannot reach for some time: the string is then played alone. Returns the
/// samples played.
template <typename T>
HWY_INLINE std::size_t play_apart(const Strike<T>& strike, HammerFlight<T>& hammer, std::span<T> out, T* force) {
  const ModesInPlace<T> modes(strike.string, strike.place, strike.pickup);
  const T place = modes.place(), way = strike.time_step_s * hammer.velocity_m_per_s;
  const T reach = modes.reach(), from_rest = hammer.compression_m + place;
  // Samples until the string might be reached or the hammer caught, which is looked at sample by sample.
  const T gap = way > 0 ? -from_rest - reach : from_rest - reach - kCaught_m<T>, speed = std::abs(way);
  if (!(gap > kWorthIt * speed) || !(-from_rest > reach) || !(from_rest - reach > kCaught_m<T>)) return 0;
  const std::size_t samples =
      gap < speed * static_cast<T>(out.size()) ? static_cast<std::size_t>(gap / speed) : out.size();
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
  while (n < out.size() && hammer.compression_m >= kCaught_m<T>) {
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
HWY_FLATTEN std::size_t PlayStruckFloat(const Strike<float>& strike, HammerFlight<float>& hammer,
                                        std::span<float> out, float* force) {
  return play_struck_at(strike, hammer, out, force);
}
HWY_FLATTEN std::size_t PlayStruckDouble(const Strike<double>& strike, HammerFlight<double>& hammer,
                                         std::span<double> out, double* force) {
  return play_struck_at(strike, hammer, out, force);
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
std::size_t play_struck(const Strike<float>& strike, HammerFlight<float>& hammer, std::span<float> out,
                        float* force) {
  const FlushDenormals flushed;
  return HWY_DYNAMIC_DISPATCH(PlayStruckFloat)(strike, hammer, out, force);
}
std::size_t play_struck(const Strike<double>& strike, HammerFlight<double>& hammer, std::span<double> out,
                        double* force) {
  const FlushDenormals flushed;
  return HWY_DYNAMIC_DISPATCH(PlayStruckDouble)(strike, hammer, out, force);
}

}  // namespace contactspline::detail
#endif
