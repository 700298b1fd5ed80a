// SPDX-License-Identifier: MIT
// A network in which a body stretches, whose numbers can be moved by a little, in any type.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "contactspline/tangent/stretching_tangent.hpp"
#include "network_scene.hpp"
#include "power_table.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

enum class Case { kPlucked, kAtStop, kStruck };

/// A string or head that stretches, of which one mode is put elsewhere meanwhile, with each number moved by a part
/// `h` of itself, the exponent by `h`: plucked alone; plucked at a stop; or struck by a mass with felt, pushed, and
/// held by a spring with a damper.
template <typename T>
struct Stretched {
  enum Number {
    kTension,
    kDecay,
    kModeMass,
    kFormStiffness,
    kSquares,
    kFactor,
    kLinear,
    kDisplacement,
    kVelocity,
    kShape,
    kStopStiffness,
    kGap,
    kMass,
    kSpeed,
    kStiffness,
    kExponent,
    kLoss,
    kWeight,
    kTime,
    kPush,
    kSpring,
    kResistance,
    kNumbers
  };
  using Slope = Dual<double, kNumbers>;
  using Directions = std::array<NetworkNumbers<double>, kNumbers>;
  static constexpr double kEnd_m = 1e-3;      // of the felt
  static constexpr std::size_t kAgain = 200;  // before this sample a mode is put elsewhere

  Stretched(Random random, Case how, int moved_number, T by) : played(how), moved(moved_number), h(by) {
    rate = random.log_between(30000, 100000);
    add_head(random);
    struck = add_place(random.between(0.1, 0.3), kShape);
    if (played == Case::kAtStop) {
      wood = power_table<T>(random.log_between(1e6, 1e7), 1.5, 1e-3, 40);
      plan.add_contact(add_place(0.6), kGround, SegmentTable<T>(wood), part(kGap, 5e-4),
                       {part(kStopStiffness, 1.0), T(0)});
    } else if (played == Case::kStruck) {
      add_hammer(random);
    }
  }

  void add_head(Random& random) {
    const double w = 2 * std::numbers::pi * random.log_between(80, 400), mass_kg = random.log_between(1e-3, 1e-2);
    std::vector<Mode> modes;
    const double square = std::pow(std::numbers::pi / 0.65, 2), share = random.log_between(0.03, 1);
    std::vector<StretchForm> forms{{2 * share * mass_kg * std::pow(w / square / 3e-3, 2), {}}};
    forms.push_back({forms[0].stiffness_j * random.between(0, 0.5), {}});
    forms[0].stiffness_j = double(part(kFormStiffness, forms[0].stiffness_j));
    for (std::size_t i = 0; i < kModes; ++i) {
      const double n = double(i) + 1;
      modes.push_back({double(T(w * n) * (moved == kTension ? std::sqrt(1 + h) : T(1))),
                       double(part(kDecay, 1.0 + n)), double(part(kModeMass, mass_kg))});
      if (i + 1 == kModes) limit(random, modes[i]);
      forms[0].squares_per_m2.push_back(double(part(kSquares, square * n * n)));
      forms[1].squares_per_m2.push_back(square * random.between(-1, 1));
      displacements.push_back(random.between(-3e-3, 3e-3) / n), velocities.push_back(random.between(-2, 2) / n);
      if (i > 0) forms[1].products.push_back({i - 1, i, double(part(kFactor, square * random.between(-2, 2)))});
    }
    // The last mode stretches the body by itself, and is stiffer than the spring that the form is of it. A copy
    // leaves the scene as it is without.
    if (Random of_linear = random; of_linear.once_in(2) || of_linear.once_in(2)) {
      const double stiffness = mass_kg * std::pow(2 * std::numbers::pi * 80, 2) * of_linear.between(1, 3);
      forms[1].linear = {kModes - 1, double(part(kLinear, std::sqrt(2 * stiffness / forms[1].stiffness_j)))};
    }
    if (random.once_in(2)) forms.resize(1);
    head = plan.add_body(modes, forms);
  }
  // The last mode may be above half the sample rate, or decay too fast to have a velocity.
  void limit(Random& random, Mode& mode) const {
    const auto kind = random.below(3);
    if (kind == 1) mode.angular_frequency_rad_per_s = 1.2 * std::numbers::pi * rate;
    if (kind == 2) mode.decay_per_s *= 0.2 * rate / 7;
  }
  void add_hammer(Random& random) {
    const double stiffness = random.log_between(1e7, 1e9), exponent = random.between(1.3, 3);
    felt = power_table<T>(stiffness, exponent, kEnd_m, 40);
    if (moved == kExponent)
      felt = table_through<T>(SegmentTable<T>(felt), T(kEnd_m), [table = felt, this](T y) {
        return y > 0 ? force(SegmentTable<T>(table), y) * std::pow(y / T(kEnd_m), h) : T(0);
      });
    memories = {
        {double(part(kWeight, random.between(0.2, 0.8))), double(part(kTime, random.log_between(2e-5, 2e-4)))}};
    mass = plan.add_mass(double(part(kMass, random.log_between(2e-3, 2e-2))));
    speed = random.between(0.5, 4);
    plan.add_contact(plan.add_mass_place(mass), struck, SegmentTable<T>(felt), T(0),
                     {part(kStiffness, 0.8), part(kLoss, 0.05)}, T(1.2), memories);
    plan.add_spring(add_place(0.9), kGround, part(kSpring, 1e4), part(kResistance, 0.3));
  }
  std::size_t add_place(double at, int number = kNumbers) {
    std::vector<double> shapes;
    for (std::size_t i = 0; i < kModes; ++i)
      shapes.push_back(double(part(number, std::sin(std::numbers::pi * double(i + 1) * at))));
    return plan.add_place(head, shapes);
  }
  [[nodiscard]] T part(int number, double value) const { return number == moved ? T(value) * (1 + h) : T(value); }

