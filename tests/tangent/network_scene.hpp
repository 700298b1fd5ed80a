// SPDX-License-Identifier: MIT
// A network whose numbers can be moved by a little, in any type, and its tangent.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/tangent/network_tangent.hpp"
#include "exact_felt.hpp"
#include "power_table.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

inline constexpr std::size_t kSamples = 400, kModes = 6;

/// Two masses with felts, the first on a string, which lies on a bridge of three points, the second above the first;
/// a spring with a damper at the end of the string and one between the masses. In any type, with each number moved by
/// a part `h` of itself.
template <typename T>
struct Scene {
  enum Number {
    kStiffness,
    kLoss,
    kWeight,
    kTime,
    kSpring,
    kResistance,
    kGap,
    kMass,
    kFrequency,
    kDecay,
    kModeMass,
    kShape,
    kSpeed,
    kPush,
    kNumbers
  };

  Scene(Random random, int moved, T h, std::size_t memory_count = 1)
      : speed(T(random.between(0.5, 4))), push(T(random.between(0, 5))) {
    const auto part = [&](Number number, double value) { return number == moved ? T(value) * (1 + h) : T(value); };
    rate = random.log_between(30000, 100000);
    speed = part(kSpeed, double(speed)), push = part(kPush, double(push));
    exponent = random.between(1.3, 3);
    felt = power_table<T>(random.log_between(1e7, 1e10), exponent, 1e-3, 40);
    wood = power_table<T>(random.log_between(1e7, 1e8), 1.3, 1e-3, 40);
    memories = {
        {double(part(kWeight, random.between(0.2, 0.8))), double(part(kTime, random.log_between(5e-6, 2e-4)))}};
    memories.push_back({0.1, 3e-5});
    memories.resize(memory_count);
    const double mass = double(part(kMass, random.log_between(2e-3, 2e-2)));
    masses = {plan.add_mass(mass), plan.add_mass(random.log_between(2e-3, 2e-2))};
    std::vector<Mode> modes;
    const double w = 2 * std::numbers::pi * random.log_between(80, 400), mode_mass = random.log_between(1e-3, 1e-2);
    for (std::size_t i = 1; i <= kModes; ++i)
      modes.push_back({double(part(kFrequency, w * double(i))), double(part(kDecay, 1.0 + double(i))),
                       double(part(kModeMass, mode_mass))});
    const std::size_t string = plan.add_body(modes);
    const std::size_t hammer = plan.add_mass_place(masses[0]), second = plan.add_mass_place(masses[1]);
    const auto place = [&](double at, bool is_moved) {
      std::vector<double> shapes;
      for (std::size_t i = 1; i <= kModes; ++i) {
        const double shape = std::sin(std::numbers::pi * double(i) * at);
        shapes.push_back(is_moved ? double(part(kShape, shape)) : shape);
      }
      return plan.add_place(string, shapes);
    };
    struck = place(random.between(0.1, 0.3), true);
    const ContactControls<T> controls{part(kStiffness, random.log_between(0.5, 2)),
                                      part(kLoss, random.between(0.01, 0.1))};
    plan.add_contact(hammer, struck, SegmentTable<T>(felt), part(kGap, 1e-5), controls, T(1.3), memories);
    plan.add_contact(second, hammer, SegmentTable<T>(felt), T(2e-4));
    for (const double at : {0.55, 0.6, 0.65})
      plan.add_contact(place(at, false), kGround, SegmentTable<T>(wood), T(1e-5), {}, T(0.1));
    plan.add_spring(place(0.9, false), kGround, part(kSpring, random.log_between(1e3, 1e5)), part(kResistance, 0.3));
    plan.add_spring(hammer, second, T(200));
  }

