// SPDX-License-Identifier: MIT
// The models that a fit chooses among: a law and a loss, and which of the common parameters each of them frees.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace contactspline {

/// The parameters of all models, in the order of the fit: those of the law, ln of the
/// frequency [Hz] of a low-pass before the data, then the mass and the gain, ln of kg and
/// of the output, which are no part of a material: a fit of levels may free them.
enum FitParameter {
  kLogForce,
  kExponent,
  kHuntCrossley,
  kWeight,
  kLogTime,
  kLogCore,
  kDepth,
  kLogLowPass,
  kLawParameters,
  kLogMass = kLawParameters,
  kLogGain,
  kFitParameters
};

/// The value of kLogCore without a core.
inline constexpr double kNoCore = -1000;

/// The value of kLogLowPass without a low-pass that is fitted.
inline constexpr double kNoLowPass = 1000;

/// One row of the table of laws or of losses.
struct ModelRow {
  const char* name;
  const char* words;                ///< for reports
  std::vector<FitParameter> frees;  ///< the others stay at `fixed`
};

inline constexpr double kHertzExponent = 1.5;
inline constexpr const char* kLayers = "layers";

/// Laws: power, hertz, layers. All have a force at a reference compression; Hertz's exponent is 1.5. Layers are a
/// power law and, from a depth on, a hard core with Hertz's exponent beside it.
[[nodiscard]] const std::vector<ModelRow>& laws();

/// Losses: none, hunt_crossley, memory (Stulov's law).
[[nodiscard]] const std::vector<ModelRow>& losses();

[[nodiscard]] std::vector<std::string> names_of_laws();
[[nodiscard]] std::vector<std::string> names_of_losses();

}  // namespace contactspline
