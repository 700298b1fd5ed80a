// SPDX-License-Identifier: MIT
// The spectrum of impacts, its error as a figure of a spline, and knots designed for it: against numerical
// integration of the motion, which shares no step with the generator.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <string>

#include "generator/contact/barrier_impact.hpp"
#include "generator/spline/design.hpp"
#include "generator/spline/graded_knots.hpp"
#include "generator/spline/impact_spectrum.hpp"
#include "generator/spline/spectrum_knots.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using Long = long double;

/// A force over compression with the energy it stores between two compressions, and where it is not smooth.
struct LongLaw {
  std::function<Long(Long)> force;
  std::function<Long(Long, Long)> energy;  // stored between two compressions, without cancellation
  std::vector<Long> breaks;
};

LongLaw power_law(const PowerLaw& law) {
  const Long k = law.stiffness, a = law.exponent;
  // (high^(a + 1) - low^(a + 1)) by expm1, because both are nearly equal near the turning point
  return {[=](Long y) { return k * std::pow(y, a); },
          [=](Long low, Long high) {
            const Long whole = k / (a + 1) * std::pow(high, a + 1);
            return low == 0 ? whole : -whole * std::expm1((a + 1) * std::log1p((low - high) / high));
          },
          {}};
}

LongLaw linear_law(PiecewiseLinearForce line) {
  const auto force = [line](Long y) {
    std::size_t j = 0;
    while (j + 1 < line.segments() && y >= line.y[j + 1]) ++j;
    return line.f[j] + (Long(line.f[j + 1]) - line.f[j]) / (Long(line.y[j + 1]) - line.y[j]) * (y - line.y[j]);
  };
  LongLaw law{force, {}, {line.y.begin() + 1, line.y.end() - 1}};
  law.energy = [force, breaks = law.breaks](Long low, Long high) {
    Long sum = 0;
    for (const Long at : breaks)
      if (at > low && at < high) {
        sum += (force(low) + force(at)) / 2 * (at - low);
        low = at;
      }
    return sum + (force(low) + force(high)) / 2 * (high - low);
  };
  return law;
}

/// Half the contact duration, and the cosine integrals of the force at the given angular frequencies.
struct LongImpact {
  Long half_duration = 0;
  std::vector<Long> spectrum;
};

// The time t before the largest compression ym, with y = ym (1 - x^2), by Gauss' rule with two points on `panels`
// panels between any two breaks, and the integrals of 2 F cos(W t) dt by Simpson's rule on the same panels. In x the
// speed's zero at ym cancels. Towards the first touch the panels shrink, because F may begin as any power.
LongImpact integrate(const LongLaw& law, Long mass, Long ym, const std::vector<Long>& frequencies, int panels) {
  const auto time_per_x = [&](Long x) {
    const Long y = ym * (1 - x * x);
    const Long stored = law.energy(y < 0 ? 0 : y, ym);
    return x == 0 ? std::sqrt(2 * mass * ym / law.force(ym)) : 2 * ym * x / std::sqrt(2 * stored / mass);
  };
  std::vector<Long> ends{0};
  for (auto at = law.breaks.rbegin(); at != law.breaks.rend(); ++at)
    if (*at < ym) ends.push_back(std::sqrt(1 - *at / ym));
  ends.push_back(1);
  LongImpact found{0, std::vector<Long>(frequencies.size())};
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (int p = 0; p < panels; ++p) {
      const auto at = [&](Long fraction) {
        return ends[i] + (ends[i + 1] - ends[i]) * std::sin(fraction * std::numbers::pi_v<Long> / 2);
      };
      const Long left = at(Long(p) / panels), right = at(Long(p + 1) / panels), width = right - left;
      // t to the middle and to the end of the panel, by Lobatto's rule of the sixth order
      const auto time = [&](Long from, Long to) {
        const Long middle = (from + to) / 2, reach = (to - from) / 2, inner = reach / std::sqrt(Long(5));
        return reach *
               (time_per_x(from) + 5 * time_per_x(middle - inner) + 5 * time_per_x(middle + inner) + time_per_x(to)) /
               6;
      };
      const Long middle = (left + right) / 2;
      const Long t0 = found.half_duration, t1 = t0 + time(left, middle), t2 = t1 + time(middle, right);
      const auto flow = [&](Long x) { return law.force(std::max<Long>(0, ym * (1 - x * x))) * time_per_x(x); };
      const Long f0 = flow(left), f1 = flow(middle), f2 = flow(right);
      for (std::size_t k = 0; k < frequencies.size(); ++k)
        found.spectrum[k] += width / 3 *
                             (f0 * std::cos(frequencies[k] * t0) + 4 * f1 * std::cos(frequencies[k] * t1) +
                              f2 * std::cos(frequencies[k] * t2));
      found.half_duration = t2;
    }
  return found;
}

