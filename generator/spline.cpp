// SPDX-License-Identifier: MIT
#include "generator/spline.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <numeric>

#include "generator/error.hpp"
#include "generator/potential_quad.hpp"

namespace contactspline {
namespace {

using Vector = Eigen::Matrix<Quad, Eigen::Dynamic, 1>;

/// a-bar, b-bar, c-bar of (5), one entry per segment.
struct Reparametrised {
  Vector a, b, c;
};

/// (9): V at the knots j = 0..N in units of `scale`.
struct Samples {
  Quad scale;
  Vector values;
};

// A power law is normalised: Vn(j) = j^(a+1)/(a+1), so that V(y_j) = k Delta_y^(a+1) Vn(j).
Samples sample_power_law(const PowerLaw& law, const Quad& width, Eigen::Index segments) {
  const Quad power = Quad(law.exponent) + 1;
  Samples samples{law.stiffness * pow(width, power), Vector(segments + 1)};
  samples.values(0) = 0;
  for (Eigen::Index j = 1; j <= segments; ++j) samples.values(j) = pow(Quad(j), power) / power;
  return samples;
}

// Any other law is in units of Delta_y times the mean force up to the last knot.
Samples sample_potential(const Potential& contact, const Quad& width, Eigen::Index segments) {
  if (const PowerLaw* law = contact.power_law()) return sample_power_law(*law, width, segments);
  Samples samples{exact_energy(contact, Quad(width * segments)) / segments, Vector(segments + 1)};
  for (Eigen::Index j = 0; j <= segments; ++j)
    samples.values(j) = exact_energy(contact, Quad(width * j)) / samples.scale;
  return samples;
}

// (22): ones on the diagonal and below it.
Eigen::SparseMatrix<Quad> smoothness_matrix(Eigen::Index size) {
  Eigen::SparseMatrix<Quad> matrix(size, size);
  matrix.reserve(Eigen::VectorXi::Constant(size, 2));
  for (Eigen::Index j = 0; j < size; ++j) {
    matrix.insert(j, j) = 1;
    if (j + 1 < size) matrix.insert(j + 1, j) = 1;
  }
  return matrix;
}

Reparametrised solve_conditions(const Vector& samples) {
  const Eigen::Index n = samples.size() - 1;
  const Vector rise = samples.tail(n) - samples.head(n);
  Reparametrised bars{Vector(n), Vector(n), samples.head(n)};  // (10) and (15)
  bars.b(0) = 0;                                               // (11)
  bars.b.tail(n - 1) =                                         // (21)(22), right side 2 [V(y_j) - V(y_j-1)]
      smoothness_matrix(n - 1).triangularView<Eigen::Lower>().solve(Vector(rise.head(n - 1) * Quad(2)));
  bars.a = rise - bars.b;  // (18)
  return bars;
}

std::vector<double> rounded(const Vector& values) {
  std::vector<double> doubles;
  doubles.reserve(static_cast<std::size_t>(values.size()));
  for (const Quad& value : values) doubles.push_back(value.convert_to<double>());
  return doubles;
}

Coefficients normalised_coefficients(const Reparametrised& bars) {
  return {rounded(bars.a), rounded(bars.b), rounded(bars.c)};
}

std::vector<double> counted(Eigen::Index n) {
  std::vector<double> numbers(static_cast<std::size_t>(n));
  std::iota(numbers.begin(), numbers.end(), 0.0);
  return numbers;
}

// (8), with j counted from 0 to N - 1 here.
Coefficients regular_coefficients(const Reparametrised& bars, Quad energy, Quad width) {
  const Eigen::Index n = bars.a.size();
  Reparametrised regular{Vector(n), Vector(n), Vector(n)};
  for (Eigen::Index j = 0; j < n; ++j) {
    regular.a(j) = energy * bars.a(j) / (width * width);
    regular.b(j) = energy * (bars.b(j) - 2 * Quad(j) * bars.a(j)) / width;
    regular.c(j) = energy * (bars.a(j) * j * j - bars.b(j) * j + bars.c(j));
  }
  return normalised_coefficients(regular);
}

std::vector<Segment<double>> local_segments(const Reparametrised& bars, Quad energy, Quad width) {
  std::vector<Segment<double>> segments;
  for (Eigen::Index j = 0; j < bars.a.size(); ++j)
    segments.push_back({Quad(width * j).convert_to<double>(), Quad(energy * bars.c(j)).convert_to<double>(),
                        Quad(energy * bars.b(j) / width).convert_to<double>(),
                        Quad(energy * bars.a(j) / (width * width)).convert_to<double>()});
  return segments;
}

[[noreturn]] void refuse_concave(const Material& material, Eigen::Index segment, std::string_view file) {
  const std::string wrong = fmt::format(
      "uniform knots the spline is not convex (segment {} of {} has negative curvature), so a contact step could "
      "have "
      "several solutions",
      segment, material.spline.segments);
  if (const PowerLaw* law = material.contact.power_law())
    throw BadInput(
        fmt::format("{}: contact.exponent: with {} and {}; use an exponent >= 1", file, law->exponent, wrong));
  throw BadInput(fmt::format("{}: spline.segments: with {}; use another number of segments", file, wrong));
}

void require_convex(const Reparametrised& bars, const Material& material, std::string_view file) {
  for (Eigen::Index j = 0; j < bars.a.size(); ++j)
    if (bars.a(j) < 0) refuse_concave(material, j + 1, file);
}

// Subnormal numbers lose digits; beyond them the table would be wrong rather than inexact.
void require_in_range(const Spline& spline, std::string_view file) {
  const auto usable = [](double value) { return value == 0 || std::isnormal(value); };
  for (const auto& s : spline.segments)
    if (!(usable(s.knot) && usable(s.energy) && usable(s.force) && usable(s.half_curvature)))
      throw BadInput(
          fmt::format("{}: contact.stiffness_n_per_m_alpha: stiffness, exponent and max_compression_m together leave "
                      "the range of "
                      "double precision; energies and stiffnesses must lie between 1e-300 and 1e300",
                      file));
}

}  // namespace

Spline uniform_spline(const Material& material, std::string_view file) {
  const Quad width = Quad(material.spline.max_compression_m) / material.spline.segments;
  const auto [energy, samples] = sample_potential(material.contact, width, material.spline.segments);
  const Reparametrised bars = solve_conditions(samples);
  require_convex(bars, material, file);
  Spline spline{local_segments(bars, energy, width),       width.convert_to<double>(),    energy.convert_to<double>(),
                regular_coefficients(bars, energy, width), normalised_coefficients(bars), counted(bars.a.size())};
  spline.end_m = material.spline.max_compression_m;
  require_in_range(spline, file);
  return spline;
}

Spline line_spline(const ForceLine& line, const Material& material, std::string_view file) {
  const Quad length = material.spline.max_compression_m;
  const PowerLaw* law = material.contact.power_law();
  const Quad energy = law != nullptr ? Quad((Quad(law->exponent) + 1) * exact_energy(material.contact, length))
                                     : Quad(length * material.contact.force(material.spline.max_compression_m));
  Spline spline{{}, length.convert_to<double>(), energy.convert_to<double>(), {}, {}, {}};
  const auto push = [](Coefficients& to, const Quad& a, const Quad& b, const Quad& c) {
    to.a.push_back(a.convert_to<double>());
    to.b.push_back(b.convert_to<double>());
    to.c.push_back(c.convert_to<double>());
  };
  Quad stored = 0;
  for (std::size_t j = 0; j < line.segments(); ++j) {
    const Quad y = Quad(line.y[j]), f = Quad(line.f[j]);
    const Quad width = Quad(line.y[j + 1]) - y, rise = Quad(line.f[j + 1]) - f;
    const Quad a = rise / (2 * width);
    push(spline.normalised, a, f, stored);
    push(spline.regular, energy * a / (length * length), energy * (f - 2 * a * y) / length,
         energy * ((a * y - f) * y + stored));
    spline.normalised_knots.push_back(y.convert_to<double>());
    spline.segments.push_back({Quad(length * y).convert_to<double>(), Quad(energy * stored).convert_to<double>(),
                               Quad(energy / length * f).convert_to<double>(),
                               Quad(energy / (length * length) * a).convert_to<double>()});
    stored += (f + rise / 2) * width;
  }
  spline.end_m = Quad(length * line.y.back()).convert_to<double>();
  require_in_range(spline, file);
  return spline;
}

std::vector<Segment<double>> segment_table(const Spline& spline) {
  std::vector<Segment<double>> table{{}};
  table.insert(table.end(), spline.segments.begin(), spline.segments.end());
  return table;
}

}  // namespace contactspline
