// SPDX-License-Identifier: MIT
// What was measured of impacts on a rigid wall, and the models that may describe it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/contact/measured_curve.hpp"
#include "generator/material/contact_reader.hpp"

namespace contactspline {

/// The force of one impact over time: the contact, and a fourth of its duration before and after it.
struct Pulse {
  std::string file;
  std::vector<double> time_s, force_n;
  std::optional<double> speed_m_per_s;  ///< fitted if it is not known
};

/// One row of a table over the impact speed.
struct ImpactRow {
  std::string file;
  double speed_m_per_s;
  std::optional<double> duration_s, max_force_n, restitution;
};

/// Force against compression: slow (speeds of 0) or in an impact.
struct MeasuredForce {
  std::string file;
  std::vector<CurveSample> samples;
  std::optional<double> impact_speed_m_per_s;
};

struct Measurements {
  std::string name, description;
  double mass_kg;
  std::vector<Pulse> pulses;
  std::vector<ImpactRow> rows;
  std::vector<MeasuredForce> curves;
  std::vector<std::string> laws, losses;  ///< to choose among; empty: all
  std::vector<std::string> files;         ///< that were read beside the fit file
};

/// Reads a fit file (docs/how-to/fit.md) and the data it names, and looks for what cannot be right: no contact, a
/// saturated sensor, a wrong unit. `file` appears in messages and begins the paths of the data in them. Throws
/// BadInput.
[[nodiscard]] Measurements parse_measurements(std::string_view text, std::string_view file, const ReadFile& read);

}  // namespace contactspline
