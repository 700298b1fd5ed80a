// SPDX-License-Identifier: MIT
// What connections move, and how stiff contacts may be on it.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "generator/instrument/instrument_draft.hpp"

namespace contactspline {

/// The effective masses of the points of the places that connections may move.
class MovedMasses {
 public:
  explicit MovedMasses(const InstrumentDraft& draft) : draft_(draft) {}

  /// Adds a place. A connection moves what it holds, and no less than the lightest mass of a file.
  void add(const JsonObject& json, std::size_t place);
  /// No contact is too stiff for the masses that it moves, at this stiffness ratio. key: what makes it stiffer.
  void check_stiffness(const JsonObject& json, const std::string& key, const ConnectionGroup& group,
                       double ratio) const;
  /// Contacts are not too stiff where a control moves their place or makes their mass lightest.
  void check_lightest(const JsonObject& json, const ControlTargets& control, double min_mass_kg);

 private:
  [[nodiscard]] double largest_ratio(const ConnectionGroup& group) const;
  [[nodiscard]] std::size_t place_of_mass(std::size_t body) const;

  const InstrumentDraft& draft_;
  std::map<std::size_t, std::vector<double>> masses_kg_;
};

}  // namespace contactspline
