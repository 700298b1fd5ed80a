// SPDX-License-Identifier: MIT
// bowing [RATE [POINTS [QUALITY]]]: Schelleng's diagram of a violin's D string, bowed at 10 cm/s with rosin: 24
// forces for each of 7 places of the bow. POINTS: 1 of a rigid bow, or more across the hair of a bow. QUALITY: of the
// string's transverse modes, 300 unless told. Prints for each force what the string does, then the ends of the
// longest row of forces at which it moves as Helmholtz found, times the relative place over the speed (c_upper) and
// times its square over the speed (c_lower). Measured (E. Schoonderwaldt, K. Guettler and A. Askenfelt, Acta Acustica
// united with Acustica 94, 2008): c_upper 0.73 kg/s, c_lower 4.2 g/s.
//
//     -  does not stick and slip     m  several slips in a period     H  one     r  none that is regular
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/network/contact_network.hpp"

namespace contactspline::bench {
namespace {

constexpr double kFrequency_hz = 293.7, kImpedance_kg_per_s = 0.25, kSpeed_m_per_s = 0.1;
// Of torsion, at the surface of the string; assumed.
constexpr double kTorsionalImpedance = 2.5 * kImpedance_kg_per_s, kTorsionalFrequency_hz = 5.5 * kFrequency_hz,
                 kTorsionalQuality = 30;
constexpr std::size_t kModes = 60, kTorsionalModes = 20;
// Across all of the hair.
constexpr double kHairStiffness_n_per_m = 1.1e5, kHair_kg = 6.2e-3, kHairResistance_kg_per_s = 10;
constexpr double kHairWidth_m = 0.008, kLength_m = 0.325;

void add_modes(std::vector<Mode>& modes, std::size_t count, double frequency_hz, double impedance, double quality) {
  for (std::size_t n = 1; n <= count; ++n) {
    const double w = 2 * std::numbers::pi * frequency_hz * double(n);
    modes.push_back({w, w / (2 * quality), impedance / (4 * frequency_hz)});
  }
}

std::vector<double> shapes_at(double part) {
  std::vector<double> shapes;
  for (const std::size_t count : {kModes, kTorsionalModes})
    for (std::size_t n = 1; n <= count; ++n) shapes.push_back(std::sin(std::numbers::pi * double(n) * part));
  return shapes;
}

struct BowedString {
  BowedString(double part, std::size_t count, double quality, double rate)
      : network(plan_of(part, count, quality), rate) {}

  NetworkPlan<double> plan_of(double part, std::size_t count, double quality) {
    NetworkPlan<double> plan;
    std::vector<Mode> modes;
    add_modes(modes, kModes, kFrequency_hz, kImpedance_kg_per_s, quality);
    add_modes(modes, kTorsionalModes, kTorsionalFrequency_hz, kTorsionalImpedance, kTorsionalQuality);
    const std::size_t string = plan.add_body(modes);
    const double points_here = double(count);
    for (std::size_t p = 0; p < count; ++p) {
      const double offset = ((double(p) + 0.5) / points_here - 0.5) * kHairWidth_m / kLength_m;
      const std::size_t place = plan.add_place(string, shapes_at(part + (count > 1 ? offset : 0)));
      std::size_t hair = kGround;
      if (count > 1) {
        hair = plan.add_mass_place(plan.add_mass(kHair_kg / points_here));
        plan.add_spring(hair, kGround, kHairStiffness_n_per_m / points_here, kHairResistance_kg_per_s / points_here);
      }
      points.push_back(plan.add_friction(hair, place, kRosin, 0.01 / points_here));
    }
    return plan;
  }

  // Mean slip of all points in a sample [m].
  double tick(double force_n, double speed_m_per_s) {
    double slip = 0;
    for (const std::size_t point : points) {
      network.set_normal_force(point, force_n / double(points.size()));
      network.set_surface_speed(point, speed_m_per_s);
    }
    network.tick();
    for (const std::size_t point : points) slip += network.slip(point);
    return slip / double(points.size());
  }

  std::vector<std::size_t> points;
  ContactNetwork<double> network;
};

struct Motion {
  char name;
  double cents;
};

// What the string does in the last 0.4 s of one second. A slip counts that follows a stick and is faster than a fifth
// of Helmholtz'.
Motion motion_of(BowedString& bowed, double force_n, double part, double rate) {
  const auto samples = static_cast<int>(rate), from = static_cast<int>(0.6 * rate);
  const double carried = kSpeed_m_per_s / rate, period = rate / kFrequency_hz;
  std::vector<int> begins;
  bool has_stuck = false;
  for (int n = 0; n < samples; ++n) {
    const double slip = bowed.tick(force_n, std::min(kSpeed_m_per_s, 2.0 * n / rate));
    if (slip > 0.2 * carried / part && std::exchange(has_stuck, false) && n >= from) begins.push_back(n);
    has_stuck |= slip < 0.05 * carried;
  }
  if (begins.size() < 3) return {'-', 0};
  const double mean = double(begins.back() - begins.front()) / double(begins.size() - 1);
  double square = 0;
  for (std::size_t i = 1; i < begins.size(); ++i) square += std::pow(begins[i] - begins[i - 1] - mean, 2);
  const bool is_regular = std::sqrt(square / double(begins.size() - 1)) < 0.03 * mean + 1;
  if (mean < 0.8 * period) return {'m', 0};
  return {is_regular && mean < 1.2 * period ? 'H' : 'r', 1200 * std::log2(period / mean)};
}

// The longest row of H.
struct Row {
  std::size_t begin = 0, count = 0;
};

Row longest_row(const std::string& motions) {
  Row longest, row;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    row = motions[i] == 'H' ? Row{i - row.count, row.count + 1} : Row{};
    if (row.count > longest.count) longest = row;
  }
  return longest;
}

void print_diagram(double rate, std::size_t points, double quality) {
  constexpr int kForces = 24;
  constexpr double kLeast_n = 0.01, kMost_n = 4;
  const auto force_of = [](std::size_t i) {
    return kLeast_n * std::pow(kMost_n / kLeast_n, double(i) / (kForces - 1));
  };
  std::printf("%.0f Hz, %zu points, quality %g; %d forces from %g to %g N\n", rate, points, quality, kForces,
              kLeast_n, kMost_n);
  std::size_t bounded = 0;
  for (const double part : {0.05, 0.06, 0.08, 0.1, 0.12, 0.16, 0.2}) {
    std::string motions;
    std::vector<double> cents;
    for (std::size_t i = 0; i < kForces; ++i) {
      BowedString bowed(part, points, quality, rate);
      const Motion motion = motion_of(bowed, force_of(i), part, rate);
      motions += motion.name;
      cents.push_back(motion.cents);
      bounded += bowed.network.solver().bounded();
    }
    std::printf("%.2f  %s", part, motions.c_str());
    if (const Row row = longest_row(motions); row.count > 0) {
      const double least = force_of(row.begin), most = force_of(row.begin + row.count - 1);
      std::printf("  %.3f to %.3f N, c_upper %.2f kg/s, c_lower %.1f g/s, %.0f to %.0f cents", least, most,
                  most * part / kSpeed_m_per_s, 1000 * least * part * part / kSpeed_m_per_s, cents[row.begin],
                  cents[row.begin + row.count - 1]);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  std::printf("%zu samples by the bounding law\n", bounded);
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  contactspline::bench::print_diagram(argc > 1 ? std::atof(argv[1]) : 44100,
                                      argc > 2 ? static_cast<std::size_t>(std::atoi(argv[2])) : 1,
                                      argc > 3 ? std::atof(argv[3]) : 300);
}
