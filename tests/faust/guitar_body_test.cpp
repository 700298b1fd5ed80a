// SPDX-License-Identifier: MIT
// slide_string.dsp on its guitar body against the bank of the body's modes in C++.
#include "contactspline/resonators/guitar_body.hpp"

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/modal.hpp"
#include "cpp_program.hpp"
#include "support/compare.hpp"

#define FAUSTFLOAT double
#include "slide_on_bridge.hpp"
#include "slide_string_double.hpp"

namespace contactspline::testing {
namespace {

using GuitarBody = resonators::guitar_body;

template <typename Dsp>
Signals<double> plucked(std::size_t samples) {
  CppProgram<Dsp, double> program(44100);
  program.set("pluck", 1);
  return program.run({}, samples);
}

// The program's sound is the velocity of the body under the force on the bridge.
TEST(GuitarBody, IsDrivenByTheBridge) {
  constexpr std::size_t kSamples = 11025;
  const auto on_bridge = plucked<slide_on_bridge>(kSamples), on_body = plucked<slide_string_double>(kSamples);
  ModalBank<double> body(modes_in<GuitarBody>, 44100);
  const ModeShapes<double> bridge(GuitarBody::strike_shapes);
  const auto pickup = body.sound_pickup(ModeShapes<double>(GuitarBody::pickup_shapes));
  std::vector<double> expected;
  for (const double millinewtons : on_bridge[0]) {
    body.predict();
    body.push(bridge, millinewtons / 1000);
    body.commit();
    expected.push_back(body.velocity(pickup) / 0.5);
  }
  EXPECT_TRUE(sequences_within<double>(on_body[0], expected, 1e-9));
  EXPECT_TRUE(sequences_within<double>(on_body[1], on_bridge[1], 1e-9));
}

// (T beta + EI beta^3) cos(beta L) of the string in data/resonators/guitar_g3.json, to 13 digits of the emitted
// modes.
TEST(GuitarBody, KnowsTheForceOnTheBridge) {
  const auto shapes = plucked<slide_on_bridge>(1);
  for (int i = 1; i <= 5; ++i) {
    const double beta = i * std::numbers::pi / 0.648;
    const double force = (135 * beta + 0.000251327 * beta * beta * beta) * (i % 2 == 0 ? -1 : 1);
    EXPECT_TRUE(relatively_within(shapes.at(static_cast<std::size_t>(i) + 1)[0], force, 1e-11));
  }
}

}  // namespace
}  // namespace contactspline::testing
