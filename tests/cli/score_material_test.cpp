// SPDX-License-Identifier: MIT
// The material of a score: every kind of it, and every one that ships, sounds as its own spline.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "cases.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

/// A material that a score plays: a file beside the score, or a name that ships.
struct MaterialCase {
  std::string test;
  std::string key;  ///< what the score calls it
  Files files = {};

  [[nodiscard]] Design design() const {
    if (files.empty()) return shipped_material(key);
    return design_material(files.at(key), key, [this](const std::string& path) { return files.at(path); });
  }
};

void PrintTo(const MaterialCase& one, std::ostream* stream) {
  *stream << one.test;
}

MaterialCase felt_with(const std::string& test, const std::string& spline, const std::string& more = "") {
  return {test,
          "felt.json",
          {{"felt.json", R"({ "name": "probe", "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
              "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },
              "spline": { )" +
                             spline + " }" + more + " }"}}};
}

MaterialCase law_with(const std::string& test, const std::string& contact) {
  MaterialCase one = {
      test,
      "law.json",
      {{"law.json", R"({ "name": "probe", "contact": )" + contact +
                        R"(, "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 4.0, "min_speed_m_per_s": 0.1 },
              "spline": { "knots": "graded", "segments": 12 } })"}}};
  if (test == "measured_curve")
    one.files["felt.csv"] =
        "compression_mm,force_n\n0.1,1\n0.2,3\n0.4,8\n0.6,20\n0.8,40\n1.2,80\n1.4,140\n1.6,190\n3,1000\n";
  return one;
}

const std::string kUniform = R"("knots": "uniform", "segments": 8)";
const std::string kGraded = R"("knots": "graded", "segments": 8)";
const std::string kCompensation = R"(, "compensation": { "sample_rate_hz": 44100, "mass_kg": 0.003 })";

// Every kind of material that `generate` accepts, and every one that ships.
std::vector<MaterialCase> material_cases() {
  std::vector<MaterialCase> cases = {
      felt_with("uniform", kUniform),
      felt_with("uniform_by_tolerance", R"("knots": "uniform", "tolerance": 0.01)"),
      felt_with("graded", kGraded),
      felt_with("graded_by_tolerance", R"("knots": "graded", "tolerance": 0.01)"),
      felt_with("optimal", R"("knots": "optimal", "segments": 8)"),
      felt_with("optimal_by_tolerance", R"("knots": "optimal", "tolerance": 0.01)"),
      felt_with("optimal_in_force", R"("knots": "optimal", "segments": 8, "minimise": "force")"),
      felt_with("optimal_in_spectrum", R"("knots": "optimal", "segments": 8, "minimise": "spectrum")"),
      felt_with("spectrum_by_tolerance", R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": 10)"),
      felt_with("compensated", kGraded, kCompensation),
      felt_with("live_exponent", kUniform, R"(, "live_exponent": { "min": 2.0, "max": 3.0, "members": 5 })"),
      law_with("lossy", R"({ "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5, "loss_s_per_m": 0.1 })"),
      law_with("sum", R"({ "sum": [ { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
                         { "stiffness_n_per_m_alpha": 1e8, "exponent": 1.5, "offset_m": 2e-4 } ] })"),
      law_with("series", R"({ "series": [ { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
                            { "stiffness_n_per_m_alpha": 3e6, "exponent": 1.4 } ] })"),
      law_with("hertz", R"({ "hertz": { "bodies": [
          { "shape": "sphere", "radius_m": 0.01, "youngs_modulus_pa": 1e9, "poisson_ratio": 0.3 },
          { "shape": "plane", "youngs_modulus_pa": 1e9, "poisson_ratio": 0.3 } ] } })"),
      law_with("measured_curve", R"({ "curve": { "file": "felt.csv", "shape": "monotone" } })")};
  for (const auto& [file, text] : embedded_files(Shipped::kMaterials)) {
    const std::string name(file.substr(0, file.rfind('.')));
    if (file.ends_with(".json")) cases.push_back({"shipped_" + name, name});
  }
  return cases;
}

class ScoreMaterial : public ::testing::TestWithParam<MaterialCase> {};

// A single stroke: the contact force is that of the model on the table that the library designs.
TEST_P(ScoreMaterial, PlaysOnAHammerWithItsOwnSpline) {
  const Design design = GetParam().design();
  Parts parts("string_c4", design);
  HammerString<double> model(parts.table, parts.modes, parts.at(parts.resonator.strike.position_m), kRate,
                             design.material.memories);
  std::vector<double> force;
  for (int n = 0; n < 1764; ++n) {
    if (n == 441) model.strike(2.5, 1e-4);
    model.tick({.hammer_mass_kg = 0.003, .felt = {1, design.material.loss_s_per_m}});
    force.push_back(model.force());
  }
  expect_is(sound_alone(hammer_score("string_c4", GetParam().key, 0.04), GetParam().files, {"--signal", "force"}),
            force);
}

CONTACTSPLINE_CASES(Each, ScoreMaterial, material_cases());

// Materials that differ in their splines only must not sound the same.
TEST(ScoreMaterial, SoundsAsTheSplineOfItsMaterial) {
  std::vector<std::vector<double>> sounds;
  for (const auto& felt : {felt_with("uniform", kUniform), felt_with("graded", kGraded),
                           felt_with("optimal", R"("knots": "optimal", "segments": 8)"),
                           felt_with("in_force", R"("knots": "optimal", "segments": 8, "minimise": "force")"),
                           felt_with("in_spectrum", R"("knots": "optimal", "segments": 8, "minimise": "spectrum")"),
                           felt_with("tolerance", R"("knots": "uniform", "tolerance": 0.01)"),
                           felt_with("compensated", kGraded, kCompensation)})
    sounds.push_back(
        sound_alone(hammer_score("string_c4", "felt.json", 0.04), felt.files, {"--signal", "force"}).samples);
  for (std::size_t i = 0; i < sounds.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_FALSE(sequences_within<double>(sounds[i], sounds[j], 100 * kLevel)) << i << " and " << j;
}

}  // namespace
}  // namespace contactspline::testing