std::vector<Long> multiples(Long step, int count) {
  std::vector<Long> frequencies;
  for (int k = 0; k < count; ++k) frequencies.push_back(k * step);
  return frequencies;
}

// At 0 the integral is the impulse, and every value is relative to it. Half of the lines have a segment of constant
// force, and one of the frequencies is that of a segment, where the closed form divides 0 by 0.
TEST(ImpactSpectrum, EqualsTheIntegralOfTheMotion) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> draw(0.1, 1);
  for (int i = 0; i < 10; ++i) {
    PiecewiseLinearForce line{{0}, {0}};
    for (int j = 0; j <= i % 7; ++j) {
      line.y.push_back(line.y.back() + draw(random));
      line.f.push_back(line.f.back() + (j == 2 && i % 2 == 0 ? 0 : draw(random)));
    }
    for (const double reach : {0.05, 0.6, 1.5}) {
      const double energy = reach * line.energies().back();
      const double ym = turning_point(line, energy);
      const double w = std::sqrt((line.f[1] - line.f[0]) / (line.y[1] - line.y[0]));
      const auto exact = integrate(linear_law(line), 1, ym, multiples(w / 4, 60), 500);
      const auto found = impact_spectrum(line, energy, w / 4, 60);
      EXPECT_TRUE(relatively_within(found[0], 2 * std::sqrt(2 * energy), 1e-14));
      for (std::size_t k = 0; k < found.size(); ++k)
        EXPECT_TRUE(within(found[k], static_cast<double>(exact.spectrum[k]), 1e-9 * found[0]))
            << i << " " << reach << " " << k;
    }
  }
}

Material felt(const std::string& name, Knots knots, ErrorOf minimise, int segments) {
  const auto* file = find_embedded(Shipped::kMaterials, name + ".json");
  Material material = parse_material(file->content, file->name, shipped_file);
  const double range =
      max_compression(material.contact, material.impact->mass_kg, material.impact->max_speed_m_per_s);
  material.spline = {segments, range, knots, minimise};
  return material;
}

/// The figure once more, for a power law: its spectra differ from speed to speed by their scales of level and time
/// only, so one of them, integrated numerically, serves all.
class Figure {
 public:
  explicit Figure(const Material& material) : material_(material) {
    const PowerLaw& law = *material.contact.power_law();
    const Impact& impact = *material.impact;
    const double duration = law.contact_duration(impact.mass_kg, impact.max_speed_m_per_s);
    const Long ym = law.max_compression(impact.mass_kg, impact.max_speed_m_per_s);
    const LongImpact exact = integrate(power_law(law), impact.mass_kg, ym,
                                       multiples(2 * std::numbers::pi_v<Long> / duration / 4, 80), 400);
    EXPECT_TRUE(relatively_within(static_cast<double>(2 * exact.half_duration), duration, 1e-9));
    for (const Long value : exact.spectrum) relative_.push_back(static_cast<double>(value / exact.spectrum[0]));
  }

  /// The error of a spline over a number of speeds.
  [[nodiscard]] SpectrumError of(const Spline& spline, int speeds) const {
    const auto& [mass, fastest, slowest] = *material_.impact;
    PiecewiseLinearForce force{{}, {}};  // for a unit mass
    for (const auto& segment : spline.segments) {
      force.y.push_back(segment.knot);
      force.f.push_back(segment.force / mass);
    }
    force.y.push_back(2 * spline.end_m);
    force.f.push_back(spline.segments.back().force_at(2 * spline.end_m) / mass);
    SpectrumError error{0, 0};
    int count = 0;
    for (int i = 0; i < speeds; ++i) {
      const double speed = slowest * std::pow(fastest / slowest, i / (speeds - 1.0));
      const double step = 0.25 / material_.contact.power_law()->contact_duration(mass, speed);
      const auto found = impact_spectrum(force, speed * speed / 2, 2 * std::numbers::pi * step, 60);
      for (std::size_t k = 1; k < found.size() && static_cast<double>(k) * step <= 15000; ++k) {
        const auto magnitude = [](double a, double b) { return std::abs(a) < std::abs(b); };
        const double envelope =
            std::abs(*std::max_element(relative_.begin() + static_cast<long>(k), relative_.end(), magnitude));
        if (envelope < 1e-3) break;
        const double level = 20 * std::log10(1 + std::abs(found[k] / (2 * speed) - relative_[k]) / envelope);
        error.mean_db += level;
        if (!(level <= error.worst_db)) error.worst_db = level;
        ++count;
      }
    }
    error.mean_db /= count;
    return error;
  }

