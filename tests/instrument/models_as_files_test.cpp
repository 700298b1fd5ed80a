// SPDX-License-Identifier: MIT
// Models written by hand, described as instrument files: the same samples up to rounding.
#include <initializer_list>
#include <utility>

#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "contactspline/models/slide_string.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/input_file.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

Design design_of(const std::string& material) {
  return design_material(find_embedded(Shipped::kMaterials, material + ".json")->content, material);
}

std::vector<Segment<double>> table_of(const std::string& material) {
  return segment_table(design_of(material).spline);
}

// A mass of 10 g that falls from 5 cm on felt again and again for 2 s, with gravity as a force. Rounding of 1e-16 in
// 88,200 samples adds up to 1e-11 at most. The felt multiplies it: 1e5 N/m times 1e-11 of 5 cm are 2e-9 of 31 N.
void expect_same_mass_barrier(const std::string& material, int min_contacts) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "mass", "mass_kg": 0.01 } ],
    "contacts": [ { "name": "barrier", "between": ["mass", "ground"], "material": ")" +
                                                     material + R"(" } ],
    "controls": [ { "name": "weight", "force_n": "mass" },
                  { "name": "barrier", "loss_s_per_m": "barrier", "initial": 0.1 } ],
    "strikes": ["mass"],
    "outputs": [ { "name": "mass", "displacement_m": "mass" }, { "name": "barrier", "force_n": "barrier" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  BySample<double> instrument(arrays.view(), kRate);
  const Design design = design_of(material);
  const auto table = segment_table(design.spline);
  MassBarrier<double> by_hand(table, kRate, design.material.memories);
  instrument.set(0, 0.0981);  // not from the beginning: then it would count from where the felt holds it
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
  EXPECT_GE(contacts, min_contacts);
  EXPECT_TRUE(sequences_within(std::span<const double>(actual[0]), std::span<const double>(expected[0]), 1e-11));
  EXPECT_TRUE(sequences_within(std::span<const double>(actual[1]), std::span<const double>(expected[1]), 2e-9));
}

TEST(ModelsAsFiles, MassBarrier) {
  expect_same_mass_barrier("felt_c4", 5);
}

TEST(ModelsAsFiles, MassBarrierWithMemory) {
  expect_same_mass_barrier("felt_stulov_c4", 3);
}

// An instrument of examples/instruments/, and the table and the string of its twin by hand.
struct Example {
  Example(const std::string& name, const std::string& material, const std::string& resonator, double rate = kRate)
      : arrays(arrays_of(
            unloaded(parse_instrument(read_input(std::string(EXAMPLES_FOLDER) + "/" + name + ".json"), name)),
            rate / 2)),
        instrument(arrays.view(), rate),
        table(table_of(material)) {
    const auto* file = find_embedded(Shipped::kResonators, resonator + ".json");
    for (const ResonatorMode& mode : modes_of(parse_resonator(file->content, resonator), rate / 2).modes) {
      const std::size_t i = modes.size();
      modes.push_back({arrays.angular_frequencies[i], arrays.decays[i], arrays.masses[i]});
      wavenumbers.push_back(mode.wavenumber_per_m);
    }
  }

  // The models begin without forces.
  static InstrumentModel unloaded(InstrumentModel model) {
    for (std::size_t c = 0; c < model.controls.size(); ++c)
      if (model.controls[c].quantity == ControlQuantity::kForce) model.parameters[c].initial = 0;
    return model;
  }

  [[nodiscard]] StringShapes<double> shapes() const {
    return StringShapes<double>(std::span<const double>(wavenumbers));
  }
  [[nodiscard]] ModeShapes<double> shapes_at(double place_m) const {
    ModeShapes<double> at(modes.size());
    shapes().at(place_m, at);
    return at;
  }

  // Advances a sample with values of parameters, and records the outputs.
  void tick(std::initializer_list<std::pair<const char*, double>> values) {
    for (const auto& [name, value] : values) {
      const auto found = std::ranges::find(arrays.parameters, std::string_view(name), &Parameter::name);
      ASSERT_NE(found, arrays.parameters.end()) << name;
      instrument.set(static_cast<std::size_t>(found - arrays.parameters.begin()), value);
    }
    instrument.tick();
    received_j += instrument.work() - instrument.dissipated();
    peak_j = std::max(peak_j, instrument.energy());
    if (const double e = std::abs(instrument.energy() - begin_j - received_j); !(e <= imbalance_j)) imbalance_j = e;
    for (std::size_t o = 0; o < 3; ++o) actual[o].push_back(instrument.output(o));
  }

  void expect_exact_books() const {
    EXPECT_GT(peak_j, 0);
    EXPECT_TRUE(within(imbalance_j, 0, 1e-12 * peak_j));
  }

  // Largest difference of an output from that of the twin in the first samples, over its largest value.
  [[nodiscard]] double error(std::size_t output, std::size_t samples) const {
    double peak = 0, error = 0;
    for (std::size_t n = 0; n < samples; ++n) {
      const double e = std::abs(actual[output].at(n) - expected[output].at(n));
      peak = std::max(peak, std::abs(expected[output][n]));
      if (!(e <= error)) error = e;
    }
    return error / peak;
  }

  InstrumentArrays arrays;
  BySample<double> instrument;
  std::vector<Segment<double>> table;
  std::vector<Mode> modes;
  std::vector<double> wavenumbers;
  std::vector<double> actual[3], expected[3];
  double begin_j = instrument.energy(), received_j = 0, peak_j = 0, imbalance_j = 0;
};

// A string over a fret that comes closer, moves along it at 0.4 m/s, plucked three times and damped by a hand. The
// shapes of a file are rounded to 13 digits. While the fret moves, the two differ by order 3 in the time step
// (moving_places_test), and each hit on the fret amplifies that.
TEST(ModelsAsFiles, FretString) {
  Example file("fret_under_string", "rubber_on_wood", "guitar_d3");
  FretString<double> by_hand(file.table, file.modes, file.shapes(), 0.3, kRate);
  by_hand.place(0.6, 1e-4);
  const auto pickup = by_hand.string().sound_pickup(file.shapes_at(0.05));
  constexpr int kMoves = 25000, kEnd = 44100;
  for (int n = 0; n < kEnd; ++n) {
    const double force = n % 15000 < 200 ? 0.02 * (n % 15000) : 0;
    const double gap = n < 20000 ? 1e-4 : 2e-5, damping = n > 40000 ? 20 : 0;
    const double place = 0.6 - 0.4 * std::clamp(n - kMoves, 0, 10000) / kRate;
    file.tick({{"finger_force_n", force},
               {"fret_gap_shift_m", gap - 1e-4},
               {"hand_damping_per_s", damping},
               {"fret_place_m", place}});
    by_hand.tick({.place_m = place,
                  .gap_m = gap,
                  .pluck_force_n = force,
                  .damping_per_s = damping,
                  .contact = {.stiffness_ratio = 1, .loss_s_per_m = 0.2}});
    file.expected[1].push_back(by_hand.string().displacement(pickup));
    file.expected[2].push_back(by_hand.force());
  }
  file.expect_exact_books();
  for (const std::size_t output : {1, 2}) {
    EXPECT_TRUE(within(file.error(output, kMoves), 0, 1e-9)) << file.arrays.outputs[output].name;
    EXPECT_TRUE(within(file.error(output, kEnd), 0, 1e-3)) << file.arrays.outputs[output].name;
  }
}

// A slide that a hand presses on a string moves by a fourth. Until then fingers rest on the string, halfway to it: in
// motion they feel how the string leans there, which the model leaves out. Returns the larger one of the differences
// of displacement and force.
double play_slide(double rate) {
  Example file("slide_on_string", "steel_on_steel", "guitar_g3", rate);
  SlideString<double> by_hand(file.table, file.modes, file.shapes(), 0.52, rate);
  by_hand.place(0.1625, 0);
  const auto pickup = by_hand.string().sound_pickup(file.shapes_at(0.6));
  const auto samples = static_cast<std::size_t>(rate / 2);
  for (std::size_t n = 0; n < samples; ++n) {
    const double time_s = static_cast<double>(n) / rate;
    const double force = time_s < 0.005 ? 800 * time_s : 0, fingers = time_s < 0.1 ? 1.5 : 0;
    const double place = 0.1625 + 0.2 * std::clamp(time_s - 0.1, 0.0, 0.25);
    file.tick({{"press_force_n", 8},
               {"pick_force_n", force},
               {"slide_place_m", place},
               {"fingers_resistance_n_s_per_m", fingers}});
    by_hand.tick({.place_m = place,
                  .slide_mass_kg = 0.05,
                  .hand_force_n = 8,
                  .hand_stiffness_n_per_m = 300,
                  .hand_resistance_n_s_per_m = 3,
                  .rest_resistance_n_s_per_m = fingers,
                  .pluck_force_n = force,
                  .contact = {.stiffness_ratio = 1, .loss_s_per_m = 0.2}});
    file.expected[1].push_back(by_hand.string().displacement(pickup));
    file.expected[2].push_back(by_hand.force());
  }
  file.expect_exact_books();
  return std::max(file.error(1, samples), file.error(2, samples));
}

TEST(ModelsAsFiles, SlideString) {
  const double coarse = play_slide(44100), fine = play_slide(88200);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_LT(fine, coarse / 4);
}

// Three blows with other masses, felts and places, which are set while the last one sounds. A damper brings the
// string to rest in between, because the class throws its hammer from the string and the file from where the string
// rests.
TEST(ModelsAsFiles, HammerString) {
  Example file("hammer_on_string", "felt_c4", "string_c4");
  HammerString<double> by_hand(file.table, file.modes, file.shapes_at(0.0744), kRate);
  const auto pickup = by_hand.string().sound_pickup(file.shapes_at(0.248));
  HammerStringControls<double> controls{.hammer_mass_kg = 0.00297, .felt = {.stiffness_ratio = 1, .loss_s_per_m = 0}};
  HammerStringControls<double> next = controls;
  double strike_m = 0.0744;
  constexpr int kEnd = 45000;
  for (int n = 0; n < kEnd; ++n) {
    if (n % 15000 == 0) {
      file.instrument.strike(0, 2.5);
      next.damping_per_s = 0;
      controls = next;
      by_hand.strike_at(file.shapes_at(strike_m));
      by_hand.strike(2.5, 1e-4);
    }
    if (n % 15000 == 50) {  // in the blow
      strike_m += 0.02;
      next.hammer_mass_kg *= 2;
      next.felt.stiffness_ratio *= 0.5;
      next.felt.loss_s_per_m += 0.1;
    }
    controls.damping_per_s = n % 15000 > 7000 ? 1000 : 0;
    file.tick({{"hammer_mass_kg", next.hammer_mass_kg},
               {"strike_place_m", strike_m},
               {"felt_stiffness_ratio", next.felt.stiffness_ratio},
               {"felt_loss_s_per_m", next.felt.loss_s_per_m},
               {"hand_damping_per_s", controls.damping_per_s}});
    by_hand.tick(controls);
    file.expected[1].push_back(by_hand.string().displacement(pickup));
    file.expected[2].push_back(by_hand.force());
  }
  file.expect_exact_books();
  for (const std::size_t output : {1, 2})
    EXPECT_TRUE(within(file.error(output, kEnd), 0, 1e-9)) << file.arrays.outputs[output].name;
}

}  // namespace
}  // namespace contactspline::testing
