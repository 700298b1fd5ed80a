// SPDX-License-Identifier: MIT
#include "generator/resonator/radiation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "contactspline/modal/mode.hpp"
#include "generator/resonator/quadrature.hpp"
#include "generator/resonator/ribbed_plate.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr double kMaxFrequency_hz = 24e3;  // beyond it nothing is integrated
constexpr double kMaxFitted_hz = 20e3;     // up to here the taps are fitted,
constexpr double kFittedPart = 0.9;        // and up to this part of half the sample rate
constexpr double kWeightAbove = 1e-2;      // of errors above it
constexpr double kBin_s = 1 / (16 * kMaxFrequency_hz);
constexpr int kMargin = 4;         // taps before the first arrival and after the last one
constexpr double kMaxDecay = 5;    // of a mode that two weights stand for, over all arrivals [neper]
constexpr double kMaxLoss = 0.19;  // ModalBank::velocity has none of a mode with more loss

struct Point {
  double x, y, z;
};

// Seen from the middle of the body, which lies in the plane z = 0.
Point position_of(const ListeningPlace& at) {
  const double along = at.distance_m * std::sin(at.angle_rad), c = std::cos(at.around_rad),
               s = std::sin(at.around_rad);
  return {along * c - at.side_m * s, along * s + at.side_m * c, at.distance_m * std::cos(at.angle_rad)};
}

/// Points of a body with their weights, in rows and columns. A mode's shape is a number of the row times one of the
/// column.
struct Grid {
  std::vector<double> row_weights, column_weights;
  std::vector<std::vector<double>> row_shapes, column_shapes;  // of each mode

  [[nodiscard]] std::size_t rows() const { return row_weights.size(); }
  [[nodiscard]] std::size_t columns() const { return column_weights.size(); }
};

double max_wavenumber() {
  return 2 * pi * kMaxFrequency_hz / kSpeedOfSound_m_per_s;
}

template <typename Function>
std::vector<double> values_at(const std::vector<double>& points, Function function) {
  std::vector<double> values;
  for (const double point : points) values.push_back(function(point));
  return values;
}

/// A body's grid, and where its points lie, seen from the middle.
struct PlateGrid : Grid {
  PlateGrid(const Plate& plate, std::span<const NumberedMode> modes) {
    int max_row = 0, max_number = 0;
    for (const NumberedMode& mode : modes) {
      max_row = std::max(max_row, mode.row);
      max_number = std::max(max_number, mode.number);
    }
    const QuadratureRule along = gauss_rule(plate.length_m, max_row * pi + max_wavenumber() * plate.length_m);
    const QuadratureRule across = gauss_rule(plate.width_m, max_number * pi + max_wavenumber() * plate.width_m);
    column_weights = along.weights;
    row_weights = across.weights;
    for (const NumberedMode& mode : modes) {
      const double kx = mode.row * pi / plate.length_m, ky = mode.number * pi / plate.width_m;
      column_shapes.push_back(values_at(along.points, [&](double at) { return std::sin(kx * at); }));
      row_shapes.push_back(values_at(across.points, [&](double at) { return std::sin(ky * at); }));
    }
    x = values_at(along.points, [&](double at) { return at - plate.length_m / 2; });
    y = values_at(across.points, [&](double at) { return at - plate.width_m / 2; });
  }
  [[nodiscard]] Point point(std::size_t row, std::size_t column) const { return {x[column], y[row], 0}; }

  std::vector<double> x, y;
};

// A membrane or a circular plate. Rows are circles. Around a circle equal steps are exact for all angular orders
// below their number.
struct RoundGrid : Grid {
  RoundGrid(const decltype(Resonator::body)& body, std::span<const NumberedMode> modes, double zero_rad) {
    double max_beta = 0;
    int max_order = 0;
    for (const NumberedMode& mode : modes) {
      max_beta = std::max(max_beta, mode.wavenumber_per_m);
      max_order = std::max(max_order, mode.row);
    }
    constexpr double kMore = 60;  // orders of 1/R near the body
    const double radius_m = radius_of(body), phase = (max_beta + max_wavenumber()) * radius_m;
    const QuadratureRule radial = gauss_rule(radius_m, phase);
    radii = radial.points;
    const auto steps = static_cast<std::size_t>(max_order + max_wavenumber() * radius_m + kMore);
    for (std::size_t i = 0; i < steps; ++i)
      angles.push_back(2 * pi * static_cast<double>(i) / static_cast<double>(steps));
    column_weights.assign(steps, 2 * pi / static_cast<double>(steps));
    for (std::size_t r = 0; r < radii.size(); ++r) row_weights.push_back(radial.weights[r] * radii[r]);
    for (const NumberedMode& mode : modes) {
      column_shapes.push_back(values_at(angles, [&](double a) { return angular_shape(mode, a - zero_rad); }));
      row_shapes.push_back(
          values_at(radii, [&](double r) { return radial_shape(body, mode.row, mode.wavenumber_per_m, r); }));
    }
  }
  [[nodiscard]] Point point(std::size_t row, std::size_t column) const {
    return {radii[row] * std::cos(angles[column]), radii[row] * std::sin(angles[column]), 0};
  }

