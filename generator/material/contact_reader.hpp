// SPDX-License-Identifier: MIT
// The `contact` object of a material file: a contact law and its loss.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/step/memory.hpp"
#include "generator/contact/contact_law.hpp"
#include "generator/contact/measured_curve.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Returns the text of a file that another file names by its path relative to itself. Throws BadInput.
using ReadFile = std::function<std::string(const std::string& path)>;

/// The text of the file at `path`, which the value of `key` in `file` names. Throws BadInput, with `file` and `key`
/// before what `read` says.
[[nodiscard]] std::string read_for_key(std::string_view file, std::string_view key, const std::string& path,
                                       const ReadFile& read);

/// ReadFile for the shipped materials, which have no folder: the text of a shipped curve. Throws BadInput.
[[nodiscard]] std::string shipped_file(const std::string& path);

struct Contact {
  ContactLaw law;
  double loss_s_per_m;  ///< Hunt-Crossley loss: force F(y) (1 + loss dy/dt)
  std::optional<Measurement> measured;
  std::vector<Memory> memories = {};
};

/// Reads the `contact` object of a material. `file` is the path of the material, for the paths of its curves in
/// messages; `read` reads the curves. Throws BadInput.
[[nodiscard]] Contact read_contact(const JsonObject& material, std::string_view file, const ReadFile& read);

}  // namespace contactspline
