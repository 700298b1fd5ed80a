// SPDX-License-Identifier: MIT
// `normalised` as a material: lengths in length scales w, energies in energy scales E, so V(y) = E Vn(y/w).
#include <gtest/gtest.h>

#include <iostream>

#include "strike_cases.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 96000;

class NormalisedTest : public ::testing::TestWithParam<MaterialUnderTest> {
 protected:
  [[nodiscard]] double width() const { return GetParam().length_scale_m; }
  [[nodiscard]] double energy() const { return GetParam().energy_scale_j; }
};

/// What one row of probe.dsp reads.
struct Row {
  double compression, free_increment, receptance, stiffness_ratio, loss, last_increment;
};

// From before the barrier to beyond the table, slow to fast, up and down, soft to stiff.
std::vector<Row> rows(const MaterialUnderTest& material) {
  const double end = material.max_compression_m;
  const double compliance = 1 / (2 * material.in_double.table.back().half_curvature);
  std::vector<Row> rows;
  for (int i = -20; i <= 110; ++i)
    for (const double increment : {-0.5, -0.01, 1e-4, 0.03, 0.4})
      for (const double receptance : {1e-4, 0.1, 30.0})
        rows.push_back(
            {0.01 * i * end, increment * end, receptance * compliance, 0.7, i % 2 ? 0 : 0.2, 0.3 * increment * end});
  return rows;
}

// Scaled by w and E, what a step reads and returns: xi f is a length, loss times a speed has no unit.
Row normalise(const Row& row, double width, double energy) {
  return {row.compression / width, row.free_increment / width, row.receptance * energy / (width * width),
          row.stiffness_ratio,     row.loss * width,           row.last_increment / width};
}

TEST_P(NormalisedTest, EveryFunctionScales) {
  const auto rows_in_si = rows(GetParam());
  Signals<double> in(6);
  for (const Row& si : rows_in_si) {
    const Row row = normalise(si, width(), energy());
    const double values[] = {row.compression,     row.free_increment, row.receptance,
                             row.stiffness_ratio, row.loss,           row.last_increment};
    for (std::size_t k = 0; k < in.size(); ++k) in[k].push_back(values[k]);
  }
  auto out = GetParam().normalised.probe(kRate)->run(std::move(in), rows_in_si.size());

  const auto table = GetParam().in_double.table;
  Signals<double> expected(4);
  for (const Row& row : rows_in_si) {
    const Approach<double> approach{row.compression, row.free_increment, row.receptance};
    const ContactControls<double> controls{row.stiffness_ratio, row.loss};
    expected[0].push_back(potential(table, row.compression));
    expected[1].push_back(force(table, row.compression));
    expected[2].push_back(contact_force(table, approach));
    const auto start = segment_index(table, row.compression);
    expected[3].push_back(contact_step(table, controls, 1.0 / kRate, approach, start, row.last_increment).force);
  }
  for (double& value : out[0]) value *= energy();
  for (std::size_t k = 1; k < out.size(); ++k)
    for (double& value : out[k]) value *= energy() / width();
  // Relative to the largest; scaling rounds every input by u, which a stiff contact passes on some tens of times.
  for (std::size_t k = 0; k < out.size(); ++k)
    EXPECT_TRUE(sequences_within<double>(out[k], expected[k], 1e-13)) << "output " << k;
}

TEST_P(NormalisedTest, TheModelScales) {
  const auto& material = GetParam();
  Strike strike;
  strike.sample_rate_hz = kRate;
  strike.mass_kg = mass_for(material);
  strike.speed_m_per_s = 3;
  strike.start_m = -0.4e-4;
  strike.stiffness_ratio = 0.5;
  strike.loss_s_per_m = 0.1;
  strike.gravity_m_per_s2 = 9.81;
  strike.samples = 400;
  const auto expected = run_twin(material.in_double.table, strike);

  // Mass from energy: m v^2.
  Strike scaled = strike;
  scaled.mass_kg *= width() * width() / energy();
  for (double* length : {&scaled.speed_m_per_s, &scaled.start_m, &scaled.gravity_m_per_s2}) *length /= width();
  scaled.loss_s_per_m *= width();
  auto actual = run_faust(*material.normalised.mass_barrier(kRate), scaled);
  for (double& value : actual.displacement) value *= width();
  for (double& value : actual.force) value *= energy() / width();
  EXPECT_TRUE(sequences_within<double>(actual.displacement, expected.displacement, 1e-12));
  EXPECT_TRUE(sequences_within<double>(actual.force, expected.force, 1e-12));
}

INSTANTIATE_TEST_SUITE_P(Materials, NormalisedTest, ::testing::ValuesIn(materials_under_test()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace contactspline::testing
