// SPDX-License-Identifier: MIT
// Strings under a bow, with constants of publications, and what they do: Schelleng's and Guettler's diagrams.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "contactspline/network/contact_network.hpp"

namespace contactspline::bench {

/// A string between rigid ends.
struct StringUnderBow {
  double frequency_hz, impedance_kg_per_s, kg_per_m;
  double inharmonicity;  ///< B: partial n sounds at n f sqrt(1 + B n^2)
  std::size_t modes;

  [[nodiscard]] double length_m() const { return impedance_kg_per_s / kg_per_m / (2 * frequency_hz); }
};

/// The steel D string of a violin on which E. Schoonderwaldt, K. Guettler and A. Askenfelt measured limits of the bow
/// force (Acta Acustica united with Acustica 94, 2008). Inharmonicity: of the steel cello string whose losses are
/// below.
inline constexpr StringUnderBow kViolinD{293.66, 0.25, 1.29e-3, 4.2e-5, 60};
/// The D string of a cello of H. Mansour, J. Woodhouse and G. P. Scavone (Acta Acustica united with Acustica 102,
/// 2016): 111 N, 0.69 m, 3e-4 N m^2. On such a string P. M. Galluzzo measured Guettler's diagram (J. Woodhouse and P.
/// M. Galluzzo, Tribology Letters 73, 2025).
inline constexpr StringUnderBow kCelloD{146.83, 0.548, 2.703e-3, 5.6e-5, 120};

namespace bowing {

/// Loss factor of partial n, of frequency f: (fixed + in_air/(2 pi f) + B n^2 bending)/(1 + B n^2). Formula: of these
/// and of J. Woodhouse (Acta Acustica united with Acustica 90, 2004). Constants: steel string of a cello between
/// rigid ends (M. van Walstijn, V. Chatziioannou, M. Lampis and A. Matusiak, Acta Acustica 10, 2026). The paper
/// prints fixed and bending the other way round, with which partials would have quality 4; so they fit damping that
/// its laboratory measured (Proceedings of Meetings on Acoustics 58, 035013, 2025).
inline constexpr double kFixedLoss = 7e-4, kLossInAir_per_s = 0.02, kBendingLoss = 0.25;
/// Torsion at the surface of the string: ratio of impedances (of 0.53 kg/s, for the violin's string above, ibid.),
/// of speeds (R. Mores, PLoS ONE 14, 2019, a steel string), quality (J. Woodhouse and A. R. Loach, Acta Acustica
/// united with Acustica 85, 1999).
inline constexpr double kTorsionalImpedance = 2.1, kTorsionalSpeed = 5.55, kTorsionalQuality = 30;
inline constexpr std::size_t kTorsionalModes = 20;
/// All of the hair (van Walstijn et al., after R. Pitteroff and J. Woodhouse, 1998).
inline constexpr double kHairStiffness_n_per_m = 1.1e5, kHair_kg = 6.2e-3, kHairResistance_kg_per_s = 10,
                        kHairWidth_m = 0.01;

inline double loss_factor(const StringUnderBow& string, double n, double angular_frequency) {
  const double bending = string.inharmonicity * n * n;
  return (kFixedLoss + kLossInAir_per_s / angular_frequency + bending * kBendingLoss) / (1 + bending);
}

inline std::vector<Mode> modes_of(const StringUnderBow& string) {
  std::vector<Mode> modes;
  const double mass_kg = string.kg_per_m * string.length_m() / 2, w = 2 * std::numbers::pi * string.frequency_hz;
  for (std::size_t i = 1; i <= string.modes; ++i) {
    const auto n = static_cast<double>(i);
    const double wn = w * n * std::sqrt(1 + string.inharmonicity * n * n);
    modes.push_back({wn, wn * loss_factor(string, n, wn) / 2, mass_kg});
  }
  for (std::size_t n = 1; n <= kTorsionalModes; ++n) {
    const double wn = w * kTorsionalSpeed * static_cast<double>(n);
    modes.push_back({wn, wn / (2 * kTorsionalQuality), mass_kg * kTorsionalImpedance / kTorsionalSpeed});
  }
  return modes;
}

/// Shapes of these modes at the surface. part: distance from the bridge, parts of the length.
inline std::vector<double> shapes_at(const StringUnderBow& string, double part) {
  std::vector<double> shapes;
  for (const std::size_t count : {string.modes, kTorsionalModes})
    for (std::size_t n = 1; n <= count; ++n)
      shapes.push_back(std::sin(std::numbers::pi * static_cast<double>(n) * part));
  return shapes;
}

/// Where point p of `count` across the hair is, parts of the length.
inline double part_of(const StringUnderBow& string, double part, std::size_t p, std::size_t count) {
  if (count == 1) return part;
  return part +
         ((static_cast<double>(p) + 0.5) / static_cast<double>(count) - 0.5) * kHairWidth_m / string.length_m();
}

/// A string under the points of a bow, and what else the network joins to it. All points share hair and normal force.
struct BowedProblem {
  std::vector<Mode> string, hair, body;     // hair: one mode at each point, or none; the body may have none
  std::vector<std::vector<double>> points;  // shapes of the string under each
  std::vector<double> string_at_bridge, body_at_bridge;  // where a spring joins string and body
  static constexpr double kBridge_n_per_m = 1e6, kBridge_kg_per_s = 1;

