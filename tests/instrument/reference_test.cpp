// SPDX-License-Identifier: MIT
// Each instrument that ships against an independent solution of its equations, and how it converges.
#include <map>
#include <set>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/support/embedded_files.hpp"
#include "place_index.hpp"
#include "reference_network.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

std::string_view shipped_text(Shipped folder, const std::string& name) {
  return find_embedded(folder, name + ".json")->content;
}

// How an instrument is tested. The reference stays alone for so many samples.
struct Excitation {
  std::string score;  ///< that ships, or the first pluck, where the score plays keys
  std::string place;  ///< whose displacement is compared
  std::size_t alone;
  double softening;      ///< ratio that softens stiff contacts, where the order is measured
  double error = 1e-10;  ///< that is allowed, in parts of the largest value
};

// Rattling wires and bolts amplify differences: rounding to 1e-16 becomes 1e-6 within 50 ms. So the reference
// continues from the state of the instrument each 10 or 2.5 ms.
//
// fret_guitar: the place over the fret may move, so its shapes are sines. Those of the reference have 13 digits, and
// differ by up to 2e-11: after a pluck of 3 N by 2e-15 m in all. Steel under the largest force, 4.4 N, has 1.2e7 N/m,
// so forces differ by up to 6e-9 of it.
const std::map<std::string, Excitation> kExcitations = {
    {"classical_guitar", {"guitar_arpeggio", "saddle", 2205, 1}},
    {"dulcimer", {R"({ "time_s": 0.1, "cs5_hammer_speed_m_per_s": 2 })", "bridge_cs5", 2205, 1}},
    {"fret_guitar", {R"({ "time_s": 0.1, "finger_release_n": 3 })", "over_fret", 110, 1, 6e-9}},
    {"kit",
     {R"({ "time_s": 0.1, "snare_speed_m_per_s": 3, "tom_10_speed_m_per_s": 2, "bass_speed_m_per_s": 2 })", "pickup",
      441, 1e-4}},
    {"lap_steel", {R"({ "time_s": 0.1, "pick_release_n": 3 })", "under_bar", 2205, 1}},
    {"kalimba", {R"({ "time_s": 0.1, "thumb_a4_release_n": 3 })", "bridge", 2205, 1}},
    {"marimba", {R"({ "time_s": 0.1, "mallet_ds4_speed_m_per_s": 1.2 })", "mouth_ds4", 2205, 1}},
    {"prepared_piano", {"prepared_notes", "under_bolt", 110, 1e-6}},
    {"slap_bass", {"slap_line", "pickup", 441, 1e-4}},
    {"snare", {"snare_roll", "pickup", 110, 1e-4}},
    {"steel_guitar", {R"({ "time_s": 0.1, "finger_d3_release_n": 3 })", "saddle", 2205, 1}},
    {"tanpura", {"tanpura_drone", "finger", 2205, 1e-4}},
    {"tom", {"tom_pattern", "pickup", 2205, 1e-3}},
    {"trichord_c4", {"trichord_blows", "bridge_middle", 2205, 1}}};

// The reference does not stretch and hears no room: stretching_files_test and pressure_test compare these.
InstrumentArrays arrays_for_reference(InstrumentModel model) {
  for (InstrumentBody& body : model.bodies) body.stretch_j = 0;
  std::erase_if(model.outputs, [](const ModelOutput& o) { return o.quantity == OutputQuantity::kPressure; });
  return arrays_of(model, kRate / 2);
}

class EachInstrument : public ::testing::TestWithParam<std::string> {};

