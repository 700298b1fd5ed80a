// SPDX-License-Identifier: MIT
// Models whose number of modes is known at compile time play as those on the heap, and allocate nothing.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/models/slide_string.hpp"
#include "contactspline/resonators/guitar_e4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"

// clang++ cannot compute std::exp at compile time.
#ifdef __clang__
#define CONTACTSPLINE_TEST_CONSTINIT
#else
#define CONTACTSPLINE_TEST_CONSTINIT constinit
#endif

namespace contactspline::testing {
namespace {

constexpr double kRate = 48000;
constexpr double kPluck = 0.1;
using Piano = resonators::string_c4;
using Guitar = resonators::guitar_e4;
constexpr auto& kFelt = segments_of<materials::felt_c4, double>;
constexpr auto& kSteel = segments_of<materials::steel_on_steel, double>;
constexpr auto& kPianoModes = modes_in<Piano>;
constexpr auto& kGuitarModes = modes_in<Guitar>;

using PianoShapes = ModeShapes<double, Piano::modes>;
using GuitarShapes = StringShapes<double, Guitar::modes>;

CONTACTSPLINE_TEST_CONSTINIT HammerString<double, kFelt.size(), Piano::modes> hammer_string(
    kFelt, kPianoModes, PianoShapes(Piano::strike_shapes), kRate);
CONTACTSPLINE_TEST_CONSTINIT SlideString<double, kSteel.size(), Guitar::modes> slide_string(
    kSteel, kGuitarModes, GuitarShapes(Guitar::wavenumbers), kPluck, kRate);
CONTACTSPLINE_TEST_CONSTINIT FretString<double, kSteel.size(), Guitar::modes> fret_string(
    kSteel, kGuitarModes, GuitarShapes(Guitar::wavenumbers), kPluck, kRate);

using Samples = std::vector<double>;
constexpr std::size_t kSamples = 4800;

// Two blows, the second one elsewhere, with a damper at the end: displacements, then forces.
template <typename Model>
Samples played_hammer(Model& model, const typename Model::Shapes& pickup, const typename Model::Shapes& elsewhere) {
  Samples out(kSamples), forces(kSamples);
  const std::size_t before = allocations;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == 1) model.strike_at(elsewhere);
    if (i < 2) model.strike(3.0, 1e-4);
    const std::span<double> part(out.data() + i * kSamples / 3, kSamples / 3);
    model.process({.hammer_mass_kg = 0.00297, .damping_per_s = i < 2 ? 0.0 : 50.0}, pickup, part,
                  forces.data() + i * kSamples / 3);
  }
  EXPECT_EQ(allocations, before);
  out.insert(out.end(), forces.begin(), forces.end());
  return out;
}

template <typename Model>
Samples played_slide(Model& model) {
  Samples forces(kSamples);
  const std::size_t before = allocations;
  model.place(0.3, 0.0);
  for (std::size_t i = 0; i < kSamples; ++i) {
    model.tick({.place_m = 0.3 + 1e-5 * static_cast<double>(i),
                .slide_mass_kg = 0.05,
                .hand_force_n = 2,
                .rest_resistance_n_s_per_m = 1,
                .pluck_force_n = i < 100 ? 1.0 : 0.0});
    forces[i] = model.force();
  }
  EXPECT_EQ(allocations, before);
  return forces;
}

template <typename Model>
Samples played_fret(Model& model) {
  Samples forces(kSamples);
  const std::size_t before = allocations;
  model.place(0.3, 1e-4);
  for (std::size_t i = 0; i < kSamples; ++i) {
    model.tick({.place_m = 0.3 + 1e-5 * static_cast<double>(i), .gap_m = 1e-4, .pluck_force_n = i < 100 ? 2.0 : 0.0});
    forces[i] = model.force();
  }
  EXPECT_EQ(allocations, before);
  return forces;
}

// Only the order of sums differs, and constants in the last digit, 1e-16. Each bounce of steel on steel multiplies a
// difference; after dozens of them it is 1e-9 of the largest force.
constexpr double kBound = 1e-7;

void expect_same(const Samples& fixed, const Samples& heap) {
  EXPECT_TRUE(sequences_within<double>(fixed, heap, kBound));
}

TEST(FixedSize, HammerStringPlaysAsTheOneOnTheHeap) {
  HammerString<double> heap(kFelt, kPianoModes, ModeShapes<double>(Piano::strike_shapes), kRate);
  const Samples expected =
      played_hammer(heap, heap.string().sound_pickup(Piano::pickup_shapes), ModeShapes<double>(Piano::pickup_shapes));
  const Samples played = played_hammer(hammer_string, hammer_string.string().sound_pickup(Piano::pickup_shapes),
                                       PianoShapes(Piano::pickup_shapes));
  expect_same({played.begin(), played.begin() + kSamples}, {expected.begin(), expected.begin() + kSamples});
  expect_same({played.begin() + kSamples, played.end()}, {expected.begin() + kSamples, expected.end()});
}

TEST(FixedSize, SlideStringPlaysAsTheOneOnTheHeap) {
  SlideString<double> heap(kSteel, kGuitarModes, StringShapes<double>(Guitar::wavenumbers), kPluck, kRate);
  expect_same(played_slide(slide_string), played_slide(heap));
}

TEST(FixedSize, FretStringPlaysAsTheOneOnTheHeap) {
  FretString<double> heap(kSteel, kGuitarModes, StringShapes<double>(Guitar::wavenumbers), kPluck, kRate);
  expect_same(played_fret(fret_string), played_fret(heap));
}

TEST(FixedSize, ConstructionAllocatesNothing) {
  const std::size_t before = allocations;
  const HammerString<double, std::dynamic_extent, Piano::modes> model(
      segments_of<materials::felt_c4, double>, kPianoModes, ModeShapes<double, Piano::modes>(Piano::strike_shapes),
      kRate);
  EXPECT_EQ(model.string().size(), Piano::modes);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace contactspline::testing
