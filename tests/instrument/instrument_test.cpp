// SPDX-License-Identifier: MIT
// Instrument files: what they become, against models written by hand and against the classes emitted for them.
#include "generator/instrument/instrument.hpp"

#include <fmt/format.h>

#include "contactspline/instruments/prepared_piano.hpp"
#include "contactspline/instruments/slap_bass.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/precisions.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

std::string_view shipped_text(Shipped folder, const std::string& name) {
  return find_embedded(folder, name + ".json")->content;
}

// As the engine has compiled it, at the rate.
template <typename I>
Handle<typename I::value_type> prepared() {
  auto instrument = compiled<I>();
  instrument->prepare(kRate);
  return instrument;
}

// A hammer on a string as a file is the hammer-string: the same contact step on the same modes. Only sums are added
// in another order, and the hammer is a body of its own: differences of rounding, which the contact multiplies.
TEST(InstrumentFile, OfAHammerStringIsTheHammerString) {
  constexpr double kSpeed = 2.5, kMass = 0.003;
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "string", "resonator": "string_c4" }, { "name": "hammer", "mass_kg": 0.003 } ],
    "places": [ { "name": "struck", "body": "string", "position_m": 0.0744 },
                { "name": "pickup", "body": "string", "position_m": 0.248 } ],
    "contacts": [ { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4" } ],
    "strikes": ["hammer"],
    "outputs": [ { "name": "pickup", "velocity_m_per_s": "pickup" }, { "name": "felt", "force_n": "felt" },
                 { "name": "bridge", "end_force_n": "string" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  BySample<double> instrument(arrays.view(), kRate);

  // The same numbers: those of the arrays, which are rounded to 13 digits. Shapes: the hammer's, then three places.
  const std::size_t count = arrays.body_ends[0];
  std::vector<Mode> modes;
  for (std::size_t i = 0; i < count; ++i)
    modes.push_back({arrays.angular_frequencies[i], arrays.decays[i], arrays.masses[i]});
  const std::span<const double> shapes = arrays.shapes;
  const auto struck = shapes.subspan(1, count), pickup = shapes.subspan(1 + count, count),
             bridge = shapes.subspan(1 + 2 * count, count);
  const auto table = segment_table(design_material(shipped_text(Shipped::kMaterials, "felt_c4"), "felt").spline);
  HammerString<double> by_hand(table, modes, ModeShapes<double>(struck), kRate);
  const auto at_pickup = by_hand.string().sound_pickup(pickup);
  const auto at_bridge = by_hand.string().sound_pickup(bridge);

  instrument.strike(0, kSpeed);
  by_hand.strike(kSpeed, 0);
  std::vector<double> actual[3], expected[3];
  for (int n = 0; n < 20000; ++n) {
    instrument.tick();
    by_hand.tick({.hammer_mass_kg = kMass});
    for (std::size_t i = 0; i < 3; ++i) actual[i].push_back(instrument.output(i));
    expected[0].push_back(by_hand.string().velocity(at_pickup));
    expected[1].push_back(by_hand.force());
    expected[2].push_back(by_hand.string().displacement(at_bridge));
  }
  // 20,000 samples, each with rounding of 1e-16 of the largest modes.
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(sequences_within(std::span<const double>(actual[i]), std::span<const double>(expected[i]), 1e-11))
        << i;
}

CONTACTSPLINE_EACH_PRECISION(EveryPrecision);

TYPED_TEST(EveryPrecision, AllocatesNothingAfterConstruction) {
  using T = TypeParam;
  const auto instrument = prepared<instruments::prepared_piano<T>>();
  const auto number = [](std::string_view name) {
    const auto& all = instruments::prepared_piano<T>::data::parameters;
    const auto found = std::ranges::find(all, name, &Parameter::name);
    EXPECT_NE(found, all.end()) << name;
    return static_cast<std::size_t>(found - all.begin());
  };
  const std::array<std::pair<std::size_t, double>, 5> moved = {{{number("play_gap_shift_m"), -1e-4},
                                                                {number("screw_stiffness_n_per_m"), 1e5},
                                                                {number("bolt_loss_s_per_m"), 0.5},
                                                                {number("damper_damping_per_s"), 20},
                                                                {number("weight_force_n"), 0.1}}};
  std::vector<T> block(2000);
  const std::array<std::span<T>, 2> outputs = {block, {}};
  ASSERT_EQ(instrument->outputs().size(), 2U);
  const std::size_t before = allocations;
  instrument->strike(0, 3);
  instrument->process(outputs, {});
  for (const auto& [parameter, value] : moved) instrument->set(parameter, value);
  instrument->process(outputs, {});
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(all_finite(block));
}

// The precision of the state changes the sound little before collisions have amplified it.
TEST(EmittedClass, SoundsAlikeInSinglePrecision) {
  BySample<float> single(compiled<instruments::trichord_c4<float>>(), kRate);
  BySample<double> exact(compiled<instruments::trichord_c4<double>>(), kRate);
  single.strike(0, 3);
  exact.strike(0, 3);
  std::vector<double> actual, expected;
  for (int n = 0; n < 4410; ++n) {
    single.tick();
    exact.tick();
    actual.push_back(double(single.output(0)));
    expected.push_back(exact.output(0));
  }
  EXPECT_TRUE(sequences_within(std::span<const double>(actual), std::span<const double>(expected), 0.02));
}

TEST(NetworkInstrument, DoesNoWorkUntilItIsPlayed) {
  BySample<double> instrument(compiled<instruments::slap_bass<>>(), kRate);
  instrument.tick();
  EXPECT_EQ(instrument.work(), 0);
}

// Controls that are not numbers do nothing; reset() brings an instrument to where it began.
TEST(NetworkInstrument, ResetsAndIgnoresWhatIsNoNumber) {
  BySample<double> instrument(compiled<instruments::slap_bass<>>(), kRate);
  const auto played = [&] {
    std::vector<double> sound;
    instrument.strike(0, 4);
    for (int n = 0; n < 4410; ++n) {
      instrument.tick();
      sound.push_back(instrument.output(0));
    }
    return sound;
  };
  const auto first = played();
  for (std::size_t p = 0; p < instrument.parameters().size(); ++p)
    instrument.set(p, std::numeric_limits<double>::quiet_NaN());
  instrument.reset();
  EXPECT_EQ(instrument.energy(), 0);
  EXPECT_EQ(played(), first);
}

// A control keeps the value that acts: within the range of its quantity.
TEST(NetworkInstrument, MovesControlsIntoTheirRange) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  BySample<double> instrument(compiled<instruments::prepared_piano<>>(), kRate);
  const auto controls = instrument.parameters();
  ASSERT_GE(controls.size(), 5U);
  for (std::size_t i = 0; i < controls.size(); ++i) {
    const auto [min, max] = controls[i].allowed;
    instrument.set(i, 2 * max);
    EXPECT_EQ(instrument.value(i), max) << controls[i].name;
    instrument.set(i, -kInfinity);
    EXPECT_EQ(instrument.value(i), min) << controls[i].name;
    instrument.set(i, std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(instrument.value(i), min) << controls[i].name;
  }
}

// The gap of the file with its shift stays within 0.1 m, whether the shift is the first value or comes later, and
// whether displacements count from where the spring is relaxed or not. A spring of 1 N/m with this gap holds a mass
// of 10 t: its energy is strain^2/2. While the gap moves by at most 0.1 m at 1 m/s, the mass moves by x <= 0.1 N/1e4
// kg (0.1 s)^2/2 = 5e-8 m. So the work of the gap, the integral of strain - x, is wrong by 5e-9 J at most.
TEST(NetworkInstrument, LimitsAShiftedGapFromTheBeginning) {
  InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "mass", "mass_kg": 1e4 } ],
    "springs": [ { "name": "coil", "between": ["mass", "ground"], "stiffness_n_per_m": 1, "gap_m": 0.05 } ],
    "controls": [ { "name": "coil", "gap_shift_m": "coil" } ],
    "outputs": [ { "name": "coil", "force_n": "coil" } ]
  })",
                                           "probe.json");
  InstrumentArrays arrays = arrays_of(model, kRate / 2);
  // The spring may keep 1e-12 of the 0.05 N that it pulls with at displacement 0.
  EXPECT_TRUE(within(arrays.connections[0].gap_m, 0, 5e-14));
  EXPECT_TRUE(within(arrays.connections[0].moved_m, -0.05, 5e-14));
  for (const double moved : {-0.05, 0.0}) {
    arrays.connections[0].gap_m = 0.05 + moved;
    arrays.connections[0].moved_m = moved;
    for (const auto& [shift, gap] : {std::pair(0.03, 0.08), {0.09, 0.1}, {5.0, 0.1}, {-0.1, -0.05}}) {
      const double energy = (gap + moved) * (gap + moved) / 2;
      arrays.parameters[0].initial = 0;
      BySample<double> later(arrays.view(), kRate);
      later.set(0, shift);
      for (int n = 0; n < 0.2 * kRate; ++n) later.tick();
      EXPECT_TRUE(within(later.energy(), energy, 5e-9)) << shift << ' ' << moved;
      arrays.parameters[0].initial = shift;
      const BySample<double> at_first(arrays.view(), kRate);
      EXPECT_TRUE(relatively_within(at_first.energy(), energy, 1e-14)) << shift << ' ' << moved;
      EXPECT_EQ(at_first.value(0), later.value(0));
    }
  }
  // At its limit from the beginning, it is relaxed there, and stays.
  model.parameters[0].initial = 0.05;
  const InstrumentArrays at_limit = arrays_of(model, kRate / 2);
  BySample<double> instrument(at_limit.view(), kRate);
  instrument.set(0, 5);
  for (int n = 0; n < 0.2 * kRate; ++n) instrument.tick();
  EXPECT_TRUE(within(instrument.energy(), 0, 1e-30));
}

