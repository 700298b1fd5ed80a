// SPDX-License-Identifier: MIT
// The tuning of a plug-in in a row: numbers that one drags, lists that one clicks through.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "window/canvas.hpp"
#include "window/window_source.hpp"

namespace contactspline {

class TuningStrip {
 public:
  TuningStrip(const std::vector<WindowParameter>& tuning, const Box& box) : tuning_(tuning) {
    constexpr float kDistance = 8;
    constexpr std::array<float, kTuningParameters.size()> kParts = {0.22f, 0.2f, 0.38f, 0.2f};
    float x = box.x;
    for (std::size_t t = 0; t < std::min(tuning.size(), kParts.size()); ++t) {
      const float width = kParts[t] * (box.width - kDistance * static_cast<float>(kParts.size() - 1));
      cells_.push_back({x, box.y, width, box.height});
      x += width + kDistance;
    }
  }

  /// Where MTS-ESP tunes, all but the bend range rest.
  void tune_outside(bool is_outside) { is_outside_ = is_outside; }
  [[nodiscard]] bool is_outside() const { return is_outside_; }

  [[nodiscard]] std::optional<std::size_t> at(double x, double y) const {
    for (std::size_t t = 0; t < cells_.size(); ++t)
      if (is_shown(t) && cells_[t].has(x, y)) return t;
    return {};
  }

  /// The value of a list after a click: the one before or behind it, around the ends.
  [[nodiscard]] double clicked(std::size_t number, double value, double x) const {
    const Box place = field(number);
    const bool is_back = x >= place.x && x < place.x + place.width / 2;
    return stepped(number, value, is_back ? -1 : 1);
  }
  [[nodiscard]] double stepped(std::size_t number, double value, int steps) const {
    const int count = static_cast<int>(tuning_[number].entries.size());
    return (static_cast<int>(value) + steps + count) % count;
  }

  /// values: of the tuning.
  void draw(Canvas& canvas, std::span<const double> values, std::optional<std::size_t> held) const {
    for (std::size_t t = 0; t < cells_.size(); ++t)
      if (is_shown(t)) draw_cell(canvas, t, values[t], held == t);
    if (!is_outside_ || cells_.empty()) return;
    const Box& first = cells_[kA4];
    const Box rest{first.x, first.y, cells_.back().x + cells_.back().width - first.x, first.height};
    canvas.lay(rest, colours::kPanel);
    canvas.text(rest.inner(6), "tuned by MTS-ESP", 12, colours::kAccent, Side::kMiddle);
  }

  // Where things are, for tests.
  [[nodiscard]] const std::vector<Box>& cells() const { return cells_; }

 private:
  [[nodiscard]] bool is_shown(std::size_t number) const { return number == kBendRange || !is_outside_; }

  // Behind the name.
  [[nodiscard]] Box field(std::size_t number) const {
    const Box& cell = cells_[number];
    const float name = (tuning_[number].entries.empty() ? 0.45f : 0.27f) * cell.width;
    return {cell.x + name, cell.y, cell.width - name, cell.height};
  }

  void draw_cell(Canvas& canvas, std::size_t number, double value, bool is_held) const {
    constexpr float kMargin = 10, kArrow = 9;
    const WindowParameter& parameter = tuning_[number];
    const Box &cell = cells_[number], place = field(number);
    canvas.lay(cell, colours::kPanel);
    canvas.text({cell.x + kMargin, cell.y, place.x - cell.x - kMargin, cell.height}, parameter.name, 11,
                colours::kMuted);
    if (parameter.entries.empty())
      return canvas.text({place.x, place.y, place.width - kMargin, place.height}, number_text(value, parameter.unit),
                         12, is_held ? colours::kAccent : colours::kText, Side::kRight);
    const auto entry = std::min(static_cast<std::size_t>(value), parameter.entries.size() - 1);
    canvas.text({place.x + 2 * kArrow, place.y, place.width - 4 * kArrow, place.height}, parameter.entries[entry], 12,
                colours::kText, Side::kMiddle);
    const float y = place.y + place.height / 2;
    for (const float side : {-1.0f, 1.0f}) {
      const float x = side < 0 ? place.x + kArrow : place.x + place.width - kArrow;
      canvas.line(x - 2 * side, y - 4, x + 2 * side, y, colours::kMuted, 1.6f);
      canvas.line(x + 2 * side, y, x - 2 * side, y + 4, colours::kMuted, 1.6f);
    }
  }

  const std::vector<WindowParameter>& tuning_;
  std::vector<Box> cells_;
  bool is_outside_ = false;
};

}  // namespace contactspline
