// SPDX-License-Identifier: MIT
// Macros: knobs that are named for what one hears, over the table of parameters. An instrument has those that have
// something to move.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "contactspline/data/parameter.hpp"
#include "host_values.hpp"

namespace contactspline {

/// Where a macro moves its parameters at 1; at -1 it moves them to the other end of their sliders.
enum class MacroTo : unsigned char {
  kMax,      ///< to the end of the slider
  kFar,      ///< to the end that is farther from 0
  kNearest,  ///< to the end that is nearest to the first value
};

/// What a macro moves: the parameters with these endings, and the speeds of blows and forces of plucks if is_played.
struct Macro {
  Parameter parameter;  ///< as hosts see it
  std::array<std::string_view, 2> endings;
  bool is_played;
  MacroTo to;
  double taper;     ///< the part of the way is the macro to this power: a damping asks for a fine beginning
  double most = 1;  ///< of the way: at the very end of a string a blow is silent
};

[[nodiscard]] constexpr Parameter macro_parameter(const char* name) {
  return {name, "", {-1, 1}, {-1, 1}, 0};
}

inline constexpr std::array<Macro, 4> kMacros = {
    {{macro_parameter("harder"), {"stiffness_ratio"}, false, MacroTo::kMax, 1},
     {macro_parameter("stronger"), {"normal_force_n", "pluck_n"}, true, MacroTo::kFar, 1},
     {macro_parameter("nearer"), {"strike_m", "bow_place_m"}, false, MacroTo::kNearest, 1, 0.98},
     {macro_parameter("shorter"), {"damping_per_s"}, false, MacroTo::kMax, 3}}};

/// Does a macro move this parameter?
[[nodiscard]] inline bool is_moved(const Macro& macro, std::size_t parameter, std::span<const Parameter> parameters,
                                   std::span<const Event> events) {
  const std::string_view name = parameters[parameter].name;
  if (std::ranges::any_of(macro.endings, [&](std::string_view end) { return !end.empty() && name.ends_with(end); }))
    return true;
  return macro.is_played && std::ranges::any_of(events, [&](const Event& event) {
           return event.parameter == parameter && event.kind != EventKind::kBow;
         });
}

/// A value that a macro at `amount`, -1 to 1, has moved by that part of the rest of its slider; the value itself at
/// 0.
[[nodiscard]] inline double moved_by(const Macro& macro, double amount, const Parameter& parameter, double value) {
  const auto& [min, max] = parameter.slider;
  if (amount == 0) return value;
  const HostScale scale{min, max, parameter.scale == Scale::kLogarithmic};
  const bool is_to_min = macro.to == MacroTo::kFar       ? std::abs(min) > std::abs(max)
                         : macro.to == MacroTo::kNearest ? scale.part_of(parameter.initial) < 0.5
                                                         : false;
  const double end = (amount > 0) == is_to_min ? min : max;
  const double way = macro.most * std::pow(std::abs(amount), macro.taper);
  if (way >= 1) return end;
  return value_at(parameter, std::lerp(scale.part_of(value), end == max ? 1.0 : 0.0, way));
}

/// A macro of an instrument: its row and the parameters that it moves.
struct MacroOf {
  const Macro* macro;
  std::vector<std::size_t> moved;  ///< among `numbers`
};

/// The macros of an instrument. numbers: which of its parameters hosts see.
[[nodiscard]] inline std::vector<MacroOf> macros_of(std::span<const Parameter> parameters,
                                                    std::span<const Event> events,
                                                    std::span<const std::size_t> numbers) {
  std::vector<MacroOf> macros;
  for (const Macro& macro : kMacros) {
    MacroOf of{&macro, {}};
    for (std::size_t p = 0; p < numbers.size(); ++p)
      if (is_moved(macro, numbers[p], parameters, events)) of.moved.push_back(p);
    if (!of.moved.empty()) macros.push_back(std::move(of));
  }
  return macros;
}

}  // namespace contactspline
