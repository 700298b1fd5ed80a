// SPDX-License-Identifier: MIT
// Models written by hand, described as instrument files: the same samples up to rounding.
#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

std::vector<Segment<double>> table_of(const std::string& material) {
  const auto* file = find_embedded(Shipped::kMaterials, material + ".json");
  return segment_table(design_material(file->content, material).spline);
}

// A mass of 10 g that falls from 5 cm on felt again and again for 2 s, with gravity as a force. Rounding of 1e-16 in
// 88,200 samples adds up to 1e-11 at most. The felt multiplies it: 1e5 N/m times 1e-11 of 5 cm are 2e-9 of 31 N.
TEST(ModelsAsFiles, MassBarrier) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "mass", "mass_kg": 0.01 } ],
    "contacts": [ { "name": "barrier", "between": ["mass", "ground"], "material": "felt_c4" } ],
    "controls": [ { "name": "weight", "force_n": "mass", "initial": 0.0981 },
                  { "name": "barrier", "loss_s_per_m": "barrier", "initial": 0.1 } ],
    "strikes": ["mass"],
    "outputs": [ { "name": "mass", "displacement_m": "mass" }, { "name": "barrier", "force_n": "barrier" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  NetworkInstrument<double> instrument(arrays.view(), kRate);
  const auto table = table_of("felt_c4");
  MassBarrier<double> by_hand(table, kRate);
  instrument.strike(0, -1);
  by_hand.throw_from(0, -1);
  std::vector<double> actual[2], expected[2];
  int contacts = 0;
  for (int n = 0; n < 88200; ++n) {
    const bool touched = by_hand.force() > 0;
    instrument.tick();
    by_hand.tick({.mass_kg = 0.01, .gravity_m_per_s2 = 9.81, .contact = {.stiffness_ratio = 1, .loss_s_per_m = 0.1}});
    for (std::size_t i = 0; i < 2; ++i) actual[i].push_back(instrument.output(i));
    expected[0].push_back(by_hand.displacement());
    expected[1].push_back(by_hand.force());
    contacts += by_hand.force() > 0 && !touched;
  }
  EXPECT_GE(contacts, 5);
  EXPECT_TRUE(sequences_within(std::span<const double>(actual[0]), std::span<const double>(expected[0]), 1e-11));
  EXPECT_TRUE(sequences_within(std::span<const double>(actual[1]), std::span<const double>(expected[1]), 2e-9));
}

// A string over a fret that comes closer, plucked twice and damped by a hand. The shapes of a file are rounded to 13
// digits, and each hit on the fret amplifies differences.
TEST(ModelsAsFiles, FretStringWhoseFretStaysAtItsPlace) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "string", "resonator": "guitar_d3" } ],
    "places": [ { "name": "plucked", "body": "string", "position_m": 0.3 },
                { "name": "over_fret", "body": "string", "position_m": 0.6 } ],
    "contacts": [ { "name": "fret", "between": ["over_fret", "ground"], "material": "rubber_on_wood", "gap_m": 1e-4 } ],
    "controls": [ { "name": "finger", "force_n": "plucked" },
                  { "name": "fret", "gap_shift_m": "fret" },
                  { "name": "fret", "loss_s_per_m": "fret", "initial": 0.2 },
                  { "name": "hand", "damping_per_s": "string" } ],
    "outputs": [ { "name": "string", "displacement_m": "plucked" }, { "name": "fret", "force_n": "fret" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  NetworkInstrument<double> instrument(arrays.view(), kRate);

  const auto* file = find_embedded(Shipped::kResonators, "guitar_d3.json");
  std::vector<Mode> modes;
  std::vector<double> wavenumbers;
  for (const ResonatorMode& mode : modes_of(parse_resonator(file->content, "guitar_d3"), kRate / 2).modes) {
    const std::size_t i = modes.size();
    modes.push_back({arrays.angular_frequencies[i], arrays.decays[i], arrays.masses[i]});
    wavenumbers.push_back(mode.wavenumber_per_m);
  }
  const auto table = table_of("rubber_on_wood");
  FretString<double> by_hand(table, modes, StringShapes<double>(std::span<const double>(wavenumbers)), 0.3, kRate);
  by_hand.place(0.6, 1e-4);
  const auto pickup =
      by_hand.string().sound_pickup(std::span<const double>(arrays.shapes).first(arrays.body_ends[0]));
  std::vector<double> actual[2], expected[2];
  for (int n = 0; n < 44100; ++n) {
    const double force = n % 15000 < 200 ? 0.02 * (n % 15000) : 0;
    const double gap = n < 20000 ? 1e-4 : 2e-5, damping = n > 40000 ? 20 : 0;
    instrument.set(0, force);
    instrument.set(1, gap - 1e-4);
    instrument.set(3, damping);
    instrument.tick();
    by_hand.tick({.place_m = 0.6,
                  .gap_m = gap,
                  .pluck_force_n = force,
                  .damping_per_s = damping,
                  .contact = {.stiffness_ratio = 1, .loss_s_per_m = 0.2}});
    for (std::size_t i = 0; i < 2; ++i) actual[i].push_back(instrument.output(i));
    expected[0].push_back(by_hand.string().displacement(pickup));
    expected[1].push_back(by_hand.force());
  }
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(sequences_within(std::span<const double>(actual[i]), std::span<const double>(expected[i]), 1e-9))
        << i;
}

}  // namespace
}  // namespace contactspline::testing
