// SPDX-License-Identifier: MIT
#include "generator/cli/plot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "generator/cli/gnuplot.hpp"

namespace contactspline {
namespace {

constexpr double kSmallestDecimal = 1e-3, kLargestDecimal = 1e5;  // of labels; others are multiples of a power

int decade_of(double number) {
  return static_cast<int>(std::floor(std::log10(std::abs(number)) + 1e-9));
}

// The power of ten by which tics with this distance are divided.
int common_power(double largest, double step) {
  return step >= kSmallestDecimal && largest < kLargestDecimal ? 0 : decade_of(largest);
}

std::string power_label(double number) {
  const int power = decade_of(number);
  const double digit = number / std::pow(10, power);
  return std::abs(digit - 1) < 1e-9 ? fmt::format("10^{{{}}}", power) : fmt::format("{:.3g}·10^{{{}}}", digit, power);
}

std::vector<double> logarithmic_tics(Interval range) {
  const bool is_narrow = range.high / range.low < 100;
  std::vector<double> tics;
  for (int power = decade_of(range.low); std::pow(10, power) <= range.high; ++power)
    for (const int digit : {1, 2, 5})
      if (const double tic = digit * std::pow(10, power);
          tic >= range.low && tic <= range.high && (digit == 1 || is_narrow))
        tics.push_back(tic);
  return tics.size() < 2 ? std::vector{range.low, range.high} : tics;
}

std::string axis_script(char axis, Interval range, const std::vector<double>& tics,
                        const std::vector<std::string>& labels, const std::string& label) {
  std::vector<std::string> pairs;
  for (std::size_t i = 0; i < tics.size(); ++i) pairs.push_back(fmt::format("'{}' {:.12g}", labels[i], tics[i]));
  return fmt::format("set {0}range [{1:.12g}:{2:.12g}]\nset {0}tics ({3})\nset {0}label \"{4}\"\n", axis, range.low,
                     range.high, fmt::join(pairs, ", "), label);
}

std::string logarithmic_script(char axis, Interval range, const std::vector<double>& tics, const std::string& label) {
  const bool is_decimal = tics.front() >= kSmallestDecimal && tics.back() < kLargestDecimal;
  std::vector<std::string> labels;
  for (const double tic : tics)
    labels.push_back(!is_decimal  ? power_label(tic)
                     : tic < 1000 ? fmt::format("{:.4g}", tic)
                                  : fmt::format("{:.0f}", tic));
  return fmt::format("set logscale {}\n", axis) + axis_script(axis, range, tics, labels, label);
}

}  // namespace

std::string heading(std::string_view layout) {
  return fmt::format("set multiplot layout {} title '{}' noenhanced font ',17' textcolor rgb '#222222'\n", layout,
                     kTitle);
}

std::string key_beside(const std::string& title, const std::vector<KeyEntry>& entries) {
  constexpr double kTop = 1.08, kRow = 0.12;  // parts of the height of the panel
  std::string script = kNoKey;
  double y = kTop;
  const auto text = [&](double x, const std::string& words) {
    script +=
        fmt::format("set label {} at screen {}, graph {:.3f} left noenhanced font ',12' textcolor rgb '#444444'\n",
                    in_quotes(words), x, y);
  };
  if (!title.empty()) text(0.695, title);
  for (const KeyEntry& entry : entries) {
    y -= kRow;
    script +=
        entry.is_point
            ? fmt::format("set label '' at screen 0.706, graph {:.3f} point {}\n", y, entry.style)
            : fmt::format("set arrow from screen 0.695, graph {0:.3f} to screen 0.717, graph {0:.3f} nohead {1}\n", y,
                          entry.style);
    text(0.724, entry.text);
  }
  return script;
}

std::string in_quotes(std::string_view text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? "''" : std::string(1, c);
  return safe + "'";
}

void Interval::include(double number) {
  low = std::min(low, number);
  high = std::max(high, number);
}

void Interval::include(Interval other) {
  low = std::min(low, other.low);
  high = std::max(high, other.high);
}

Interval Data::range(std::size_t column) const {
  Interval range;
  for (const auto& row : rows_)
    if (!row.empty()) range.include(row[column - 1]);
  return range;
}

std::string Data::text() const {
  std::string text = fmt::format("${} << EOD\n", name_);
  for (const auto& row : rows_) text += fmt::format("{:g}\n", fmt::join(row, " "));
  return text + "EOD\n";
}

double tic_step(double range) {
  if (!(range > 0)) return 1;
  constexpr double kTics = 6;
  const double power = std::pow(10, std::floor(std::log10(range / kTics)));
  const double step = range / kTics / power;
  return power * (step <= 1 ? 1 : step <= 2 ? 2 : step <= 5 ? 5 : 10);
}

std::string linear_axis(char axis, Interval range, const std::string& label) {
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  const bool is_constant = range.high - range.low <= 1e-6 * largest;
  const double step = tic_step(is_constant ? largest : range.high - range.low);
  const auto first = static_cast<long long>(std::floor(range.low / step + 1e-9));
  const auto last = std::max(first + 1, static_cast<long long>(std::ceil(range.high / step - 1e-9)));
  if (axis == 'y' || is_constant) range = {static_cast<double>(first) * step, static_cast<double>(last) * step};
  const int power = common_power(largest, step), decimals = std::max(0, power - decade_of(step));
  std::vector<double> tics;
  std::vector<std::string> labels;
  for (long long i = first; i <= last; ++i) {
    tics.push_back(static_cast<double>(i) * step);
    labels.push_back(i == 0 ? "0" : fmt::format("{:.{}f}", tics.back() / std::pow(10, power), decimals));
  }
  std::string scaled = label;
  if (power != 0) scaled.insert(scaled.rfind('[') + 1, fmt::format("10^{{{}}} ", power));
  return axis_script(axis, range, tics, labels, scaled);
}

std::string logarithmic_axis(char axis, Interval range, const std::string& label) {
  return logarithmic_script(axis, range, logarithmic_tics(range), label);
}

Interval between_tics(Interval range) {
  Interval found = range;
  for (int power = decade_of(range.low); power <= decade_of(range.high) + 1; ++power)
    for (const int digit : {1, 2, 5}) {
      const double tic = digit * std::pow(10, power);
      if (tic <= range.low) found.low = tic;
      if (tic >= range.high && tic > found.low) return {found.low, tic};
    }
  return found;
}

std::string logarithmic_axis_at(const std::vector<double>& tics, const std::string& label) {
  return logarithmic_script('x', {tics.front(), tics.back()}, tics, label);
}

}  // namespace contactspline
