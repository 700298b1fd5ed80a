// SPDX-License-Identifier: MIT
#include "generator/cli/error_panel.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "generator/cli/plot.hpp"

namespace contactspline {
namespace {

constexpr double kRoundingError = 1e-11;  // errors below it are drawn as it
constexpr double kDecades = 5;

double percent(double error) {
  return 100 * std::max(std::abs(error), kRoundingError);
}

std::size_t largest_of(const ErrorCurve& curve) {
  const auto largest = std::ranges::max_element(curve.error, {}, [](double error) { return std::abs(error); });
  return static_cast<std::size_t>(largest - curve.error.begin());
}

// Whole decades around the errors.
Interval decades_around(const std::vector<ErrorCurve>& curves) {
  Interval range;
  for (const ErrorCurve& curve : curves)
    for (const double error : curve.error) range.include(percent(error));
  const double high = std::ceil(std::log10(range.high) - 1e-9);
  const double low = std::floor(std::log10(range.low) + 1e-9);
  return {std::pow(10, std::max(std::min(low, high - 1), high - kDecades)), std::pow(10, high)};
}

// A few points are tics.
std::string x_axis(const std::vector<ErrorCurve>& curves, const std::string& label) {
  constexpr std::size_t kMaxTics = 6;
  const std::vector<double>& at = curves.front().at;
  if (at.size() <= kMaxTics && at.size() > 1) return logarithmic_axis_at(at, label);
  Interval range;
  for (const ErrorCurve& curve : curves)
    for (const double x : curve.at) range.include(x);
  return logarithmic_axis('x', range, label);
}

}  // namespace

ErrorCurve envelope_of(const ErrorCurve& curve) {
  if (curve.at.size() <= 40) return curve;
  const double stretches = std::clamp(static_cast<double>(curve.at.size()) / 8, 10.0, 40.0);
  ErrorCurve envelope{curve.name, curve.style, {}, {}, curve.largest};
  const double whole = std::log(curve.at.back() / curve.at.front());
  double stretch = -1;
  for (std::size_t i = 0; i < curve.at.size(); ++i) {
    const double in =
        std::min(stretches - 1, std::floor(stretches * std::log(curve.at[i] / curve.at.front()) / whole));
    if (in > stretch) {
      envelope.at.push_back(curve.at[i]);
      envelope.error.push_back(curve.error[i]);
      stretch = in;
    } else if (std::abs(curve.error[i]) > std::abs(envelope.error.back())) {
      envelope.at.back() = curve.at[i];
      envelope.error.back() = curve.error[i];
    }
  }
  envelope.at.insert(envelope.at.begin(), curve.at.front());  // level from end to end of the axis
  envelope.error.insert(envelope.error.begin(), envelope.error.front());
  envelope.at.push_back(curve.at.back());
  envelope.error.push_back(envelope.error.back());
  return envelope;
}

std::string error_panel(const std::string& name, const std::string& x_label, const std::string& y_label,
                        const std::vector<ErrorCurve>& curves) {
  const Interval shown = decades_around(curves);
  std::string data;
  std::vector<std::string> plots;
  std::vector<KeyEntry> key;
  const auto add = [&](const std::string& suffix, const ErrorCurve& curve, std::size_t first, std::size_t last,
                       std::string_view with) {
    Data points(fmt::format("{}{}", name, suffix));
    for (std::size_t p = first; p <= last; ++p)
      points.add({curve.at[p], std::max(percent(curve.error[p]), shown.low)});
    data += points.text();
    plots.push_back(fmt::format("${} using 1:2 with {}", points.name(), with));
  };
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const ErrorCurve& curve = curves[i];
    add(fmt::format("{}", i), curve, 0, curve.at.size() - 1, "lines " + curve.style);
    if (curve.name.empty()) continue;
    const std::size_t largest = largest_of(curve);
    add(fmt::format("_largest{}", i), curve, largest, largest, fmt::format("points {} pt 7 ps 0.7", curve.style));
    const double stated = curve.largest.value_or(curve.error[largest]);
    key.push_back({fmt::format("{}: {:.2g} %", curve.name, percent(stated)), curve.style});
  }
  return data + x_axis(curves, x_label) + logarithmic_axis('y', shown, y_label) + key_beside("largest error", key) +
         fmt::format("plot {}\n{}", fmt::join(plots, ", "), kNoKey);
}

}  // namespace contactspline
