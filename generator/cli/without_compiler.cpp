// SPDX-License-Identifier: MIT
// What plugin_build.cpp does, on a system for which it is not written.
#include "generator/cli/plugin_build.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

void require_compiler() {
  throw BadInput(
      "plugin: this program does not build on Windows; allowed: --no-build, which writes the project only");
}

void build_plugin(const std::filesystem::path& /*project*/, const std::string& /*name*/) {
  require_compiler();
}

}  // namespace contactspline