  std::vector<double> radii, angles;
};

/// What the accelerations of the modes add to the pressure, by the time of arrival: rho/(2 pi) times the integral of
/// shape/R over the body, in bins of equal time. Bin b arrives at first_s + b kBin_s.
struct Arrivals {
  double first_s;
  std::vector<std::vector<double>> of_mode;
};

// A value between four bins counts for all of them, by cubic interpolation.
std::array<double, 4> cubic_weights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

template <typename BodyGrid>
Arrivals arrivals_of(const BodyGrid& grid, const ListeningPlace& place, const Reach& reach) {
  const Point at = position_of(place);
  const double first_s = reach.nearest_m / kSpeedOfSound_m_per_s - 2 * kBin_s;
  const auto bins =
      static_cast<std::size_t>((reach.farthest_m - reach.nearest_m) / kSpeedOfSound_m_per_s / kBin_s) + 6;
  const std::size_t modes = grid.row_shapes.size(), columns = grid.columns();
  Arrivals arrivals{first_s, std::vector(modes, std::vector<double>(bins))};
  std::vector<std::size_t> bin(columns);
  std::vector<std::array<double, 4>> weights(columns);
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const Point from = grid.point(row, column);
      const double distance_m = std::hypot(at.x - from.x, at.y - from.y, at.z - from.z);
      const double position = (distance_m / kSpeedOfSound_m_per_s - first_s) / kBin_s;
      bin[column] = static_cast<std::size_t>(position);
      weights[column] = cubic_weights(position - std::floor(position));
      for (double& weight : weights[column])
        weight *= kAirDensity_kg_m3 / (2 * pi) * grid.row_weights[row] * grid.column_weights[column] / distance_m;
    }
    for (std::size_t mode = 0; mode < modes; ++mode) {
      double* const of_mode = arrivals.of_mode[mode].data();
      for (std::size_t column = 0; column < columns; ++column) {
        const double shape = grid.row_shapes[mode][row] * grid.column_shapes[mode][column];
        for (std::size_t i = 0; i < 4; ++i) of_mode[bin[column] + i - 1] += shape * weights[column][i];
      }
    }
  }
  return arrivals;
}

// The modes of a plate with ribs are sums of those without.
Arrivals arrivals_of_ribbed(const Plate& plate, std::span<const NumberedMode> modes, const ListeningPlace& place,
                            const Reach& reach) {
  const RibbedModes& ribbed = plate.ribbed->modes();
  std::vector<NumberedMode> sines;
  for (const PlateSine& sine : ribbed.sines) sines.push_back({{}, 0, sine.along, sine.across});
  const Arrivals of_sines = arrivals_of(PlateGrid(plate, sines), place, reach);
  Arrivals arrivals{of_sines.first_s, {}};
  for (const NumberedMode& mode : modes) {
    const std::vector<double>& weights = ribbed.weights[static_cast<std::size_t>(mode.number)];
    std::vector<double>& sum = arrivals.of_mode.emplace_back(of_sines.of_mode.front().size());
    for (std::size_t i = 0; i < weights.size(); ++i)
      for (std::size_t b = 0; b < sum.size(); ++b) sum[b] += weights[i] * of_sines.of_mode[i][b];
  }
  return arrivals;
}

Arrivals arrivals_of(const Resonator& resonator, std::span<const NumberedMode> modes, const ListeningPlace& place) {
  const Reach reach = reach_of(resonator.body, place);
  if (const auto* plate = std::get_if<Plate>(&resonator.body))
    return plate->ribbed ? arrivals_of_ribbed(*plate, modes, place, reach)
                         : arrivals_of(PlateGrid(*plate, modes), place, reach);
  return arrivals_of(RoundGrid(resonator.body, modes, resonator.strike.angle_rad), place, reach);
}

// The sum of what arrives times exp(-p t), t counted from the time that is left out.
Complex transform(const Arrivals& arrivals, std::size_t mode, Complex p, double left_out_s) {
  const Complex step = std::exp(-p * kBin_s);
  Complex sum = 0;
  for (std::size_t b = arrivals.of_mode[mode].size(); b-- > 0;) sum = sum * step + arrivals.of_mode[mode][b];
  return sum * std::exp(-p * (arrivals.first_s - left_out_s));
}

/// Two weights of a mode, and its response to a modal force, at one sample rate.
class ModeFilter {
 public:
  ModeFilter(const Mode& mode, double sample_rate_hz)
      : mode_(mode), constants_(detail::mode_constants(mode, sample_rate_hz)), time_step_s_(1 / sample_rate_hz) {}