// The reference has no friction, whose own tests are friction_test and friction_network_test. Of the gong nothing
// would be left: it stretches and is heard in the room.
std::vector<std::string> instruments_of_the_reference() {
  std::vector<std::string> names;
  for (const std::string& name : shipped_names(Shipped::kInstruments))
    if (const auto text = shipped_text(Shipped::kInstruments, name);
        text.find("\"frictions\"") == std::string_view::npos && name != "gong")
      names.push_back(name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(, EachInstrument, ::testing::ValuesIn(instruments_of_the_reference()),
                         [](const auto& test) { return test.param; });

class SmoothInstrument : public EachInstrument {};

INSTANTIATE_TEST_SUITE_P(, SmoothInstrument,
                         ::testing::Values("classical_guitar", "marimba", "prepared_piano", "slap_bass", "snare",
                                           "tanpura", "tom", "trichord_c4"),
                         [](const auto& test) { return test.param; });

Score score_of(const std::string& instrument, const std::string& score) {
  if (!score.starts_with('{')) return parse_score(shipped_text(Shipped::kScores, score), score, shipped_file);
  return parse_score(R"({ "instrument": ")" + instrument + R"(", "duration_s": 1, "events": [)" + score + "] }",
                     "probe.json", shipped_file);
}

double first_event_s(const Voice& voice) {
  double first = std::numeric_limits<double>::infinity();
  for (const Strike& strike : voice.strikes) first = std::min(first, strike.time_s);
  for (const Glide& glide : voice.glides) first = std::min(first, glide.time_s);
  return first;
}

void copy_state(const SeenNetwork<double>& from, ReferenceNetwork& to, const InstrumentArrays& arrays) {
  for (std::size_t b = 0; b < arrays.body_ends.size(); ++b) {
    const std::span<const double> displacements = from.displacements(b);
    for (std::size_t i = 0; i < displacements.size(); ++i) to.set_motion(b, i, displacements[i], from.velocity(b, i));
  }
}

// 50 ms after the first strike or pluck of the score, all outputs.
TEST_P(EachInstrument, AgreesWithAnIndependentSolution) {
  const Excitation& excitation = kExcitations.at(GetParam());
  const Score score = score_of(GetParam(), excitation.score);
  const Voice& voice = score.voices.front();
  const InstrumentArrays arrays = arrays_for_reference(*voice.model);
  SeenNetwork<double> instrument(arrays.view(), kRate);
  ReferenceNetwork reference(arrays.view(), kRate);
  ControlTrack controls(voice, kRate);
  StrikeTrack strikes(voice.strikes, kRate);
  const std::size_t begin = sample_at(first_event_s(voice), kRate), outputs = arrays.sources.size();
  std::vector<double> peak(outputs), error(outputs);
  for (std::size_t n = begin; n < begin + 2205; ++n) {
    if (n > begin && (n - begin) % excitation.alone == 0) copy_state(instrument, reference, arrays);
    const auto values = controls.at(n);
    for (std::size_t i = 0; i < arrays.controls.size(); ++i) {
      instrument.set(i, values[i]);
      const InstrumentControl& control = arrays.controls[i];
      if (control.quantity == ControlQuantity::kForce)
        for (std::size_t t = 0; t < control.count; ++t)
          reference.push(arrays.targets[control.first_target + t], values[i]);
      else
        ASSERT_EQ(values[i], arrays.parameters[i].initial) << "only forces may change here";
    }
    while (const auto* change = strikes.next_until(n)) {
      instrument.strike(change->strike->strike, change->strike->speed_m_per_s);
      reference.strike(change->strike->strike, change->strike->speed_m_per_s);
    }
    instrument.tick();
    reference.tick();
    for (std::size_t i = 0; i < outputs; ++i) {
      const auto expected = static_cast<double>(reference.output(i));
      peak[i] = std::max(peak[i], std::abs(expected));
      const double difference = std::abs(instrument.output(i) - expected);
      if (!(difference <= error[i])) error[i] = difference;
    }
  }
  EXPECT_LE(reference.residual(), 1e-15L);
  for (std::size_t i = 0; i < outputs; ++i) {
    EXPECT_GT(peak[i], 1e-3);
    EXPECT_TRUE(within(error[i], 0, excitation.error * peak[i])) << arrays.outputs[i].name;
    Measured() << GetParam() << ", " << arrays.outputs[i].name << ": " << error[i] / peak[i] << " of the largest";
  }
}

// Displacement of a place at multiples of 1/44100 s. Forces are those in the middle of each sample, for a force that
// is sampled at its beginning is late by half a sample.
template <typename Network>
std::vector<double> displacements(const InstrumentArrays& arrays, std::size_t place, int oversampling,
                                  std::size_t samples) {
  const double rate = kRate * oversampling;
  Network network(arrays.view(), rate);
  if (!arrays.strikes.empty()) network.strike(0, 2.5);
  std::vector<double> found;
  for (std::size_t n = 0; n < samples * static_cast<std::size_t>(oversampling); ++n) {
    for (std::size_t i = 0; i < arrays.controls.size(); ++i) {
      const InstrumentControl& control = arrays.controls[i];
      if (control.quantity != ControlQuantity::kForce) continue;
      double force = arrays.parameters[i].initial;
      const double part = (static_cast<double>(n) + 0.5) / (oversampling * 100);
      if (arrays.strikes.empty() && part < 1) force = 0.45 * part * part * (3 - 2 * part);
      if constexpr (std::same_as<Network, ReferenceNetwork>) {
        network.push(arrays.targets[control.first_target], force);
      } else {
        network.set(i, force);
      }
    }
    network.tick();
    if ((n + 1) % static_cast<std::size_t>(oversampling) != 0) continue;
    found.push_back(static_cast<double>(network.displacement(place)));
  }
  return found;
}

// The largest difference from a reference, as a part of its largest value.
double relative_error(const std::vector<double>& found, const std::vector<double>& exact) {
  double scale = 0, error = 0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    scale = std::max(scale, std::abs(exact[n]));
    const double difference = std::abs(found.at(n) - exact[n]);
    if (!(difference <= error)) error = difference;
  }
  return error / scale;
}

// 5 ms against the independent solution at 16 times the rate. With an error c/k^2 at k times the rate, the ratios are
// (1 - 1/256)/(1/4 - 1/256) = 4.05 and 4.2. Contacts so stiff that a hit is shorter than a sample reduce the order:
// the stiffness of steel on steel and of a drum stick is reduced.
TEST_P(SmoothInstrument, IsOfSecondOrder) {
  const InstrumentModel model = parse_instrument(shipped_text(Shipped::kInstruments, GetParam()), GetParam());
  InstrumentArrays arrays = arrays_for_reference(model);
  const Excitation& excitation = kExcitations.at(GetParam());
  const std::set<std::string> kStiff{"felt_over_wood", "steel_on_steel"};
  for (InstrumentConnection& connection : arrays.connections)
    if (connection.kind == ConnectionKind::kContact && kStiff.contains(model.tables[connection.table].material))
      connection.weight *= excitation.softening;
  const std::size_t place = place_index(model, excitation.place);
  const auto exact = displacements<ReferenceNetwork>(arrays, place, 16, 221);
  double coarse = 0;
  for (const int oversampling : {1, 2, 4}) {
    const double error = relative_error(displacements<SeenNetwork<double>>(arrays, place, oversampling, 221), exact);
    Measured() << GetParam() << " at " << oversampling << " times 44.1 kHz: " << error << " of the largest";
    if (coarse > 0) {
      EXPECT_TRUE(within(coarse / error, 4.15, 0.45)) << oversampling;
    }
    coarse = error;
  }
}

// The bridge of the tanpura with n points, of the same length, curve and stiffness.
InstrumentArrays tanpura_of(std::size_t n) {
  InstrumentModel model = parse_instrument(shipped_text(Shipped::kInstruments, "tanpura"), "tanpura");
  InstrumentPlace& place = *std::ranges::find(model.places, "over_bridge", &InstrumentPlace::name);
  ConnectionGroup& bridge = *std::ranges::find(model.connections, "bridge", &ConnectionGroup::name);
  place.points.clear();
  bridge.gaps_m.clear();
  bridge.weights.assign(n, 1 / static_cast<double>(n));
  for (std::size_t k = 0; k < n; ++k) {
    const double part = (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    place.points.push_back({0.0192 * part});
    bridge.gaps_m.push_back(8e-5 * std::pow(0.96 * part, 2));
  }
  return arrays_of(model, kRate / 2);
}

// 20 ms of a pluck against 192 points. The shipped bridge has 24.
TEST(Tanpura, ConvergesAsItsBridgeIsRefined) {
  const auto sound_of = [](std::size_t points) {
    return displacements<SeenNetwork<double>>(tanpura_of(points), 0, 1, 882);
  };
  const auto exact = sound_of(192);
  double coarse = std::numeric_limits<double>::infinity();
  for (const std::size_t points : {6u, 12u, 24u, 48u}) {
    const double error = relative_error(sound_of(points), exact);
    Measured() << points << " points: " << error << " of the largest";
    EXPECT_LT(error, coarse / 1.5) << points;
    coarse = error;
  }
  EXPECT_LT(coarse, 1e-3);
}

}  // namespace
}  // namespace contactspline::testing