 private:
  Material material_;
  std::vector<double> relative_;  // to the impulse, at multiples of a quarter of the distance between two zeros
};

// Both read the same speeds and frequencies; what differs are the exact spectra, by 0.001 dB on average and 0.02 dB
// at most.
TEST(SpectrumError, IsThatOfTheIntegratedMotion) {
  for (const std::string name : {"felt_c2", "felt_c4", "felt_c7"})
    for (const auto& [knots, minimise, segments] : {std::tuple{Knots::uniform, ErrorOf::contact_duration, 16},
                                                    {Knots::graded, ErrorOf::contact_duration, 32},
                                                    {Knots::optimal, ErrorOf::spectrum, 32},
                                                    {Knots::optimal, ErrorOf::spectrum, 96}}) {
      Material material = felt(name, knots, minimise, segments);
      const Spline spline = design_spline(material, name);
      const SpectrumError expected = Figure(material).of(spline, 256);
      const auto found = measure_spectrum(spline, material);
      ASSERT_TRUE(found.has_value());
      EXPECT_TRUE(within(found->mean_db, expected.mean_db, 0.001 + 1e-3 * expected.mean_db))
          << name << " " << segments;
      EXPECT_TRUE(within(found->worst_db, expected.worst_db, 0.02 + 1e-3 * expected.worst_db))
          << name << " " << segments;
    }
}

TEST(SpectrumError, IsAbsentWithoutImpactAndWithCompensation) {
  Material material = felt("felt_c4", Knots::graded, ErrorOf::contact_duration, 16);
  const Spline spline = design_spline(material, "felt");
  Material compensated = material, free_of_impact = material;
  compensated.compensation = {44100, 0.003};
  free_of_impact.impact.reset();
  EXPECT_TRUE(measure_spectrum(spline, material).has_value());
  EXPECT_FALSE(measure_spectrum(spline, compensated).has_value());
  EXPECT_FALSE(measure_spectrum(spline, free_of_impact).has_value());
}

struct Promise {
  std::string name;
  int segments;
  double mean_db, worst_db;
};

// The figures of docs/how-it-works/knots.md, with the worst over 1,000 speeds, and the contact
// duration within 0.1 %.
TEST(SpectrumKnots, KeepTheFiguresOfTheDocs) {
  for (const auto& [name, segments, mean_db, worst_db] : {Promise{"felt_c2", 32, 0.45, 4.2},
                                                          {"felt_c4", 32, 0.57, 7.0},
                                                          {"felt_c7", 32, 0.38, 7.0},
                                                          {"felt_c2", 48, 0.18, 2.1},
                                                          {"felt_c4", 48, 0.24, 3.2},
                                                          {"felt_c7", 48, 0.15, 3.4},
                                                          {"felt_c2", 64, 0.085, 1.4},
                                                          {"felt_c4", 64, 0.12, 1.9},
                                                          {"felt_c7", 64, 0.08, 2.2}}) {
    Material material = felt(name, Knots::optimal, ErrorOf::spectrum, segments);
    const Design design = design_material(material, name);
    ASSERT_EQ(design.spline.segments.size(), static_cast<std::size_t>(segments));
    const SpectrumError error = Figure(material).of(design.spline, 1000);
    Measured() << name << " " << segments << ": mean " << error.mean_db << " dB, worst " << error.worst_db
               << " dB, measured " << design.spectrum->mean_db << ", " << design.spectrum->worst_db << ", duration "
               << 100 * design.quality.impact->contact_duration << " %";
    EXPECT_TRUE(within(error.mean_db, 0, mean_db)) << name << " " << segments;
    EXPECT_TRUE(within(error.worst_db, 0, worst_db)) << name << " " << segments;
    EXPECT_TRUE(within(design.quality.impact->contact_duration, 0, 1e-3)) << name << " " << segments;
  }
}

