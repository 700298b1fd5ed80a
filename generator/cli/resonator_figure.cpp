// SPDX-License-Identifier: MIT
// The figure of a resonator: decay and shapes of its modes over their frequencies.
#include <fmt/format.h>

#include <numbers>
#include <string>
#include <string_view>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"

namespace contactspline {
namespace {

// Columns: frequency [Hz], decay [1/s], shape at the strike, shape at the pickup.
Data modes_data(const ModeSet& set) {
  Data data("modes");
  for (const ResonatorMode& mode : set.modes)
    data.add({mode.mode.angular_frequency_rad_per_s / (2 * std::numbers::pi), mode.mode.decay_per_s,
              mode.strike_shape, mode.pickup_shape});
  return data;
}

// A decay may be 0.
std::string decay_panel(Interval decays) {
  const std::string label = "decay [1/s]";
  return (decays.low > 0 ? logarithmic_axis('y', between_tics(decays), label)
                         : linear_axis('y', {0, decays.high}, label)) +
         "plot $modes using 1:2 with points lt 4\nunset logscale y\n";
}

std::string shape_panel(const Data& modes, std::size_t column, const std::string& label) {
  Interval shapes = modes.range(column);
  shapes.include(0);
  return linear_axis('y', shapes, label) +
         fmt::format("plot $modes using 1:{0} with impulses lt 2 lw 1, '' using 1:{0} with points lt 4\n", column);
}

}  // namespace

std::string figure_of(const Resonator& resonator, double max_frequency_hz, FigureFormat format) {
  const ModeSet set = modes_of(resonator, max_frequency_hz);
  const Data modes = modes_data(set);
  const auto [lowest, highest] = modes.range(1);
  const std::string script = modes.text() + heading(kThreePanels) + "unset key\nset xzeroaxis lc rgb '#888888'\n" +
                             logarithmic_axis('x', {lowest / 1.1, highest * 1.1}, "frequency [Hz]") +
                             decay_panel(modes.range(2)) + shape_panel(modes, 3, "shape at the strike [1]") +
                             shape_panel(modes, 4, "shape at the pickup [1]") + "unset multiplot";
  return draw(script,
              fmt::format("{}: {} mode{} below {:g} Hz", title_of(resonator), set.modes.size(),
                          set.modes.size() == 1 ? "" : "s", max_frequency_hz),
              FigureKind::kResonator, format);
}

}  // namespace contactspline
