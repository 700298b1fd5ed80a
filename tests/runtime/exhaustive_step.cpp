// SPDX-License-Identifier: MIT
// The contact step in single precision on every free increment there is, beside the step in double precision.
//
//   exhaustive_step triples [EVERY [FIRST]]  five triples of table, compression and receptance, each of all 2^32
//                                            increments
//   exhaustive_step grid [EVERY]             12 tables by 8 compressions and 4 receptances, each of every 1,009th
//                                            increment
//   exhaustive_step planted                  one wrong answer in each of them, of which one must be found
//
// EVERY: in place of 1 and 1009. FIRST: the triple to begin with, from 1 to 5. Exit 0 where every step is right, and
// of `planted` where the wrong answer was found; else 1.
//
// The bounds. Both steps take the same table, rounded to single precision. By step_reference.cpp each is the exact
// step of the C1 potential of that table for a free increment moved by u |x|, with forces changed by a fraction
//   40 u + slope_error + energy_error (E_k + E_l)/|W|,
// the last term where more than one knot is passed; the increment moves by 12 u (|x| + |xf|) and that fraction of
// xi f. u is 2^-24 for one and 2^-53, which is nothing beside it, for the other, so the two differ by these with the
// errors of the table taken twice. A free increment moved by D moves the force by D times 1/xi at most, and times the
// steepest slope of a mean force.
//
// Below the normal numbers of single precision, products lose up to 2^-150 each, eight of them 2^-147. The constant
// of the quadratic A s^2 + B s + g moves its root by sqrt(2^-147/A) at most, which is less than 2^-73 m, for A >= 1;
// that of xi A f^2 - b f + q moves the force by sqrt(2^-147/xi) at most. Sums add a few of the smallest numbers.
//
// Energy: f x is the work of the contact, as in contact_step_test.cpp: up to twice (fraction |W| + |F(y1) - f| e),
// where e is the uncertainty of x. So no step is active beyond rounding. Monotone: the exact force never falls as xf
// rises, so a rounded one falls by no more than the two bounds. Free increments beyond 1e15 m, whose squares leave
// single precision, and those that are no numbers are counted, and not judged.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "contactspline/materials/felt_c2.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/felt_c7.hpp"
#include "contactspline/materials/felt_over_wood.hpp"
#include "contactspline/materials/felt_stulov_c4.hpp"
#include "contactspline/materials/felt_synthetic.hpp"
#include "contactspline/materials/rubber_on_wood.hpp"
#include "contactspline/materials/steel_ball_on_plate.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "runtime/exact_contact.hpp"
#include "runtime/random_steps.hpp"
#include "runtime/step_cases.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {
namespace {

constexpr double kU = kRoundoff<float>;
constexpr double kSmallest = 16 * 0x1p-149, kLost = 0x1p-147, kLost_m = 0x1p-73;
constexpr double kLargest_m = 1e15;
constexpr std::uint64_t kPatterns = std::uint64_t{1} << 32;

/// A table in both precisions, and how far it is from a C1 potential.
struct Table {
  Table(std::string called, std::vector<Segment<float>> rounded)
      : name(std::move(called)), single(std::move(rounded)) {
    for (const Segment<float>& s : single) {
      wide.push_back({s.knot, s.energy, s.force, s.half_curvature});
      steepest = std::max(steepest, double{s.half_curvature});
    }
    const ExactContact exact(single);
    slope_error = static_cast<double>(exact.slope_error());
    energy_error = static_cast<double>(exact.energy_error());
  }

  std::string name;
  std::vector<Segment<float>> single;
  std::vector<Segment<double>> wide;
  double slope_error, energy_error, steepest = 0;
};

struct Triple {
  const Table* table;
  float compression, receptance;
};

/// The worst that was found, in parts of the bounds.
struct Worst {
  std::uint64_t steps = 0, not_judged = 0, failures = 0;
  double force = 0, compression = 0, energy = 0, fall = 0;

  void add(const Worst& other) {
    steps += other.steps, not_judged += other.not_judged, failures += other.failures;
    force = std::max(force, other.force), compression = std::max(compression, other.compression);
    energy = std::max(energy, other.energy), fall = std::max(fall, other.fall);
  }
};

/// The single numbers by rising value: not-a-numbers at both ends.
float number_of(std::uint32_t rank) {
  return std::bit_cast<float>(rank & 0x80000000u ? rank ^ 0x80000000u : ~rank);
}

/// Judges the steps of one triple by rising free increments.
class Judge {
 public:
  Judge(const Triple& triple, bool plants)
      : table_(*triple.table),
        y0_(triple.compression),
        xi_(triple.receptance),
        start_(segment_index(SegmentTable<float>(table_.single), y0_)),
        lost_n_(std::sqrt(kLost / double{xi_}) + kSmallest),
        plants_(plants) {}

