// SPDX-License-Identifier: MIT
#include "strings_on_body.hpp"

#include <Eigen/Eigenvalues>
#include <complex>

namespace contactspline::testing {

Strings::Strings(const StruckString& struck, std::vector<double> cents, int max_modes, double max_frequency_hz,
                 bool has_losses) {
  StiffString string = struck.string;
  if (!has_losses) string.losses = {0, 0};
  string.detuning_cents = std::move(cents);
  const int all = max_modes * static_cast<int>(string.detuning_cents.size());
  const auto found = modes_of({"", "", string, {struck.strike_m}, {struck.strike_m}, all}, max_frequency_hz).modes;
  modes = bare(found);
  strike = shapes<double>(found, &ResonatorMode::strike_shape);
  for (const auto& mode : found) bridge.push_back(bridge_shape(string, mode));
  stiffness = bridge_stiffness(string, found);
}

namespace {

constexpr double kUnit = 2 * pi * 1000;  // rad/s

}  // namespace

/// In units in which all numbers of the matrix are of one size: sqrt(M) x and sqrt(M) x'/kUnit.
struct ExactMotion::State {
  Eigen::VectorXd root_mass;
  Eigen::VectorXcd rates, parts, struck;
  Eigen::MatrixXcd vectors;
};

ExactMotion::ExactMotion(const Strings& strings, const std::vector<ResonatorMode>& body)
    : strings_(strings), body_(body), state_(std::make_unique<State>()) {
  const auto s = static_cast<Eigen::Index>(strings.modes.size()), b = static_cast<Eigen::Index>(body.size()),
             n = s + b;
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd mass(n), decay(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i < s ? i : i - s);
    const Mode& mode = i < s ? strings.modes[at] : body[at].mode;
    mass(i) = mode.mass_kg;
    decay(i) = mode.decay_per_s;
    stiffness(i, i) = mode.mass_kg * (std::pow(mode.angular_frequency_rad_per_s, 2) + std::pow(mode.decay_per_s, 2));
  }
  for (Eigen::Index i = 0; i < b; ++i) {
    const double shape = body[static_cast<std::size_t>(i)].strike_shape;
    for (Eigen::Index j = 0; j < b; ++j)
      stiffness(s + i, s + j) +=
          (strings.stiffness.ends + strings.stiffness.modes) * shape * body[static_cast<std::size_t>(j)].strike_shape;
    for (Eigen::Index j = 0; j < s; ++j)
      stiffness(s + i, j) = stiffness(j, s + i) = -shape * strings.bridge[static_cast<std::size_t>(j)];
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  state_->root_mass = mass.cwiseSqrt();
  const Eigen::VectorXd inverse = state_->root_mass.cwiseInverse();
  matrix.topRightCorner(n, n) = kUnit * Eigen::MatrixXd::Identity(n, n);
  matrix.bottomLeftCorner(n, n) = (-inverse / kUnit).eval().asDiagonal() * stiffness * inverse.asDiagonal();
  matrix.bottomRightCorner(n, n) = (-2 * decay).eval().asDiagonal();
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  state_->rates = solver.eigenvalues();
  state_->vectors = solver.eigenvectors();
}

void ExactMotion::start(const std::vector<double>& displacement, double rate) {
  Eigen::VectorXcd state = Eigen::VectorXcd::Zero(state_->rates.size());
  double force = 0;
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    state(static_cast<Eigen::Index>(i)) = displacement[i];
    force += strings_.bridge[i] * displacement[i];
  }
  for (std::size_t i = 0; i < body_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(displacement.size() + i);
    const double acceleration = body_[i].strike_shape * force / body_[i].mode.mass_kg;
    state(at) = acceleration / (8 * rate * rate);
    state(state_->rates.size() / 2 + at) = -acceleration / (2 * rate) / kUnit;
  }
  for (Eigen::Index i = 0; i < state.size(); ++i) state(i) *= state_->root_mass(i % state_->root_mass.size());
  state_->parts = state_->vectors.partialPivLu().solve(state);
}

std::vector<double> ExactMotion::frequencies() const {
  std::vector<double> frequencies;
  for (const auto& rate : state_->rates)
    if (rate.imag() > 0) frequencies.push_back(rate.imag());
  std::ranges::sort(frequencies);
  return frequencies;
}

void ExactMotion::rest() {
  state_->parts = Eigen::VectorXcd::Zero(state_->rates.size());
}

void ExactMotion::advance(const ModeShapes<double>& at, double force_n, double time_s) {
  if (state_->struck.size() == 0) {
    state_->struck = Eigen::VectorXcd::Zero(state_->rates.size());
    for (std::size_t i = 0; i < at.size(); ++i)
      state_->struck(state_->rates.size() / 2 + static_cast<Eigen::Index>(i)) =
          at[i] / kUnit / state_->root_mass(static_cast<Eigen::Index>(i));
    state_->struck = state_->vectors.partialPivLu().solve(state_->struck).eval();
  }
  const Eigen::ArrayXcd growth = (state_->rates.array() * time_s).exp();
  state_->parts =
      (state_->parts.array() * growth + state_->struck.array() * (growth - 1) / state_->rates.array() * force_n)
          .matrix();
}

double ExactMotion::body_velocity(const ModeShapes<double>& at) const {
  const Eigen::Index modes = state_->root_mass.size(), first = modes - static_cast<Eigen::Index>(at.size());
  double velocity = 0;
  for (Eigen::Index i = first; i < modes; ++i)
    velocity += at[static_cast<std::size_t>(i - first)] * kUnit / state_->root_mass(i) *
                (state_->vectors.row(modes + i) * state_->parts)(0).real();
  return velocity;
}

double ExactMotion::force_at(double time_s) const {
  const Eigen::VectorXcd state =
      state_->vectors * (state_->parts.array() * (state_->rates.array() * time_s).exp()).matrix();
  double force = 0;
  for (std::size_t i = 0; i < strings_.bridge.size(); ++i)
    force += strings_.bridge[i] * state(static_cast<Eigen::Index>(i)).real() /
             state_->root_mass(static_cast<Eigen::Index>(i));
  return force;
}

ExactMotion::~ExactMotion() = default;

}  // namespace contactspline::testing