  [[nodiscard]] std::vector<T> play() const {
    ContactNetwork<T> network(plan, rate);
    network.set_motion(masses[0], 0, speed);
    network.set_motion(masses[1], 0, 2 * speed);
    std::vector<T> samples;
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (n < 50) network.push(struck, push);
      network.tick();
      samples.push_back(network.displacement(struck));
      for (std::size_t k = 0; k < plan.connections().size(); ++k) samples.push_back(network.force(k));
    }
    return samples;
  }

  T speed, push;
  double rate, exponent;
  std::vector<Segment<T>> felt, wood;
  std::vector<Memory> memories;
  NetworkPlan<T> plan;
  std::array<std::size_t, 2> masses{};
  std::size_t struck = 0;
};

using Played = Scene<double>;
using Tangent = NetworkTangent<double, Played::kNumbers>;

/// The derivatives for all numbers, as play() orders the samples.
struct Slopes {
  explicit Slopes(const Played& scene) : scene_(scene), tangent(scene.plan, scene.rate, directions()) {
    tangent.set_motion(scene.masses[0], 0, along(Played::kSpeed, scene.speed));
    tangent.set_motion(scene.masses[1], 0, along(Played::kSpeed, 2 * scene.speed));
  }

  static Tangent::Number along(std::size_t number, double value) {
    Tangent::Number result(value);
    result.slopes[number] = value;
    return result;
  }

  [[nodiscard]] std::array<NetworkNumbers<double>, Played::kNumbers> directions() const {
    const NetworkPlan<double>& plan = scene_.plan;
    std::array<NetworkNumbers<double>, Played::kNumbers> all;
    const auto& contact = plan.connections()[0];
    const auto& spring = plan.connections()[5];
    for (auto& direction : all) direction.connections.resize(plan.connections().size());
    all[Played::kStiffness].connections[0].contact.stiffness_ratio = contact.contact.stiffness_ratio;
    all[Played::kLoss].connections[0].contact.loss_s_per_m = contact.contact.loss_s_per_m;
    if (const auto& memories = scene_.memories; !memories.empty())
      for (const auto number : {Played::kWeight, Played::kTime}) {
        auto& moved = all[number].connections[0].contact.memories;
        moved.resize(memories.size());
        moved[0] = {number == Played::kWeight ? memories[0].weight : 0,
                    number == Played::kTime ? memories[0].time_s : 0};
      }
    all[Played::kSpring].connections[5].spring_n_per_m = spring.spring_n_per_m;
    all[Played::kResistance].connections[5].resistance_n_s_per_m = spring.resistance_n_s_per_m;
    all[Played::kGap].connections[0].gap_m = contact.gap_m;
    for (const auto number : {Played::kMass, Played::kFrequency, Played::kDecay, Played::kModeMass}) {
      auto& bodies = all[number].bodies;
      bodies.resize(plan.bodies().size());
      const std::size_t body = number == Played::kMass ? 0 : 2;
      for (const Mode& mode : plan.bodies()[body])
        bodies[body].push_back({number == Played::kFrequency ? mode.angular_frequency_rad_per_s : 0,
                                number == Played::kDecay ? mode.decay_per_s : 0,
                                number == Played::kMass || number == Played::kModeMass ? mode.mass_kg : 0});
    }
    auto& places = all[Played::kShape].places;
    places.resize(plan.places().size());
    places[scene_.struck] = plan.places()[scene_.struck].shapes;
    return all;
  }

  void tick(std::size_t n) {
    if (n < 50) tangent.push(scene_.struck, along(Played::kPush, scene_.push));
    tangent.tick();
  }

  const Played& scene_;
  Tangent tangent;
};

/// A mass that is pressed on a string with felt and slides along it, from rest to rest. Under the mass, at the place
/// that moves, the ground limits the string; it lies on a point, too, and is held by a spring. With each number moved
/// by a part `h` of itself.
template <typename T>
struct Slide {
  enum Number { kStart, kEnd, kSlideSpeed, kFrequency, kStiffness, kNumbers };
  static constexpr double kRate = 44100;

