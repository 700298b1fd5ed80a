// SPDX-License-Identifier: MIT
// What was measured of impacts on a rigid wall and of blows on a resonator, and the models that may describe it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "generator/contact/measured_curve.hpp"
#include "generator/fit/strike_model.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// The force of one impact over time: the contact, and as long before and after it.
struct Pulse {
  std::string file;
  std::vector<double> time_s, force_n;
  std::optional<double> speed_m_per_s;     ///< fitted if it is not known
  bool is_struck = false;                  ///< on the resonator, not on a wall
  std::optional<double> low_pass_hz = {};  ///< that the force has passed: of Butterworth's kind
  int low_pass_order = 1;
  std::size_t recorded = 0;  ///< samples that were averaged to these
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

/// One blow on a resonator: what its partials, counted back to the first touch, sound like.
struct Blow {
  struct Level {
    std::size_t mode;
    double level_db;
  };
  std::string file;
  std::vector<Level> levels;
  std::optional<double> speed_m_per_s;  ///< fitted if it is not known
};

/// A known resonator and blows on it of which levels are known. A level is 20 log10 of the amplitude of the
/// displacement of a mode times its `output_per_m`, and a gain that nobody knows.
struct StruckResonator {
  std::vector<StruckMode> modes;
  std::vector<double> output_per_m;
  bool has_common_gain;  ///< one gain for all blows, not one for each
  std::vector<Blow> blows;

  /// By how much the frequency of a partial may differ from that of its mode.
  static constexpr double kMistuned = 0.03;

  /// Is there no node of the mode under the hammer, nor at the pickup?
  [[nodiscard]] bool sounds(std::size_t mode) const { return modes[mode].shape * output_per_m[mode] != 0; }
};

/// What levels are called among the quantities of data, and how many decibels a ratio of e has.
inline constexpr const char* kLevels = "level";
inline constexpr double kDecibelsPerNeper = 8.685889638065037;  // 20/ln 10

/// The masses of bodies that collide in instruments [kg]: narrow enough to catch a wrong unit.
inline constexpr Range kFitMass{1e-7, 1e3};

struct Measurements {
  std::string name, description;
  double mass_kg;  ///< 0 if it is fitted
  std::vector<Pulse> pulses;
  std::vector<ImpactRow> rows;
  std::vector<MeasuredForce> curves;
  std::vector<std::string> laws, losses;  ///< to choose among; empty: all
  std::vector<std::string> files;         ///< that were read beside the fit file
  std::optional<StruckResonator> struck = {};

  [[nodiscard]] bool fits_mass() const { return mass_kg == 0; }
  [[nodiscard]] bool has_blows() const { return struck && !struck->blows.empty(); }
};

}  // namespace contactspline
