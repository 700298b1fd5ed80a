// SPDX-License-Identifier: MIT
// Pieces of gnuplot scripts that several figures share: layouts, data, axes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

/// Layouts with the same left and right border for all panels of a column, whatever the width of their numbers.
inline constexpr auto kFourPanels = "2,2 margins 0.115,0.985,0.085,0.93 spacing 0.125,0.14";
inline constexpr auto kThreePanels = "3,1 margins 0.115,0.985,0.085,0.93 spacing 0,0.13";
inline constexpr auto kThreePanelsWithKey = "3,1 margins 0.115,0.68,0.085,0.93 spacing 0,0.13";
inline constexpr auto kOnePanel = "1,1 margins 0.115,0.985,0.085,0.93";
inline constexpr auto kOwnMargins = "3,1";
inline constexpr auto kWholePage = "1,1 margins 0.01,0.99,0.01,0.94";

/// Colours that colour-blind readers can distinguish.
inline constexpr std::array kColours = {"#999999", "#d55e00", "#0072b2", "#009e73", "#cc79a7"};

/// Begins a figure of several panels; the title stands above them.
[[nodiscard]] std::string heading(std::string_view layout);

/// A line or a point with what it means.
struct KeyEntry {
  std::string text, style;
  bool is_point = false;
};

/// A key to the right of a panel of kThreePanelsWithKey, in place of that of gnuplot, which wraps into a second
/// column.
[[nodiscard]] std::string key_beside(const std::string& title, const std::vector<KeyEntry>& entries);
inline constexpr auto kNoKey = "unset key\nunset label\nunset arrow\n";

/// A text in single quotes, which gnuplot takes as it is.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// An interval of numbers that grows with every number it includes.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void include(double number);
  void include(Interval other);  ///< all of it
  [[nodiscard]] bool is_empty() const { return low > high; }
};

/// Rows of numbers under a name that gnuplot's `plot $name` takes. A row without numbers ends a line.
class Data {
 public:
  explicit Data(std::string name) : name_(std::move(name)) {}

  void add(std::vector<double> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] Interval range(std::size_t column) const;  ///< of a column, counted from 1 as gnuplot does
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<std::vector<double>>& rows() const { return rows_; }
  [[nodiscard]] std::string text() const;

 private:
  std::string name_;
  std::vector<std::vector<double>> rows_;
};

/// A distance of tics with about six tics over the range: 1, 2 or 5 times a power of ten.
[[nodiscard]] double tic_step(double range);

/// Label, range and tics of an axis: 'x' over the range, 'y' from a tic at or below it to one at or above it. Numbers
/// too small or too large for decimals are divided by a power of ten, which the label states before its unit: `label`
/// ends with a unit in brackets.
[[nodiscard]] std::string linear_axis(char axis, Interval range, const std::string& label);

/// A logarithmic axis from low > 0 to high: tics at 1, 2 and 5 times the powers of ten, or over two decades at the
/// powers alone; at both ends if there are fewer than two of these. All labels are decimals, or all are powers.
[[nodiscard]] std::string logarithmic_axis(char axis, Interval range, const std::string& label);

/// From a number at or below a range > 0 to a higher one at or above it, both 1, 2 or 5 times a power of ten.
[[nodiscard]] Interval between_tics(Interval range);

/// A logarithmic x axis with a tic at each of these rising numbers.
[[nodiscard]] std::string logarithmic_axis_at(const std::vector<double>& tics, const std::string& label);

/// The smallest and the largest value in each of about 1200 intervals of time, as rows of time [s] and value: it
/// looks like a plot of all samples.
template <typename T>
[[nodiscard]] Data envelope(std::string name, std::span<const T> values, double scale, double rate_hz) {
  constexpr std::size_t kColumns = 1200;
  const std::size_t interval = std::max<std::size_t>(1, values.size() / kColumns);
  Data data(std::move(name));
  for (std::size_t begin = 0; begin < values.size(); begin += interval) {
    const auto part = values.subspan(begin, std::min(interval, values.size() - begin));
    const auto [min, max] = std::ranges::minmax_element(part);
    for (const auto at : {std::min(min, max), std::max(min, max)})
      data.add({static_cast<double>(&*at - values.data()) / rate_hz, scale * static_cast<double>(*at)});
  }
  return data;
}

}  // namespace contactspline
