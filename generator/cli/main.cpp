// SPDX-License-Identifier: MIT
#include "generator/cli/command_line.hpp"
#include "generator/cli/system.hpp"

int main(int argc, char** argv) {
  const auto words = contactspline::begin_program(argc, argv);
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  return contactspline::run_command_line(static_cast<int>(pointers.size()), pointers.data());
}
