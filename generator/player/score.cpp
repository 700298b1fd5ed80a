// SPDX-License-Identifier: MIT
#include "generator/player/score.hpp"

#include <array>
#include <limits>

#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

constexpr Range kMass{1e-6, 100};
constexpr Range kPlace{0, 100};
constexpr Range kDecay{0, 1e5};
constexpr Range kRatio{1e-6, 1e6};
constexpr Range kLoss{0, 1e3};
constexpr Range kHeight{-0.1, 0.1};
constexpr Range kForce{-1e3, 1e3};
constexpr Range kStiffness{0, 1e9};
constexpr Range kResistance{0, 1e6};
constexpr Range kVibrato{0, 0.1};
constexpr Range kVibratoRate{0, 100};

constexpr std::array kHammerControls = {
    ControlName{"hammer_mass_kg", kMass, kUnset}, ControlName{"stiffness_ratio", kRatio, 1},
    ControlName{"loss_s_per_m", kLoss, 0},        ControlName{"damping_per_s", kDecay, 0},
    ControlName{"strike_m", kPlace, kUnset},      ControlName{"bend_cents", kTuningCents, 0}};

constexpr std::array kSlideControls = {ControlName{"place_m", kPlace, kUnset},
                                       ControlName{"slide_mass_kg", kMass, kUnset},
                                       ControlName{"hand_force_n", kForce, 0},
                                       ControlName{"hand_stiffness_n_per_m", kStiffness, 0},
                                       ControlName{"hand_resistance_n_s_per_m", kResistance, 0},
                                       ControlName{"rest_resistance_n_s_per_m", kResistance, 0},
                                       ControlName{"pluck_force_n", kForce, 0},
                                       ControlName{"stiffness_ratio", kRatio, 1},
                                       ControlName{"loss_s_per_m", kLoss, 0},
                                       ControlName{"vibrato_m", kVibrato, 0},
                                       ControlName{"vibrato_hz", kVibratoRate, 0}};

constexpr std::array kFretControls = {
    ControlName{"place_m", kPlace, kUnset},    ControlName{"gap_m", kHeight, kUnset},
    ControlName{"pluck_force_n", kForce, 0},   ControlName{"damping_per_s", kDecay, 0},
    ControlName{"stiffness_ratio", kRatio, 1}, ControlName{"loss_s_per_m", kLoss, 0}};

constexpr std::array kPedals = {ControlName{"sustain", {0, 1}, 0}, ControlName{"sostenuto", {0, 1}, 0},
                                ControlName{"una_corda", {0, 1}, 0}};

constexpr const char* kHammerKeys[] = {"hammer_mass_kg", "damper_per_s"};
constexpr const char* kSlideKeys[] = {"pluck_m", "pickup_m", "height_m"};
constexpr const char* kFretKeys[] = {"pluck_m", "pickup_m"};

// In the order of Instrument.
constexpr std::array kRules = {
    InstrumentRules{"hammer-string", kHammerControls, "speed_m_per_s", 0, kHammerKeys},
    InstrumentRules{"slide-string", kSlideControls, "pluck_n", SlideStringControl::kPluckForce, kSlideKeys},
    InstrumentRules{"fret-string", kFretControls, "pluck_n", FretStringControl::kPluckForce, kFretKeys},
    InstrumentRules{"instrument", {}, nullptr, 0, {}}};

}  // namespace

std::span<const ControlName> pedal_controls() {
  return kPedals;
}

const InstrumentRules& rules_of(Instrument instrument) {
  return kRules[static_cast<std::size_t>(instrument)];
}

}  // namespace contactspline
