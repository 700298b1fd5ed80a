// SPDX-License-Identifier: MIT
// A knob: the name of a parameter, an arc for its value, the value with its unit.
#pragma once

#include <algorithm>
#include <string>

#include "window/canvas.hpp"
#include "window/window_source.hpp"

namespace contactspline {

/// A name in one line, or in two that are about as long.
[[nodiscard]] inline std::pair<std::string, std::string> two_lines(const std::string& name) {
  std::size_t best = std::string::npos;
  const auto longer = [&](std::size_t space) { return std::max(space, name.size() - space - 1); };
  for (std::size_t space = name.find(' '); space != std::string::npos; space = name.find(' ', space + 1))
    if (best == std::string::npos || longer(space) < longer(best)) best = space;
  if (best == std::string::npos) return {name, ""};
  return {name.substr(0, best), name.substr(best + 1)};
}

/// box: at least 90 high.
inline void draw_knob(Canvas& canvas, const Box& box, const WindowParameter& parameter, double value, bool is_held) {
  constexpr float kRadius = 19, kFrom = 2.356f, kSweep = 4.712f, kNameSize = 11, kLine = 13;
  const Box text = box.inner(2);
  const auto name_line = [&](float y, const std::string& words) {
    canvas.text({text.x, box.y + y, text.width, kLine}, words, kNameSize, colours::kMuted, Side::kMiddle);
  };
  if (canvas.width_of(parameter.name, kNameSize) <= text.width) {
    name_line(13, parameter.name);
  } else {
    const auto [first, second] = two_lines(parameter.name);
    name_line(0, first);
    name_line(13, second);
  }
  const float x = box.x + box.width / 2, y = box.y + 50;
  const float part = static_cast<float>(parameter.scale.part_of(value)), angle = kFrom + kSweep * part;
  canvas.arc(x, y, kRadius, kFrom, kFrom + kSweep, colours::kLine, 4);
  // From 0 where the range has both signs, else from the left.
  const double zero = parameter.scale.min < 0 && parameter.scale.max > 0 ? parameter.scale.part_of(0) : 0;
  const float origin = kFrom + kSweep * static_cast<float>(zero);
  if (std::abs(angle - origin) > 0.01f)
    canvas.arc(x, y, kRadius, std::min(origin, angle), std::max(origin, angle), colours::kAccent, 4);
  canvas.disc(x, y, kRadius - 6, is_held ? colours::kLine : colours::kPanel);
  const float cosine = std::cos(angle), sine = std::sin(angle);
  canvas.line(x + 4 * cosine, y + 4 * sine, x + 12 * cosine, y + 12 * sine, colours::kText, 2.5f);
  canvas.text({text.x, box.y + 74, text.width, 14}, number_text(value, parameter.unit), 12, colours::kText,
              Side::kMiddle);
}

}  // namespace contactspline
