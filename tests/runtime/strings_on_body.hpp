// SPDX-License-Identifier: MIT
// Strings and a board, and their exact motion together.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "contactspline/modal/stiff_string.hpp"
#include "generator/resonator/resonator.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {

using std::numbers::pi;

// The kernels do not tell what the strings dissipate: there they have no losses.
#ifdef CONTACTSPLINE_SIMD
inline constexpr bool kHasLosses = false;
#else
inline constexpr bool kHasLosses = true;
#endif

/// A board of spruce.
inline std::vector<ResonatorMode> board(int max_modes, double quadratic_loss = 0.29,
                                        const Place& bridge = {0.62, 0, 0.51}) {
  const Plate plate{1.39, 0.91, 0.018, 392, 11.5e9, 8e9, 1.5e9, 0.3, {8, quadratic_loss}};
  return modes_of({"board", "", plate, bridge, {0.87, 0, 0.29}, max_modes}, 22050).modes;
}

/// The shapes of its modes at so many places along a bridge.
template <typename T>
std::vector<ModeShapes<T>> bridge_of_board(int max_modes, std::size_t places) {
  std::vector<ModeShapes<T>> bridge;
  for (std::size_t p = 0; p < places; ++p) {
    const double along = static_cast<double>(p) / static_cast<double>(places);
    bridge.push_back(
        shapes<T>(board(max_modes, 0.29, {0.62 + 0.5 * along, 0, 0.51 - 0.3 * along}), &ResonatorMode::strike_shape));
  }
  return bridge;
}

/// The modes of all strings of a key, with their forces on the bridge.
struct Strings {
  Strings(const StruckString& struck, std::vector<double> cents, int max_modes, double max_frequency_hz) {
    StiffString string = struck.string;
    if (!kHasLosses) string.losses = {0, 0};
    string.detuning_cents = std::move(cents);
    const int all = max_modes * static_cast<int>(string.detuning_cents.size());
    const auto found = modes_of({"", "", string, {struck.strike_m}, {struck.strike_m}, all}, max_frequency_hz).modes;
    modes = bare(found);
    strike = shapes<double>(found, &ResonatorMode::strike_shape);
    for (const auto& mode : found) bridge.push_back(bridge_shape(string, mode));
    stiffness = bridge_stiffness(string, found);
  }

  std::vector<Mode> modes;
  ModeShapes<double> strike;
  std::vector<double> bridge;
  BridgeStiffness stiffness;
};

