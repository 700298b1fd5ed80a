// SPDX-License-Identifier: MIT
// Modes of a stiff string, computed from its physical parameters.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "contactspline/data/mode.hpp"

namespace contactspline {

/// Losses of a resonator. A mode of wavenumber beta [1/m] decays by constant + quadratic beta^2 [1/s]. On a flexible
/// string or a membrane the second term is proportional to the square of the frequency.
struct Losses {
  double constant_per_s;
  double quadratic_m2_per_s;

  [[nodiscard]] double decay_per_s(double wavenumber_per_m) const {
    return constant_per_s + quadratic_m2_per_s * wavenumber_per_m * wavenumber_per_m;
  }
};

/// Stiff string between rigid supports: w0^2 = (T beta^2 + EI beta^4)/mu, beta = i pi/L, mu = M/L (Chaigne and
/// Askenfelt, JASA 1994, with EI = eps T L^2). Shapes sin(beta x) at a place x [m] from one end, modal
/// mass M/2. Each detuning adds one string; all of them lie side by side under one hammer.
struct StiffString {
  double length_m;
  double mass_kg;
  double tension_n;
  double bending_stiffness_n_m2;
  Losses losses;
  std::vector<double> detuning_cents = {0};
};

/// A mode without its losses.
struct UndampedMode {
  double angular_frequency_rad_per_s;
  double wavenumber_per_m;
  double mass_kg;

  /// The damped mode, w^2 = w0^2 - s^2. Empty if it does not oscillate.
  [[nodiscard]] std::optional<Mode> with(const Losses& losses) const {
    const double decay = losses.decay_per_s(wavenumber_per_m);
    const double square = (angular_frequency_rad_per_s - decay) * (angular_frequency_rad_per_s + decay);
    if (!(square > 0)) return {};
    return Mode{std::sqrt(square), decay, mass_kg};
  }
};

/// Mode i = 1, 2, ... of a string without losses. A change of tension detunes it by `cents`.
[[nodiscard]] inline UndampedMode undamped_mode(const StiffString& string, int i, double cents = 0) {
  const double beta = i * std::numbers::pi / string.length_m;
  const double tension = string.tension_n * std::exp2(cents / 600);  // frequency is proportional to sqrt(tension)
  const double stiffness = beta * beta * (tension + string.bending_stiffness_n_m2 * beta * beta);
  return {std::sqrt(stiffness * string.length_m / string.mass_kg), beta, string.mass_kg / 2};
}

/// Stiffness [N/m] of a mode: mass (w^2 + decay^2).
[[nodiscard]] inline double stiffness_of(const Mode& mode) {
  const auto& [w, decay, mass] = mode;
  return mass * (w * w + decay * decay);
}

/// Force on the support at the string's far end per modal displacement [N/m]: -(T beta + EI beta^3) cos(beta L),
/// where T is the tension of the string that the mode belongs to, detuned or not. It is computed from the stiffness k
/// of the mode, as T beta + EI beta^3 = 2 k/(L beta). Row: StringMode, or another type with members `mode` and
/// `wavenumber_per_m`.
template <typename Row>
[[nodiscard]] double bridge_shape(const StiffString& string, const Row& row) {
  const double angle = row.wavenumber_per_m * string.length_m;
  return -2 * stiffness_of(row.mode) / angle * std::cos(angle);
}

/// Stiffness [N/m] that strings add to a bridge.
struct BridgeStiffness {
  double ends = 0;   ///< by their tension, sounding or not
  double modes = 0;  ///< by their modes, which follow the bridge