// With more segments and no breaks, graded knots are not tried; the difference is then below 0.001 dB.
TEST(SpectrumKnots, AreNeverWorseThanGradedKnotsAndSuitEveryLaw) {
  for (const std::string name : {"felt_over_wood", "felt_synthetic", "rubber_on_wood", "steel_on_steel", "mb1"})
    for (const int segments : {1, 2, 7, 24, 128}) {
      const FitTarget target = fit_target(felt(name, Knots::graded, ErrorOf::contact_duration, segments));
      const PiecewiseLinearForce force = spectrum_knots(segments, target);
      EXPECT_TRUE(force.rises()) << name << " " << segments;
      EXPECT_EQ(force.segments(), static_cast<std::size_t>(segments));
      if (segments <= 2) continue;  // the contact duration decides
      const ExactSpectra exact(target, 64);
      const double error = exact.rms_error_of(force);
      const bool tried = segments <= 8 || !target.breaks.empty();
      EXPECT_TRUE(within(error, 0, exact.rms_error_of(graded_knots(segments, target)) + (tried ? 0 : 1e-4)))
          << name << " " << segments;
    }
}

// Over wide ranges of speeds the widths alone would spoil the softest impacts: 69 % at 1e6.
TEST(SpectrumKnots, KeepTheContactDurationOverWideRanges) {
  for (const double ratio : {1e3, 1e4, 1e6}) {
    Material material = felt("felt_c4", Knots::optimal, ErrorOf::spectrum, 32);
    material.impact->min_speed_m_per_s = material.impact->max_speed_m_per_s / ratio;
    const double spectrum = design_material(material, "felt").quality.impact->contact_duration;
    material.spline.knots = Knots::graded;
    material.spline.minimise = ErrorOf::contact_duration;
    const double graded = design_material(material, "felt").quality.impact->contact_duration;
    EXPECT_TRUE(within(spectrum, 0, std::max(1.1 * graded, 0.005))) << ratio << " " << graded;
  }
}

// A contact of some microseconds: all of its spectrum that can be compared is flat.
TEST(SpectrumKnots, AreRefusedWhereNothingCanBeCompared) {
  Material material{
      "grain", "", PowerLaw{1e14, 1.5}, Impact{1e-6, 10, 1}, {32, 0, Knots::optimal, ErrorOf::spectrum}};
  material.spline.max_compression_m = max_compression(material.contact, 1e-6, 10);
  EXPECT_THROW(static_cast<void>(design_spline(material, "grain.json")), BadInput);
  material.spline.minimise = ErrorOf::contact_duration;
  EXPECT_FALSE(design_material(material, "grain.json").spectrum);
}

// A low exponent and few frequencies: the bound in decibels alone would do with one segment.
TEST(SpectrumTolerance, KeepsTheContactDuration) {
  for (const auto& [law, impact] : {std::pair(PowerLaw{1e10, 1.5}, Impact{0.001, 2, 0.05}),
                                    std::pair(PowerLaw{1e3, 0.1}, Impact{0.03, 1, 0.01})}) {
    Material material{"probe", "", law, impact, {0, 0, Knots::optimal, ErrorOf::spectrum, 1.0}};
    material.spline.max_compression_m = max_compression(material.contact, impact.mass_kg, impact.max_speed_m_per_s);
    EXPECT_TRUE(within(design_material(material, "probe.json").quality.impact->contact_duration, 0, 0.01));
  }
}

TEST(SpectrumTolerance, FindsTheFewestSegments) {
  for (const double tolerance_db : {1.0, 4.0, 15.0}) {
    Material material = felt("felt_c4", Knots::optimal, ErrorOf::spectrum, 0);
    material.spline.tolerance = tolerance_db;
    const Spline found = design_spline(material, "felt");
    ASSERT_EQ(found.segments.size(), static_cast<std::size_t>(material.spline.segments));
    EXPECT_LE(measure_spectrum(found, material)->worst_db, tolerance_db);
    const int segments = material.spline.segments;
    material.spline.tolerance = 0;
    for (material.spline.segments = segments - 1;
         material.spline.segments >= segments - 3 && material.spline.segments > 0; --material.spline.segments)
      EXPECT_GT(measure_spectrum(design_spline(material, "felt"), material)->worst_db, tolerance_db / 1.003)
          << tolerance_db << " " << material.spline.segments;
  }
}

TEST(SpectrumTolerance, IsRefusedWhereNoNumberMeetsIt) {
  Material material = felt("felt_c4", Knots::optimal, ErrorOf::spectrum, 0);
  material.spline.tolerance = 0.1;
  try {
    static_cast<void>(design_spline(material, "felt.json"));
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what())
                  .find("felt.json: spline.tolerance_db: 0.1 is not met by 128 optimal segments; "
                        "allowed: at least "),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace contactspline::testing
