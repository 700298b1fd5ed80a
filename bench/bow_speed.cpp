// SPDX-License-Identifier: MIT
// bow_speed [ROUNDS]: what a sample of a bowed string costs, 51 rounds unless told: 60 transverse and 20 torsional
// modes under four points of hair or one of a rigid bow, on a body of 40 modes, in double and single precision;
// beside the same equations by Newton's method and, if the build found it, the bowed string of STK, a waveguide
// without torsion under one point. Medians of paired rounds; ratios are surer than times.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/baselines/newton_bow.hpp"
#include "bench/bowed_string.hpp"
#include "bench/paired_timer.hpp"
#ifdef CONTACTSPLINE_STK
#include <stk/Bowed.h>
#endif

namespace contactspline::bench {
namespace {

constexpr double kRate = 44100, kForce_n = 0.5, kSpeed_m_per_s = 0.1;
constexpr int kSamples = 2205;

using Task = TimedTask<std::function<void()>>;

bowing::BowedProblem problem_of(std::size_t points) {
  auto problem = bowing::problem_of(kViolinD, 0.1, points);
  bowing::add_body(problem, kViolinD, 40);
  return problem;
}

template <std::floating_point T>
Task ours(const bowing::BowedProblem& problem) {
  std::vector<std::size_t> points;
  const auto plan = bowing::plan_of<T>(problem, points);
  const auto network = std::make_shared<ContactNetwork<T>>(plan, kRate);
  for (const std::size_t point : points) {
    network->set_normal_force(point, T(kForce_n * problem.share()));
    network->set_surface_speed(point, T(kSpeed_m_per_s));
  }
  return {"friction step", [network] {
            for (int n = 0; n < kSamples; ++n) network->tick();
          }};
}

template <std::floating_point T>
Task by_newton(const bowing::BowedProblem& problem) {
  const auto bow = std::make_shared<NewtonBow<T>>(problem, kRate);
  return {"Newton's method", [bow] {
            for (int n = 0; n < kSamples; ++n) bow->tick(T(kForce_n), T(kSpeed_m_per_s));
          }};
}

#ifdef CONTACTSPLINE_STK
Task by_stk() {
  stk::Stk::setSampleRate(kRate);
  const auto bowed = std::make_shared<stk::Bowed>(50);
  bowed->noteOn(kViolinD.frequency_hz, 0.5);
  return {"STK", [bowed] {
            for (int n = 0; n < kSamples; ++n) bowed->tick();
          }};
}
#endif

template <std::floating_point T>
void print_times(const char* precision, std::size_t points, int rounds) {
  const auto problem = problem_of(points);
  std::vector<Task> tasks = {ours<T>(problem), by_newton<T>(problem)};
#ifdef CONTACTSPLINE_STK
  tasks.push_back(by_stk());
#endif
  PairedTimer<std::function<void()>, ThreadClock> timer(tasks, kSamples);
  for (int i = 0; i < rounds; ++i) timer.round();
  for (std::size_t i = 0; i < tasks.size(); ++i)
    std::printf("| %s | %zu | %s | %.0f | %.1f | %.2f |\n", precision, points, tasks[i].name.c_str(),
                timer.nanoseconds(i), 1e9 / kRate / timer.nanoseconds(i), 1 / timer.ratio(i));
}

void report(int rounds) {
  std::printf(
      "| precision | points | bowed string | ns per sample of 44.1 kHz | times real time | time, of ours |\n"
      "|---|---:|---|---:|---:|---:|\n");
  for (const std::size_t points : {4, 1}) {
    print_times<double>("double", points, rounds);
    print_times<float>("single", points, rounds);
  }
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  contactspline::bench::report(argc > 1 ? std::max(1, std::atoi(argv[1])) : 51);
}
