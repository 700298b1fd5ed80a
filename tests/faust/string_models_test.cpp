// SPDX-License-Identifier: MIT
// Faust's slide-string and fret-string against the C++ models, on the same emitted strings and material.
#include <numbers>

#include "contactspline/data/friction_materials.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/slide_string.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/resonators/guitar_d3.hpp"
#include "contactspline/resonators/guitar_g3.hpp"
#include "cpp_program.hpp"
#include "support/compare.hpp"

#define FAUSTFLOAT double
#include "bowed_string_model.hpp"
#include "fret_string_model.hpp"
#include "slide_string_model.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 44100;
constexpr std::size_t kSamples = 22050;
constexpr double kStrike = 0.13;  // m, where the emitted strings are struck

using Steel = materials::steel_on_steel;
using Signal = std::vector<double>;

constexpr std::span<const Segment<double>> kSteel(segments_of<Steel, double>);

Signal signal_of(auto value_at) {
  Signal signal;
  for (std::size_t n = 0; n < kSamples; ++n) signal.push_back(value_at(static_cast<double>(n) / kRate));
  return signal;
}

double pluck(double time) {
  return time < 0.01 ? 0.5 - 0.5 * std::cos(100 * std::numbers::pi * time) : 0;
}

template <typename String>
ModeShapes<double> pickup_of(const ModalBank<double>& string) {
  return string.sound_pickup(String::pickup_shapes);
}

// The force of Faust and C++ over the whole time, and Faust's displacement one sample later, each within `tolerance`
// of its peak. Faust has `outputs[0]` displacement, `outputs[1]` force.
void expect_agreement(const std::vector<Signal>& outputs, const Signal& displacement, const Signal& force,
                      double tolerance = 1e-10) {
  const Signal later(outputs[0].begin() + 1, outputs[0].end());
  const Signal earlier(displacement.begin(), displacement.end() - 1);
  EXPECT_TRUE(sequences_within<double>(later, earlier, tolerance));
  EXPECT_TRUE(sequences_within<double>(outputs[1], force, tolerance));
}

// Plucked, then touched by the slide, which glides with vibrato and is lifted off again.
TEST(FaustSlideString, AgreesWithTheRuntime) {
  using String = resonators::guitar_g3;
  const Signal place = signal_of([](double t) { return 0.3 + 0.1 * t + 0.003 * std::sin(35 * t); });
  const Signal press = signal_of([](double t) { return t < 0.4 ? 2.0 : -1.0; });
  const Signal plucked = signal_of(pluck);
  SlideString<double> model(kSteel, modes_in<String>, StringShapes<double>(String::wavenumbers), kStrike, kRate);
  const auto pickup = pickup_of<String>(model.string());
  model.place(place[0], 0);
  Signal displacement, force, height;
  for (std::size_t n = 0; n < kSamples; ++n) {
    model.tick({.place_m = place[n],
                .slide_mass_kg = 0.02,
                .hand_force_n = press[n],
                .hand_stiffness_n_per_m = 100,
                .hand_resistance_n_s_per_m = 1,
                .rest_resistance_n_s_per_m = 0.7,
                .pluck_force_n = plucked[n],
                .contact = {.stiffness_ratio = 0.5, .loss_s_per_m = 0.01}});
    displacement.push_back(model.string().displacement(pickup));
    force.push_back(model.force());
    height.push_back(model.slide());
  }
  CppProgram<slide_string_model, double> program(kRate);
  const auto outputs = program.run({place, press, plucked}, kSamples);
  expect_agreement(outputs, displacement, force);
  EXPECT_TRUE(sequences_within<double>(outputs[2], height, 1e-10));
}

// Plucked over a fret that wanders, at this gap.
void expect_agreement_over_fret(const Signal& gap) {
  using String = resonators::guitar_d3;
  const std::size_t samples = gap.size();
  Signal place = signal_of([](double t) { return 0.32 + 0.05 * t; }), plucked = signal_of(pluck);
  place.resize(samples), plucked.resize(samples);
  FretString<double> model(kSteel, modes_in<String>, StringShapes<double>(String::wavenumbers), kStrike, kRate);
  const auto pickup = pickup_of<String>(model.string());
  model.place(place[0], gap[0]);
  Signal displacement, force;
  for (std::size_t n = 0; n < samples; ++n) {
    model.tick({.place_m = place[n],
                .gap_m = gap[n],
                .pluck_force_n = plucked[n],
                .damping_per_s = 3,
                .contact = {.stiffness_ratio = 2, .loss_s_per_m = 0.01}});
    displacement.push_back(model.string().displacement(pickup));
    force.push_back(model.force());
  }
  CppProgram<fret_string_model, double> program(kRate);
  expect_agreement(program.run({place, gap, plucked}, samples), displacement, force);
}

// The fret sinks: some hundred contacts.
TEST(FaustFretString, AgreesWithTheRuntime) {
  expect_agreement_over_fret(signal_of([](double t) { return 2e-4 + 4e-4 * t; }));
}

// In the first sample there is no last increment.
TEST(FaustFretString, AgreesWithTheRuntimeWherePressedAtFirst) {
  expect_agreement_over_fret(Signal(100, -2e-5));
}

// Bowed: a force and a speed that jump, a bow that turns, is lifted and put down again. Rounding moves each of some
// hundred slips, which moves the next one.
TEST(FaustBowedString, AgreesWithTheRuntime) {
  using String = resonators::guitar_d3;
  const Signal force = signal_of([](double t) { return t < 0.2 ? 0.2 + t : t < 0.3 ? 0.0 : t < 0.4 ? 1.5 : 0.4; });
  const Signal speed = signal_of([](double t) { return t < 0.1 ? 0.08 : t < 0.35 ? -0.3 * t : 0.2; });
  NetworkPlan<double> plan;
  const std::size_t body = plan.add_body(modes_in<String>);
  const std::size_t bow = plan.add_friction(kGround, plan.add_place(body, String::strike_shapes), kRosin, 0.01);
  ContactNetwork<double> network(plan, kRate);
  network.set_damping(body, 1.5);
  const auto pickup = pickup_of<String>(network.body(body));
  Signal displacement, rubbed;
  for (std::size_t n = 0; n < kSamples; ++n) {
    network.set_normal_force(bow, force[n]);
    network.set_surface_speed(bow, speed[n]);
    network.tick();
    displacement.push_back(network.body(body).displacement(pickup));
    rubbed.push_back(network.force(bow));
  }
  EXPECT_GT(*std::ranges::max_element(displacement), 1e-4);
  CppProgram<bowed_string_model, double> program(kRate);
  expect_agreement(program.run({force, speed}, kSamples), displacement, rubbed, 1e-9);
}

}  // namespace
}  // namespace contactspline::testing
