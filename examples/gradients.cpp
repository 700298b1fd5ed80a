// SPDX-License-Identifier: MIT
// gradients: derivatives of a struck string, forwards and backwards, and of a network
// (docs/how-it-works/gradients.md). Fails where forwards and backwards differ.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/tangent/network_gradient.hpp"
#include "contactspline/tangent/strike_gradient.hpp"
#include "contactspline/tangent/strike_tangent.hpp"

namespace cs = contactspline;
using Felt = cs::materials::felt_c4;
constexpr auto& felt = cs::segments_of<Felt, double>;

/// How the energy of a struck C4 string, the sum of its squares, changes with the stiffness of the felt, its exponent
/// and the speed of the hammer. Do both ways agree?
static bool differentiate_strike() {
  using String = cs::resonators::string_c4;
  const cs::ModeShapes<double> strike_shapes(std::span<const double>{String::strike_shapes});
  const cs::ModeShapes<double> pickup_shapes(std::span<const double>{String::pickup_shapes});
  const cs::HammerStrike<double> strike{
      felt, cs::modes_in<String>, strike_shapes, pickup_shapes, {.hammer_mass_kg = 0.00297}, 2.5, 1e-4};

  std::array<cs::StrikeNumbers<double>, 3> directions;
  directions[0].felt.stiffness_ratio = 1;
  directions[1].felt.table = cs::exponent_direction<double>(felt, Felt::max_compression_m, 0.0005);
  directions[2].velocity_m_per_s = 1;

  cs::StrikeTangent<double, 3> tangent(strike, 44100, directions);
  std::vector<cs::Dual<double, 3>> out(4410);
  tangent.process(out);
  std::array<double, 3> forwards{};
  std::vector<double> weights;  // derivative of the sum with respect to each sample
  for (const auto& sample : out) {
    for (std::size_t p = 0; p < 3; ++p) forwards[p] += 2 * sample.value * sample.slopes[p];
    weights.push_back(2 * sample.value);
  }

  const auto gradient = cs::strike_gradient<double>(strike, 44100, weights);
  bool agree = true;
  for (std::size_t p = 0; p < 3; ++p) {
    const double backwards = cs::derivative(gradient, directions[p]);
    std::printf("%g %g\n", forwards[p], backwards);
    agree = agree && std::abs(forwards[p] - backwards) <= 1e-9 * std::abs(backwards);
  }
  return agree;
}

/// A mass is thrown on a string of six modes that a spring holds. Prints how the sum of the squares of the
/// displacement at a place changes with the stiffness of the felt, with the place of the blow and with the speed.
static void differentiate_network() {
  std::vector<double> wavenumbers;
  std::vector<cs::Mode> modes;
  for (int i = 1; i <= 6; ++i) {
    wavenumbers.push_back(std::numbers::pi * i);  // of a string of 1 m
    modes.push_back({1600.0 * i, 1.0 * i, 0.003});
  }
  cs::NetworkPlan<double> plan;
  const std::size_t hammer = plan.add_mass(0.003), string = plan.add_body(modes);
  const std::size_t struck = plan.add_moving_place(string, wavenumbers, 0.12);
  const std::size_t heard = plan.add_moving_place(string, wavenumbers, 0.4);
  plan.add_contact(plan.add_mass_place(hammer), struck, felt);
  plan.add_spring(heard, cs::kGround, 100);

  cs::RecordedNetwork<double> network(plan, 44100);
  network.set_motion(hammer, 0, 2.5);
  cs::NetworkWeights<double> weights;
  weights.displacements.resize(plan.places().size());
  for (int n = 0; n < 4410; ++n) {
    network.tick();
    weights.displacements[heard].push_back(2 * network.model().displacement(heard));
  }
  const auto gradient = network.gradient(weights);
  const auto by_place = cs::shapes_tangent<double>(wavenumbers, 0.12, 1);
  double by_metre = 0;
  for (std::size_t i = 0; i < modes.size(); ++i) by_metre += gradient.numbers.places[struck][i] * by_place[i];
  std::printf("%g %g %g\n", gradient.numbers.connections[0].contact.stiffness_ratio, by_metre,
              gradient.motions[0].velocity_m_per_s);
}

int main() {
  if (!differentiate_strike()) return 1;
  differentiate_network();
}