  // Do two weights stand for it, with a span of arrivals of so many seconds?
  [[nodiscard]] bool rings(double span_s) const {
    return constants_.loss <= kMaxLoss && mode_.decay_per_s * span_s <= kMaxDecay;
  }

  // What a modal acceleration of exp(p t) sounds like, by its transform, for the mean force over a sample: its middle
  // is half a sample before its end, and the mean of an oscillation is smaller than the oscillation.
  [[nodiscard]] Complex of_mean_force(Complex p, Complex transform) const {
    const Complex half = p * time_step_s_ / 2.0;
    return transform * half / std::sinh(half) * std::exp(half);
  }
  [[nodiscard]] Complex response(double w, Complex transform) const {
    const double square = std::norm(pole());
    return of_mean_force({0, w}, transform) * -w * w /
           (mode_.mass_kg * Complex(square - w * w, 2 * mode_.decay_per_s * w));
  }

  // Of velocity and displacement, so that the mode rings after a force as it does in the response: the residues at
  // its pole are the same.
  void set_weights(const Arrivals& arrivals, std::size_t mode, double left_out_s) {
    const Complex p = pole(), z = std::exp(p * time_step_s_);
    const Complex residue = time_step_s_ * of_mean_force(p, transform(arrivals, mode, p, left_out_s)) * p * p /
                            (mode_.mass_kg * (p - std::conj(p)));
    const auto [velocity, displacement] = motion(1.0 / z);
    const Complex sound = residue * (1.0 - std::conj(z) / z);
    of_velocity_ = (std::conj(displacement) * sound).imag() / (std::conj(displacement) * velocity).imag();
    of_displacement_ = (std::conj(velocity) * sound).imag() / (std::conj(velocity) * displacement).imag();
  }
  [[nodiscard]] double of_velocity() const { return of_velocity_; }
  [[nodiscard]] double of_displacement() const { return of_displacement_; }

  // What the two weights make of a modal force that is constant over each sample; x: exp(-j w dt).
  [[nodiscard]] Complex weighted(Complex x) const {
    const auto [velocity, displacement] = motion(x);
    const Complex z = std::exp(pole() * time_step_s_);
    return (of_velocity_ * velocity + of_displacement_ * displacement) / ((1.0 - z * x) * (1.0 - std::conj(z) * x));
  }

 private:
  struct Motion {
    Complex velocity, displacement;
  };

  [[nodiscard]] Complex pole() const { return {-mode_.decay_per_s, mode_.angular_frequency_rad_per_s}; }

  // Numerators of the z transforms of velocity and displacement after a sample under a modal force of 1 N, as the
  // sound pickups of ModalBank read them; x: 1/z.
  [[nodiscard]] Motion motion(Complex x) const {
    constexpr double kMinAveraging = 4 / (pi * pi);
    const double real = 1 - (constants_.loss + constants_.stiffness) / 2,
                 square = 1 - constants_.loss;  // Re z, |z|^2
    const double scale = constants_.receptance / std::max(constants_.averaging_factor, kMinAveraging);
    const Complex displacement = scale * (1.0 + x), free_increment = scale * (2 * real - (1 + square) * x);
    const double gain = constants_.velocity_gain;
    return {(gain * (1 - real) - mode_.decay_per_s) * displacement + gain * free_increment, displacement};
  }

  Mode mode_;
  detail::ModeConstants constants_;
  double time_step_s_;
  double of_velocity_ = 0, of_displacement_ = 0;
};

/// Fits taps to responses: the smallest squares of their errors over the frequencies.
class TapFit {
 public:
  TapFit(std::size_t taps, double sample_rate_hz) : taps_(static_cast<Eigen::Index>(taps)) {
    const std::size_t frequencies = std::max<std::size_t>(256, 2 * taps);
    const double fitted_hz = std::min(kMaxFitted_hz, kFittedPart * sample_rate_hz / 2);
    for (std::size_t i = 0; i < frequencies; ++i) {
      const double w = pi * sample_rate_hz * (static_cast<double>(i) + 0.5) / static_cast<double>(frequencies);
      angular_frequencies_.push_back(w);
      phases_.push_back(w / sample_rate_hz);
      weights_.push_back(w < 2 * pi * fitted_hz ? 1 : kWeightAbove * kWeightAbove);
    }
    Eigen::VectorXd row = Eigen::VectorXd::Zero(taps_);
    for (std::size_t i = 0; i < frequencies; ++i)
      for (Eigen::Index lag = 0; lag < taps_; ++lag)
        row[lag] += weights_[i] * std::cos(phases_[i] * static_cast<double>(lag));
    Eigen::MatrixXd matrix(taps_, taps_);
    for (Eigen::Index r = 0; r < taps_; ++r)
      for (Eigen::Index c = 0; c < taps_; ++c) matrix(r, c) = row[std::abs(r - c)];
    factors_.compute(matrix);
  }
  [[nodiscard]] std::span<const double> angular_frequencies() const { return angular_frequencies_; }

