// SPDX-License-Identifier: MIT
// Runs the contact step over the cases of step_reference and judges every answer by its bounds. Built with every
// compiler and optimisation the step must survive, -Ofast among them: nothing here relies on comparisons with NaN.
//
//   step_checker double|float CASES PLANT FILE...
//
// PLANT is `none`, or an error to plant into one answer, which must be found: `nan`, `infinite`, `wrong` (beyond its
// bound by the width of the bound), `negative`, `missing`. Exit 0 where all of exactly CASES steps are right, 1 where
// not, 2 for data or words missing.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "runtime/step_cases.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {
namespace {

/// As in random_steps.hpp, which needs the generator.
constexpr std::size_t kPairedSegments = 200;
/// 1e-12 in double, as many roundings in single precision.
template <typename T>
constexpr double kWellConditioned = 1e-12 / kRoundoff<double>* kRoundoff<T>;
/// The part of all steps that must be: in double precision all.
template <typename T>
constexpr double kMinWellConditionedPart = sizeof(T) == sizeof(double) ? 1 : 0.999;

template <typename T>
class Checker {
 public:
  explicit Checker(std::string plant) : plant_(std::move(plant)) {}

  void run(StepCases<T> set) {
    if (plant_ == "missing") set.cases.pop_back();
    hits_.resize(set.tables.size());
    planted_ = plant_ == "none" ? set.cases.size() : set.cases.size() / 2;
    for (std::size_t i = 0; i < set.cases.size(); ++i) check(set.tables, set.cases[i], i);
    for (const auto& extreme : set.extremes) check(set.tables, extreme);
    for (std::size_t table = 0; table < set.tables.size(); ++table) sizes_.push_back(set.tables[table].size());
  }

  /// Prints the figures; whether all is well.
  bool report(const char* precision, std::size_t expected) {
    std::printf(
        "%s: %zu steps, force within %.2f of its bound, increment %.2f; %.4f %% well conditioned, increment "
        "within %.2g of max(|x|, |xf|); %zu steps down to the smallest numbers\n",
        precision, steps_, worst_force_, worst_increment_,
        100 * static_cast<double>(well_) / static_cast<double>(steps_), worst_relative_, extremes_);
    if (steps_ != expected || extremes_ == 0) fail("missing data: %zu steps instead of %zu", steps_, expected);
    if (!(static_cast<double>(well_) >= kMinWellConditionedPart<T> * static_cast<double>(steps_)))
      fail("only %zu of %zu steps well conditioned", well_, steps_);
    for (std::size_t table = 0; table < hits_.size(); ++table) require_hits(table);
    return failures_ == 0;
  }

 private:
  using Tables = std::vector<std::vector<Segment<T>>>;

  static double wide(T value) { return static_cast<double>(value); }

  template <typename... Arguments>
  void fail(const char* format, Arguments... arguments) {
    if (++failures_ > 10) return;
    std::printf("FAILED: ");
    std::printf(format, arguments...);
    std::printf("\n");
  }

  void fail(const char* what, const StepCase<T>& c, T force, T compression) {
    fail("%s: table %u, y0 %.17g, xf %.17g, xi %.17g: f %.17g instead of %.17g (%.17g to %.17g), y1 %.17g, x %.17g",
         what, c.table, wide(c.compression), wide(c.free_increment), wide(c.receptance), wide(force), c.force,
         c.min_force, c.max_force, wide(compression), c.increment);
  }

  T planted(T force, const StepCase<T>& c) const {
    if (plant_ == "nan") return std::numeric_limits<T>::quiet_NaN();
    if (plant_ == "infinite") return std::numeric_limits<T>::infinity();
    if (plant_ == "wrong") return static_cast<T>(2 * c.max_force - c.min_force);
    if (plant_ == "negative") return -force;
    return force;
  }

  void check(const Tables& tables, const StepCase<T>& c, std::size_t index) {
    ++steps_;
    const SegmentTable<T> table(tables[c.table]);
    const auto step = contact_step(table, Approach<T>{c.compression, c.free_increment, c.receptance});
    T force = step.force;
    if (index >= planted_ && c.force > 0) {
      force = planted(force, c);
      planted_ = static_cast<std::size_t>(-1);
    }
    note_hit(tables[c.table], c);

    const bool reference_is_finite = is_finite(c.increment) && is_finite(c.increment_error) && is_finite(c.force) &&
                                     is_finite(c.min_force) && is_finite(c.max_force);
    if (!reference_is_finite) return fail("reference not finite", c, force, step.compression);
    if (!is_finite(force) || !is_finite(step.compression)) return fail("not finite", c, force, step.compression);
    if (force < 0) return fail("negative", c, force, step.compression);
    const bool apart = c.compression <= 0 && c.compression + c.free_increment <= 0;
    if ((force == 0) != apart) return fail("not 0 exactly when apart", c, force, step.compression);
    judge(c, force, step.compression);
  }

