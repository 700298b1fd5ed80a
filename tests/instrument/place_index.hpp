// SPDX-License-Identifier: MIT
// Finds a place of an instrument file among the points of its network.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "generator/instrument/instrument.hpp"

namespace contactspline::testing {

/// The number of the first point of a place.
inline std::size_t place_index(const InstrumentModel& model, const std::string& name) {
  std::size_t index = 0;
  for (const InstrumentPlace& place : model.places) {
    if (place.name == name) return index;
    index += place.points.size();
  }
  throw std::runtime_error(name);
}

}  // namespace contactspline::testing
