// SPDX-License-Identifier: MIT
// A reference string with a slide or a fret, for the tests of both models.
#pragma once

#include <vector>

#include "strings.hpp"

namespace contactspline::testing {

/// Model: a slide-string or a fret-string. The contact is placed at place_m, at a distance from the string at rest.
template <typename Model>
struct PluckedString {
  PluckedString(const StruckString& string, const std::vector<Segment<double>>& contact, double pluck_m,
                double place_m, double distance_m, double rate)
      : modes(audible_modes(string)),
        table(contact),
        shapes(wavenumbers_of(modes)),
        model(table, bare(modes), shapes, pluck_m, rate) {
    model.place(place_m, distance_m);
  }

  [[nodiscard]] ModeShapes<double> shapes_at(double place) const {
    ModeShapes<double> at(shapes.size());
    shapes.at(place, at);
    return at;
  }
  [[nodiscard]] double displacement(const ModeShapes<double>& at) const { return model.string().displacement(at); }
  [[nodiscard]] double displacement_at(double place) const { return displacement(shapes_at(place)); }

  std::vector<ResonatorMode> modes;
  std::vector<Segment<double>> table;
  StringShapes<double> shapes;
  Model model;
};

}  // namespace contactspline::testing
