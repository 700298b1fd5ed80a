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

/// The lines of a panel, from its top on: title and value, the curve, words at the ends of its axis.
struct Panel {
  Box box;

  [[nodiscard]] Box plot() const {
    const Box inner = box.inner(12);
    return {inner.x, inner.y + 22, inner.width, inner.height - 42};
  }
  [[nodiscard]] Box title() const {
    const Box inner = box.inner(12);
    return {inner.x, inner.y - 2, inner.width * 0.6f, 16};
  }
  [[nodiscard]] Box value() const {
    const Box inner = box.inner(12);
    return {inner.x + inner.width * 0.6f, inner.y - 2, inner.width * 0.4f, 16};
  }
  [[nodiscard]] Box axis(Side side) const {
    const Box place = plot();
    return {side == Side::kLeft ? place.x : place.x + place.width / 2, place.y + place.height + 6, place.width / 2,
            14};
  }
};

/// The points of a signal in a box: where there are more samples than units of width, the largest and the smallest of
/// each two units.
inline void points_of(std::span<const float> samples, const Box& plot, float low, float high, std::vector<float>& xs,
                      std::vector<float>& ys) {
  xs.clear();
  ys.clear();
  const auto add = [&](std::size_t n) {
    const float part = std::clamp((samples[n] - low) / (high - low), 0.0f, 1.0f);
    xs.push_back(plot.x + plot.width * static_cast<float>(n) / static_cast<float>(samples.size() - 1));
    ys.push_back(plot.y + plot.height * (1 - part));
  };
  const auto columns = static_cast<std::size_t>(plot.width / 2);
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

/// The three panels in a box.
class Plots {
 public:
  void place(const Box& box) {
    constexpr float kGap = 12;
    const float width = box.width - 2 * kGap;
    motion_.box = {box.x, box.y, 0.4f * width, box.height};
    blow_.box = {motion_.box.x + motion_.box.width + kGap, box.y, 0.36f * width, box.height};
    energy_.box = {blow_.box.x + blow_.box.width + kGap, box.y, 0.24f * width, box.height};
  }

  /// What does not change.
  void draw_ground(Canvas& canvas, const WindowTable& table) const {
    draw_panel(canvas, motion_, table.motion, "0", number_text(1000 * ContactFigure::kMotion_s, "ms"));
    draw_panel(canvas, blow_, "contact force, last blow", "0", "");
    draw_panel(canvas, energy_, "energy", number_text(-ContactFigure::kEnergy_s, "s"), "now");
    draw_line(canvas, motion_, 0.5f);
    draw_line(canvas, blow_, 1);
    for (int decade = 2; decade <= kDecades; decade += 2)
      draw_line(canvas, energy_, static_cast<float>(decade) / kDecades);
  }

  void draw(Canvas& canvas, const WindowTable& table, const ContactFigure& figure) {
    draw_motion(canvas, table, figure);
    draw_blow(canvas, figure);
    draw_energy(canvas, figure);
  }

 private:
  static constexpr int kDecades = 6;  // of the energy, below the largest that is shown

  static void draw_panel(Canvas& canvas, const Panel& panel, const std::string& title, const std::string& left,
                         const std::string& right) {
    canvas.lay(panel.box, colours::kPanel);
    canvas.text(panel.title(), title, 12, colours::kMuted);
    canvas.text(panel.axis(Side::kLeft), left, 11, colours::kMuted);
    canvas.text(panel.axis(Side::kRight), right, 11, colours::kMuted, Side::kRight);
  }

  // A line at a part of the height of the curve, from the top on.
  static void draw_line(Canvas& canvas, const Panel& panel, float part) {
    const Box plot = panel.plot();
    const float y = plot.y + plot.height * part;
    canvas.line(plot.x, y, plot.x + plot.width, y, colours::kLine);
  }

  static void draw_value(Canvas& canvas, const Panel& panel, const std::string& value) {
    canvas.text(panel.value(), value, 13, colours::kText, Side::kRight);
  }

  void draw_motion(Canvas& canvas, const WindowTable& table, const ContactFigure& figure) {
    const double full_scale = table.motion_full_scale;
    const double range =
        round_up(std::max(full_scale * static_cast<double>(figure.motion_peak()), 1e-4 * full_scale));
    draw_value(canvas, motion_, "±" + number_text(range, table.motion_unit));
    const auto limit = static_cast<float>(range / full_scale);
    const auto motion = figure.motion();
    if (motion.size() < 2) return;
    points_of(motion, motion_.plot(), -limit, limit, xs_, ys_);
    canvas.curve(xs_, ys_, colours::kAccent, 1.6f);
  }

  void draw_blow(Canvas& canvas, const ContactFigure& figure) {
    const auto force = figure.blow();
    const double time_s = round_up(figure.blow_s() > 0 ? figure.blow_s() : 0.01);
    canvas.text(blow_.axis(Side::kRight), prefixed_text(time_s, "s"), 11, colours::kMuted, Side::kRight);
    if (force.empty()) return;
    draw_value(canvas, blow_, "peak " + prefixed_text(static_cast<double>(figure.blow_peak()), "N"));
    if (force.size() < 2 || !(figure.blow_peak() > 0)) return;
    Box plot = blow_.plot();
    plot.width *= static_cast<float>(figure.blow_s() / time_s);
    points_of(force, plot, 0, figure.blow_peak() * 1.04f, xs_, ys_);
    canvas.curve(xs_, ys_, colours::kAccent, 1.6f);
  }

  void draw_energy(Canvas& canvas, const ContactFigure& figure) {
    const auto& energies = figure.energies();
    if (energies.empty()) return;
    draw_value(canvas, energy_, prefixed_text(static_cast<double>(energies.back()), "J"));
    const float largest = *std::max_element(energies.begin(), energies.end());
    if (!(largest > 0)) return;
    const Box plot = energy_.plot();
    const float top = std::ceil(std::log10(largest));
    xs_.clear();
    ys_.clear();
    const auto steps = static_cast<float>(ContactFigure::kEnergy_s / ContactFigure::kEnergyStep_s);
    for (std::size_t n = 0; n < energies.size(); ++n) {
      const float decades = energies[n] > 0 ? top - std::log10(energies[n]) : kDecades;
      xs_.push_back(plot.x + plot.width * (1 - static_cast<float>(energies.size() - 1 - n) / steps));
      ys_.push_back(plot.y + plot.height * std::clamp(decades / kDecades, 0.0f, 1.0f));
    }
    canvas.curve(xs_, ys_, colours::kAccent, 1.6f);
  }

  Panel motion_{}, blow_{}, energy_{};
  std::vector<float> xs_, ys_;  // of a curve
};

}  // namespace contactspline
