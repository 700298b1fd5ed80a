// SPDX-License-Identifier: MIT
// The `contact` object of a material file: one of the laws, and what is lost.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/curve.hpp"
#include "generator/json_input.hpp"
#include "generator/potential.hpp"

namespace contactspline {

/// Text of a file that another one names, by its path relative to that one. Throws BadInput.
using ReadFile = std::function<std::string(const std::string& path)>;

/// A curve that ships, for a material that has no folder. Throws BadInput.
[[nodiscard]] std::string shipped_file(const std::string& path);

/// A curve as measured, for pictures and reports.
struct Measurement {
  std::string file;  ///< as the material names it
  std::vector<CurveSample> samples;
};

struct Contact {
  Potential potential;
  double loss_s_per_m;  ///< Hunt-Crossley loss: force F(y) (1 + loss dy/dt)
  std::optional<Measurement> measured;
};

/// Reads `contact` of a material. `file`, the material's, tells where curves lie in messages. Throws BadInput.
[[nodiscard]] Contact read_contact(const JsonObject& material, std::string_view file, const ReadFile& read);

}  // namespace contactspline
