// SPDX-License-Identifier: MIT
// Build-time program: write_samples FILE.json. What programs on felt C4 read, should give and may be wrong by, for
// the tests in JavaScript.
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "step_cases.hpp"
#include "strike_cases.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

template <std::floating_point T>
constexpr const char* kPrecision = std::same_as<T, double> ? "double" : "single";

/// One bound per output.
template <std::floating_point T>
Json strike_run(const MaterialUnderTest& material, const Strike& strike) {
  const auto exact = run_twin(material.in_double.table, strike);
  const auto bound = bound_in<T>(material, strike, exact);
  return {{"program", "mass_barrier"},
          {"precision", kPrecision<T>},
          {"sample_rate_hz", strike.sample_rate_hz},
          {"controls",
           {{"throw", 1},
            {"speed", strike.speed_m_per_s},
            {"start", strike.start_m},
            {"mass", strike.mass_kg},
            {"stiffness ratio", strike.stiffness_ratio},
            {"loss", strike.loss_s_per_m},
            {"gravity", strike.gravity_m_per_s2}}},
          {"inputs", Json::array()},
          {"outputs", {exact.displacement, exact.force}},
          {"bounds", {bound.displacement, bound.force}}};
}

std::vector<double> column(const std::vector<Output<Real>>& rows, Real Output<Real>::*member) {
  std::vector<double> values;
  for (const auto& row : rows) values.push_back(static_cast<double>(row.*member));
  return values;
}

Json columns(const std::vector<Output<Real>>& rows) {
  return {column(rows, &Output<Real>::potential), column(rows, &Output<Real>::force),
          column(rows, &Output<Real>::step), column(rows, &Output<Real>::contact)};
}

/// One bound per output and sample.
template <std::floating_point T>
Json probe_run(const MaterialUnderTest& material) {
  constexpr std::size_t kRows = 1000;
  const ExactContact exact(material.in<T>().table);
  const auto inputs = RandomInput<T>(material, -6, Closeness::kRepresentable).take(kRows);
  std::vector<std::vector<double>> in(6);
  std::vector<Output<Real>> out, bounds;
  for (const auto& row : inputs) {
    const T values[] = {row.compression,     row.free_increment, row.receptance,
                        row.stiffness_ratio, row.loss,           row.last_increment};
    for (std::size_t k = 0; k < in.size(); ++k) in[k].push_back(values[k]);
    out.push_back(solve_exactly(exact, row));
    const auto unit = roundings(exact, row, out.back());
    bounds.push_back(
        {kRoundings * unit.potential, kRoundings * unit.force, kRoundings * unit.step, kRoundings * unit.contact});
  }
  return {
      {"program", "probe"}, {"precision", kPrecision<T>}, {"sample_rate_hz", kRate},  {"controls", Json::object()},
      {"inputs", in},       {"outputs", columns(out)},    {"bounds", columns(bounds)}};
}

Json all_runs() {
  const auto& material = *std::ranges::find(materials_under_test(), "felt_c4", &MaterialUnderTest::name);
  Json runs = {probe_run<double>(material), probe_run<float>(material)};
  const auto strikes = strikes_on(material);
  for (std::size_t i = 0; i < strikes.size(); i += 5) {
    runs.push_back(strike_run<double>(material, strikes[i]));
    runs.push_back(strike_run<float>(material, strikes[i]));
  }
  return runs;
}

}  // namespace
}  // namespace contactspline::testing

int main(int, char** argv) {
  std::ofstream file(argv[1]);
  file << contactspline::testing::all_runs().dump(1) << std::flush;
  if (file) return 0;
  std::cerr << "cannot write " << argv[1] << '\n';
  return 1;
}
