// SPDX-License-Identifier: MIT
// What all outputs agree on, for random materials: `generate` in C++, Faust and JSON, `inspect --json`, `impact
// --json` and the C++ library give the same spline, bit by bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "generator/spline/design.hpp"
#include "generator/support/error.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

int number_of_materials() {
  return std::getenv("CONTACTSPLINE_FULL_TESTS") == nullptr ? 60 : 300;
}

class RandomMaterials {
 public:
  Json next() {
    Json material = {{"name", "probe"}, {"contact", contact()}, {"impact", impact()}};
    const int kind = integer(0, 9);
    Json& spline = material["spline"];
    spline = {{"knots", kind < 6 ? "uniform" : kind < 9 ? "graded" : "optimal"}, {"segments", integer(1, 24)}};
    if (kind == 5) spline["max_compression_m"] = logarithmic(1e-6, 1e-2);
    if (kind == 9) spline["minimise"] = "force";
    if (kind == 8) spline.erase("segments"), spline["tolerance"] = logarithmic(0.01, 0.1);
    return material;
  }

 private:
  double uniform(double min, double max) {
    return min + (max - min) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  double logarithmic(double min, double max) { return std::exp(uniform(std::log(min), std::log(max))); }
  int integer(int min, int max) { return static_cast<int>(uniform(min, max + 1)); }

  Json power_law() { return {{"stiffness_n_per_m_alpha", logarithmic(1e3, 1e12)}, {"exponent", uniform(1, 4)}}; }
  Json body(bool may_be_plane) {
    Json body = {{"youngs_modulus_pa", logarithmic(1e6, 1e12)}, {"poisson_ratio", uniform(0, 0.49)}};
    body["shape"] = may_be_plane && integer(0, 1) == 0 ? "plane" : "sphere";
    if (body["shape"] == "sphere") body["radius_m"] = logarithmic(1e-4, 1);
    return body;
  }
  Json contact() {
    Json contact = power_law();
    const int kind = integer(0, 3);
    if (kind == 0) contact = {{"hertz", {{"bodies", {body(false), body(true)}}}}};
    if (kind == 1) {
      Json layer = power_law();
      layer["offset_m"] = logarithmic(1e-6, 1e-3);
      contact = {{"sum", {power_law(), layer}}};
    }
    if (integer(0, 1) == 0) contact["loss_s_per_m"] = logarithmic(1e-3, 1);
    return contact;
  }
  Json impact() {
    const double max = logarithmic(0.1, 10);
    return {{"mass_kg", logarithmic(1e-5, 1)},
            {"max_speed_m_per_s", max},
            {"min_speed_m_per_s", max * logarithmic(0.01, 0.9)}};
  }

  std::mt19937_64 random_{20260117};
};

using Numbers = std::vector<double>;

/// The numbers of the braces that follow `before` in a source text.
Numbers numbers_after(const std::string& text, const std::string& before) {
  const auto found = text.find(before);
  if (found == std::string::npos) return {};
  const char* at = text.c_str() + text.find('{', found) + 1;
  Numbers numbers;
  for (char* end = nullptr;; at = end + 1) {
    numbers.push_back(std::strtod(at, &end));
    if (end == at) return {};
    if (*end != ',') return numbers;
  }
}

struct Tables {
  Numbers knots, energies, forces, half_curvatures;
  bool operator==(const Tables&) const = default;
};

Tables tables_of(const Spline& spline) {
  Tables tables;
  for (const auto& s : spline.segments) {
    tables.knots.push_back(s.knot), tables.energies.push_back(s.energy);
    tables.forces.push_back(s.force), tables.half_curvatures.push_back(s.half_curvature);
  }
  return tables;
}

Tables tables_of_cpp(const std::string& text) {
  return {numbers_after(text, " knots = "), numbers_after(text, " energies = "), numbers_after(text, " forces = "),
          numbers_after(text, " half_curvatures = ")};
}

// The first entry stands for "out of contact".
Tables tables_of_faust(const std::string& text) {
  const auto table = [&](const std::string& name) {
    Numbers numbers = numbers_after(text, "\n" + name + "(index) = ");
    if (numbers.empty() || numbers.front() != 0) return Numbers{};
    return Numbers(numbers.begin() + 1, numbers.end());
  };
  return {table("knot"), table("energy"), table("force"), table("half_curvature")};
}

Tables tables_of_json(const Json& emitted) {
  return {emitted.at("knots_m").get<Numbers>(), emitted.at("energy_j").get<Numbers>(),
          emitted.at("force_n").get<Numbers>(), emitted.at("half_curvature_n_per_m").get<Numbers>()};
}

Tables tables_of_inspection(const Json& inspected) {
  Tables tables;
  for (const Json& s : inspected.at("segments")) {
    tables.knots.push_back(s.at("knot_m")), tables.energies.push_back(s.at("energy_j"));
    tables.forces.push_back(s.at("force_n")), tables.half_curvatures.push_back(s.at("half_curvature_n_per_m"));
  }
  return tables;
}

TEST(Agreement, EveryOutputHasTheSameSpline) {
  const Sandbox box;
  RandomMaterials materials;
  const int count = number_of_materials();
  int designed = 0;
  for (int i = 0; i < count && !HasFailure(); ++i) {
    const std::string text = materials.next().dump();
    SCOPED_TRACE(text);
    write_file(box / "probe.json", text);
    const Outcome generated = run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
    if (generated.exit_code != 0) {  // by every command alike
      EXPECT_THROW((void)design_material(text, "probe.json"), BadInput);
      EXPECT_EQ(run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}).err, generated.err);
      continue;
    }
    ++designed;
    const Design design = design_material(text, "probe.json");
    const Tables expected = tables_of(design.spline);
    EXPECT_EQ(expected.knots.size(), static_cast<std::size_t>(design.material.spline.segments));
    EXPECT_TRUE(tables_of_cpp(read_file(box / "out/probe.hpp")) == expected);
    EXPECT_TRUE(tables_of_faust(read_file(box / "out/probe.lib")) == expected);
    EXPECT_TRUE(tables_of_json(Json::parse(read_file(box / "out/probe.json"))) == expected);
    EXPECT_TRUE(tables_of_inspection(Json::parse(
                    succeed({.arguments = {"inspect", "probe.json", "--json"}, .folder = box.path()}))) == expected);
    const Json motion = Json::parse(
        succeed({.arguments = {"impact", "probe.json", "--json", "--rate", "44100"}, .folder = box.path()}))[0];
    EXPECT_EQ(motion.at("segments"), expected.knots.size());
    if (design.material.loss_s_per_m == 0) {
      const auto& range = *design.material.impact;
      const SplineImpact impact = impact_on_spline(design.spline, range.mass_kg, range.max_speed_m_per_s);
      EXPECT_EQ(motion.at("motions")[1].at("contact_duration_s"), impact.contact_duration_s);
      EXPECT_EQ(motion.at("motions")[1].at("max_compression_m"), impact.max_compression_m);
    }
  }
  Measured() << designed << " of " << count << " designed";
  EXPECT_GT(designed, count / 2);
}

}  // namespace
}  // namespace contactspline::testing
