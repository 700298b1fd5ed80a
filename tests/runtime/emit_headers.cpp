// SPDX-License-Identifier: MIT
// Build-time program: emit_headers DIRECTORY MATERIAL.json... writes NAME.hpp of every material, with all its forms.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "generator/emit/emit_material.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/spline/design.hpp"

namespace fs = std::filesystem;

static std::string read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

int main(int argc, char** argv) try {
  using namespace contactspline;
  for (int i = 2; i < argc; ++i) {
    const Design design = design_material(read(argv[i]), argv[i]);
    std::ofstream file(fs::path(argv[1]) / (design.material.name + ".hpp"));
    const Emitter emitter{"cpp", "hpp", true};
    if (!(file << emit(emitter, design, "tests/contact") << std::flush)) throw std::runtime_error("cannot write");
  }
} catch (const std::exception& error) {
  std::cerr << "emit_headers: " << error.what() << '\n';
  return 1;
}