  Slide(Random random, int moved, T h) {
    const auto part = [&](Number number, double value) { return number == moved ? T(value) * (1 + h) : T(value); };
    start = part(kStart, random.between(0.2, 0.3)), end = part(kEnd, random.between(0.31, 0.33));
    metres_per_sample = part(kSlideSpeed, random.between(1e-4, 3e-4));  // slower than the string lets it
    felt = power_table<T>(random.log_between(1e7, 1e9), random.between(1.3, 3), 1e-3, 40);
    mass = plan.add_mass(random.log_between(2e-3, 2e-2));
    const double w = 2 * std::numbers::pi * random.log_between(80, 400);
    std::vector<Mode> modes;
    for (std::size_t i = 1; i <= kModes; ++i) {
      modes.push_back({double(part(kFrequency, w * double(i))), 1.0 + double(i), 4e-3});
      wavenumbers.push_back(std::numbers::pi * double(i));  // of a string of 1 m
    }
    const std::size_t string = plan.add_body(modes);
    const auto place = [&](double at) {
      std::vector<double> shapes;
      for (const double beta : wavenumbers) shapes.push_back(std::sin(beta * at));
      return plan.add_place(string, shapes);
    };
    on_mass = plan.add_mass_place(mass);
    slid = plan.add_moving_place(string, wavenumbers, start);
    output = place(0.7);
    plan.add_contact(on_mass, slid, SegmentTable<T>(felt), 0, {part(kStiffness, 1.0), T(0.05)});
    plan.add_contact(place(0.6), kGround, SegmentTable<T>(felt), T(1e-5));
    plan.add_spring(place(0.9), kGround, T(1e4), T(0.2));
    limit = plan.add_contact(slid, kGround, SegmentTable<T>(felt), T(2e-5));
  }

  /// Where the mass is sent before sample n.
  template <typename Value>
  [[nodiscard]] static Value target(std::size_t n, const Value& from, const Value& to, const Value& step) {
    const Value at = from + Value(static_cast<double>(std::min<std::size_t>(n, 250))) * step;
    return at < to ? at : to;
  }

  [[nodiscard]] std::vector<T> play(bool slides = true) const {
    return play_to(
        [&](std::size_t n) { return slides && n >= 60 ? target(n - 60, start, end, metres_per_sample) : start; });
  }
  /// target(n): where the mass is sent before sample n.
  template <typename Target>
  [[nodiscard]] std::vector<T> play_to(Target target) const {
    ContactNetwork<T> network(plan, kRate);
    network.set_motion(mass, 0, T(0.5));
    std::vector<T> samples;
    for (std::size_t n = 0; n < kSamples; ++n) {
      network.push(on_mass, 5);
      network.move_place(slid, target(n));
      network.tick();
      samples.push_back(network.displacement(output));
      samples.push_back(network.displacement(slid));
      for (std::size_t k = 0; k < plan.connections().size(); ++k) samples.push_back(network.force(k));
    }
    return samples;
  }

  T start, end, metres_per_sample;
  std::vector<Segment<T>> felt;
  std::vector<double> wavenumbers;
  NetworkPlan<T> plan;
  std::size_t mass = 0, on_mass = 0, slid = 0, output = 0, limit = 0;
};

inline double largest(std::span<const double> values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

// Knots bend what is played: the wider a central difference, the more of them lie within it. The narrower, the more
// its values round. Of three widths the middle difference is the right one, sample by sample.
template <typename Play>
std::vector<double> middle_difference(Play play, Real width) {
  const auto wide = central_difference(play, 10 * width), middle = central_difference(play, width),
             narrow = central_difference(play, width / 10);
  std::vector<double> differences;
  for (std::size_t n = 0; n < wide.size(); ++n)
    differences.push_back(std::max(std::min(wide[n], middle[n]), std::min(std::max(wide[n], middle[n]), narrow[n])));
  return differences;
}

/// By how much a central difference moves a number: the samples follow some of them weakly.
inline Real width_for(int number) {
  constexpr std::array kWeak = {Played::kSpring, Played::kResistance, Played::kDecay};
  return std::ranges::count(kWeak, number) > 0 ? 1e-6L : 1e-8L;
}

}  // namespace contactspline::testing
