// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <string>

#include "generator/contact/measured_curve.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/text_encoding.hpp"
#include "generator/support/text_lines.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kMinSamples = 8, kMaxSamples = 10000;
constexpr double kNoise = 0.2;  // part of the largest force; the noise of any sensor is smaller

// Wide enough for every struck object, narrow enough to catch a wrong unit.
constexpr Range kCompression{1e-8, 0.1};
constexpr Range kForce{1e-3, 1e6};

constexpr auto kHeaders =
    "a header compression_UNIT,force_UNIT (m, mm, um; n, mn, kn), then two numbers per line with a decimal point";

// Where the speed of both branches stands.
constexpr auto kImpactSpeed = "the key impact_speed_m_per_s (contact.curve.impact_speed_m_per_s of a material)";

constexpr std::string_view kBlanks = " \t\r";

/// The next line that is neither blank nor a comment, without blanks around it; nothing at the end of the file.
std::optional<std::string_view> next_line(std::string_view& rest, LineOfFile& position) {
  const auto line = contactspline::next_line(rest, position, kBlanks, "#");
  return line ? std::optional(trimmed(*line, kBlanks)) : std::nullopt;
}

/// The two columns of a line; `what` is wrong if it has another number of them.
std::array<std::string_view, 2> columns(std::string_view line, const LineOfFile& position, std::string_view what) {
  const auto comma = line.find(',');
  if (comma == std::string_view::npos || line.find(',', comma + 1) != std::string_view::npos)
    position.fail(what, kHeaders);
  return {trimmed(line.substr(0, comma), kBlanks), trimmed(line.substr(comma + 1), kBlanks)};
}

struct Unit {
  std::string_view name;
  double size;
};
constexpr std::array kLengths = {Unit{"compression_m", 1}, Unit{"compression_mm", 1e-3},
                                 Unit{"compression_um", 1e-6}};
constexpr std::array kForces = {Unit{"force_n", 1}, Unit{"force_mn", 1e-3}, Unit{"force_kn", 1e3}};

// A header that is not one of a curve is not shown: a material may name a file that is somebody else's.
Unit unit_of(std::string_view header, std::span<const Unit> units, const LineOfFile& position,
             std::string_view which) {
  const auto found = std::ranges::find(units, header, &Unit::name);
  if (found == units.end()) position.fail(fmt::format("the {} column of the header is unknown", which), kHeaders);
  return *found;
}

double number(std::string_view text, const LineOfFile& position) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    position.fail(fmt::format("'{}' is not a number", shown(text, 40)), "finite numbers such as 1.5e-4");
  return value;
}

void require_rising(const std::vector<CurveSample>& samples, const CurveSample& next, const LineOfFile& position) {
  if (next.compression_m < 0)
    position.fail(fmt::format("compression {:.9g} m is negative", next.compression_m),
                  "0 or more, counted from the first contact");
  if (!samples.empty() && !(next.compression_m > samples.back().compression_m))
    position.fail(fmt::format("compression {:.9g} m does not rise", next.compression_m),
                  fmt::format("rising compressions: the loading branch only, or both branches and {}", kImpactSpeed));
}

// Beyond the turning point, compressions fall. `turned` tells whether it has been passed.
void require_loop(const std::vector<CurveSample>& samples, const CurveSample& next, bool turned,
                  const LineOfFile& position) {
  if (next.compression_m < 0)
    position.fail(fmt::format("compression {:.9g} m is negative", next.compression_m),
                  "0 or more, counted from the first contact");
  if (samples.empty()) return;
  const double before = samples.back().compression_m;
  if (next.compression_m == before || (turned && next.compression_m > before))
    position.fail(fmt::format("compression {:.9g} m does not {}", next.compression_m, turned ? "fall" : "change"),
                  "compressions that rise to the largest, then fall, each once in each branch");
}

void require_order(const std::vector<CurveSample>& samples, const std::vector<std::size_t>& lines,
                   std::string_view file, bool is_impact) {
  std::vector<CurveSample> before;
  bool turned = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const LineOfFile position{file, lines[i]};
    if (is_impact)
      require_loop(before, samples[i], turned, position);
    else
      require_rising(before, samples[i], position);
    turned = turned || (i > 0 && samples[i].compression_m < samples[i - 1].compression_m);
    before.push_back(samples[i]);
  }
}

// The samples first, second ... of a branch have forces that rise, apart from noise. A second contact lets them fall
// further.
void require_monotone(const std::vector<CurveSample>& samples, const std::vector<std::size_t>& lines,
                      std::span<const std::size_t> branch, std::string_view file, std::string_view allowed) {
  const double largest = std::ranges::max(samples, {}, &CurveSample::force_n).force_n;
  double max_so_far = 0;
  for (const std::size_t i : branch) {
    const double force = samples[i].force_n;
    const LineOfFile position{file, lines[i]};
    max_so_far = std::max(max_so_far, force);
    if (force < -kNoise * largest)
      position.fail(fmt::format("force {:.9g} N is negative", force),
                    "positive forces, apart from noise of a fifth of the largest");
    if (force < max_so_far - kNoise * largest)
      position.fail(fmt::format("force falls from {:.9g} to {:.9g} N", max_so_far, force), allowed);
  }
}

