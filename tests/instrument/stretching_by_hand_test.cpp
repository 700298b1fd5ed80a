// SPDX-License-Identifier: MIT
// An instrument file with the key `stretch` against a network by hand and against its class.
#include <cmath>
#include <numbers>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/input_file.hpp"
#include "slack_string.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100, kPi = std::numbers::pi;

// A finger that pulls within 10 ms and lets go [N].
double pull(int n) {
  return n < 441 ? 0.3 * n / 441 : 0;
}

// The string of slack_string.json, with its form and the force on its far support, -(T + dT) u' + EI u''', by hand.
// T is 6.35 N, EI 8e-5 N m^2; dT = E S/(2 L) times the integral of u'^2. The arrays have 13 digits.
TEST(StretchingFile, PlaysAStringAsANetworkByHand) {
  constexpr double kLength = 0.65, kTension = 6.35, kBending = 8e-5, kAxial = 2e11 * kPi / 4 * 3e-4 * 3e-4;
  const InstrumentArrays arrays =
      arrays_of(parse_instrument(read_input(EXAMPLES_FOLDER "/slack_string.json"), "slack_string.json"), kRate / 2);
  BySample<double> instrument(arrays.view(), kRate);
  StretchForm form{kAxial * kLength / 8, {}};
  std::vector<double> plucked, pickup, wavenumbers;
  for (std::size_t i = 0; i < arrays.masses.size(); ++i) {
    wavenumbers.push_back(static_cast<double>(i + 1) * kPi / kLength);
    form.squares_per_m2.push_back(wavenumbers[i] * wavenumbers[i]);
    plucked.push_back(std::sin(wavenumbers[i] * 0.13));
    pickup.push_back(std::sin(wavenumbers[i] * 0.06));
  }
  NetworkPlan<double> plan;
  const std::size_t string = plan.add_body(arrays.view().modes(), std::vector{form});
  const std::size_t finger = plan.add_place(string, plucked);
  ContactNetwork<double> network(plan, kRate);
  const ModeShapes<double> heard = network.body(string).sound_pickup(pickup);
  std::vector<double> actual[2], expected[2];
  double highest = 0;
  for (int n = 0; n < 8820; ++n) {
    instrument.set(0, pull(n));
    instrument.tick();
    network.push(finger, pull(n));
    network.tick();
    double rise = 0, end = 0;
    for (std::size_t i = 0; i < wavenumbers.size(); ++i)
      rise += kAxial / 4 * form.squares_per_m2[i] * std::pow(network.body(string).displacement(i), 2);
    for (std::size_t i = 0; i < wavenumbers.size(); ++i)
      end -= wavenumbers[i] * (kTension + rise + kBending * form.squares_per_m2[i]) * (i % 2 == 0 ? -1 : 1) *
             network.body(string).sound_shape(i, network.body(string).displacement(i));
    highest = std::max(highest, rise / kTension);
    for (std::size_t o = 0; o < 2; ++o) actual[o].push_back(instrument.output(o));
    expected[0].push_back(network.body(string).displacement(heard));
    expected[1].push_back(end);
  }
  Measured() << "the tension rises by " << 100 * highest << " %";
  EXPECT_GT(highest, 0.2);
  for (std::size_t o = 0; o < 2; ++o)
    EXPECT_TRUE(sequences_within<double>(actual[o], expected[o], 1e-9)) << arrays.outputs[o].name;
}

// The class that `generate` emits has the forms and the far end, too.
TEST(StretchingFile, PlaysAsItsClass) {
  const InstrumentArrays arrays =
      arrays_of(parse_instrument(read_input(EXAMPLES_FOLDER "/slack_string.json"), "slack_string.json"), kRate / 2);
  BySample<double> of_file(arrays.view(), kRate);
  BySample<double> of_class(instruments::slack_string<double>::data::view(), kRate);
  for (int n = 0; n < 2000; ++n) {
    of_file.set(0, pull(n));
    of_class.set(0, pull(n));
    of_file.tick();
    of_class.tick();
    ASSERT_EQ(of_file.output(0), of_class.output(0)) << n;
    ASSERT_EQ(of_file.output(1), of_class.output(1)) << n;
  }
}

}  // namespace
}  // namespace contactspline::testing
