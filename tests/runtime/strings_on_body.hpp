// SPDX-License-Identifier: MIT
// Strings and a board, and their exact motion together.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "generator/resonator/resonator.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {

using std::numbers::pi;

/// The vectorised kernels do not tell what the strings dissipate: there they have no losses.
inline bool has_losses() {
  return !detail::kernels<double>.are_vectorised();
}

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
  Strings(const StruckString& struck, std::vector<double> cents, int max_modes, double max_frequency_hz,
          bool has_losses = testing::has_losses());

  std::vector<Mode> modes;
  ModeShapes<double> strike;
  std::vector<double> bridge;
  BridgeStiffness stiffness;
};

/// The exact motion of strings on a body in continuous time: M x'' + 2 M S x' + K x = 0 by the eigenvectors of its
/// matrix.
class ExactMotion {
 public:
  ExactMotion(const Strings& strings, const std::vector<ResonatorMode>& body);
  ~ExactMotion();

  /// From the displacements of the strings' modes at rest. The body is at rest half a sample later, as in Body: at
  /// time 0 it moves backwards.
  void start(const std::vector<double>& displacement, double rate);

  /// Angular frequencies that sound [rad/s], rising.
  [[nodiscard]] std::vector<double> frequencies() const;

  /// Begins at rest.
  void rest();

  /// Advances by a time under a constant force on the strings [N].
  void advance(const ModeShapes<double>& at, double force_n, double time_s);

  /// Velocity of the body at a place [m/s].
  [[nodiscard]] double body_velocity(const ModeShapes<double>& at) const;

  /// Force of the strings on the bridge [N].
  [[nodiscard]] double force_at(double time_s) const;

 private:
  struct State;  // keeps Eigen out of the tests, which would compile it again each

  const Strings& strings_;
  const std::vector<ResonatorMode>& body_;
  std::unique_ptr<State> state_;
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
