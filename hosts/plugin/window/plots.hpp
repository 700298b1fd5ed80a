// SPDX-License-Identifier: MIT
// The figure of a running contact: motion, force of the last blow, energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "window/canvas.hpp"
#include "window/contact_figure.hpp"
#include "window/window_source.hpp"

namespace contactspline {

/// A panel with a title at its top left and a value at its top right; returns the place for the curve.
inline Box draw_panel(Canvas& canvas, const Box& box, const std::string& title, const std::string& value) {
  canvas.lay(box, colours::kPanel);
  const Box inner = box.inner(12);
  canvas.text({inner.x, inner.y - 2, inner.width * 0.6f, 16}, title, 12, colours::kMuted);
  canvas.text({inner.x + inner.width * 0.6f, inner.y - 2, inner.width * 0.4f, 16}, value, 13, colours::kText,
              Side::kRight);
  return {inner.x, inner.y + 22, inner.width, inner.height - 42};
}

/// Words at both ends of the axis below a curve.
inline void draw_axis(Canvas& canvas, const Box& plot, const std::string& left, const std::string& right) {
  const float y = plot.y + plot.height + 6;
  canvas.text({plot.x, y, plot.width / 2, 14}, left, 11, colours::kMuted);
  canvas.text({plot.x + plot.width / 2, y, plot.width / 2, 14}, right, 11, colours::kMuted, Side::kRight);
}

/// The points of a signal in a box: where there are more samples than units of width, the largest and the smallest of
/// each.
inline void points_of(std::span<const float> samples, const Box& plot, float low, float high, std::vector<float>& xs,
                      std::vector<float>& ys) {
  xs.clear();
  ys.clear();
  const auto add = [&](std::size_t n) {
    const float part = std::clamp((samples[n] - low) / (high - low), 0.0f, 1.0f);
    xs.push_back(plot.x + plot.width * static_cast<float>(n) / static_cast<float>(samples.size() - 1));
    ys.push_back(plot.y + plot.height * (1 - part));
  };
  const auto columns = static_cast<std::size_t>(plot.width);
  if (samples.size() <= 2 * columns) {
    for (std::size_t n = 0; n < samples.size(); ++n) add(n);
    return;
  }
  for (std::size_t c = 0; c < columns; ++c) {
    const auto begin = samples.begin() + static_cast<std::ptrdiff_t>(c * samples.size() / columns);
    const auto end = samples.begin() + static_cast<std::ptrdiff_t>((c + 1) * samples.size() / columns);
    const auto [low_place, high_place] = std::minmax_element(begin, end);
    add(static_cast<std::size_t>(std::min(low_place, high_place) - samples.begin()));
    add(static_cast<std::size_t>(std::max(low_place, high_place) - samples.begin()));
  }
}

/// Draws the three panels.
class Plots {
 public:
  void draw(Canvas& canvas, const Box& box, const WindowTable& table, const ContactFigure& figure) {
    constexpr float kGap = 12;
    const float width = box.width - 2 * kGap;
    const Box motion{box.x, box.y, 0.4f * width, box.height};
    const Box blow{motion.x + motion.width + kGap, box.y, 0.36f * width, box.height};
    const Box energy{blow.x + blow.width + kGap, box.y, 0.24f * width, box.height};
    draw_motion(canvas, motion, table, figure);
    draw_blow(canvas, blow, figure);
    draw_energy(canvas, energy, figure);
  }

 private:
  void draw_motion(Canvas& canvas, const Box& box, const WindowTable& table, const ContactFigure& figure) {
    const double full_scale = table.motion_full_scale;
    const double range =
        round_up(std::max(full_scale * static_cast<double>(figure.motion_peak()), 1e-4 * full_scale));
    const Box plot = draw_panel(canvas, box, table.motion, "±" + number_text(range, table.motion_unit));
    const float middle = plot.y + plot.height / 2;
    canvas.line(plot.x, middle, plot.x + plot.width, middle, colours::kLine);
    const auto limit = static_cast<float>(range / full_scale);
    const auto motion = figure.motion();
    if (motion.size() > 1) points_of(motion, plot, -limit, limit, xs_, ys_);
    if (motion.size() > 1) canvas.curve(xs_, ys_, colours::kAccent, 1.6f);
    draw_axis(canvas, plot, "0", number_text(1000 * ContactFigure::kMotion_s, "ms"));
  }

  void draw_blow(Canvas& canvas, const Box& box, const ContactFigure& figure) {
    const auto force = figure.blow();
    const double time_s = round_up(figure.blow_s() > 0 ? figure.blow_s() : 0.01);
    const std::string peak =
        force.empty() ? "" : "peak " + prefixed_text(static_cast<double>(figure.blow_peak()), "N");
    const Box plot = draw_panel(canvas, box, "contact force, last blow", peak);
    const float floor = plot.y + plot.height;
    canvas.line(plot.x, floor, plot.x + plot.width, floor, colours::kLine);
    draw_axis(canvas, plot, "0", prefixed_text(time_s, "s"));
    if (force.size() < 2 || !(figure.blow_peak() > 0)) return;
    const Box drawn{plot.x, plot.y, plot.width * static_cast<float>(figure.blow_s() / time_s), plot.height};
    points_of(force, drawn, 0, figure.blow_peak() * 1.04f, xs_, ys_);
    canvas.lay_area(xs_, ys_, floor, colours::kAccentArea);
    canvas.curve(xs_, ys_, colours::kAccent, 1.6f);
  }

  // Decades below the largest energy that is shown.
  void draw_energy(Canvas& canvas, const Box& box, const ContactFigure& figure) {
    constexpr float kDecades = 6;
    const auto& energies = figure.energies();
    const float largest = energies.empty() ? 0 : *std::max_element(energies.begin(), energies.end());
    const Box plot = draw_panel(canvas, box, "energy",
                                energies.empty() ? "" : prefixed_text(static_cast<double>(energies.back()), "J"));
    const float floor = plot.y + plot.height;
    for (int decade = 2; decade < static_cast<int>(kDecades); decade += 2) {
      const float y = plot.y + plot.height * static_cast<float>(decade) / kDecades;
      canvas.line(plot.x, y, plot.x + plot.width, y, colours::kLine);
    }
    canvas.line(plot.x, floor, plot.x + plot.width, floor, colours::kLine);
    draw_axis(canvas, plot, number_text(-ContactFigure::kEnergy_s, "s"), "now");
    if (!(largest > 0)) return;
    const float top = std::ceil(std::log10(largest));
    xs_.clear();
    ys_.clear();
    const auto steps = static_cast<float>(ContactFigure::kEnergy_s / ContactFigure::kEnergyStep_s);
    for (std::size_t n = 0; n < energies.size(); ++n) {
      const float decades = energies[n] > 0 ? top - std::log10(energies[n]) : kDecades;
      xs_.push_back(plot.x + plot.width * (1 - static_cast<float>(energies.size() - 1 - n) / steps));
      ys_.push_back(plot.y + plot.height * std::clamp(decades / kDecades, 0.0f, 1.0f));
    }
    canvas.lay_area(xs_, ys_, floor, colours::kAccentArea);
    canvas.curve(xs_, ys_, colours::kAccent, 1.6f);
  }

  std::vector<float> xs_, ys_;
};

}  // namespace contactspline
