// SPDX-License-Identifier: MIT
// Tables and random contact steps that reach every corner of the contact step.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "generator/spline/contact_spline.hpp"
#include "runtime/exact_contact.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

inline constexpr std::array<int, 10> kSegmentCounts = {1, 2, 3, 7, 8, 16, 31, 64, 200, 1024};
inline constexpr std::array<double, 5> kExponents = {1.0, 1.5, 2.3, 3.155, 5.0};

/// Power law that takes a force at the end of its range, on uniform knots.
inline std::vector<Segment<double>> power_law_table(double exponent, int segments, double range_m, double force_n) {
  const double stiffness = force_n / std::pow(range_m, exponent);
  return segment_table(uniform_spline({"test", "", {stiffness, exponent}, {}, {segments, range_m}}, "test"));
}

/// The same on knots in ratio 2^(1/4), force interpolated: any knots are allowed (design 2.1).
inline std::vector<Segment<double>> graded_table(double exponent, int segments, double range_m, double force_n) {
  std::vector<Segment<double>> table(1);
  for (int j = 0; j <= segments; ++j) {
    const double y = j == 0 ? 0 : std::exp2((j - segments) / 4.0);
    table.push_back({range_m * y, 0, force_n * std::pow(y, exponent), 0});
  }
  for (std::size_t j = 1; j + 1 < table.size(); ++j) {
    const double width = table[j + 1].knot - table[j].knot;
    table[j].half_curvature = (table[j + 1].force - table[j].force) / (2 * width);
    table[j + 1].energy = table[j].energy + width * (table[j].force + table[j + 1].force) / 2;
  }
  table.pop_back();
  return table;
}

template <typename T>
std::vector<Segment<T>> in_precision(const std::vector<Segment<double>>& table) {
  std::vector<Segment<T>> rounded;
  for (const auto& s : table)
    rounded.push_back({static_cast<T>(s.knot), static_cast<T>(s.energy), static_cast<T>(s.force),
                       static_cast<T>(s.half_curvature)});
  return rounded;
}

/// A table and the range it is made for.
template <typename T>
struct TestTable {
  std::vector<Segment<T>> segments;
  double exponent, range_m, force_n;
};

/// Every exponent with every number of segments, ranges over five decades and forces over six; two tables on graded
/// knots; one whose entries are powers of two times small integers, so that a knot can be hit exactly.
template <typename T>
std::vector<TestTable<T>> test_tables() {
  std::vector<TestTable<T>> tables;
  const auto add = [&](const auto& maker, double exponent, int segments, double range, double force) {
    tables.push_back({in_precision<T>(maker(exponent, segments, range, force)), exponent, range, force});
  };
  Random random(1);
  for (const double exponent : kExponents)
    for (const int segments : kSegmentCounts) {
      const double range = random.decades(-6, -1), force = random.decades(-1, 5);
      add(power_law_table, exponent, segments, range, force);
    }
  add(graded_table, 1.5, 48, 1e-3, 50.0);
  add(graded_table, 2.5, 16, 1e-4, 2000.0);
  add(power_law_table, 1.0, 8, 0x1p-10, 0x1p+6);
  return tables;
}

template <typename T>
struct RandomStep {
  std::uint32_t table;
  T compression, free_increment, receptance;
  std::optional<Wide> increment;  ///< the root but for the rounding of xf, where the step was built from it
};

/// Tables up to this size are hit with every pair of start and end segment, larger ones with every start and
/// every end segment.
inline constexpr std::size_t kPairedSegments = 200;

/// A sequence of steps, the same on every machine. Lengths run over twelve decades of either sign beside the range of
/// the table, receptances over twelve decades about range / force: from soft (xi V'' = 1e-6) to stiff (1e6).
template <typename T>
class RandomSteps {
 public:
  enum class Pairs { kFirst, kNone };

  explicit RandomSteps(const std::vector<TestTable<T>>& tables, Pairs pairs = Pairs::kFirst)
      : tables_(tables), paired_(pairs == Pairs::kFirst ? 0 : tables.size()) {
    for (const auto& table : tables) contacts_.emplace_back(table.segments);
  }

  /// First every pair of start and end segment of the tables up to kPairedSegments, then all kinds by turns.
  RandomStep<T> next() {
    if (paired_ < tables_.size()) return next_pair();
    const std::size_t table = random_.below(tables_.size());
    const std::size_t last = contacts_[table].last();
    switch (kind_++ % 12) {
      case 0:
        return between(table, anywhere(table), anywhere(table));
      case 1:
        return between(table, knot(table), anywhere(table));
      case 2:
        return between(table, anywhere(table), knot(table));
      case 3:
        return between(table, knot(table), knot(table));
      case 4:
        return between(table, near_knot(table), near_knot(table));
      case 5:
        return between(table, within(table, last), within(table, last));
      case 6:
        return between(table, within(table, 0), anywhere(table));
      case 7:
        return short_step(table, anywhere(table));
      case 8:
        return short_step(table, near_knot(table));
      case 9:
        return apart(table);
      default:
        return free(table);
    }
  }

