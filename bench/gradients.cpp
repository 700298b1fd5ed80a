// SPDX-License-Identifier: MIT
// bench/gradients: what derivatives of a struck C4 string cost, in runs of the string itself; and those of the string
// as a network, alone and over a bridge, in runs of the network. One second, medians over rounds in which every task
// runs once.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "bench/paired_timer.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/felt_stulov_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/tangent/network_gradient.hpp"
#include "contactspline/tangent/network_tangent.hpp"
#include "contactspline/tangent/strike_gradient.hpp"
#include "contactspline/tangent/strike_tangent.hpp"

namespace contactspline::bench {
namespace {

using Felt = materials::felt_c4;
using String = resonators::string_c4;
constexpr double kRate = 44100;
constexpr std::size_t kSamples = 44100;
double computed = 0;  // so that nothing is left out

HammerStrike<double> strike() {
  const auto& felt = segments_of<Felt, double>;
  return {felt,
          modes_in<String>,
          ModeShapes<double>(std::span<const double>(String::strike_shapes)),
          ModeShapes<double>(std::span<const double>(String::pickup_shapes)),
          {.hammer_mass_kg = 0.00297},
          2.5,
          1e-4};
}

// Parameters of the hammer and its felt; or of the string, whose modes all change.
template <std::size_t P>
std::array<StrikeNumbers<double>, P> directions(bool of_string) {
  std::array<StrikeNumbers<double>, P> all;
  for (std::size_t p = 0; p < P; ++p) {
    if (of_string)
      for (const Mode& mode : modes_in<String>)
        all[p].modes.push_back({double(p + 1) * mode.angular_frequency_rad_per_s, mode.decay_per_s, 0});
    else
      (p % 2 == 0 ? all[p].felt.stiffness_ratio : all[p].velocity_m_per_s) = double(p + 1);
  }
  return all;
}

void play_by_tick() {
  const HammerStrike<double> s = strike();
  auto model = detail::struck(s, kRate);
  for (std::size_t n = 0; n < kSamples; ++n) {
    model.tick(s.controls);
    computed += model.string().displacement(s.output);
  }
}

void play_by_process() {
  const HammerStrike<double> s = strike();
  auto model = detail::struck(s, kRate);
  std::vector<double> out(256);
  for (std::size_t n = 0; n < kSamples; n += out.size()) model.process(s.controls, s.output, out);
  computed += out[0];
}

template <std::size_t P>
void play_forwards(bool of_string) {
  StrikeTangent<double, P> tangent(strike(), kRate, directions<P>(of_string));
  std::vector<Dual<double, P>> out(256);
  for (std::size_t n = 0; n < kSamples; n += out.size()) tangent.process(out);
  computed += out[0].slopes[0];
}

void play_backwards() {
  const std::vector<double> weights(kSamples, 1.0);
  const auto gradient = strike_gradient<double>(strike(), kRate, weights);
  computed += gradient.felt.stiffness_ratio;
}

/// The string, its hammer and a spring at one place of it as a network; with a bridge, it lies on eight points. Where
/// it slides, the hammer meets a place that moves in each sample, from which a spring holds it, too.
struct Network {
  explicit Network(std::size_t bridge_points, bool has_memory, bool slides = false) : is_sliding(slides) {
    std::vector<double> wavenumbers;
    for (std::size_t i = 1; i <= String::modes; ++i)
      wavenumbers.push_back(std::numbers::pi * double(i));  // length 1 m
    const auto place = [&](double at) {
      std::vector<double> shapes;
      for (const double beta : wavenumbers) shapes.push_back(std::sin(beta * at));
      return plan.add_place(string, shapes);
    };
    const std::size_t on_hammer = plan.add_mass_place(hammer);
    struck = slides ? plan.add_moving_place(string, wavenumbers, 0.12) : place(0.12);
    if (slides) plan.add_spring(on_hammer, struck, 1e3, 0.1);
    const SegmentTable<double> felt(segments_of<Felt, double>), slow(segments_of<materials::felt_stulov_c4, double>);
    if (has_memory)
      plan.add_contact(on_hammer, struck, slow, 1e-4, {}, 1, memories_of<materials::felt_stulov_c4>);
    else
      plan.add_contact(on_hammer, struck, felt, 1e-4);
    for (std::size_t i = 0; i < bridge_points; ++i)
      plan.add_contact(place(0.9 + 0.01 * double(i)), kGround, felt, 1e-6, {}, 0.1);
    plan.add_spring(place(0.99), kGround, 1e4, 0.1);
    output = place(0.4);
  }

  template <typename Model>
  void play(Model& model) const {
    if constexpr (requires { model.samples(); })
      model.set_motion(hammer, 0, 2.5);
    else
      model.set_motion(hammer, {0.0}, {2.5});
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (is_sliding) model.move_place(struck, 0.12 + 0.01 * std::sin(double(n) / 1000));
      model.tick();
      if constexpr (requires { model.samples(); })
        computed += model.model().displacement(output);
      else if constexpr (requires { model.displacement(output).value; })
        computed += model.displacement(output).value;
      else
        computed += model.displacement(output);
    }
  }