  /// The derivatives of all numbers of the plan by h.
  [[nodiscard]] Directions directions() const {
    Directions all;
    const auto& forms = plan.forms(head);
    for (NetworkNumbers<double>& each : all) {
      each.bodies.resize(head + 1), each.bodies[head].resize(kModes);
      each.forms.resize(head + 1), each.forms[head].resize(forms.size());
      each.places.resize(struck + 1);
      each.connections.resize(plan.connections().size());
    }
    for (std::size_t i = 0; i < kModes; ++i) {
      const Mode& mode = plan.bodies()[head][i];
      all[kTension].bodies[head][i].angular_frequency_rad_per_s = mode.angular_frequency_rad_per_s / 2;
      all[kDecay].bodies[head][i].decay_per_s = mode.decay_per_s;
      all[kModeMass].bodies[head][i].mass_kg = mode.mass_kg;
    }
    all[kFormStiffness].forms[head][0].stiffness_j = forms[0].stiffness_j;
    all[kSquares].forms[head][0].squares_per_m2 = forms[0].squares_per_m2;
    if (forms.size() > 1) {
      all[kFactor].forms[head][1].products = forms[1].products;
      all[kLinear].forms[head][1].linear = forms[1].linear;
    }
    all[kShape].places[struck] = plan.places()[struck].shapes;
    if (!plan.connections().empty()) connect(all);
    return all;
  }
  void connect(Directions& all) const {
    const auto& contact = plan.connections()[0];
    if (played == Case::kAtStop) {
      all[kStopStiffness].connections[0].contact.stiffness_ratio = contact.contact.stiffness_ratio;
      all[kGap].connections[0].gap_m = contact.gap_m;
      return;
    }
    all[kMass].bodies.resize(mass + 1);
    all[kMass].bodies[mass] = {{0, 0, plan.bodies()[mass][0].mass_kg}};
    all[kStiffness].connections[0].contact.stiffness_ratio = contact.contact.stiffness_ratio;
    all[kLoss].connections[0].contact.loss_s_per_m = contact.contact.loss_s_per_m;
    all[kExponent].connections[0].contact.table = exponent_direction(contact.table, kEnd_m, kEnd_m);
    all[kWeight].connections[0].contact.memories = {{memories[0].weight, 0}};
    all[kTime].connections[0].contact.memories = {{0, memories[0].time_s}};
    all[kSpring].connections[1].spring_n_per_m = plan.connections()[1].spring_n_per_m;
    all[kResistance].connections[1].resistance_n_s_per_m = plan.connections()[1].resistance_n_s_per_m;
  }

  /// Plays a network or its tangent. number(index, value): a number to begin with or to push. hear(): after each
  /// sample.
  template <typename Model, typename Value, typename Hear>
  void play(Model& model, Value number, Hear hear) const {
    if (played == Case::kStruck)
      model.set_motion(mass, 0, number(kSpeed, speed));
    else
      for (std::size_t i = 0; i < kModes; ++i)
        model.set_motion(head, number(kDisplacement, displacements[i]), number(kVelocity, velocities[i]), i);
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (played == Case::kStruck && n < 50) model.push(struck, number(kPush, 3.0));
      if (n == kAgain) model.set_motion(head, number(kDisplacement, 1e-3), number(kVelocity, 0.5), 1);
      model.tick();
      hear();
    }
  }
  /// What play() gives to motion i, in the order of its calls.
  [[nodiscard]] NetworkGradient<double>::Motion motion(std::size_t i) const {
    if (i == (played == Case::kStruck ? 1 : kModes)) return {1e-3, 0.5};
    if (played == Case::kStruck) return {0, speed};
    return {displacements[i], velocities[i]};
  }
  /// Displacement and forces.
  template <typename Model, typename Samples>
  void hear(const Model& model, Samples& samples) const {
    samples.push_back(model.displacement(struck));
    for (std::size_t k = 0; k < plan.connections().size(); ++k) samples.push_back(model.force(k));
  }
  [[nodiscard]] std::vector<T> play() const {
    ContactNetwork<T> network(plan, rate);
    std::vector<T> samples;
    play(
        network, [&](int number, double value) { return part(number, value); }, [&] { hear(network, samples); });
    return samples;
  }
  static Slope along(int number, double value) {
    Slope result(value);
    result.slopes[std::size_t(number)] = value;
    return result;
  }
  [[nodiscard]] std::vector<Slope> play_with_slopes(StretchingTangent<double, kNumbers>& tangent) const {
    std::vector<Slope> samples;
    play(tangent, along, [&] { hear(tangent, samples); });
    return samples;
  }

  Case played;
  int moved;
  T h;
  double rate = 0, speed = 0;
  std::vector<Segment<T>> felt, wood;
  std::vector<Memory> memories;
  std::vector<double> displacements, velocities;
  NetworkPlan<T> plan;
  std::size_t head = 0, struck = 0, mass = 0;
};

using Scene64 = Stretched<double>;
using StretchedTangent = StretchingTangent<double, Scene64::kNumbers>;

}  // namespace contactspline::testing