  void judge(float xf) {
    ++worst_.steps;
    if (!is_finite(xf) || std::abs(xf) > kLargest_m) return void(++worst_.not_judged);
    auto step = contact_step(SegmentTable<float>(table_.single), Approach<float>{y0_, xf, xi_}, start_);
    if (plants_ && xf > 1e-4f) step.force *= 1.001f, plants_ = false;
    const auto wide = contact_step(SegmentTable<double>(table_.wide), Approach<double>{y0_, xf, xi_}, start_);
    const double x = double{xf} - double{xi_} * wide.force, fraction = fraction_of(x, wide);
    const double moved = kU * std::abs(x) + kLost_m;
    const double force_bound = fraction * wide.force + std::min(1 / double{xi_}, table_.steepest) * moved + lost_n_;
    const double end_bound = kLost_m + 12 * kU * (std::abs(x) + std::abs(double{xf})) +
                             fraction * double{xi_} * wide.force + 2 * kU * std::abs(wide.compression) + kSmallest;
    require(is_finite(step.force) && is_finite(step.compression), "not finite", xf, step, wide);
    require(step.force >= 0, "negative", xf, step, wide);
    if (y0_ <= 0 && double{y0_} + double{xf} <= 0) require(step.force == 0, "pushes while apart", xf, step, wide);
    within(step.force - wide.force, force_bound, worst_.force, "force", xf, step, wide);
    within(step.compression - wide.compression, end_bound, worst_.compression, "compression", xf, step, wide);
    judge_energy(xf, step, wide, fraction, moved);
    judge_fall(xf, step, wide, force_bound);
  }

  [[nodiscard]] const Worst& worst() const { return worst_; }

 private:
  using Single = ContactStep<float>;
  using Double = ContactStep<double>;

  // What forces may be changed by.
  [[nodiscard]] double fraction_of(double x, const Double& wide) const {
    const std::size_t end =
        contactspline::detail::relocate_segment(table_.wide, wide.segment, double{y0_} + x * (1 + 0x1p-10));
    const auto [low, high] = std::minmax(start_, end);
    const double fraction = 40 * kU + 2 * table_.slope_error;
    if (high <= low + 1) return fraction;
    return fraction + 2 * (table_.energy_error + kU) * (table_.wide[high].energy + table_.wide[low + 1].energy) /
                          (wide.force * std::abs(x));
  }

  // V(y0 + x) - V(y0), as an area up to the first knot and a difference of energies beyond.
  [[nodiscard]] double work(double x) const {
    const auto& table = table_.wide;
    const double y0 = y0_, force = table[start_].force_at(y0);
    const std::size_t end = contactspline::detail::relocate_segment(table, start_, y0 + x);
    if (end == start_) return x * (force + table[end].half_curvature * x);
    const std::size_t first = end > start_ ? start_ + 1 : start_, entry = end > start_ ? end : end + 1;
    const double beyond = x - (table[entry].knot - y0);
    return (table[first].knot - y0) * (force + table[first].force) / 2 + (table[entry].energy - table[first].energy) +
           beyond * (table[entry].force + table[end].half_curvature * beyond);
  }

  void judge_energy(float xf, const Single& step, const Double& wide, double fraction, double moved) {
    const double x = double{xf} - double{xi_} * double{step.force}, gained = work(x);
    const double e = moved + fraction * double{xi_} * wide.force;
    const double beyond = std::abs(force(SegmentTable<double>(table_.wide), double{y0_} + x) - wide.force);
    const double bound =
        2 * (fraction * std::abs(gained) + (beyond + 2 * table_.steepest * e) * e) + kSmallest * (1 + std::abs(x));
    within(double{step.force} * x - gained, bound, worst_.energy, "energy", xf, step, wide);
  }

  void judge_fall(float xf, const Single& step, const Double& wide, double bound) {
    if (step.force >= highest_) {
      highest_ = step.force;
      bound_of_highest_ = bound;
      return;
    }
    const double fall = double{highest_} - double{step.force};
    within(fall, bound + bound_of_highest_, worst_.fall, "falls", xf, step, wide);
  }

  void within(double error, double bound, double& worst, const char* what, float xf, const Single& step,
              const Double& wide) {
    if (error == 0) return;
    worst = std::max(worst, std::abs(error) / bound);
    require(std::abs(error) <= bound, what, xf, step, wide);
  }

  void require(bool is_right, const char* what, float xf, const Single& step, const Double& wide) {
    if (is_right || ++worst_.failures > 3) return;
    std::printf("FAILED: %s: %s, y0 %.9g, xi %.9g, xf %.9g: f %.9g beside %.17g, y1 %.9g beside %.17g\n",
                table_.name.c_str(), what, double{y0_}, double{xi_}, double{xf}, double{step.force}, wide.force,
                double{step.compression}, wide.compression);
  }

