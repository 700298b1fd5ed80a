// SPDX-License-Identifier: MIT
// The cases of docs/measurements/beside-the-paper.md, and the error and the energy of each scheme in them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bench/baselines/newton.hpp"
#include "bench/baselines/quadratised.hpp"
#include "bench/baselines/spline_updates.hpp"
#include "bench/energy_books.hpp"
#include "bench/models.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/resonators/guitar_g3.hpp"
#include "generator/spline/contact_spline.hpp"

namespace contactspline::bench {

/// ours: the contact step on a string with the receptances of ModalBank. The others have those with which the schemes
/// were published; so has our_update, the contact step in place of the reconstruction, which is not in the tables.
enum class Method { reconstruction, exp3, newton, ours, our_update };

inline constexpr std::array kMethods = {Method::reconstruction, Method::exp3, Method::newton, Method::ours};
inline constexpr std::array kMethodNames = {"reconstruction", "EXP-3", "Newton", "ours"};

/// A hammer or a slide that is thrown at a string or a barrier. The spline has uniform knots.
struct PaperCase {
  Model model;
  int segments;
  double speed_m_per_s, distance_m;
  double press_n;  ///< constant force of the hand on the slide
  double seconds;  ///< that are compared
  int between;     ///< samples from throw to throw

  [[nodiscard]] PowerLaw law() const { return {model.hammer.stiffness_n_per_m_alpha, model.hammer.exponent}; }
  [[nodiscard]] Spline spline() const {
    return uniform_spline({model.name, "", law(), {}, {segments, model.max_compression_m}}, model.name);
  }
};

namespace detail {

inline PaperCase slide_case() {
  using String = resonators::guitar_g3;
  constexpr double kPlace = 0.163, kPickup = 0.52;  // m
  Model model = model_of<materials::steel_on_steel>("slide", 0.05, 0);
  const auto& modes = modes_in<String>;
  model.modes.assign(modes.begin(), modes.end());
  for (const double k : String::wavenumbers) {
    model.strike_shapes.push_back(std::sin(k * kPlace));
    model.pickup_shapes.push_back(std::sin(k * kPickup));
  }
  return {std::move(model), 64, 0, 1e-4, 2.5, 0.01, kSampleRate / 10};
}

}  // namespace detail

inline std::vector<PaperCase> paper_cases() {
  constexpr int kBetween = kSampleRate / 100;
  return {{mb1(), 64, 2, 1e-4, 0, 0, kBetween},
          {c4(), 32, 2.5, 1e-4, 0, 0.008, kBetween},
          {c2(), 32, 2.5, 1e-4, 0, 0.008, kBetween},
          detail::slide_case()};
}

/// visit(scheme, modes, potential) with a new scheme in precision T; potential is that of its contact.
template <std::floating_point T, typename Visit>
auto visit_scheme(const PaperCase& played, Method method, double rate, Visit visit) {
  const Model& model = played.model;
  const auto modes = method == Method::ours ? model.modes : with_mass_kept(model.modes, rate);
  const auto one_step = [&]<typename Update>(Update update, auto potential) {
    OneStepHammerString<T, Update> scheme(model.hammer.mass_kg, std::move(update), modes, model.strike_shapes,
                                          model.pickup_shapes, rate);
    scheme.press(static_cast<T>(played.press_n));
    return visit(scheme, modes, potential);
  };
  if (method == Method::exp3) {
    Exp3HammerString<T> scheme(model.hammer, modes, model.strike_shapes, model.pickup_shapes, rate);
    scheme.press(static_cast<T>(played.press_n));
    return visit(scheme, modes, 0);
  }
  if (method == Method::newton)
    return one_step(NewtonUpdate<T>(model.hammer), [law = played.law()](double y) { return law.energy(y); });
  const Spline spline = played.spline();
  const auto potential_of_spline = [table = segment_table(spline)](double y) {
    return potential(SegmentTable<double>(table), y);
  };
  if (method != Method::reconstruction)
    return one_step(ContactStepUpdate<T>(table_in<T>(segment_table(spline))), potential_of_spline);
  std::vector<RegularSegment<T>> regular(1);
  for (std::size_t j = 0; j < spline.segments.size(); ++j)
    regular.push_back({static_cast<T>(spline.segments[j].knot), static_cast<T>(spline.regular.a[j]),
                       static_cast<T>(spline.regular.b[j]), static_cast<T>(spline.regular.c[j])});
  return one_step(RegularQuadraticUpdate<T>(std::move(regular)), potential_of_spline);
}

/// Advances so many samples. Returns the displacement at the pickup [m].
template <typename Scheme>
double advance(Scheme& scheme, int samples = 1) {
  typename Scheme::Sample out[1] = {};
  for (int n = 0; n < samples; ++n) scheme.process(out);
  return static_cast<double>(out[0]);
}

/// What is compared on a string, for each sample after the throw: the contact force [N]; below the slide, whose force
/// is a rapid sequence of impacts, the displacement at the pickup [m].
inline std::vector<double> signal(const PaperCase& played, Method method, double rate) {
  return visit_scheme<double>(played, method, rate, [&](auto& scheme, const auto&, const auto&) {
    std::vector<double> values;
    scheme.strike(played.speed_m_per_s, played.distance_m);
    for (int n = 0; n < played.seconds * rate; ++n) {
      const double displacement = advance(scheme);
      values.push_back(played.press_n > 0 ? displacement : scheme.force());
    }
    return values;
  });
}

/// Relative L2 error of the signal against `reference`, that of Newton's scheme at `ratio` times the rate. A
/// displacement is that at the end of a sample. The force of EXP-3 acts at the beginning of its sample, that of the
/// others over it.
inline double signal_error(const PaperCase& played, Method method, double rate, const std::vector<double>& reference,
                           std::size_t ratio) {
  const auto found = signal(played, method, rate);
  const bool is_force = !(played.press_n > 0);
  const std::size_t shift = is_force ? (method == Method::exp3 ? 0 : ratio / 2) : ratio - 1;
  double error = 0, power = 0;
  for (std::size_t n = 1; n < found.size() && n * ratio + shift < reference.size(); ++n) {
    const std::size_t at = n * ratio + shift;
    const double exact = is_force ? (reference[at] + reference[at - 1]) / 2 : reference[at];
    error += (found[n] - exact) * (found[n] - exact);
    power += exact * exact;
  }
  return std::sqrt(error / power);
}

/// Mean of |error of the exit time| over `phases` places of the first touch between two samples, in samples. The
/// exact time is that of the power law.
inline double exit_error(const PaperCase& played, Method method, double rate, int phases) {
  const double exact = played.law().contact_duration(played.model.hammer.mass_kg, played.speed_m_per_s) * rate;
  const int samples = 20 + static_cast<int>(2 * exact);
  double sum = 0;
  for (int phase = 0; phase < phases; ++phase) {
    const double before = (phase + 0.5) / phases;
    sum += visit_scheme<double>(played, method, rate, [&](auto& scheme, const auto&, const auto&) {
      scheme.strike(played.speed_m_per_s, before * played.speed_m_per_s / rate);
      advance(scheme, samples);
      return std::abs(samples - scheme.compression() / (scheme.hammer_velocity() / rate) - before - exact);
    });
  }
  return sum / phases;
}

/// Newton's signal at so many times 44.1 kHz; nothing without modes.
inline std::vector<double> exact_signal(const PaperCase& played, int reference) {
  if (played.model.modes.empty()) return {};
  return signal(played, Method::newton, double{kSampleRate} * reference);
}

/// The error of a method at a multiple of 44.1 kHz: of the exit time [samples] without modes, else of the signal.
/// exact: exact_signal(played, reference).
inline double error(const PaperCase& played, Method method, int multiple, const std::vector<double>& exact,
                    int reference, int phases) {
  const double rate = double{kSampleRate} * multiple;
  if (played.model.modes.empty()) return exit_error(played, method, rate, phases);
  return signal_error(played, method, rate, exact, static_cast<std::size_t>(reference / multiple));
}

/// Largest error of the scheme's own energy balance over so many samples, divided by the largest energy.
inline double energy_drift(const PaperCase& played, Method method, int samples) {
  return visit_scheme<double>(
      played, method, kSampleRate, [&]<typename Scheme>(Scheme& scheme, const auto& modes, const auto& potential) {
        const auto throw_at = [&](int n) {
          if (n % played.between == 0) scheme.strike(played.speed_m_per_s, played.distance_m);
        };
        const auto keep = [&](auto book) {
          const auto books = balance(scheme, std::move(book), samples, kSampleRate, played.press_n, throw_at);
          return books.worst / books.peak;
        };
        if constexpr (requires { scheme.psi(); })
          return keep(TwoStepBook<Scheme>(scheme, played.model.hammer.mass_kg, modes, kSampleRate));
        else
          return keep(OneStepBook(scheme, played.model.hammer.mass_kg, modes, played.model.strike_shapes, kSampleRate,
                                  potential));
      });
}

/// The worst |speed after a blow at a barrier over the speed before it - 1| over places of the first touch.
template <std::floating_point T>
double rebound_error(const PaperCase& played, Method method, int phases) {
  PaperCase at_barrier = played;
  at_barrier.model.modes.clear();
  double worst = 0;
  for (int phase = 0; phase < phases; ++phase)
    worst =
        std::max(worst, visit_scheme<T>(at_barrier, method, kSampleRate, [&](auto& scheme, const auto&, const auto&) {
                   const double speed = static_cast<double>(static_cast<T>(played.speed_m_per_s));
                   scheme.strike(static_cast<T>(speed), static_cast<T>(speed * phase / phases / kSampleRate));
                   advance(scheme, 100);
                   return std::abs(-static_cast<double>(scheme.hammer_velocity()) / speed - 1);
                 }));
  return worst;
}

}  // namespace contactspline::bench
