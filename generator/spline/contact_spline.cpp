// SPDX-License-Identifier: MIT
#include "generator/spline/contact_spline.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "generator/contact/contact_law_quad.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

using Vector = std::vector<Quad>;

/// a-bar, b-bar, c-bar of (5); one entry per segment.
struct Reparametrised {
  Vector a, b, c;
};

/// (9): V at the knots j = 0..N, divided by `scale`.
struct Samples {
  Quad scale;
  Vector values;
};

// For a power law the samples depend on the exponent only: Vn(j) = j^(a+1)/(a+1), V(y_j) = k Delta_y^(a+1) Vn(j).
Samples sample_power_law(const PowerLaw& law, const Quad& width, int segments) {
  const Quad power = Quad(law.exponent) + 1;
  Samples samples{law.stiffness * pow(width, power), {0}};
  for (int j = 1; j <= segments; ++j) samples.values.push_back(pow(Quad(j), power) / power);
  return samples;
}

// For any other law the scale is Delta_y times the mean force up to the last knot.
Samples sample_potential(const ContactLaw& contact, const Quad& width, int segments) {
  if (const PowerLaw* law = contact.power_law()) return sample_power_law(*law, width, segments);
  Samples samples{exact_energy(contact, Quad(width * segments)) / segments, {}};
  for (int j = 0; j <= segments; ++j)
    samples.values.push_back(exact_energy(contact, Quad(width * j)) / samples.scale);
  return samples;
}

// The bidiagonal system (21)(22) has ones on and below the diagonal, so forward substitution solves it:
// b(j) = 2 [V(y_j) - V(y_j-1)] - b(j-1).
Reparametrised solve_conditions(const Vector& samples) {
  Reparametrised bars;
  Quad slope = 0;  // b(0), (11)
  for (std::size_t j = 0; j + 1 < samples.size(); ++j) {
    const Quad rise = samples[j + 1] - samples[j];
    bars.a.push_back(rise - slope);  // (18)
    bars.b.push_back(slope);
    bars.c.push_back(samples[j]);  // (10) and (15)
    slope = 2 * rise - slope;
  }
  return bars;
}

// The nearest double. Never -0.0: the sign of a difference that is zero in 113 bits depends on the machine.
double rounded(const Quad& value) {
  return value.convert_to<double>() + 0.0;
}

std::vector<double> rounded(const Vector& values) {
  std::vector<double> doubles;
  doubles.reserve(values.size());
  for (const Quad& value : values) doubles.push_back(rounded(value));
  return doubles;
}

Coefficients normalised_coefficients(const Reparametrised& bars) {
  return {rounded(bars.a), rounded(bars.b), rounded(bars.c)};
}

// 0, 1, ..., n - 1.
std::vector<double> first_numbers(std::size_t n) {
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  return numbers;
}

// (8); here j counts from 0 to N - 1.
Coefficients regular_coefficients(const Reparametrised& bars, const Quad& energy, const Quad& width) {
  Reparametrised regular;
  for (std::size_t j = 0; j < bars.a.size(); ++j) {
    regular.a.push_back(energy * bars.a[j] / (width * width));
    regular.b.push_back(energy * (bars.b[j] - 2 * Quad(j) * bars.a[j]) / width);
    regular.c.push_back(energy * (bars.a[j] * j * j - bars.b[j] * j + bars.c[j]));
  }
  return normalised_coefficients(regular);
}

std::vector<Segment<double>> local_segments(const Reparametrised& bars, const Quad& energy, const Quad& width) {
  std::vector<Segment<double>> segments;
  for (std::size_t j = 0; j < bars.a.size(); ++j)
    segments.push_back({rounded(width * j), rounded(energy * bars.c[j]), rounded(energy * bars.b[j] / width),
                        rounded(energy * bars.a[j] / (width * width))});
  return segments;
}