  [[nodiscard]] double share() const { return 1 / static_cast<double>(points.size()); }
  /// Shapes of the hair's modes at a point.
  [[nodiscard]] std::vector<double> at_hair(std::size_t point) const {
    std::vector<double> shapes(hair.size());
    if (!shapes.empty()) shapes[point] = 1;
    return shapes;
  }
};

inline BowedProblem problem_of(const StringUnderBow& string, double part, std::size_t count) {
  BowedProblem problem;
  problem.string = modes_of(string);
  for (std::size_t p = 0; p < count; ++p)
    problem.points.push_back(shapes_at(string, part_of(string, part, p, count)));
  if (count > 1) {
    const double decay = kHairResistance_kg_per_s / (2 * kHair_kg);
    const double w = std::sqrt(kHairStiffness_n_per_m / kHair_kg - decay * decay);
    problem.hair.assign(count, {w, decay, kHair_kg * problem.share()});
  }
  return problem;
}

/// Adds a body of modes at equal ratios of frequency from 275 Hz, 0.2 kg each, of loss factor 0.04, and a bridge at
/// 0.036 of the length: a load for solvers, not a violin.
inline void add_body(BowedProblem& problem, const StringUnderBow& string, std::size_t modes) {
  for (std::size_t i = 0; i < modes; ++i) {
    const double w = 2 * std::numbers::pi * 275 * std::pow(1.09, static_cast<double>(i));
    problem.body.push_back({w, 0.02 * w, 0.2});
  }
  problem.string_at_bridge = shapes_at(string, 0.036);
  for (std::size_t i = string.modes; i < problem.string_at_bridge.size(); ++i) problem.string_at_bridge[i] = 0;
  problem.body_at_bridge.assign(modes, 1);
}

/// The network of a problem. points: its connections of friction, in order.
template <std::floating_point T>
NetworkPlan<T> plan_of(const BowedProblem& problem, std::vector<std::size_t>& points) {
  NetworkPlan<T> plan;
  const std::size_t string = plan.add_body(problem.string);
  const std::size_t hair = problem.hair.empty() ? kGround : plan.add_body(problem.hair);
  for (std::size_t p = 0; p < problem.points.size(); ++p)
    points.push_back(plan.add_friction(hair == kGround ? kGround : plan.add_place(hair, problem.at_hair(p)),
                                       plan.add_place(string, problem.points[p]), kRosin,
                                       kHairWidth_m * problem.share()));
  if (!problem.body.empty())
    plan.add_spring(plan.add_place(string, problem.string_at_bridge),
                    plan.add_place(plan.add_body(problem.body), problem.body_at_bridge),
                    T(BowedProblem::kBridge_n_per_m), T(BowedProblem::kBridge_kg_per_s));
  return plan;
}

}  // namespace bowing

/// A string under a bow. points: 1 of a rigid bow, or more across its hair.
template <std::floating_point T = double>
class BowedString {
 public:
  BowedString(const StringUnderBow& string, double part, std::size_t points, double rate)
      : string_(string),
        part_(part),
        rate_(rate),
        network_(bowing::plan_of<T>(bowing::problem_of(string, part, points), points_), rate) {}

  /// Puts the string into Helmholtz' motion, half a period after its corner passed the bridge: it sticks.
  void set_helmholtz_motion(double speed_m_per_s) {
    for (std::size_t i = 0; i < string_.modes; ++i) {
      const double velocity = 2 * speed_m_per_s / (std::numbers::pi * part_ * static_cast<double>(i + 1));
      network_.set_motion(0, 0, T(i % 2 == 0 ? velocity : -velocity), i);
    }
  }