  [[nodiscard]] std::vector<double> taps(std::span<const Complex> response) const {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(taps_);
    for (std::size_t i = 0; i < response.size(); ++i)
      for (Eigen::Index tap = 0; tap < taps_; ++tap)
        right[tap] += weights_[i] * (response[i] * std::polar(1.0, phases_[i] * static_cast<double>(tap))).real();
    const Eigen::VectorXd solved = factors_.solve(right);
    return {solved.begin(), solved.end()};
  }

 private:
  Eigen::Index taps_;
  std::vector<double> angular_frequencies_, phases_, weights_;
  Eigen::LLT<Eigen::MatrixXd> factors_;
};

}  // namespace

bool radiates(const decltype(Resonator::body)& body) {
  return std::holds_alternative<Plate>(body) || is_round(body);
}

Reach reach_of(const decltype(Resonator::body)& body, const ListeningPlace& place) {
  const Point at = position_of(place);
  double near_x = 0, near_y = 0, far_x = 0, far_y = 0;
  if (const auto* plate = std::get_if<Plate>(&body)) {
    near_x = std::max(0.0, std::abs(at.x) - plate->length_m / 2);
    near_y = std::max(0.0, std::abs(at.y) - plate->width_m / 2);
    far_x = std::abs(at.x) + plate->length_m / 2;
    far_y = std::abs(at.y) + plate->width_m / 2;
  } else {
    const double radius = radius_of(body), from_axis = std::hypot(at.x, at.y);
    near_x = std::max(0.0, from_axis - radius);
    far_x = from_axis + radius;
  }
  return {std::hypot(near_x, near_y, at.z), std::hypot(far_x, far_y, at.z)};
}

RadiationTiming radiation_timing(double nearest_m, double sample_rate_hz) {
  return {nearest_m / kSpeedOfSound_m_per_s - kMargin / sample_rate_hz, sample_rate_hz};
}

Radiation radiation_of(const Resonator& resonator, std::span<const NumberedMode> modes, const ListeningPlace& place,
                       const RadiationTiming& timing, std::span<const std::vector<double>> driven) {
  const auto [left_out_s, rate_hz] = timing;
  const Arrivals arrivals = arrivals_of(resonator, modes, place);
  const double span_s = reach_of(resonator.body, place).farthest_m / kSpeedOfSound_m_per_s - left_out_s;
  Radiation radiation;
  std::vector<ModeFilter> filters;
  double tail_s = 0;  // of modes that taps alone stand for
  for (std::size_t m = 0; m < modes.size(); ++m) {
    ModeFilter& filter = filters.emplace_back(modes[m].mode, rate_hz);
    if (filter.rings(span_s))
      filter.set_weights(arrivals, m, left_out_s);
    else
      tail_s = std::max(tail_s, kMaxDecay / modes[m].mode.decay_per_s);
    radiation.of_velocity.push_back(filter.of_velocity());
    radiation.of_displacement.push_back(filter.of_displacement());
  }
  const TapFit fit(static_cast<std::size_t>((span_s + tail_s) * rate_hz) + kMargin, rate_hz);
  std::vector responses(driven.size(), std::vector<Complex>(fit.angular_frequencies().size()));
  for (std::size_t i = 0; i < fit.angular_frequencies().size(); ++i) {
    const double w = fit.angular_frequencies()[i];
    if (w > 2 * pi * kMaxFrequency_hz) break;
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const Complex part = filters[m].response(w, transform(arrivals, m, {0, w}, left_out_s)) -
                           filters[m].weighted(std::polar(1.0, -w / rate_hz));
      for (std::size_t d = 0; d < driven.size(); ++d) responses[d][i] += driven[d][m] * part;
    }
  }
  for (const auto& response : responses) radiation.taps.push_back(fit.taps(response));
  return radiation;
}

Radiation rounded(Radiation radiation) {
  const auto thirteen_digits = [](double value) { return rounded_to(value, 13); };
  for (auto* weights : {&radiation.of_velocity, &radiation.of_displacement})
    std::ranges::transform(*weights, weights->begin(), thirteen_digits);
  for (std::vector<double>& taps : radiation.taps) {
    double largest = std::numeric_limits<double>::min();
    for (const double tap : taps) largest = std::max(largest, std::abs(tap));
    const double ninth_digit = std::pow(10, std::floor(std::log10(largest)) - 8);
    for (double& tap : taps) tap = thirteen_digits(std::round(tap / ninth_digit) * ninth_digit);
  }
  return radiation;
}

}  // namespace contactspline