[[noreturn]] void refuse_concave(const Material& material, std::size_t segment, std::string_view file) {
  const std::string wrong = fmt::format(
      "uniform knots the spline is not convex (segment {} of {} has negative curvature), so a contact step could "
      "have "
      "several solutions",
      segment, material.spline.segments);
  if (const PowerLaw* law = material.contact.power_law())
    refuse(file, "contact.exponent", fmt::format("with {} and {}", law->exponent, wrong), "an exponent >= 1");
  refuse(file, "spline.segments", fmt::format("with {}", wrong), "another number of segments");
}

void require_convex(const Reparametrised& bars, const Material& material, std::string_view file) {
  for (std::size_t j = 0; j < bars.a.size(); ++j)
    if (bars.a[j] < 0) refuse_concave(material, j + 1, file);
}

// Subnormal numbers lose digits, and numbers beyond the range of double make the table useless.
void require_in_range(const Spline& spline, std::string_view file) {
  const auto usable = [](double value) { return value == 0 || std::isnormal(value); };
  for (const auto& s : spline.segments)
    if (!(usable(s.knot) && usable(s.energy) && usable(s.force) && usable(s.half_curvature)))
      refuse(file, "contact.stiffness_n_per_m_alpha",
             "stiffness, exponent and max_compression_m together leave the range of double precision",
             "energies and stiffnesses between 1e-300 and 1e300");
}

}  // namespace

Spline uniform_spline(const Material& material, std::string_view file) {
  const Quad width = Quad(material.spline.max_compression_m) / material.spline.segments;
  const auto [energy, samples] = sample_potential(material.contact, width, material.spline.segments);
  const Reparametrised bars = solve_conditions(samples);
  require_convex(bars, material, file);
  Spline spline{local_segments(bars, energy, width),
                rounded(width),
                rounded(energy),
                regular_coefficients(bars, energy, width),
                normalised_coefficients(bars),
                first_numbers(bars.a.size())};
  spline.end_m = material.spline.max_compression_m;
  require_in_range(spline, file);
  return spline;
}

Spline spline_through(const PiecewiseLinearForce& force, const Material& material, std::string_view file) {
  const Quad length = material.spline.max_compression_m;
  const PowerLaw* law = material.contact.power_law();
  const Quad energy = law != nullptr ? Quad((Quad(law->exponent) + 1) * exact_energy(material.contact, length))
                                     : Quad(length * material.contact.force(material.spline.max_compression_m));
  Spline spline{{}, rounded(length), rounded(energy), {}, {}, {}};
  const auto push = [](Coefficients& to, const Quad& a, const Quad& b, const Quad& c) {
    to.a.push_back(rounded(a));
    to.b.push_back(rounded(b));
    to.c.push_back(rounded(c));
  };
  Quad stored = 0;
  for (std::size_t j = 0; j < force.segments(); ++j) {
    const Quad y = Quad(force.y[j]), f = Quad(force.f[j]);
    const Quad width = Quad(force.y[j + 1]) - y, rise = Quad(force.f[j + 1]) - f;
    const Quad a = rise / (2 * width);
    push(spline.normalised, a, f, stored);
    push(spline.regular, energy * a / (length * length), energy * (f - 2 * a * y) / length,
         energy * ((a * y - f) * y + stored));
    spline.normalised_knots.push_back(rounded(y));
    spline.segments.push_back({rounded(length * y), rounded(energy * stored), rounded(energy / length * f),
                               rounded(energy / (length * length) * a)});
    stored += (f + rise / 2) * width;
  }
  spline.end_m = rounded(length * force.y.back());
  require_in_range(spline, file);
  return spline;
}

std::vector<Segment<double>> segment_table(const Spline& spline) {
  std::vector<Segment<double>> table{{}};
  table.insert(table.end(), spline.segments.begin(), spline.segments.end());
  return table;
}

LawView law_view(const Spline& spline) {
  LawView law{{}, {}, {}};
  const auto table = segment_table(spline);
  law.energy = [table](double y) { return potential(std::span(table), y); };
  law.force = [table](double y) { return force(std::span(table), y); };
  for (const auto& segment : spline.segments)
    if (segment.knot > 0) law.breaks.push_back(segment.knot);
  return law;
}

}  // namespace contactspline
