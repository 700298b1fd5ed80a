// SPDX-License-Identifier: MIT
// Build-time program: emit_libraries DIRECTORY MATERIAL.json... writes NAME.lib and NAME.hpp of every material and of
// felt C4 with 1, 64 and 1024 segments, with graded and optimal knots, and compensated.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "generator/emit/emit_material.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/spline/design.hpp"

namespace {

using contactspline::Design;
namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string felt_c4(const std::string& variant, const std::string& spline, const std::string& more = "") {
  return R"({ "name": "felt_c4_)" + variant + R"(",
    "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
    "impact": { "mass_kg": 0.00297, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },
    "spline": { )" +
         spline + " }" + more + " }";
}

void write(const fs::path& directory, const Design& design) {
  for (auto emitter : contactspline::emitters()) {
    if (emitter.name == "json") continue;
    emitter.all_forms = true;
    std::ofstream file(directory / (design.material.name + "." + std::string(emitter.extension)));
    file << contactspline::emit(emitter, design, "tests/faust") << std::flush;
    if (!file) throw std::runtime_error("cannot write into " + directory.string());
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path directory = argv[1];
  for (int i = 2; i < argc; ++i) write(directory, contactspline::design_material(read(argv[i]), argv[i]));
  for (const std::string segments : {"1", "64", "1024"})
    write(directory, contactspline::design_material(
                         felt_c4("n" + segments, R"("knots": "uniform", "segments": )" + segments), "variant"));
  for (const std::string knots : {"graded", "optimal"})
    write(directory, contactspline::design_material(
                         felt_c4(knots, R"("knots": ")" + knots + R"(", "tolerance": 0.001)"), "variant"));
  write(directory, contactspline::design_material(
                       felt_c4("compensated", R"("knots": "graded", "segments": 64)",
                               R"(, "compensation": { "sample_rate_hz": 44100, "mass_kg": 0.00297 })"),
                       "variant"));
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
