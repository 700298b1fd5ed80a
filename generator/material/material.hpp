// SPDX-License-Identifier: MIT
// A material: a contact law, a range of impacts and the spline that is wanted for them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/step/memory.hpp"
#include "generator/contact/contact_law.hpp"
#include "generator/contact/measured_curve.hpp"

namespace contactspline {

/// The impacts that the spline is designed for: a mass on a rigid barrier, over a range of speeds.
struct Impact {
  double mass_kg;
  double max_speed_m_per_s;
  double min_speed_m_per_s;
};

/// How knots are placed (docs/how-it-works/knots.md): at equal distances, in geometric progression, or for the
/// smallest error.
enum class Knots { uniform, graded, optimal };

/// The error that optimal knots minimise and that a tolerance bounds: the worst relative error of the contact
/// duration over the impacts, the worst error of the force, relative to the largest force, or the error of the
/// spectrum of the impacts' force (spectrum_error.hpp).
enum class ErrorOf { contact_duration, force, spectrum };

/// Largest number of segments for which forces are fitted to the contact duration, and for `optimal` knots.
constexpr int kMaxFittedSegments = 128;

/// A spline over [0, max_compression_m].
struct SplineDesign {
  int segments;  ///< 0 if `tolerance` is given: then the design finds the smallest number
  double max_compression_m;
  Knots knots = Knots::uniform;
  ErrorOf minimise = ErrorOf::contact_duration;
  double tolerance = 0;  ///< 0 if `segments` is given; in decibels if `minimise` is the spectrum
};

/// The simulation whose time-step error a spline compensates (docs/how-it-works/knots.md).
struct Compensation {
  double sample_rate_hz;
  double mass_kg;  ///< mass of the free body that meets the rigid barrier or the other body
};

/// Range of exponents for which a material is also emitted as a family (exponent_family.hpp).
struct LiveExponents {
  double min, max;
  int members;  ///< number of splines, at equal steps of the exponent
};

struct Material {
  std::string name;         ///< lower-case identifier; names files and code
  std::string description;  ///< one line, may be empty
  ContactLaw contact;
  std::optional<Impact> impact;
  SplineDesign spline;
  double loss_s_per_m = 0;                   ///< Hunt-Crossley loss: force F(y) (1 + loss dy/dt)
  std::optional<Measurement> measured = {};  ///< the samples from which `contact` was smoothed
  std::optional<Compensation> compensation = {};
  std::optional<LiveExponents> live_exponent = {};
  std::vector<Memory> memories = {};  ///< at most kMaxMemories; then `contact` is the force of a fast blow
};

/// The impacts that the spline is designed for and whose errors are measured: without loss or memory. A felt with
/// memory is compressed as far as by a mass that its slow stiffness stops, so the impacts have this mass; the slowest
/// one is as short as the fast stiffness makes it.
[[nodiscard]] Impact elastic_impact(const Impact& impact, const std::vector<Memory>& memories);
[[nodiscard]] Impact elastic_impact(const Material& material);

/// The description of a material, resonator, keyboard or instrument, or its name if it has none.
template <typename Described>
[[nodiscard]] const std::string& title_of(const Described& described) {
  return described.description.empty() ? described.name : described.description;
}

/// Memories as a list in JSON: [{"weight": 0.5, "relaxation_time_s": 1e-05}].
[[nodiscard]] std::string json_of(const std::vector<Memory>& memories);

/// The contact law as one line of text: its formula, or where the samples come from.
[[nodiscard]] std::string law_text(const Material& material);

/// "power law", "sum", "series" or "measured".
[[nodiscard]] std::string_view name_of_law(const Material& material);

/// "uniform", "graded" or "optimal".
[[nodiscard]] std::string_view name_of(Knots knots);

/// "contact_duration", "force" or "spectrum".
[[nodiscard]] std::string_view name_of(ErrorOf error);

}  // namespace contactspline
