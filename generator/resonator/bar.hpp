// SPDX-License-Identifier: MIT
// The modes of a bar with free, clamped or supported ends, in closed form.
#pragma once

#include <array>
#include <memory>

#include "contactspline/data/stiff_string.hpp"

namespace contactspline {

class UndercutBar;  // undercut_bar.hpp

/// How a bar is held at an end: not at all; by a clamp, which holds place and direction; or by a support, which holds
/// the place alone.
enum class BarEnd { kFree, kClamped, kSupported };

/// Euler-Bernoulli bar, of uniform section unless it is undercut: w0^2 = EI beta^4/mu. Place: x [m] from the first
/// end. Rigid motions, of which a free bar has two and one on a single support has one, are no modes here.
struct Bar {
  double length_m;
  double mass_kg;
  double bending_stiffness_n_m2;
  Losses losses;
  std::array<BarEnd, 2> ends = {BarEnd::kFree, BarEnd::kFree};
  std::shared_ptr<const UndercutBar> undercut = {};  ///< whose modes these are, if it has an arch
};

/// beta L of mode i = 1, 2, ...: cosh cos = 1 between two free or two clamped ends, cosh cos = -1 between a clamped
/// and a free one, tan = tanh where one end is supported, sin = 0 where both are.
[[nodiscard]] double wavenumber_times_length(const Bar& bar, int i);

/// Mode i = 1, 2, ... of the uniform bar without losses. The modal mass is M/4, and M/2 between two supports.
[[nodiscard]] UndampedMode undamped_mode(const Bar& bar, int i);

/// Shape of mode i of the uniform bar with this wavenumber [1/m] at x [m]: sin(beta x) between two supports;
/// otherwise it is 1 or -1 at a free end, and shape''/beta^2 is 1 or -1 at a clamped one. Right to rounding for any
/// i.
[[nodiscard]] double shape_at(const Bar& bar, int i, double wavenumber_per_m, double x_m);

}  // namespace contactspline
