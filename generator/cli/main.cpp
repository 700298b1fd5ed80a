// SPDX-License-Identifier: MIT
#include "generator/cli/command_line.hpp"

int main(int argc, char** argv) {
  return contactspline::run_command_line(argc, argv);
}
