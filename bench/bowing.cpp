// SPDX-License-Identifier: MIT
// What strings do under a bow of rosin, beside what was measured, with one set of constants (bench/bowed_string.hpp):
//
// bowing limits [RATE [POINTS [rest]]]: Schelleng's diagram of a violin's D string: 24 forces for each of 11 places
// of the bow at four speeds. Then the ends of the longest row of forces that keep Helmholtz' motion going, to 3.5 %,
// times the place over the speed (c_upper) and times its square over the speed (c_lower): means and slopes over the
// places. `rest`: strokes begin at rest, not in this motion. bowing starts [RATE [POINTS]]: Guettler's diagram of a
// cello's D string, 20 forces by 20 accelerations: periods from the first slip to Helmholtz' motion. bowing rates:
// the limits of both at 44.1 kHz beside those at 705.6 kHz, and times of first slips. bowing cells: both diagrams,
// for docs/figures/bowing.gp.
//
// POINTS: 1 of a rigid bow, or more across the hair of a bow, 4 unless told.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/bowed_string.hpp"

namespace contactspline::bench {
namespace {

constexpr double kRate = 44100, kFineRate = 705600;

struct Setting {
  double rate = kRate;
  std::size_t points = 4;
  bool from_rest = false;
};

// --- Schelleng's diagram ---

constexpr std::size_t kForces = 24, kPlaces = 11;
constexpr double kLeast_n = 0.01, kMost_n = 6;
constexpr std::array kSpeeds_m_per_s = {0.05, 0.1, 0.15, 0.2};
// Means over the places of E. Schoonderwaldt, K. Guettler and A. Askenfelt (Acta Acustica united with Acustica 94,
// 2008) at these speeds.
constexpr std::array kMeasuredUpper_kg_per_s = {1.0, 0.73, 0.75, 0.75}, kMeasuredLower_g_per_s = {7.0, 4.2, 2.3, 1.8};

double geometric(double from, double to, std::size_t i, std::size_t count) {
  return from * std::pow(to / from, static_cast<double>(i) / static_cast<double>(count - 1));
}
double force_of(std::size_t i) {
  return geometric(kLeast_n, kMost_n, i, kForces);
}
double part_of(std::size_t i) {
  return geometric(0.03, 0.2, i, kPlaces);
}

BowedMotion motion_at(const Setting& setting, double part, double force_n, double speed_m_per_s) {
  BowedString<double> bowed(kViolinD, part, setting.points, setting.rate);
  return bowed_motion(bowed, force_n, speed_m_per_s, setting.from_rest);
}

// One place of the bow: what the string does at each force, and the limits of Helmholtz' motion.
struct Row {
  double part = 0;
  std::string motions;
  std::size_t begin = 0, count = 0;  // of the longest row of H
  double least_n = 0, most_n = 0, cents = 0;
};

// Between a force that keeps Helmholtz' motion and one that does not.
double limit_between(const Setting& setting, const Row& row, double speed_m_per_s, double keeps_n, double loses_n) {
  for (int i = 0; i < 3; ++i) {
    const double middle = std::sqrt(keeps_n * loses_n);
    (motion_at(setting, row.part, middle, speed_m_per_s).name == 'H' ? keeps_n : loses_n) = middle;
  }
  return keeps_n;
}

Row row_at(const Setting& setting, double part, double speed_m_per_s) {
  Row row;
  row.part = part;
  std::vector<double> cents;
  std::size_t count = 0;
  for (std::size_t i = 0; i < kForces; ++i) {
    const BowedMotion motion = motion_at(setting, part, force_of(i), speed_m_per_s);
    row.motions += motion.name;
    cents.push_back(motion.cents);
    count = motion.name == 'H' ? count + 1 : 0;
    if (count > row.count) row.count = count, row.begin = i + 1 - count;
  }
  if (row.count == 0) return row;
  const std::size_t first = row.begin, last = first + row.count - 1;
  row.cents = cents[last];
  row.least_n = force_of(first), row.most_n = force_of(last);
  if (first > 0) row.least_n = limit_between(setting, row, speed_m_per_s, row.least_n, force_of(first - 1));
  if (last + 1 < kForces) row.most_n = limit_between(setting, row, speed_m_per_s, row.most_n, force_of(last + 1));
  return row;
}

// Geometric mean of forces times places to a power, over the speed, and how the forces fall with the place.
struct Trend {
  double mean, slope;
};

Trend trend_of(const std::vector<Row>& rows, double Row::*force_n, double power, double speed_m_per_s) {
  double x = 0, y = 0, xx = 0, xy = 0, n = 0;
  for (const Row& row : rows) {
    if (row.count == 0) continue;
    const double at = std::log(row.part), force = std::log(row.*force_n);
    n += 1, x += at, y += force, xx += at * at, xy += at * force;
  }
  return {std::exp((y + power * x) / n) / speed_m_per_s, (n * xy - x * y) / (n * xx - x * x)};
}

std::vector<Row> print_rows(const Setting& setting, double speed_m_per_s) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const Row& row = rows.emplace_back(row_at(setting, part_of(i), speed_m_per_s));
    std::printf("%.3f  %s  %.3f to %.3f N, %.0f cents\n", row.part, row.motions.c_str(), row.least_n, row.most_n,
                row.cents);
    std::fflush(stdout);
  }
  return rows;
}