  void backwards() const {
    RecordedNetwork<double> network(plan, kRate);
    play(network);
    NetworkWeights<double> weights;
    weights.displacements.resize(plan.places().size());
    weights.displacements[output].assign(kSamples, 1.0);
    computed += network.gradient(weights).numbers.connections[0].contact.stiffness_ratio;
  }

  // of_string: parameters of the string's modes, or of the felt.
  template <std::size_t P>
  void forwards(bool of_string) const {
    std::array<NetworkNumbers<double>, P> directions;
    for (auto& direction : directions) {
      if (of_string) {
        direction.bodies = plan.bodies();
        direction.bodies[hammer].clear();
        continue;
      }
      direction.connections.resize(plan.connections().size());
      direction.connections[0].contact.stiffness_ratio = 1;
    }
    NetworkTangent<double, P> network(plan, kRate, directions);
    play(network);
  }

  /// How many numbers a gradient is with respect to.
  [[nodiscard]] double numbers() const {
    double count = 2;  // the motion of the hammer
    for (const auto& body : plan.bodies()) count += 3 * double(body.size());
    for (const auto& place : plan.places()) count += double(place.shapes.size());
    for (const auto& connection : plan.connections())
      count += connection.table.empty() ? 3 : 3 + 2 * double(connection.table.size() + connection.memories.size());
    return count;
  }

  NetworkPlan<double> plan;
  std::size_t hammer = plan.add_mass(0.00297), string = plan.add_body(modes_in<String>), output = 0, struck = 0;
  bool is_sliding;
};

struct Task {
  std::string name;
  double parameters;
  std::function<void()> run;
};

// What each task takes, in runs of the first.
void print_table(const std::vector<Task>& all, int rounds) {
  std::vector<TimedTask<std::function<void()>>> tasks;
  for (const Task& task : all) tasks.push_back({task.name, task.run});
  PairedTimer<std::function<void()>, ThreadClock> timer(tasks, kSamples);
  for (int i = 0; i < rounds; ++i) timer.round();
  fmt::print("| parameters | number | runs of `tick` | more runs for each parameter |\n|---|---|---|---|\n");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double runs = 1 / timer.ratio(i);
    fmt::print("| {} | {} | {:.2f} | {} |\n", all[i].name, all[i].parameters, runs,
               all[i].parameters > 0 ? fmt::format("{:.3f}", (runs - 1) / all[i].parameters) : "");
  }
  fmt::print("\n`tick`: {:.1f} ns a sample\n\n", timer.nanoseconds(0));
}

void print_struck_string(int rounds) {
  std::vector<Task> all = {{"tick", 0, play_by_tick}, {"process", 0, play_by_process}};
  for (const bool of_string : {false, true}) {
    const std::string of = of_string ? "of the string" : "of hammer and felt";
    all.push_back({of, 1, [=] { play_forwards<1>(of_string); }});
    all.push_back({of, 2, [=] { play_forwards<2>(of_string); }});
    all.push_back({of, 4, [=] { play_forwards<4>(of_string); }});
    all.push_back({of, 8, [=] { play_forwards<8>(of_string); }});
    all.push_back({of, 16, [=] { play_forwards<16>(of_string); }});
  }
  const double numbers = 3.0 * segments_of<Felt, double>.size() + 5.0 * String::modes;
  all.push_back({"backwards", numbers, play_backwards});
  print_table(all, rounds);
}

void print_network(std::size_t bridge_points, bool has_memory, bool slides, int rounds) {
  const Network network(bridge_points, has_memory, slides);
  const auto tick = [&] {
    ContactNetwork<double> model(network.plan, kRate);
    network.play(model);
  };
  fmt::print("A network, the string over {} points, {} memory{}:\n\n", bridge_points, has_memory ? "with" : "without",
             slides ? ", with a place that moves" : "");
  print_table({{"tick", 0, tick},
               {"forwards, of the felt", 1, [&] { network.forwards<1>(false); }},
               {"forwards, of the felt", 4, [&] { network.forwards<4>(false); }},
               {"forwards, of the string", 1, [&] { network.forwards<1>(true); }},
               {"forwards, of the string", 4, [&] { network.forwards<4>(true); }},
               {"backwards", network.numbers(), [&] { network.backwards(); }}},
              rounds);
}

void print(int rounds) {
  print_struck_string(rounds);
  for (const std::size_t bridge_points : {0, 8})
    for (const bool has_memory : {false, true}) print_network(bridge_points, has_memory, false, rounds);
  for (const std::size_t bridge_points : {0, 8}) print_network(bridge_points, false, true, rounds);
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  contactspline::bench::print(argc > 1 ? std::atoi(argv[1]) : 21);
  return contactspline::bench::computed == 0.5;
}