// The work of the force over samples [first, last) whose compressions change one way, by trapezoids, up to each of
// them.
std::vector<double> works(const std::vector<CurveSample>& samples, CurveSample from, std::size_t first,
                          std::size_t last) {
  std::vector<double> works;
  double work = 0;
  for (std::size_t i = first; i < last; from = samples[i], ++i) {
    work += (samples[i].force_n + from.force_n) / 2 * std::abs(samples[i].compression_m - from.compression_m);
    works.push_back(std::max(work, 0.0));  // noise at the first touch may pull
  }
  return works;
}

// Gives each sample of an impact its speed, and sorts them by compression.
void add_speeds(std::vector<CurveSample>& samples, double impact_speed, std::string_view file) {
  const auto deepest =
      static_cast<std::size_t>(std::ranges::max_element(samples, {}, &CurveSample::compression_m) - samples.begin());
  if (samples.size() - deepest - 1 < kMinSamples / 2 || deepest + 1 < kMinSamples / 2)
    refuse(file, "samples",
           fmt::format("has {} of loading and {} of unloading", deepest + 1, samples.size() - deepest - 1),
           fmt::format("{} or more of each, for {}", kMinSamples / 2, kImpactSpeed));
  const auto loading = works(samples, {0, 0}, 0, deepest + 1);
  const auto unloading = works(samples, samples[deepest], deepest + 1, samples.size());
  const double stored = loading.back();
  if (!(unloading.back() < stored))
    refuse(file, "force", fmt::format("gives back {:.4g} J of {:.4g} J", unloading.back(), stored),
           "an unloading branch below the loading branch");
  for (std::size_t i = 0; i <= deepest; ++i)
    samples[i].speed_m_per_s = impact_speed * std::sqrt(std::max(1 - loading[i] / stored, 0.0));
  for (std::size_t i = deepest + 1; i < samples.size(); ++i)
    samples[i].speed_m_per_s = -impact_speed * std::sqrt(unloading[i - deepest - 1] / stored);
  std::ranges::stable_sort(samples, {}, &CurveSample::compression_m);
}

void require_size(const std::vector<CurveSample>& samples, std::string_view file) {
  if (samples.size() < kMinSamples || samples.size() > kMaxSamples)
    refuse(file, "samples", fmt::format("has {}", samples.size()), fmt::format("{} to {}", kMinSamples, kMaxSamples));
  const double force = std::ranges::max(samples, {}, &CurveSample::force_n).force_n;
  if (!(force > 0)) refuse(file, "force", "no force is positive", "positive forces in compression");
  const auto require = [&](std::string_view key, double value, Range range, const char* unit) {
    if (!(value >= range.min && value <= range.max))
      refuse(file, key, fmt::format("reaches {:.9g} {}: a wrong unit in the header?", value, unit),
             fmt::format("a largest value from {} to {} {}", range.min, range.max, unit));
  };
  require("compression", std::ranges::max(samples, {}, &CurveSample::compression_m).compression_m, kCompression, "m");
  require("force", force, kForce, "N");
}

}  // namespace

std::vector<CurveSample> parse_curve(std::string_view text, std::string_view file,
                                     std::optional<double> impact_speed_m_per_s) {
  const std::string decoded = in_utf8(text);
  text = decoded;
  LineOfFile position{file};
  const auto header = next_line(text, position);
  if (!header) refuse(file, "header", "missing", kHeaders);
  const auto [length_name, force_name] = columns(*header, position, "the header does not have two columns");
  const Unit length = unit_of(length_name, kLengths, position, "first");
  const Unit force = unit_of(force_name, kForces, position, "second");
  std::vector<CurveSample> samples;
  std::vector<std::size_t> lines;
  while (const auto line = next_line(text, position)) {
    const auto [y, f] = columns(*line, position, fmt::format("'{}' does not have two columns", shown(*line, 40)));
    samples.push_back({number(y, position) * length.size, number(f, position) * force.size});
    lines.push_back(position.line);
  }
  return checked_curve(std::move(samples), lines, file, impact_speed_m_per_s);
}

std::vector<CurveSample> checked_curve(std::vector<CurveSample> samples, const std::vector<std::size_t>& lines,
                                       std::string_view file, std::optional<double> impact_speed_m_per_s) {
  require_order(samples, lines, file, impact_speed_m_per_s.has_value());
  require_size(samples, file);
  std::vector<std::size_t> branch(samples.size());
  std::iota(branch.begin(), branch.end(), std::size_t{0});
  if (!impact_speed_m_per_s) {
    require_monotone(samples, lines, branch, file, "forces that rise, apart from noise of a fifth of the largest");
    return samples;
  }
  // Over time the force of an impact rises to its peak and falls: from its end backwards it rises, too.
  constexpr auto kOnePeak = "forces with one peak, apart from noise of a fifth of the largest";
  const auto peak = std::ranges::max_element(samples, {}, &CurveSample::force_n) - samples.begin();
  require_monotone(samples, lines, std::span(branch).first(static_cast<std::size_t>(peak)), file, kOnePeak);
  std::ranges::reverse(branch);
  require_monotone(samples, lines, std::span(branch).first(samples.size() - static_cast<std::size_t>(peak)), file,
                   kOnePeak);
  add_speeds(samples, *impact_speed_m_per_s, file);
  return samples;
}

}  // namespace contactspline