void print_limits(const Setting& setting) {
  std::printf("%.0f Hz, %zu points; %zu forces from %g to %g N\n", setting.rate, setting.points, kForces, kLeast_n,
              kMost_n);
  for (std::size_t i = 0; i < kSpeeds_m_per_s.size(); ++i) {
    const double speed = kSpeeds_m_per_s[i];
    std::printf("%g m/s\n", speed);
    const std::vector<Row> rows = print_rows(setting, speed);
    const Trend upper = trend_of(rows, &Row::most_n, 1, speed), lower = trend_of(rows, &Row::least_n, 2, speed);
    std::printf("c_upper %.2f kg/s (measured %.2f), slope %.2f; c_lower %.1f g/s (measured %.1f), slope %.2f\n",
                upper.mean, kMeasuredUpper_kg_per_s[i], upper.slope, 1000 * lower.mean, kMeasuredLower_g_per_s[i],
                lower.slope);
  }
}

// --- Guettler's diagram ---

constexpr std::size_t kSteps = 20;
constexpr double kStep = 0.15;  // N, and m/s^2
constexpr double kStartPart = 0.09;

using Starts = std::array<std::array<BowedStart, kSteps>, kSteps>;  // by acceleration, then force

BowedStart start_at(const Setting& setting, double force_n, double acceleration_m_per_s2) {
  BowedString<double> bowed(kCelloD, kStartPart, setting.points, setting.rate);
  return bowed_start(bowed, force_n, acceleration_m_per_s2);
}

double step(std::size_t i) {
  return kStep * static_cast<double>(i + 1);
}

Starts starts(const Setting& setting) {
  Starts found;
  for (std::size_t a = 0; a < kSteps; ++a)
    for (std::size_t f = 0; f < kSteps; ++f) found[a][f] = start_at(setting, step(f), step(a));
  return found;
}

std::size_t perfect(const Starts& found) {
  std::size_t count = 0;
  for (const auto& row : found)
    count += static_cast<std::size_t>(std::ranges::count_if(row, &BowedStart::is_perfect));
  return count;
}

// Perfect starts that touch each other's sides, from one on; takes them away.
std::size_t region_from(Starts& found, std::size_t a, std::size_t f) {
  if (a >= kSteps || f >= kSteps || !found[a][f].is_perfect()) return 0;
  found[a][f].periods = BowedStart::kNever;
  return 1 + region_from(found, a + 1, f) + region_from(found, a - 1, f) + region_from(found, a, f + 1) +
         region_from(found, a, f - 1);
}

std::size_t largest_region(Starts found) {
  std::size_t largest = 0;
  for (std::size_t a = 0; a < kSteps; ++a)
    for (std::size_t f = 0; f < kSteps; ++f) largest = std::max(largest, region_from(found, a, f));
  return largest;
}

void print_starts(const Setting& setting) {
  std::printf("%.0f Hz, %zu points; # perfect, 2 to 9 periods, + more, . never; forces from %g by %g N\n",
              setting.rate, setting.points, kStep, kStep);
  const Starts found = starts(setting);
  for (std::size_t a = kSteps; a-- > 0;) {
    std::printf("%.2f m/s^2  ", step(a));
    for (const BowedStart& start : found[a]) {
      const int periods = static_cast<int>(start.periods);
      const char digit = static_cast<char>('0' + std::min(periods, 9));
      std::putchar(start.is_perfect() ? '#' : periods >= int(BowedStart::kNever) ? '.' : periods < 10 ? digit : '+');
    }
    std::printf("\n");
  }
  std::printf("%zu perfect, %zu of them in one region\n", perfect(found), largest_region(found));
  for (const double force : {1.73, 0.84})
    std::printf("%g N, 1.56 m/s^2: %g periods (measured: %s)\n", force, start_at(setting, force, 1.56).periods,
                force > 1 ? "perfect" : "never");
}

// --- Rates ---

