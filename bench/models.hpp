// SPDX-License-Identifier: MIT
// The benchmark models: hammers, strings, and how often the hammer strikes.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/baselines/fd_hammer.hpp"
#include "bench/baselines/power_law_hammer.hpp"
#include "contactspline/materials/felt_c2.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/mb1.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/resonators/string_c2.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/step/contact.hpp"

namespace contactspline::bench {

inline constexpr int kSampleRate = 44100;

/// How a hammer is thrown, and how often. samples_between: between two throws.
struct Workload {
  std::string name;
  int samples_between;
  double speed_m_per_s;
  double distance_m;
  double mass_ratio = 1;  ///< factor of the hammer mass
};

/// A hammer and a string. Without modes the string is a rigid barrier.
struct Model {
  std::string name;
  PowerLawHammer hammer;
  std::vector<Segment<double>> felt;  ///< entry 0 out of contact, as SegmentTable
  double max_compression_m;           ///< to which the felt's table is designed
  std::vector<Mode> modes;
  std::vector<double> strike_shapes, pickup_shapes;
  double press_speed_m_per_s;  ///< speed of the heavy hammer that stays in contact
  std::optional<FdString> fd;

  /// Single notes, a trill, immediate repetition, and permanent contact. In permanent contact the hammer has 1e6
  /// times its mass and is thrown again from the surface every 10 ms, long before it could reverse.
  [[nodiscard]] std::vector<Workload> workloads() const {
    constexpr double kSpeed = 2.5, kDistance = 1e-4;
    return {{"every 100 ms", kSampleRate / 10, kSpeed, kDistance},
            {"every 10 ms", kSampleRate / 100, kSpeed, kDistance},
            {"every 1.36 ms", 60, kSpeed, kDistance},
            {"permanent contact", kSampleRate / 100, press_speed_m_per_s, 0, 1e6}};
  }
};

namespace detail {

template <typename Felt>
Model model_of(std::string name, double hammer_kg, double press_speed_m_per_s) {
  const auto& table = segments_of<Felt, double>;
  return {std::move(name),
          {Felt::stiffness_n_per_m_alpha, Felt::exponent, hammer_kg},
          {table.begin(), table.end()},
          Felt::max_compression_m,
          {},
          {},
          {},
          press_speed_m_per_s,
          {}};
}

template <typename String>
Model with_string(Model model, std::size_t modes = String::modes) {
  const auto& all = modes_in<String>;
  model.modes.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(modes));
  model.strike_shapes.assign(String::strike_shapes.begin(),
                             String::strike_shapes.begin() + static_cast<std::ptrdiff_t>(modes));
  model.pickup_shapes.assign(String::pickup_shapes.begin(),
                             String::pickup_shapes.begin() + static_cast<std::ptrdiff_t>(modes));
  return model;
}

}  // namespace detail

inline Model mb1() {
  return detail::model_of<materials::mb1>("MB1", 0.01, 3e-3);
}
inline Model c4() {
  Model model = detail::with_string<resonators::string_c4>(detail::model_of<materials::felt_c4>("C4", 0.00297, 0.05));
  model.fd = FdString::c4;
  return model;
}
inline Model c2() {
  Model model = detail::with_string<resonators::string_c2>(detail::model_of<materials::felt_c2>("C2", 0.0049, 0.05));
  model.fd = FdString::c2;
  return model;
}
/// C2 with the lowest 80 of its modes.
inline Model eighty_modes() {
  return detail::with_string<resonators::string_c2>(detail::model_of<materials::felt_c2>("80 modes", 0.0049, 0.05),
                                                    80);
}
inline std::vector<Model> models() {
  return {mb1(), c4(), c2(), eighty_modes()};
}

/// The C4 hammer on a string with a given number of modes, evenly spaced up to 22 kHz.
inline Model c4_with_modes(std::size_t modes) {
  Model model = c4();
  model.fd = {};
  model.modes.clear();
  model.strike_shapes.clear();
  model.pickup_shapes.clear();
  for (std::size_t i = 1; i <= modes; ++i) {
    const double number = static_cast<double>(i);
    model.modes.push_back({2 * std::numbers::pi * 22000 * number / static_cast<double>(modes), 1, 0.002});
    model.strike_shapes.push_back(std::sin(0.12 * std::numbers::pi * number));
    model.pickup_shapes.push_back(std::sin(0.4 * std::numbers::pi * number));
  }
  return model;
}

/// The same model with a given number of felt segments: power-law forces at equally spaced knots, linear between
/// them.
inline Model with_segments(Model model, std::size_t segments) {
  const double width = model.max_compression_m / static_cast<double>(segments);
  const auto force = [&](std::size_t j) {
    return model.hammer.stiffness_n_per_m_alpha * std::pow(static_cast<double>(j) * width, model.hammer.exponent);
  };
  std::vector<Segment<double>> felt = {{0, 0, 0, 0}};
  double energy = 0;
  for (std::size_t j = 0; j < segments; ++j) {
    felt.push_back({static_cast<double>(j) * width, energy, force(j), (force(j + 1) - force(j)) / (2 * width)});
    energy += width * (force(j) + force(j + 1)) / 2;
  }
  model.felt = std::move(felt);
  return model;
}

}  // namespace contactspline::bench
