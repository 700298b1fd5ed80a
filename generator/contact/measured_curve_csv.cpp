// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "generator/contact/measured_curve.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kMinSamples = 8, kMaxSamples = 10000;
constexpr double kNoise = 0.2;  // of the largest force; the noise of any sensor is smaller

// Wide enough for every struck object, narrow enough to catch a wrong unit.
constexpr Range kCompression{1e-8, 0.1};
constexpr Range kForce{1e-3, 1e6};

constexpr auto kHeaders =
    "a header compression_UNIT,force_UNIT (m, mm, um; n, mn, kn), then two numbers per line with a decimal point";

/// The file name and the number of the current line, for messages.
struct Position {
  std::string_view file;
  std::size_t line = 0;

  [[noreturn]] void fail(std::string_view wrong, std::string_view allowed) const {
    refuse(file, fmt::format("line {}", line), wrong, allowed);
  }
};

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// The next line that is neither blank nor a comment, without blanks around it; nothing at the end of the file.
std::optional<std::string_view> next_line(std::string_view& rest, Position& position) {
  while (!rest.empty()) {
    const auto end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++position.line;
    if (!line.empty() && line.front() != '#') return line;
  }
  return std::nullopt;
}

/// The two columns of a line.
std::array<std::string_view, 2> columns(std::string_view line, const Position& position) {
  const auto comma = line.find(',');
  if (comma == std::string_view::npos || line.find(',', comma + 1) != std::string_view::npos)
    position.fail(fmt::format("'{}' does not have two columns", shown(line, 40)), kHeaders);
  return {trimmed(line.substr(0, comma)), trimmed(line.substr(comma + 1))};
}

struct Unit {
  std::string_view name;
  double size;
};
constexpr std::array kLengths = {Unit{"compression_m", 1}, Unit{"compression_mm", 1e-3},
                                 Unit{"compression_um", 1e-6}};
constexpr std::array kForces = {Unit{"force_n", 1}, Unit{"force_mn", 1e-3}, Unit{"force_kn", 1e3}};

Unit unit_of(std::string_view header, std::span<const Unit> units, const Position& position) {
  const auto found = std::ranges::find(units, header, &Unit::name);
  if (found == units.end()) position.fail(fmt::format("'{}' is not a known column", shown(header, 40)), kHeaders);
  return *found;
}

double number(std::string_view text, const Position& position) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    position.fail(fmt::format("'{}' is not a number", shown(text, 40)), "finite numbers such as 1.5e-4");
  return value;
}

void require_rising(const std::vector<CurveSample>& samples, const CurveSample& next, const Position& position) {
  if (next.compression_m < 0)
    position.fail(fmt::format("compression {} m is negative", next.compression_m),
                  "0 or more, counted from the first contact");
  if (!samples.empty() && !(next.compression_m > samples.back().compression_m))
    position.fail(fmt::format("compression {} m does not rise", next.compression_m),
                  "rising compressions: the loading branch only, each once");
}

// Noise lets the force fall a little. A second contact, or loading and unloading in one file, lets it fall further.
void require_monotone(const std::vector<CurveSample>& samples, const std::vector<std::size_t>& lines,
                      std::string_view file) {
  const double largest = std::ranges::max(samples, {}, &CurveSample::force_n).force_n;
  double max_so_far = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double force = samples[i].force_n;
    const Position position{file, lines[i]};
    max_so_far = std::max(max_so_far, force);
    if (force < -kNoise * largest)
      position.fail(fmt::format("force {} N is negative", force),
                    "positive forces, apart from noise of a fifth of the largest");
    if (force < max_so_far - kNoise * largest)
      position.fail(fmt::format("force falls from {} to {} N", max_so_far, force),
                    "forces that rise, apart from noise of a fifth of the largest");
  }
}

void require_size(const std::vector<CurveSample>& samples, std::string_view file) {
  if (samples.size() < kMinSamples || samples.size() > kMaxSamples)
    refuse(file, "samples", fmt::format("has {}", samples.size()), fmt::format("{} to {}", kMinSamples, kMaxSamples));
  const double force = std::ranges::max(samples, {}, &CurveSample::force_n).force_n;
  if (!(force > 0)) refuse(file, "force", "no force is positive", "positive forces in compression");
  const auto require = [&](std::string_view key, double value, Range range, const char* unit) {
    if (!(value >= range.min && value <= range.max))
      refuse(file, key, fmt::format("reaches {} {}: a wrong unit in the header?", value, unit),
             fmt::format("a largest value from {} to {} {}", range.min, range.max, unit));
  };
  require("compression", samples.back().compression_m, kCompression, "m");
  require("force", force, kForce, "N");
}

}  // namespace

std::vector<CurveSample> parse_curve(std::string_view text, std::string_view file) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Position position{file};
  const auto header = next_line(text, position);
  if (!header) refuse(file, "header", "missing", kHeaders);
  const auto [length_name, force_name] = columns(*header, position);
  const Unit length = unit_of(length_name, kLengths, position);
  const Unit force = unit_of(force_name, kForces, position);
  std::vector<CurveSample> samples;
  std::vector<std::size_t> lines;
  while (const auto line = next_line(text, position)) {
    const auto [y, f] = columns(*line, position);
    const CurveSample sample{number(y, position) * length.size, number(f, position) * force.size};
    require_rising(samples, sample, position);
    samples.push_back(sample);
    lines.push_back(position.line);
  }
  require_size(samples, file);
  require_monotone(samples, lines, file);
  return samples;
}

}  // namespace contactspline