  const Table& table_;
  float y0_, xi_;
  std::size_t start_;
  double lost_n_;
  bool plants_;
  Worst worst_;
  float highest_ = 0;
  double bound_of_highest_ = 0;
};

/// Every so-manyth free increment of a triple, on all processors. Each thread begins with the last increment of the
/// one before it, so that no fall lies between them.
Worst judged(const Triple& triple, std::uint64_t every, bool plants) {
  const std::uint64_t count = (kPatterns + every - 1) / every;
  const std::uint64_t threads = std::max(1u, std::thread::hardware_concurrency());
  std::mutex mutex;
  Worst worst;
  std::vector<std::thread> pool;
  for (std::uint64_t t = 0; t < threads; ++t)
    pool.emplace_back([&, t] {
      Judge judge(triple, plants);
      const std::uint64_t begin = t * count / threads, end = (t + 1) * count / threads;
      for (std::uint64_t i = begin - (begin > 0); i < end; ++i)
        judge.judge(number_of(static_cast<std::uint32_t>(i * every)));
      const std::lock_guard lock(mutex);
      worst.add(judge.worst());
    });
  for (std::thread& thread : pool) thread.join();
  return worst;
}

template <typename Material>
Table shipped(const char* name) {
  const auto& table = segments_of<Material, float>;
  return {name, {table.begin(), table.end()}};
}

/// Materials that ship, one straight segment, the steepest table, and one whose knots grow.
std::vector<Table> all_tables() {
  const auto random = test_tables<float>();
  return {shipped<materials::felt_c2>("felt_c2"),
          shipped<materials::felt_c4>("felt_c4"),
          shipped<materials::felt_c7>("felt_c7"),
          shipped<materials::felt_over_wood>("felt_over_wood"),
          shipped<materials::felt_stulov_c4>("felt_stulov_c4"),
          shipped<materials::felt_synthetic>("felt_synthetic"),
          shipped<materials::rubber_on_wood>("rubber_on_wood"),
          shipped<materials::steel_ball_on_plate>("steel_ball_on_plate"),
          shipped<materials::steel_on_steel>("steel_on_steel"),
          {"one segment", random[0].segments},
          {"exponent 5, 1024 segments", random[49].segments},
          {"graded knots", random[50].segments}};
}

// Apart and pressed under a hammer of 3 g, a bar of 40 g and a mallet of 10 g at 44.1 kHz, and from a knot.
std::vector<Triple> five_triples(const std::vector<Table>& tables) {
  const Segment<float>& middle = tables[10].single[512];
  return {{&tables[1], -1e-4f, 8.6e-8f},
          {&tables[1], 5e-4f, 8.6e-8f},
          {&tables[8], 1e-6f, 6.4e-9f},
          {&tables[6], 0, 2.6e-8f},
          {&tables[10], middle.knot, 1 / middle.half_curvature}};
}

// Apart, at the surface, within the first segments, beside knots and beyond the last; from heavy bodies to light
// ones.
std::vector<Triple> grid(const std::vector<Table>& tables) {
  std::vector<Triple> triples;
  for (const Table& table : tables) {
    const std::size_t last = table.single.size() - 1, middle = (last + 1) / 2;
    const float range = last > 1 ? table.single[last].knot : 1e-3f, knot = table.single[middle].knot;
    const float stiffest = static_cast<float>(table.steepest);
    for (const float compression :
         {-range, -1e-3f * range, 0.0f, 1e-3f * range, knot, std::nextafter(knot, -1.0f), 0.7f * range, 3 * range})
      for (const float stiffness : {1e-3f, 0.1f, 1.0f, 100.0f})
        triples.push_back({&table, compression, stiffness / stiffest});
  }
  return triples;
}

bool report(const std::string& name, const Worst& w) {
  std::printf(
      "%-28s %11llu steps, %9llu not judged; of the bounds: force %.3f, compression %.3f, energy %.3f, "
      "fall %.3f; %llu wrong\n",
      name.c_str(), static_cast<unsigned long long>(w.steps), static_cast<unsigned long long>(w.not_judged), w.force,
      w.compression, w.energy, w.fall, static_cast<unsigned long long>(w.failures));
  std::fflush(stdout);
  return w.failures == 0 && w.steps > w.not_judged;
}

int run(const std::string& what, std::uint64_t every, std::size_t first) {
  const std::vector<Table> tables = all_tables();
  bool is_right = true;
  if (what == "grid") {
    Worst worst;
    for (const Triple& triple : grid(tables)) worst.add(judged(triple, every, false));
    return report("grid", worst) ? 0 : 1;
  }
  const std::vector<Triple> five = five_triples(tables);
  for (const Triple& triple : std::span(five).subspan(first - 1))
    is_right &= report(triple.table->name, judged(triple, every, what == "planted"));
  return is_right == (what == "planted") ? 1 : 0;
}

}  // namespace
}  // namespace contactspline::testing

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const std::size_t first = argc > 3 ? std::stoull(argv[3]) : 1;
  if (argc > 4 || first < 1 || first > 5 || (what != "triples" && what != "grid" && what != "planted")) {
    std::puts("usage: exhaustive_step triples|grid|planted [EVERY [FIRST]]");
    return 2;
  }
  const std::uint64_t every = what == "triples" ? 1 : what == "grid" ? 1009 : 1000003;
  return contactspline::testing::run(what, argc > 2 ? std::stoull(argv[2]) : every, first);
}
