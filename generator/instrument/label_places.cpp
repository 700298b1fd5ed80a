// SPDX-License-Identifier: MIT
#include "generator/instrument/label_places.hpp"

#include <algorithm>

namespace contactspline {
namespace {

constexpr double kCharacterWidth = 7.4, kHeight = 16;  // of a font of 12

}  // namespace

bool ScreenBox::overlaps(const ScreenBox& other) const {
  return left < other.right && other.left < right && bottom < other.top && other.bottom < top;
}

// Liang and Barsky: the part of the line between its crossings with the four borders.
bool ScreenBox::is_crossed_by(ScreenPoint from, ScreenPoint to) const {
  double enter = 0, leave = 1;
  const auto clip = [&](double begin, double end, double low, double high) {
    const double change = end - begin;
    if (change == 0) return begin > low && begin < high;
    const double a = (low - begin) / change, b = (high - begin) / change;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
    return enter < leave;
  };
  return clip(from.x, to.x, left, right) && clip(from.y, to.y, bottom, top);
}

ScreenBox box_of(std::string_view label, ScreenPoint middle) {
  const double half = kCharacterWidth * static_cast<double>(label.size()) / 2;
  return {middle.x - half, middle.y - kHeight / 2, middle.x + half, middle.y + kHeight / 2};
}

std::size_t LabelPlaces::cost(const ScreenBox& box) const {
  constexpr std::size_t kOfBox = 1000, kOffPage = 1'000'000;
  const auto lines =
      std::ranges::count_if(lines_, [&](const auto& line) { return box.is_crossed_by(line.first, line.second); });
  const auto boxes = std::ranges::count_if(boxes_, [&](const ScreenBox& taken) { return box.overlaps(taken); });
  const bool is_off =
      box.left < page_.left || box.right > page_.right || box.bottom < page_.bottom || box.top > page_.top;
  return static_cast<std::size_t>(lines) + kOfBox * static_cast<std::size_t>(boxes) + (is_off ? kOffPage : 0);
}

ScreenPoint LabelPlaces::choose(std::string_view label, const std::vector<ScreenPoint>& middles) {
  const auto best =
      std::ranges::min_element(middles, {}, [&](ScreenPoint middle) { return cost(box_of(label, middle)); });
  boxes_.push_back(box_of(label, *best));
  return *best;
}

}  // namespace contactspline