/// The exact motion of strings on a body in continuous time: M x'' + 2 M S x' + K x = 0 by the eigenvectors of its
/// matrix, in units in which all its numbers are of one size: sqrt(M) x and sqrt(M) x'/kUnit.
class ExactMotion {
 public:
  ExactMotion(const Strings& strings, const std::vector<ResonatorMode>& body) : strings_(strings), body_(body) {
    const auto s = static_cast<Eigen::Index>(strings.modes.size()), b = static_cast<Eigen::Index>(body.size()),
               n = s + b;
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd mass(n), decay(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i < s ? i : i - s);
      const Mode& mode = i < s ? strings.modes[at] : body[at].mode;
      mass(i) = mode.mass_kg;
      decay(i) = mode.decay_per_s;
      stiffness(i, i) =
          mode.mass_kg * (std::pow(mode.angular_frequency_rad_per_s, 2) + std::pow(mode.decay_per_s, 2));
    }
    for (Eigen::Index i = 0; i < b; ++i) {
      const double shape = body[static_cast<std::size_t>(i)].strike_shape;
      for (Eigen::Index j = 0; j < b; ++j)
        stiffness(s + i, s + j) += (strings.stiffness.ends + strings.stiffness.modes) * shape *
                                   body[static_cast<std::size_t>(j)].strike_shape;
      for (Eigen::Index j = 0; j < s; ++j)
        stiffness(s + i, j) = stiffness(j, s + i) = -shape * strings.bridge[static_cast<std::size_t>(j)];
    }
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    root_mass_ = mass.cwiseSqrt();
    const Eigen::VectorXd inverse = root_mass_.cwiseInverse();
    matrix.topRightCorner(n, n) = kUnit * Eigen::MatrixXd::Identity(n, n);
    matrix.bottomLeftCorner(n, n) = (-inverse / kUnit).eval().asDiagonal() * stiffness * inverse.asDiagonal();
    matrix.bottomRightCorner(n, n) = (-2 * decay).eval().asDiagonal();
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
    rates_ = solver.eigenvalues();
    vectors_ = solver.eigenvectors();
  }

  /// From the displacements of the strings' modes at rest. The body is at rest half a sample later, as in Body: at
  /// time 0 it moves backwards.
  void start(const std::vector<double>& displacement, double rate) {
    Eigen::VectorXcd state = Eigen::VectorXcd::Zero(rates_.size());
    double force = 0;
    for (std::size_t i = 0; i < displacement.size(); ++i) {
      state(static_cast<Eigen::Index>(i)) = displacement[i];
      force += strings_.bridge[i] * displacement[i];
    }
    for (std::size_t i = 0; i < body_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(displacement.size() + i);
      const double acceleration = body_[i].strike_shape * force / body_[i].mode.mass_kg;
      state(at) = acceleration / (8 * rate * rate);
      state(rates_.size() / 2 + at) = -acceleration / (2 * rate) / kUnit;
    }
    for (Eigen::Index i = 0; i < state.size(); ++i) state(i) *= root_mass_(i % root_mass_.size());
    parts_ = vectors_.partialPivLu().solve(state);
  }

  /// Angular frequencies that sound [rad/s], rising.
  [[nodiscard]] std::vector<double> frequencies() const {
    std::vector<double> frequencies;
    for (const auto& rate : rates_)
      if (rate.imag() > 0) frequencies.push_back(rate.imag());
    std::ranges::sort(frequencies);
    return frequencies;
  }

  /// Begins at rest.
  void rest() { parts_ = Eigen::VectorXcd::Zero(rates_.size()); }

  /// Advances by a time under a constant force on the strings [N].
  void advance(const ModeShapes<double>& at, double force_n, double time_s) {
    if (struck_.size() == 0) {
      struck_ = Eigen::VectorXcd::Zero(rates_.size());
      for (std::size_t i = 0; i < at.size(); ++i)
        struck_(rates_.size() / 2 + static_cast<Eigen::Index>(i)) =
            at[i] / kUnit / root_mass_(static_cast<Eigen::Index>(i));
      struck_ = vectors_.partialPivLu().solve(struck_).eval();
    }
    const Eigen::ArrayXcd growth = (rates_.array() * time_s).exp();
    parts_ = (parts_.array() * growth + struck_.array() * (growth - 1) / rates_.array() * force_n).matrix();
  }

  /// Velocity of the body at a place [m/s].
  [[nodiscard]] double body_velocity(const ModeShapes<double>& at) const {
    const Eigen::Index modes = root_mass_.size(), first = modes - static_cast<Eigen::Index>(at.size());
    double velocity = 0;
    for (Eigen::Index i = first; i < modes; ++i)
      velocity += at[static_cast<std::size_t>(i - first)] * kUnit / root_mass_(i) *
                  (vectors_.row(modes + i) * parts_)(0).real();
    return velocity;
  }

  /// Force of the strings on the bridge [N].
  [[nodiscard]] double force_at(double time_s) const {
    const Eigen::VectorXcd state = vectors_ * (parts_.array() * (rates_.array() * time_s).exp()).matrix();
    double force = 0;
    for (std::size_t i = 0; i < strings_.bridge.size(); ++i)
      force +=
          strings_.bridge[i] * state(static_cast<Eigen::Index>(i)).real() / root_mass_(static_cast<Eigen::Index>(i));
    return force;
  }

 private:
  const Strings& strings_;
  const std::vector<ResonatorMode>& body_;
  static constexpr double kUnit = 2 * pi * 1000;  // rad/s

  Eigen::VectorXd root_mass_;
  Eigen::VectorXcd rates_, parts_, struck_;
  Eigen::MatrixXcd vectors_;
};

/// Compares a unison over at least 8 s with its exact motion in windows of 0.1 s: levels within 0.05 dB, and a decay
/// at first that is more than `times` as fast as that after 6 s. Calls exact_at(n) with rising n, for the exact value
/// after sample n.
template <typename T, typename ExactAt>
void expect_two_decays(const std::vector<T>& sound, double rate_hz, double times, const ExactAt& exact_at) {
  constexpr std::size_t kEvery = 7;
  std::vector<double> levels;
  double worst = 0;
  const auto window = static_cast<std::size_t>(0.1 * rate_hz);
  for (std::size_t begin = 0; begin + window <= sound.size(); begin += window) {
    double sum = 0, exact_sum = 0;
    for (std::size_t n = begin; n < begin + window; n += kEvery) {
      sum += sound[n] * sound[n];
      exact_sum += std::pow(exact_at(n), 2);
    }
    levels.push_back(10 * std::log10(sum));
    const double error = std::abs(levels.back() - 10 * std::log10(exact_sum));
    worst = std::isfinite(error) ? std::max(worst, error) : std::numeric_limits<double>::infinity();
  }
  ASSERT_GE(levels.size(), 80u);
  const double early = (levels[0] - levels[4]) / 0.4, late = (levels[59] - levels[79]) / 2;
  Measured() << "decay " << early << " dB/s at first, " << late << " dB/s after 6 s; levels within " << worst
             << " dB";
  EXPECT_TRUE(within(worst, 0, 0.05));
  EXPECT_GT(early, times * late);
  EXPECT_GT(late, 0);
}

}  // namespace contactspline::testing
