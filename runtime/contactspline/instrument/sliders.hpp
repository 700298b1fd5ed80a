// SPDX-License-Identifier: MIT
// How the parameters and events of an instrument are laid out where sliders and buttons show them.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/parameter.hpp"

namespace contactspline {

/// A button of an event, or the slider of a parameter.
struct Slider {
  bool is_button;
  std::size_t number;  ///< of the event or the parameter
};

/// For each event its button and the slider of its parameter; then all other parameters.
template <typename Text>
[[nodiscard]] std::vector<Slider> sliders_of(std::span<const BasicParameter<Text>> parameters,
                                             std::span<const BasicEvent<Text>> events) {
  std::vector<Slider> sliders;
  std::vector<bool> is_shown(parameters.size());
  for (std::size_t e = 0; e < events.size(); ++e) {
    sliders.push_back({true, e});
    if (is_shown[events[e].parameter]) continue;
    sliders.push_back({false, events[e].parameter});
    is_shown[events[e].parameter] = true;
  }
  for (std::size_t p = 0; p < parameters.size(); ++p)
    if (!is_shown[p]) sliders.push_back({false, p});
  return sliders;
}

/// Step of a slider.
template <typename Text>
[[nodiscard]] double slider_step(const BasicParameter<Text>& parameter) {
  const auto [min, max] = parameter.slider;
  return parameter.scale == Scale::kLogarithmic ? min / 10 : (max - min) / 1e4;
}

/// The key of MIDI that presses the button of an event: those from the middle C on.
[[nodiscard]] constexpr int key_of_button(std::size_t event) {
  return 60 + static_cast<int>(event);
}

}  // namespace contactspline