// A weight on felts: a mass between two springs and a contact, under a force, rests where the forces balance: by
// bisection on the force of the table, of which a memory leaves a part. From there it counts, with its gaps as they
// are there. A finger on a string is held by its bend. Nothing moves.
TEST(InstrumentFile, BeginsAtItsStaticEquilibrium) {
  for (const auto& [felt, left] : {std::pair("felt_c4", 1.0), {"felt_stulov_c4", 0.0}})
    for (const double load : {3.0, 0.0, 10.0, 0.02}) {
      const InstrumentModel model = parse_instrument(fmt::format(R"({{
    "name": "probe",
    "bodies": [ {{ "name": "weight", "mass_kg": 0.01 }}, {{ "name": "string", "resonator": "guitar_a2" }},
                {{ "name": "plate", "mass_kg": 1 }} ],
    "places": [ {{ "name": "middle", "body": "string", "position_m": 0.3 }} ],
    "contacts": [ {{ "name": "felt", "between": ["weight", "ground"], "material": "{}", "gap_m": 0.001 }} ],
    "springs": [ {{ "name": "coil", "between": ["weight", "plate"], "stiffness_n_per_m": 50, "gap_m": -0.002 }},
                 {{ "name": "leg", "between": ["plate", "ground"], "stiffness_n_per_m": 200 }} ],
    "controls": [ {{ "name": "load", "force_n": "weight", "initial": {}, "max": 10 }},
                  {{ "name": "finger", "force_n": "middle", "initial": {}, "max": 10 }} ],
    "outputs": [ {{ "name": "felt", "force_n": "felt" }}, {{ "name": "string", "displacement_m": "middle" }},
                 {{ "name": "end", "end_force_n": "string" }} ]
  }})",
                                                                 felt, load, load / 2),
                                                     "probe.json");
      const InstrumentArrays arrays = arrays_of(model, kRate / 2);
      const ContactTable& table = model.tables.front();
      double part = 1;
      for (const Memory& memory : table.memories) part -= memory.weight;
      EXPECT_EQ(part == 1, left == 1.0);
      // Plate z = 50 (x + 0.002)/250; the coil pulls with 40 (x + 0.002).
      const auto excess = [&](double x) {
        return load - 40 * (x + 0.002) -
               part * force<double>(std::span<const Segment<double>>(table.segments), x - 0.001);
      };
      double low = -1, high = 1;
      while (high - low > 1e-15) (excess((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
      EXPECT_TRUE(within(arrays.connections[0].gap_m, 0.001 - low, 1e-10)) << load;
      EXPECT_TRUE(within(arrays.connections[1].gap_m, -0.8 * (low + 0.002), 1e-10)) << load;
      EXPECT_TRUE(within(arrays.connections[2].gap_m, -0.2 * (low + 0.002), 1e-10)) << load;
      ASSERT_EQ(arrays.holds.size(), load > 0 ? 1U : 0U);
      if (load > 0) {
        EXPECT_TRUE(relatively_within(arrays.holds[0].force_n, -load / 2, 1e-12));
      }
      for (const double rate : {kRate, 4 * kRate}) {
        BySample<double> instrument(arrays.view(), rate);
        for (int n = 0; n < 1000; ++n) {
          instrument.tick();
          for (std::size_t o = 0; o < 3; ++o) ASSERT_TRUE(within(instrument.output(o), 0, 1e-7)) << o << ' ' << n;
        }
        EXPECT_TRUE(instrument.is_at_rest(1e-15) || instrument.is_silent(1e-15)) << load;
      }
    }
}

// A string that a finger bends is silent where it rests, and not where the finger presses otherwise.
TEST(InstrumentFile, IsSilentUnderTheForceOfTheFile) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "string", "resonator": "guitar_a2" } ],
    "places": [ { "name": "middle", "body": "string", "position_m": 0.3 } ],
    "controls": [ { "name": "finger", "force_n": "middle", "initial": 2, "max": 10 } ],
    "outputs": [ { "name": "string", "displacement_m": "middle" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  BySample<double> instrument(arrays.view(), kRate);
  for (int n = 0; n < 100; ++n) instrument.tick();
  EXPECT_EQ(instrument.output(0), 0);
  EXPECT_TRUE(instrument.is_silent(1e-30));
  instrument.set(0, 0);
  EXPECT_FALSE(instrument.is_silent(1e-30));
  instrument.tick();
  EXPECT_LT(instrument.output(0), 0);
}

// What holds a body at rest may be larger than any push.
TEST(InstrumentFile, IsSilentUnderAForceBeyondTheRangeOfPushes) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "plate", "modes": [ { "frequency_hz": 2000, "decay_per_s": 3, "mass_kg": 1 } ] } ],
    "places": [ { "name": "edge", "body": "plate", "shapes": [1] } ],
    "springs": [ { "name": "press", "between": ["ground", "edge"], "stiffness_n_per_m": 1e6, "gap_m": -0.05 } ],
    "outputs": [ { "name": "plate", "displacement_m": "edge" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  ASSERT_EQ(arrays.holds.size(), 1U);
  EXPECT_GT(std::abs(arrays.holds[0].force_n), 40000);
  BySample<double> instrument(arrays.view(), kRate);
  for (int n = 0; n < 1000; ++n) {
    instrument.tick();
    ASSERT_TRUE(within(instrument.output(0), 0, 1e-12)) << n;
  }
}

// A mass that a force pushes away for ever has no equilibrium: it begins at displacement 0, and flies.
TEST(InstrumentFile, BeginsAtDisplacement0WhereNothingHolds) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "free", "mass_kg": 0.01 } ],
    "contacts": [ { "name": "wall", "between": ["free", "ground"], "material": "felt_c4", "gap_m": 0.001 } ],
    "controls": [ { "name": "pull", "force_n": "free", "initial": -1, "min": -10 } ],
    "outputs": [ { "name": "free", "displacement_m": "free" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  EXPECT_EQ(arrays.connections[0].gap_m, 0.001);
  EXPECT_TRUE(arrays.holds.empty());
  BySample<double> instrument(arrays.view(), kRate);
  instrument.tick();
  EXPECT_TRUE(relatively_within(instrument.output(0), -100 / (2 * kRate * kRate), 1e-12));
}

// A control sets what it is for, and its first value is that of the file.
TEST(InstrumentFile, GivesControlsTheirFirstValue) {
  const InstrumentModel model = parse_instrument(shipped_text(Shipped::kInstruments, "prepared_piano"), "probe");
  const auto initial = [&](const std::string& name) {
    return std::ranges::find(model.parameters, name, &ModelParameter::name)->initial;
  };
  EXPECT_EQ(initial("weight_force_n"), 0.049);
  EXPECT_EQ(initial("bolt_loss_s_per_m"), 0.2);
  EXPECT_EQ(initial("play_gap_shift_m"), 0);
  EXPECT_EQ(initial("screw_stiffness_n_per_m"), 4e4);
  EXPECT_EQ(initial("damper_damping_per_s"), 0);
}

// Shapes on a membrane: a negative radius is the other side of the centre, where the modes of odd order change sign.
TEST(InstrumentFile, MeasuresADiameterThroughTheCentre) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "head", "resonator": "drum_head", "max_modes": 12 } ],
    "places": [ { "name": "line", "body": "head", "positions_m": [-0.06, 0.06] },
                { "name": "other", "body": "head", "position_m": 0.06, "angle_rad": 3.141592653589793 } ],
    "outputs": [ { "name": "head", "displacement_m": "other" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  ASSERT_EQ(arrays.shapes.size(), 36U);
  int odd = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_TRUE(within(arrays.shapes[i], arrays.shapes[24 + i], 1e-12));
    EXPECT_TRUE(within(std::abs(arrays.shapes[i]), std::abs(arrays.shapes[12 + i]), 1e-12));
    odd += arrays.shapes[i] * arrays.shapes[12 + i] < 0;
  }
  EXPECT_GE(odd, 3);
}

