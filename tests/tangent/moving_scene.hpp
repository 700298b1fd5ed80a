// SPDX-License-Identifier: MIT
// A string over a fixed barrier on which a mass and a pickup move, in any type, and what happens to it.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "network_scene.hpp"

namespace contactspline::testing {

/// A mass is pressed on a string at a place that moves; a second place that moves only hears the string. Below the
/// string lie three fixed points, the second place of them on the way of the mass, and one that goes with the mass.
/// Springs hold the string at its end and, in every second scene, between the two places that move. Each number of a
/// direction moves by `h` times what it says.
template <typename T>
struct Moving {
  enum Direction { kPlaces, kOtherPlaces, kString, kContact, kDirections };
  static constexpr double kRate = 44100;

  /// A position that a place is given before a sample; slopes: by kPlaces and kOtherPlaces.
  struct Call {
    std::size_t sample, place;
    bool is_put;
    double to_m;
    double slopes[2];
  };

  Moving(std::uint64_t seed, int direction, T h) {
    Random random(seed);
    const auto part = [&](Direction of, double value) { return of == direction ? T(value) * (1 + h) : T(value); };
    felt = power_table<T>(random.log_between(1e7, 1e9), random.between(1.5, 3), 1e-3, 40);
    for (std::size_t i = 0; i < seed % 3; ++i)
      memories.push_back({double(part(kContact, 0.3)), double(part(kContact, 2e-5 + 5e-5 * double(i)))});
    mass = plan.add_mass(random.log_between(2e-3, 2e-2));
    const double w = 2 * std::numbers::pi * random.log_between(80, 400);
    std::vector<Mode> modes;
    for (std::size_t i = 1; i <= kModes; ++i) {
      // The slowest wave keeps its speed: it limits that of the places, whose derivatives do not count this.
      const double frequency = i == 1 ? 0.99 * w : double(part(kString, w * double(i)));
      modes.push_back({frequency, double(part(kString, 1.0 + double(i))), double(part(kString, 4e-3))});
      wavenumbers.push_back(std::numbers::pi * double(i));  // a string of 1 m
    }
    string = plan.add_body(modes);
    const auto still = [&](double at) {
      std::vector<double> shapes;
      for (const double beta : wavenumbers) shapes.push_back(std::sin(beta * at));
      return plan.add_place(string, shapes);
    };
    on_mass = plan.add_mass_place(mass);
    start = random.between(0.2, 0.3);
    slid = plan.add_moving_place(string, wavenumbers, T(start));
    heard = plan.add_moving_place(string, wavenumbers, T(0.7));
    plan.add_contact(on_mass, slid, SegmentTable<T>(felt), 0, {part(kContact, 1.0), part(kContact, 0.05)}, 1,
                     memories);
    plan.add_spring(still(0.9), kGround, part(kContact, 1e4), part(kContact, 0.2));
    plan.add_contact(slid, kGround, SegmentTable<T>(felt), part(kContact, 2e-5));
    for (const double at : {start + 0.005, 0.6, 0.65})
      plan.add_contact(still(at), kGround, SegmentTable<T>(felt), T(1e-5));
    if (seed % 2 == 0) plan.add_spring(heard, slid, part(kContact, 300), T(0.05));
    call(random);
  }

  /// Plays a model; at(call): the position that it is given. Before: each(n) after sample n.
  template <typename Model, typename At, typename Each>
  void play(Model& model, At at, Each each) const {
    model.set_motion(mass, 0.0, 0.5);
    std::size_t next = 0;
    for (std::size_t n = 0; n < kSamples; ++n) {
      for (; next < calls.size() && calls[next].sample == n; ++next) {
        const Call& c = calls[next];
        if (c.is_put)
          model.put_place(c.place, at(c));
        else
          model.move_place(c.place, at(c));
      }
      if (n == 321) model.set_motion(mass, 2e-5, -0.3);
      model.push(on_mass, 5.0);
      if (n % 50 < 10) model.push(heard, 0.5), model.push(slid, -0.2);
      model.tick();
      each(n);
    }
  }
  /// Displacements of both places and all forces, one sample after the other.
  [[nodiscard]] std::vector<T> samples(int direction, T h) const {
    ContactNetwork<T> network(plan, kRate);
    std::vector<T> all;
    const auto at = [&](const Call& c) {
      const T moved = direction == kPlaces        ? h * T(c.slopes[0])
                      : direction == kOtherPlaces ? h * T(c.slopes[1])
                                                  : T(0);
      return T(c.to_m) + moved;
    };
    play(network, at, [&](std::size_t) {
      for (const std::size_t place : {slid, heard}) all.push_back(network.displacement(place));
      for (std::size_t k = 0; k < plan.connections().size(); ++k) all.push_back(network.force(k));
    });
    return all;
  }
  [[nodiscard]] std::size_t outputs() const { return 2 + plan.connections().size(); }

  // The mass slides, rests, jumps faster than the string lets it, is called again where it rests, is put elsewhere
  // while it slides, and stops where it is. The pickup sways, rests, is put elsewhere, and sways again.
  void call(Random& random) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t n = 0; n < kSamples; ++n) {
      const auto add = [&](std::size_t place, double to_m, bool is_put = false) {
        calls.push_back({n, place, is_put, to_m, {random.between(-1, 1), random.between(-1, 1)}});
      };
      if (n >= 40 && n < 140) add(slid, start + 1e-4 * double(n - 39));
      if (n == 180) add(slid, start + 0.045), add(slid, start + 0.05);  // the last call counts
      if (n == 300 || n == 303) add(slid, start + 0.05);
      if (n >= 316 && n < 345) add(slid, start + 0.05 - 1e-4 * double(n - 315));
      if (n == 330) add(slid, start + 0.03, true);
      if (n == 360) add(slid, start + 0.2);
      if (n == 365) add(slid, none);
      if (n >= 20 && n < 250) add(heard, 0.7 + 0.002 * std::sin(double(n - 19) / 30));
      if (n == 270) add(heard, 0.5, true);
      if (n == 271) add(heard, none, true);
      if (n >= 310) add(heard, 0.5 + 0.002 * std::sin(double(n - 309) / 30));
    }
  }

  double start = 0;
  std::vector<Segment<T>> felt;
  std::vector<Memory> memories;
  std::vector<double> wavenumbers;
  NetworkPlan<T> plan;
  std::size_t mass = 0, string = 0, on_mass = 0, slid = 0, heard = 0;
  std::vector<Call> calls;
};

}  // namespace contactspline::testing
