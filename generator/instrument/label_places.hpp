// SPDX-License-Identifier: MIT
// Places for the labels of a drawing, in points of the screen: beside its lines and beside each other.
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace contactspline {

struct ScreenPoint {
  double x, y;
};

struct ScreenBox {
  double left, bottom, right, top;

  [[nodiscard]] bool overlaps(const ScreenBox& other) const;
  [[nodiscard]] bool is_crossed_by(ScreenPoint from, ScreenPoint to) const;  ///< a line touches its inside
};

/// The room that a label in the font of diagrams takes around its middle.
[[nodiscard]] ScreenBox box_of(std::string_view label, ScreenPoint middle);

/// Chooses places one after the other.
class LabelPlaces {
 public:
  explicit LabelPlaces(ScreenBox page) : page_(page) {}

  void add_line(ScreenPoint from, ScreenPoint to) { lines_.emplace_back(from, to); }
  void add_box(ScreenBox taken) { boxes_.push_back(taken); }

  /// The first of these middles where the label lies on the page, on no box and on the fewest lines; if there is
  /// none, the one on the fewest boxes. The label then takes its room.
  [[nodiscard]] ScreenPoint choose(std::string_view label, const std::vector<ScreenPoint>& middles);

 private:
  [[nodiscard]] std::size_t cost(const ScreenBox& box) const;

  ScreenBox page_;
  std::vector<std::pair<ScreenPoint, ScreenPoint>> lines_;
  std::vector<ScreenBox> boxes_;
};

}  // namespace contactspline
