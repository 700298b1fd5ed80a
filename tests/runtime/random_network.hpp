// SPDX-License-Identifier: MIT
// A random contact network, strings of a network, and a string over a bridge.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "power_table.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

// Memories of a random material: one to kMaxMemories, of 0.1 us to 0.1 s.
inline std::vector<Memory> random_memories(Random& random) {
  std::vector<Memory> memories(1 + random.below(kMaxMemories));
  const double sum = random.between(0, 0.99);
  for (Memory& memory : memories) memory = {sum / double(memories.size()), random.log_between(1e-7, 0.1)};
  return memories;
}

// Up to eight random forms, which at 1 m/s of the first mode store 0.01 to 10 times its energy.
inline std::vector<StretchForm> random_forms(Random& random, const std::vector<Mode>& modes) {
  std::vector<StretchForm> forms(1 + random.below(8));
  for (StretchForm& form : forms) {
    const double square = std::pow(modes[0].angular_frequency_rad_per_s, 2);
    form.stiffness_j = 2 * modes[0].mass_kg * random.log_between(0.01, 10);
    for (std::size_t i = 0; i < modes.size(); ++i)
      form.squares_per_m2.push_back(square * double(i + 1) * random.uniform());
    for (std::size_t i = 1; i < modes.size(); i += 1 + random.below(3))
      form.products.push_back({i - 1, i, square * random.between(-1, 1)});
  }
  return forms;
}

// A random network: masses and modal bodies, contacts of 8 decades of stiffness, springs, dampers and rigid links.
struct RandomNetwork {
  /// has_memory: do contacts have memories? stretches: do modal bodies stretch?
  explicit RandomNetwork(unsigned seed, bool has_memory = false, bool stretches = false)
      : random(seed), has_memory_(has_memory) {
    rate = std::vector<double>{22050, 44100, 96000, 192000}[random.below(4)];
    const std::size_t bodies = 2 + random.below(7), count = 1 + random.below(40);
    for (std::size_t b = 0; b < bodies; ++b) {
      if (random.below(2) == 0) {
        plan.add_mass_place(plan.add_mass(random.log_between(1e-4, 1)));
        continue;
      }
      std::vector<Mode> modes;
      const double f0 = random.log_between(30, 1000), mass = random.log_between(1e-3, 0.1);
      for (std::size_t i = 1; i <= 4 + random.below(20); ++i)
        modes.push_back({2 * std::numbers::pi * f0 * double(i), random.between(0, 20), mass});
      const std::size_t body = stretches ? plan.add_body(modes, random_forms(random, modes)) : plan.add_body(modes);
      for (std::size_t p = 0; p < 1 + random.below(8); ++p) {
        std::vector<double> shapes;
        const double place = random.between(0.01, 0.99);
        for (std::size_t i = 1; i <= modes.size(); ++i)
          shapes.push_back(std::sin(std::numbers::pi * double(i) * place));
        plan.add_place(body, shapes);
      }
    }
    tables.reserve(count);
    memories.reserve(count);
    for (std::size_t k = 0; k < count; ++k) connect();
  }

  void connect() {
    const std::size_t places = plan.places().size();
    std::size_t first = random.below(places), second = random.below(places + 1);
    if (second == first || second == places) second = kGround;
    if (second != kGround && random.below(2) == 0) std::swap(first, second);
    switch (random.below(8)) {
      case 0:
        plan.add_spring(first, second, random.log_between(10, 1e7));
        return;
      case 1: {
        const double resistance = random.log_between(1e-3, 10), stiffness = random.log_between(10, 1e5);
        plan.add_spring(first, second, stiffness, resistance);
        return;
      }
      case 2:
        if (second != kGround) {
          plan.add_rigid_link(first, second);
          return;
        }
        [[fallthrough]];
      default:
        const double exponent = random.between(1.01, 3), stiffness = random.log_between(1e4, 1e12);
        tables.push_back(power_table(stiffness, exponent, 1e-4));
        const double loss = random.below(3) == 0 ? random.between(0, 1) : 0.0, gap = random.between(0, 1e-3);
        if (has_memory_) memories.push_back(random_memories(random));
        const std::span<const Memory> memory = has_memory_ ? memories.back() : std::span<const Memory>();
        plan.add_contact(first, second, tables.back(), gap, {1, loss}, 1, memory);
    }
  }

  [[nodiscard]] ContactNetwork<double> network(int max_steps) {
    ContactNetwork<double> network(plan, rate, max_steps);
    for (std::size_t b = 0; b < plan.bodies().size(); ++b) network.set_motion(b, 0, random.between(-2, 2));
    return network;
  }

  Random random;
  double rate;
  NetworkPlan<double> plan;
  std::vector<Table> tables;
  std::vector<std::vector<Memory>> memories;

 private:
  bool has_memory_;
};

inline std::vector<Mode> string_modes(double f0, std::size_t count, double modal_mass) {
  std::vector<Mode> modes;
  for (std::size_t i = 1; i <= count; ++i)
    modes.push_back({2 * std::numbers::pi * f0 * double(i), 0.5 + 5e-4 * double(i * i), modal_mass});
  return modes;
}

inline std::vector<double> string_shapes(std::size_t count, double place) {
  std::vector<double> shapes;
  for (std::size_t i = 1; i <= count; ++i) shapes.push_back(std::sin(std::numbers::pi * double(i) * place));
  return shapes;
}

// A string of 0.9 m plucked over a bridge that curves down from it over 20 mm.
template <typename T>
struct Tanpura {
  Tanpura(std::size_t points, double rate)
      : table(power_table<T>(5e10, 1.3, 1e-4)), network(plan_of(points), rate), rate_hz(rate) {}

  NetworkPlan<T> plan_of(std::size_t points) {
    NetworkPlan<T> plan;
    const std::size_t string = plan.add_body(string_modes(131, 120, 2.7e-4));
    pluck = plan.add_place(string, string_shapes(120, 0.3));
    std::vector<std::size_t> places;
    std::vector<double> gaps, lengths(points, 0.02 / double(points));
    for (std::size_t k = 0; k < points; ++k) {
      const double part = (double(k) + 0.5) / double(points);
      places.push_back(plan.add_place(string, string_shapes(120, 0.02 * part / 0.9)));
      gaps.push_back(8e-5 * part * part);
    }
    bridge = plan.add_profile(places, kGround, SegmentTable<T>(table), gaps, lengths);
    return plan;
  }

  void tick() {
    if (sample < static_cast<int>(0.004 * rate_hz)) network.push(pluck, static_cast<T>(1000 * sample / rate_hz));
    ++sample;
    network.tick();
  }

  std::vector<Segment<T>> table;
  std::size_t pluck = 0;
  ConnectionRange bridge{};
  ContactNetwork<T> network;
  double rate_hz;
  int sample = 0;
};

}  // namespace contactspline::testing