  /// One sample. Returns whether a slip begins: the mean of all points slips faster than a fifth of the speed of
  /// Helmholtz' motion, and was slower than a twentieth of the bow since the last one.
  bool tick(double force_n, double speed_m_per_s) {
    double slip = 0;
    const auto count = static_cast<double>(points_.size());
    for (const std::size_t point : points_) {
      network_.set_normal_force(point, T(force_n / count));
      network_.set_surface_speed(point, T(speed_m_per_s));
    }
    network_.tick();
    for (const std::size_t point : points_) slip += double(network_.slip(point)) / count;
    const double carried = speed_m_per_s / rate_;
    const bool begins = slip > 0.2 * carried / part_ && std::exchange(has_stuck_, false);
    has_stuck_ |= slip < 0.05 * carried;
    return begins;
  }

  [[nodiscard]] const ContactNetwork<T>& network() const { return network_; }
  [[nodiscard]] const std::vector<std::size_t>& points() const { return points_; }
  [[nodiscard]] double rate() const { return rate_; }
  [[nodiscard]] double period() const { return rate_ / string_.frequency_hz; }  ///< [samples]

 private:
  StringUnderBow string_;
  double part_, rate_;
  std::vector<std::size_t> points_;
  ContactNetwork<T> network_;
  bool has_stuck_ = false;
};

/// What a string does: '-' does not stick and slip, 'm' several slips in a period, 'H' one, 'r' none that is regular;
/// and the pitch of its slips beside that of the string.
struct BowedMotion {
  char name;
  double cents;
};

/// In the last 0.4 s of two seconds under a constant bow, which begins in Helmholtz' motion, or at rest.
inline BowedMotion bowed_motion(BowedString<double>& bowed, double force_n, double speed_m_per_s,
                                bool from_rest = false) {
  const auto samples = static_cast<int>(2 * bowed.rate()), from = static_cast<int>(1.6 * bowed.rate());
  if (!from_rest) bowed.set_helmholtz_motion(speed_m_per_s);
  std::vector<double> begins;
  for (int n = 0; n < samples; ++n) {
    const double speed = from_rest ? std::min(speed_m_per_s, 2.0 * n / bowed.rate()) : speed_m_per_s;
    if (bowed.tick(force_n, speed) && n >= from) begins.push_back(n);
  }
  if (begins.size() < 3) return {'-', 0};
  const double mean = (begins.back() - begins.front()) / static_cast<double>(begins.size() - 1);
  double square = 0;
  for (std::size_t i = 1; i < begins.size(); ++i) square += std::pow(begins[i] - begins[i - 1] - mean, 2);
  const bool is_regular = std::sqrt(square / static_cast<double>(begins.size() - 1)) < 0.03 * mean + 1;
  if (mean < 0.8 * bowed.period()) return {'m', 0};
  return {is_regular && mean < 1.2 * bowed.period() ? 'H' : 'r', 1200 * std::log2(bowed.period() / mean)};
}

/// How a string starts under a bow that accelerates from rest: when it slips first [s], and how many periods of the
/// string later slips begin to follow each other at its period, within 15 %; kNever if not within 25.
struct BowedStart {
  static constexpr double kNever = 25;
  double first_slip_s = 0, periods = kNever;

  [[nodiscard]] bool is_perfect() const { return periods <= 1; }
};

inline BowedStart bowed_start(BowedString<double>& bowed, double force_n, double acceleration_m_per_s2) {
  const double period = bowed.period();
  std::vector<double> begins;
  int n = 0;
  for (; n < static_cast<int>(bowed.rate()); ++n) {
    if (bowed.tick(force_n, acceleration_m_per_s2 * n / bowed.rate())) begins.push_back(n);
    if (!begins.empty() && n > begins.front() + 30 * period) break;
  }
  if (begins.empty()) return {};
  BowedStart start{begins.front() / bowed.rate()};
  const auto is_regular = [&](double interval) { return std::abs(interval - period) < 0.15 * period; };
  std::size_t regular = begins.size() - 1;
  while (regular > 0 && is_regular(begins[regular] - begins[regular - 1])) --regular;
  if (begins.size() > 20 && n - begins.back() < 1.15 * period)  // they go on
    start.periods = std::min((begins[regular] - begins.front()) / period, BowedStart::kNever);
  return start;
}

}  // namespace contactspline::bench