// The pitch of the trichord: its strings are held where they cross the bridge, within 4 cents.
TEST(ShippedInstruments, TheTrichordSoundsAtC4) {
  const auto trichord = prepared<instruments::trichord_c4<>>();
  trichord->strike(0, 1);
  std::vector<double> sound(44100);
  trichord->process(std::array<std::span<double>, 3>{sound, {}, {}}, {});
  double loudest = 0, found_hz = 0;
  for (double f = 255; f < 268; f += 0.1) {
    double re = 0, im = 0;
    for (std::size_t n = 4410; n < sound.size(); ++n) {
      const double phase = 2 * std::numbers::pi * f * double(n) / kRate;
      const double window = 1 - std::cos(2 * std::numbers::pi * double(n - 4410) / double(sound.size() - 4410));
      re += window * sound[n] * std::cos(phase);
      im += window * sound[n] * std::sin(phase);
    }
    if (std::hypot(re, im) > loudest) {
      loudest = std::hypot(re, im);
      found_hz = f;
    }
  }
  EXPECT_TRUE(within(1200 * std::log2(found_hz / 261.63), 0, 4)) << found_hz;
}

// Is an instrument of one spring computed in double precision in place of single precision?
bool is_in_double(const std::string& spring, const std::string& controls) {
  const std::string text = R"({ "name": "weight", "bodies": [ { "name": "weight", "mass_kg": 1 } ],
    "springs": [ { "name": "spring", "between": ["weight", "ground"], )" +
                           spring + " } ], " + controls + R"("strikes": ["weight"],
    "outputs": [ { "name": "weight", "displacement_m": "weight" } ] })";
  const InstrumentArrays arrays = arrays_of(parse_instrument(text, "weight.json"), kRate / 2);
  return SeenNetwork<float>(arrays.view(), kRate).is_in_double();
}

TEST(InstrumentInSinglePrecision, IsInDoubleWhereASpringMayBeStrainedAtRest) {
  const std::string soft = R"("stiffness_n_per_m": 300)", damper = R"("resistance_n_s_per_m": 3)";
  const std::string gap = R"(, "gap_m": 0.01)",
                    press = R"("controls": [ { "name": "press", "gap_shift_m": "spring" } ], )";
  EXPECT_FALSE(is_in_double(soft, ""));
  EXPECT_TRUE(is_in_double(soft + gap, ""));
  EXPECT_TRUE(is_in_double(soft, press));
  EXPECT_FALSE(is_in_double(damper + gap, ""));
}

}  // namespace
}  // namespace contactspline::testing