  BridgeStiffness& operator+=(const BridgeStiffness& other) {
    ends += other.ends;
    modes += other.modes;
    return *this;
  }
};

/// Stiffness that strings add to a bridge at their far end that moves: the sum of T/L over the strings, and of
/// bridge_shape^2/k over their modes (docs/how-it-works/body.md). Row: as in bridge_shape().
template <typename Row>
[[nodiscard]] BridgeStiffness bridge_stiffness(const StiffString& string, const std::vector<Row>& rows) {
  BridgeStiffness sum;
  for (const double cents : string.detuning_cents)
    sum.ends += string.tension_n * std::exp2(cents / 600) / string.length_m;
  for (const Row& row : rows) {
    const double shape = bridge_shape(string, row);
    sum.modes += shape * shape / stiffness_of(row.mode);
  }
  return sum;
}

/// The modes of a vector of StringMode, or of another type with a member `mode`, without what is beside them.
template <typename Row>
[[nodiscard]] std::vector<Mode> bare(const std::vector<Row>& rows) {
  std::vector<Mode> modes;
  for (const Row& row : rows) modes.push_back(row.mode);
  return modes;
}

namespace detail {

/// Largest index of a mode. The search for one that sounds ends here.
inline constexpr int kMaxModeIndex = 1 << 30;

/// The first index after i whose frequency is above w; frequency_at rises with the index and is not above w at i.
/// kMaxModeIndex + 1 if there is none.
template <typename FrequencyAt>
[[nodiscard]] int first_index_above(int i, double w, FrequencyAt frequency_at) {
  int below = i, above = i;
  for (int step = 1; above == below; step *= 2) {
    if (below == kMaxModeIndex) return kMaxModeIndex + 1;
    above = below + (std::min)(step, kMaxModeIndex - below);
    if (!(frequency_at(above) > w)) below = above;
  }
  while (above - below > 1) {
    const int middle = below + (above - below) / 2;
    (frequency_at(middle) > w ? above : below) = middle;
  }
  return above;
}

/// Calls take(mode, wavenumber, i) for the modes i = 1, 2, ... with undamped frequencies below the limit [rad/s] that
/// oscillate, at most `max` of them. Overdamped ones are passed over without a visit to each: a mode of a higher
/// index decays faster, so it must also be faster than this decay.
template <typename UndampedAt, typename Take>
void for_sounding_modes(double limit, std::size_t max, const Losses& losses, UndampedAt undamped_at, Take take) {
  const auto frequency_at = [&](int i) { return undamped_at(i).angular_frequency_rad_per_s; };
  for (int i = 1; max > 0 && i <= kMaxModeIndex;) {
    const UndampedMode undamped = undamped_at(i);
    const double beta = undamped.wavenumber_per_m, w0 = undamped.angular_frequency_rad_per_s;
    const double decay = losses.decay_per_s(beta);
    if (w0 >= limit || decay >= limit) return;
    if (losses.quadratic_m2_per_s * beta * beta >= w0) return;  // overdamped, and so are all higher modes
    if (const auto mode = undamped.with(losses)) {
      take(*mode, beta, i);
      --max;
      ++i;
    } else {
      i = first_index_above(i, decay, frequency_at);
    }
  }
}

}  // namespace detail

/// A mode of a string: its shape at x is sin(wavenumber x).
struct StringMode {
  Mode mode;
  double wavenumber_per_m;
};

/// T beta^2/mu [1/s^2], by which the tension adds to w0^2. Row: as in bridge_shape().
template <typename Row>
[[nodiscard]] double square_by_tension(const StiffString& string, const Row& row) {
  const double beta = row.wavenumber_per_m, decay = row.mode.decay_per_s, w = row.mode.angular_frequency_rad_per_s;
  return w * w + decay * decay - string.bending_stiffness_n_m2 * std::pow(beta, 4) * string.length_m / string.mass_kg;
}

/// By how much a tension grows that detunes its string by `cents`, as a ratio.
[[nodiscard]] inline double tension_change(double cents) {
  return std::expm1(cents / 600 * std::numbers::ln2);
}
/// The mode whose w^2 gains so much [1/s^2]. Frequency 0 if it no longer oscillates.
[[nodiscard]] inline Mode retuned_by(const Mode& mode, double square) {
  const double w = mode.angular_frequency_rad_per_s;
  return {std::sqrt((std::max)(0.0, w * w + square)), mode.decay_per_s, mode.mass_kg};
}

/// The mode after a change of tension that detunes its string by `cents`: w0^2 gains (T' - T) beta^2/mu. square:
/// T beta^2/mu [1/s^2]. Frequency 0 if it no longer oscillates.
[[nodiscard]] inline Mode retuned(const Mode& mode, double square, double cents) {
  return retuned_by(mode, tension_change(cents) * square);
}

/// The same of a mode of a string. The tension T is that of the string that the mode belongs to, detuned or not. Row:
/// as in bridge_shape().
template <typename Row>
[[nodiscard]] Mode retuned(const StiffString& string, const Row& row, double cents) {
  return retuned(row.mode, square_by_tension(string, row), cents);
}

/// All modes with an undamped frequency below a limit, sorted by frequency; at most `max_modes` from each string. A
/// force at a place acts on all strings equally, so divide the shapes there by the number of strings.
[[nodiscard]] inline std::vector<StringMode> modes_below(
    const StiffString& string, double max_frequency_hz,
    std::size_t max_modes = (std::numeric_limits<std::size_t>::max)()) {
  std::vector<StringMode> modes;
  for (const double cents : string.detuning_cents)
    detail::for_sounding_modes(
        2 * std::numbers::pi * max_frequency_hz, max_modes, string.losses,
        [&](int i) { return undamped_mode(string, i, cents); },
        [&](const Mode& mode, double wavenumber_per_m, int) {
          modes.push_back({mode, wavenumber_per_m});
        });
  std::ranges::stable_sort(modes, {}, [](const StringMode& m) {
    return std::hypot(m.mode.angular_frequency_rad_per_s, m.mode.decay_per_s);
  });
  return modes;
}

}  // namespace contactspline