  // The increment is judged both as callers compute it from the force and as the step gives it.
  void judge(const StepCase<T>& c, T force, T compression) {
    const double f = wide(force), xf = wide(c.free_increment), xi = wide(c.receptance);
    const T x = c.free_increment - c.receptance * force;
    const double error = std::abs(wide(x) - c.increment);
    const double allowed = c.increment_error + 2 * kRoundoff<T> * (std::abs(c.increment) + xi * c.force);
    const double y1 = wide(c.compression) + c.increment;
    const double end_error = std::abs(wide(compression) - y1);
    const double end_allowed = c.increment_error + 2 * kRoundoff<T> * std::abs(y1) +
                               2 * kRoundoff<double> * (std::abs(wide(c.compression)) + std::abs(c.increment));
    if (!(f >= c.min_force && f <= c.max_force)) fail("force beyond its bound", c, force, compression);
    if (!(error <= allowed)) fail("increment beyond its bound", c, force, compression);
    if (!(end_error <= end_allowed)) fail("compression beyond its bound", c, force, compression);

    const double allowed_force = f > c.force ? c.max_force - c.force : c.force - c.min_force;
    if (f != c.force) worst_force_ = std::max(worst_force_, std::abs(f - c.force) / allowed_force);
    if (allowed > 0) worst_increment_ = std::max(worst_increment_, error / allowed);
    if (end_allowed > 0) worst_increment_ = std::max(worst_increment_, end_error / end_allowed);
    const double scale = std::max(std::abs(c.increment), std::abs(xf));
    if (!(allowed <= kWellConditioned<T> * scale)) return;
    ++well_;
    if (scale > 0) worst_relative_ = std::max(worst_relative_, error / scale);
    if (!(error <= kWellConditioned<T> * scale)) fail("increment off by more than 1e-12", c, force, compression);
  }

  void check(const Tables& tables, const ExtremeStep<T>& e) {
    ++extremes_;
    const SegmentTable<T> table(tables[e.table]);
    const auto step = contact_step(table, Approach<T>{e.compression, e.free_increment, e.receptance});
    if (is_finite(step.force) && is_finite(step.compression) && step.force >= 0) return;
    fail("not finite or negative: table %u, y0 %a, xf %a, xi %a: f %a, y1 %a", e.table, wide(e.compression),
         wide(e.free_increment), wide(e.receptance), wide(step.force), wide(step.compression));
  }

  // Counts the pairs of start and end segment that the cases cover, found without the search under test.
  void note_hit(const std::vector<Segment<T>>& table, const StepCase<T>& c) {
    const auto segment_of = [&](double y) {
      const auto above = std::upper_bound(table.begin() + 1, table.end(), y,
                                          [](double value, const Segment<T>& s) { return value < wide(s.knot); });
      return static_cast<std::size_t>(above - table.begin()) - 1;
    };
    auto& hits = hits_[c.table];
    hits.resize(table.size() * table.size());
    hits[segment_of(wide(c.compression)) * table.size() + segment_of(wide(c.compression) + c.increment)] = true;
  }

  void require_hits(std::size_t table) {
    const std::size_t size = sizes_[table];
    const auto& hits = hits_[table];
    std::size_t pairs = 0, starts = 0, end_segments = 0;
    for (std::size_t i = 0; i < size; ++i) {
      bool is_start = false, is_end = false;
      for (std::size_t j = 0; j < size; ++j) {
        pairs += hits[i * size + j];
        is_start = is_start || hits[i * size + j];
        is_end = is_end || hits[j * size + i];
      }
      starts += is_start;
      end_segments += is_end;
    }
    if (size <= kPairedSegments + 1 ? pairs != size * size : starts != size || end_segments != size)
      fail("missing data: table %zu of %zu entries hit in %zu pairs, %zu starts, %zu end_segments", table, size,
           pairs, starts, end_segments);
  }

  std::string plant_;
  std::size_t planted_ = 0, steps_ = 0, extremes_ = 0, well_ = 0, failures_ = 0;
  double worst_force_ = 0, worst_increment_ = 0, worst_relative_ = 0;
  std::vector<std::vector<bool>> hits_;
  std::vector<std::size_t> sizes_;
};

template <typename T>
int check_files(const std::vector<std::string>& words) {
  Checker<T> checker(words[3]);
  for (std::size_t i = 4; i < words.size(); ++i) checker.run(read_step_cases<T>(words[i]));
  return checker.report(words[1].c_str(), std::stoul(words[2])) ? 0 : 1;
}

}  // namespace
}  // namespace contactspline::testing

int main(int argc, char** argv) try {
  using namespace contactspline::testing;
  const std::vector<std::string> words(argv, argv + argc);
  if (words.size() < 5) throw std::runtime_error("usage: step_checker double|float CASES PLANT FILE...");
  return words[1] == "float" ? check_files<float>(words) : check_files<double>(words);
} catch (const std::exception& error) {
  std::printf("step_checker: %s\n", error.what());
  return 2;
}
