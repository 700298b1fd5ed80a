// SPDX-License-Identifier: MIT
// The figure of a bouncing mass: height and force over time, and the first contact.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"

namespace contactspline {
namespace {

constexpr std::ptrdiff_t kMaxContactPoints = 4096;

// Time [ms] and force [N] of the first contact, from a quarter of its duration before to a quarter after it.
Data first_contact_data(const MassBarrierMotion& motion) {
  const auto& f = motion.force_n;
  const auto in_contact = [](double force) { return force > 0; };
  const auto begin = std::ranges::find_if(f, in_contact);
  const auto end = std::find_if_not(begin, f.end(), in_contact);
  const auto margin = (end - begin) / 4 + 2;
  const auto from = std::max(f.begin(), begin - std::min(margin, begin - f.begin()));
  const auto to = end + std::min(margin, f.end() - end);
  const auto step = 1 + (to - from) / kMaxContactPoints;  // a mass that comes to rest stays in contact
  Data data("contact");
  for (auto sample = from; sample < to; sample += std::min(step, to - sample))
    data.add({1e3 * static_cast<double>(sample - begin) / motion.sample_rate_hz, *sample});
  return data;
}

std::string panel(const Data& data, const std::string& x_label, const std::string& y_label, std::string_view style) {
  Interval time = data.range(1);
  time.include(0);
  return linear_axis('x', time, x_label) + linear_axis('y', data.range(2), y_label) +
         fmt::format("plot ${} using 1:2 with {}\n", data.name(), style);
}

}  // namespace

std::string figure_of(const MassBarrierMotion& motion, const std::string& title, FigureFormat format) {
  const bool touches = std::ranges::any_of(motion.force_n, [](double force) { return force > 0; });
  const Data height = envelope<double>("height", motion.displacement_m, -1e3, motion.sample_rate_hz);
  const Data force = envelope<double>("force", motion.force_n, 1, motion.sample_rate_hz);
  const Data contact = first_contact_data(motion);
  std::string script = height.text() + force.text() + contact.text() + heading(touches ? kThreePanels : kOnePanel) +
                       "unset key\n" + panel(height, "time [s]", "height [mm]", "lines lt 2");
  if (touches)
    script += panel(force, "time [s]", "contact force [N]", "lines lt 3") +
              panel(contact, "time from the first contact [ms]", "contact force [N]", "linespoints lt 3 pt 7 ps 0.3");
  return draw(script + "unset multiplot", title, FigureKind::kSound, format);
}

}  // namespace contactspline
