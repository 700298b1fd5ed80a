// SPDX-License-Identifier: MIT
// Levels of the partials of struck strings, by the model that plays: HammerString with a spline of the felt.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "contactspline/models/hammer_string.hpp"
#include "fit/measured_impacts.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/contact_spline.hpp"

namespace contactspline::testing {

/// A string of 60 cm with its strike at a place, and levels of the displacement of its modes.
inline StruckResonator string_struck_at(double position, double mass_kg, double frequency_hz) {
  const double length = 0.6, speed = 2 * length * frequency_hz;
  const StiffString body{length, mass_kg, mass_kg / length * speed * speed, 0.005, {0.5, 2e-4}};
  StruckResonator struck{{}, {}, true, {}};
  for (const ResonatorMode& mode : modes_of({"s", "", body, {position * length}, {0.01}, 4096}, 20000).modes) {
    const auto& [w, decay, mass] = mode.mode;
    struck.modes.push_back({w, decay, mass, mode.strike_shape});
    struck.output_per_m.push_back(1);
  }
  return struck;
}

constexpr double kRate = 768000;

/// use(string, modes): a string at the first touch of a hammer.
template <typename Use>
auto with_string(const TrueMaterial& felt, double speed, const StruckResonator& struck, Use use) {
  const double reach = felt.law.max_compression(felt.mass_kg, 1.1 * speed);
  const auto table = segment_table(uniform_spline({"felt", "", felt.law, {}, {1024, reach}}, "felt"));
  std::vector<Mode> modes;
  ModeShapes<double> strike(struck.modes.size());
  for (std::size_t i = 0; i < struck.modes.size(); ++i) {
    const auto& [w, decay, mass, shape] = struck.modes[i];
    modes.push_back({w, decay, mass});
    strike[i] = shape;
  }
  HammerString<double> string(table, modes, strike, kRate);
  string.strike(speed, 0);
  return use(string, modes);
}

/// ln of the amplitude of each mode after a blow without loss, counted back to the first touch.
inline std::vector<double> log_amplitudes(const TrueMaterial& felt, double speed, const StruckResonator& struck) {
  return with_string(felt, speed, struck, [&](auto& string, const std::vector<Mode>& modes) {
    int ticks = 0;
    for (int quiet = 0; quiet < kRate / 100; ++ticks) {
      string.tick({.hammer_mass_kg = felt.mass_kg});
      quiet = string.force() > 0 ? 0 : quiet + 1;
    }
    std::vector<double> before, logs;
    for (std::size_t i = 0; i < modes.size(); ++i) before.push_back(string.string().displacement(i));
    string.tick({.hammer_mass_kg = felt.mass_kg});
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto& [w, decay, mass] = modes[i];
      const double after = string.string().displacement(i) * std::exp(decay / kRate);
      const double b = (after - before[i] * std::cos(w / kRate)) / std::sin(w / kRate);
      logs.push_back(std::log(std::hypot(before[i], b)) + decay * ticks / kRate);
    }
    return logs;
  });
}

/// The force of a blow at 48 kHz, with noise in parts of its largest value.
inline Pulse struck_pulse(const TrueMaterial& felt, double speed, const StruckResonator& struck, double noise,
                          Random& random) {
  constexpr std::size_t kTicks = 16, kBefore = 300, kSamples = 900;
  Pulse pulse{"pulse", {}, std::vector<double>(kBefore, 0.0), speed, true};
  with_string(felt, speed, struck, [&](auto& string, const auto&) {
    for (auto tick = static_cast<std::size_t>(random.between(0, kTicks)); pulse.force_n.size() < kSamples; ++tick) {
      string.tick({.hammer_mass_kg = felt.mass_kg, .felt = {.loss_s_per_m = felt.loss_s_per_m}});
      if (tick % kTicks == 0) pulse.force_n.push_back(string.force());
    }
    return 0;
  });
  const double deviation = noise * std::ranges::max(pulse.force_n);
  for (double& force : pulse.force_n) {
    pulse.time_s.push_back(static_cast<double>(pulse.time_s.size()) * kTicks / kRate);
    force += deviation * normal(random);
  }
  return contact_window(pulse, std::vector<std::size_t>(kSamples), felt.mass_kg);
}

/// Blows at speeds of equal ratios: the levels of the lowest partials that sound, with noise [dB] and a gain.
inline std::vector<Blow> blows_on(const StruckResonator& struck, const TrueMaterial& felt, int count, double slowest,
                                  double fastest, std::size_t partials, double noise_db, Random& random) {
  std::vector<Blow> blows;
  for (int i = 0; i < count; ++i) {
    Blow blow{"blow_" + std::to_string(i), {}, slowest * std::pow(fastest / slowest, i / (count - 1.0))};
    const auto logs = log_amplitudes(felt, *blow.speed_m_per_s, struck);
    for (std::size_t mode = 0; mode < std::min(partials, logs.size()); ++mode)
      if (struck.sounds(mode))
        blow.levels.push_back({mode, 40 + kDecibelsPerNeper * logs[mode] + noise_db * normal(random)});
    blows.push_back(std::move(blow));
  }
  return blows;
}

}  // namespace contactspline::testing
