// SPDX-License-Identifier: MIT
// A material: contact law, range of impacts and the spline asked for, as read from a material file.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "generator/contact_input.hpp"
#include "generator/potential.hpp"

namespace contactspline {

/// Impacts the spline is designed for: a mass on a rigid barrier over a range of speeds.
struct Impact {
  double mass_kg;
  double max_speed_m_per_s;
  double min_speed_m_per_s;
};

/// Where knots lie (docs/knots.md): in equal widths, by geometric progression, or where the error is least.
enum class Knots { uniform, graded, optimal };

/// What optimal knots make least, and a tolerance bounds: the worst error of the contact duration over the impacts,
/// of itself; or that of the force, of the largest one.
enum class ErrorOf { contact_duration, force };

/// A spline over [0, max_compression_m].
struct SplineDesign {
  int segments;  ///< 0 where `tolerance` asks for as few as will do
  double max_compression_m;
  Knots knots = Knots::uniform;
  ErrorOf minimise = ErrorOf::contact_duration;
  double tolerance = 0;  ///< 0 where `segments` is given
};

/// A simulation whose time step a spline makes up for (docs/knots.md).
struct Compensation {
  double sample_rate_hz;
  double mass_kg;                 ///< free mass that meets a rigid barrier, or the other body
  double compliance_m_per_n = 0;  ///< that the simulated bodies lack (missing_compliance)
};

/// Exponents over which a material is also emitted as a family (live_exponent.hpp).
struct LiveExponents {
  double least, most;
  int members;  ///< in equal steps
};

struct Material {
  std::string name;         ///< lower-case identifier; names files and code
  std::string description;  ///< one line, may be empty
  Potential contact;
  std::optional<Impact> impact;
  SplineDesign spline;
  double loss_s_per_m = 0;                   ///< Hunt-Crossley loss: force F(y) (1 + loss dy/dt)
  std::optional<Measurement> measured = {};  ///< what `contact` was smoothed from
  std::optional<Compensation> compensation = {};
  std::optional<LiveExponents> live_exponent = {};
};

/// The contact law in words, without a line end: a formula, or what was measured.
[[nodiscard]] std::string law_text(const Material& material);

/// Parses the text of a material file: JSON with comments, SI units in the key names. `file` stands in
/// messages only; `read` gives the files it names. A max_compression_m left out follows from `impact` by energy;
/// graded and optimal knots always take it from there.
/// Throws BadInput: unknown, duplicate, missing, wrong-typed, non-finite and out-of-range keys are errors.
[[nodiscard]] Material parse_material(std::string_view text, std::string_view file,
                                      const ReadFile& read = shipped_file);

/// "uniform", "graded", "optimal".
[[nodiscard]] std::string_view name_of(Knots knots);

}  // namespace contactspline