  /// y0, xf and xi scaled towards the smallest numbers of T.
  RandomStep<T> next_extreme() {
    RandomStep<T> step = next();
    constexpr std::size_t kDepth = 10 - std::numeric_limits<T>::min_exponent;
    const auto scaled = [&](T value) { return std::ldexp(value, -static_cast<int>(random_.below(kDepth))); };
    if (random_.below(2) == 0) step.compression = scaled(step.compression);
    if (random_.below(4) != 0) step.free_increment = scaled(step.free_increment);
    if (random_.below(4) == 0) step.receptance = std::max(scaled(step.receptance), std::numeric_limits<T>::min());
    return step;
  }

  /// A compression well within a segment; where that has one end only, 10^nearest to 10^farthest ranges or segments
  /// away.
  T within(std::size_t table, std::size_t segment, double nearest = -9, double farthest = 3) {
    const auto& segments = tables_[table].segments;
    const double range = tables_[table].range_m;
    if (segment == 0) return static_cast<T>(-range * random_.decades(nearest, farthest));
    const double left = static_cast<double>(segments[segment].knot);
    if (segment + 1 == segments.size())
      return static_cast<T>(left + range / static_cast<double>(segment) *
                                       random_.decades(std::max(nearest, -3.0), farthest));
    return static_cast<T>(left +
                          (static_cast<double>(segments[segment + 1].knot) - left) * random_.between(0.1, 0.9));
  }

  /// The step from y0 to y1 with any receptance: xf = x + xi (mean force), rounded.
  RandomStep<T> between(std::size_t table, T y0, T y1) { return towards(table, y0, Wide(y1) - Wide(y0)); }

 private:
  RandomStep<T> next_pair() {
    const std::size_t table = paired_, entries = tables_[table].segments.size();
    const bool all = contacts_[table].last() <= kPairedSegments;
    const std::size_t start = all ? pair_ / entries : pair_;
    const std::size_t end_segment = all ? pair_ % entries : pair_ * 383 % entries;  // 383 is prime: every one once
    if (++pair_ == (all ? entries * entries : entries)) ++paired_, pair_ = 0;
    return between(table, within(table, start, -2, 0), within(table, end_segment, -2, 0));
  }

  T receptance(std::size_t table) {
    return static_cast<T>(random_.decades(-6, 6) * tables_[table].range_m / tables_[table].force_n);
  }
  T length(std::size_t table) { return static_cast<T>(tables_[table].range_m * random_.decades(-9, 3)); }
  T anywhere(std::size_t table) { return within(table, random_.below(tables_[table].segments.size())); }
  T knot(std::size_t table) {
    const auto& segments = tables_[table].segments;
    return segments[1 + random_.below(segments.size() - 1)].knot;
  }
  // From one unit in the last place to an eighth beside a knot; beside the first, down to 1e-9 of the range.
  T near_knot(std::size_t table) {
    const T at = knot(table);
    if (at == 0) return static_cast<T>(random_.sign() * tables_[table].range_m * random_.decades(-9, 0));
    constexpr std::size_t kDigits = std::numeric_limits<T>::digits;
    const double away = std::ldexp(1.0, -3 - static_cast<int>(random_.below(kDigits - 3)));
    return static_cast<T>(static_cast<double>(at) * (1 + random_.sign() * away));
  }

  RandomStep<T> towards(std::size_t table, T y0, Wide x) {
    const T xi = receptance(table);
    const ExactApproach approach(contacts_[table], y0, 0, xi);
    const Wide xf = x + Wide(xi) * approach.mean_force(x);
    return {static_cast<std::uint32_t>(table), y0, static_cast<T>(xf), xi, x};
  }
  // As long as y0 or shorter, by up to twelve decades.
  RandomStep<T> short_step(std::size_t table, T y0) {
    const double scale = y0 == 0 ? tables_[table].range_m : static_cast<double>(y0);
    return towards(table, y0, Wide(random_.sign() * scale * random_.decades(-12, 0)));
  }
  // Both ends out of contact, a quarter of them just touching.
  RandomStep<T> apart(std::size_t table) {
    const T y0 = random_.below(16) == 0 ? T(0) : -length(table);
    const double fraction = random_.below(4) == 0 ? 1.0 : random_.between(-2.0, 1.0);
    const T xf = y0 == 0 ? -length(table) : static_cast<T>(-fraction * static_cast<double>(y0));
    return {static_cast<std::uint32_t>(table), y0, xf, receptance(table), {}};
  }
  RandomStep<T> free(std::size_t table) {
    const T y0 = static_cast<T>(random_.sign()) * length(table);
    const T xf = static_cast<T>(random_.sign()) * length(table);
    return {static_cast<std::uint32_t>(table), y0, xf, receptance(table), {}};
  }

  const std::vector<TestTable<T>>& tables_;
  std::vector<ExactContact> contacts_;
  Random random_{2};
  std::size_t paired_, pair_ = 0, kind_ = 0;
};

}  // namespace contactspline::testing