void print_limits_of_rates() {
  constexpr double kSpeed = 0.1;
  double worst_upper = 0, worst_lower = 0;
  std::array<std::vector<Row>, 2> rows;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    for (std::size_t r = 0; r < 2; ++r)
      rows[r].push_back(row_at({.rate = r ? kFineRate : kRate}, part_of(i), kSpeed));
    const Row &coarse = rows[0].back(), &fine = rows[1].back();
    const double lower = coarse.least_n / fine.least_n, upper = coarse.most_n / fine.most_n;
    worst_lower = std::max(worst_lower, std::abs(std::log(lower)));
    worst_upper = std::max(worst_upper, std::abs(std::log(upper)));
    std::printf("%.3f  %.3f to %.3f N, %.3f to %.3f N, ratios %.2f, %.2f\n", coarse.part, coarse.least_n,
                coarse.most_n, fine.least_n, fine.most_n, lower, upper);
    std::fflush(stdout);
  }
  for (const auto& of_rate : rows)
    std::printf("c_lower %.2f g/s, c_upper %.3f kg/s\n", 1000 * trend_of(of_rate, &Row::least_n, 2, kSpeed).mean,
                trend_of(of_rate, &Row::most_n, 1, kSpeed).mean);
  std::printf("limits within factors of %.2f below, %.2f above\n", std::exp(worst_lower), std::exp(worst_upper));
}

// The least or the greatest force that starts perfectly at an acceleration; 0 if none does.
double limit_of(const std::array<BowedStart, kSteps>& row, bool is_greatest) {
  double limit = 0;
  for (std::size_t f = 0; f < kSteps; ++f)
    if (row[f].is_perfect() && (is_greatest || limit == 0)) limit = step(f);
  return limit;
}

void print_starts_of_rates() {
  const Starts coarse = starts({}), fine = starts({.rate = kFineRate});
  double least = 0, greatest = 0, rows = 0;
  std::vector<double> errors;
  std::size_t agree = 0;
  for (std::size_t a = 0; a < kSteps; ++a) {
    if (limit_of(coarse[a], false) > 0 && limit_of(fine[a], false) > 0) {
      rows += 1;
      least += std::log(limit_of(coarse[a], false) / limit_of(fine[a], false));
      greatest += std::log(limit_of(coarse[a], true) / limit_of(fine[a], true));
    }
    for (std::size_t f = 0; f < kSteps; ++f) {
      errors.push_back(std::abs(coarse[a][f].first_slip_s / fine[a][f].first_slip_s - 1));
      agree += coarse[a][f].is_perfect() == fine[a][f].is_perfect();
    }
  }
  std::ranges::sort(errors);
  std::printf(
      "perfect starts: %zu, %zu; %zu of 400 agree; over %.0f accelerations, mean ratios of the least force "
      "%.2f, of the greatest %.2f\n",
      perfect(coarse), perfect(fine), agree, rows, std::exp(least / rows), std::exp(greatest / rows));
  std::printf("first slips: %.2g of the time in the median, at most %.2g\n", errors[errors.size() / 2],
              errors.back());
}

// --- Figure ---

void print_cells() {
  const std::string names = "-mHr";
  for (std::size_t i = 0; i < kPlaces; ++i)
    for (std::size_t f = 0; f < kForces; ++f) {
      const char name = motion_at({}, part_of(i), force_of(f), 0.1).name;
      std::printf("%g %g %zu\n", part_of(i), force_of(f), names.find(name));
    }
  std::printf("\n\n");
  const Starts found = starts({});
  for (std::size_t a = 0; a < kSteps; ++a)
    for (std::size_t f = 0; f < kSteps; ++f) std::printf("%g %g %g\n", step(a), step(f), found[a][f].periods);
}

int run(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "limits";
  const Setting setting{argc > 2 ? std::atof(argv[2]) : kRate,
                        argc > 3 ? static_cast<std::size_t>(std::atoi(argv[3])) : 4,
                        argc > 4 && std::string(argv[4]) == "rest"};
  if (!(setting.rate >= 8000 && setting.rate <= 1e6) || setting.points < 1 || setting.points > 8)
    return std::fprintf(stderr, "bowing: %s Hz, %s points; allowed: 8000 to 1e6, 1 to 8, such as 44100 4\n", argv[2],
                        argc > 3 ? argv[3] : "4"),
           2;
  if (what == "limits")
    print_limits(setting);
  else if (what == "starts")
    print_starts(setting);
  else if (what == "rates")
    print_limits_of_rates(), print_starts_of_rates();
  else if (what == "cells")
    print_cells();
  else
    return std::fprintf(stderr, "bowing: %s; allowed: limits, starts, rates, cells\n", what.c_str()), 2;
  return 0;
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  return contactspline::bench::run(argc, argv);
}
