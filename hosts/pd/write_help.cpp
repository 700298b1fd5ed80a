// SPDX-License-Identifier: MIT
// Prints the help patch of contactspline~: a patch that sounds, and the lists of every instrument that ships.
#include <cstdio>
#include <string>
#include <vector>

#include "hosts/wired_instrument.hpp"

namespace {

// Text of a comment as Pd's files have it: commas and semicolons are symbols of their own there.
std::string comment(const std::string& text) {
  std::string written;
  for (const char c : text) {
    if (c == ',' || c == ';') written += " \\";
    written += c;
  }
  return written;
}

void print_list(int x, int y, const char* name) {
  const auto instrument = contactspline::WiredInstrument<float>::create(name, 48000);
  const std::vector<std::string> lines = instrument->lines();
  std::printf("#N canvas 60 60 620 %zu %s 0;\n", 60 + 20 * lines.size(), name);
  for (std::size_t i = 0; i < lines.size(); ++i)
    std::printf("#X text 20 %zu %s;\n", 20 + 20 * i, comment(lines[i]).c_str());
  std::printf("#X restore %d %d pd %s;\n", x, y, name);
}

}  // namespace

int main() {
  std::puts(
      "#N canvas 40 40 640 560 12;\n"
      "#X msg 20 110 60 0.7;\n"
      "#X msg 90 110 60 0;\n"
      "#X msg 150 110 strike 2.5;\n"
      "#X msg 250 110 stiffness_ratio 4;\n"
      "#X msg 400 110 print;\n"
      "#X msg 460 110 reset;\n"
      "#X obj 20 160 contactspline~ hammer_string;\n"
      "#X obj 20 200 dac~;\n"
      "#X text 20 20 contactspline~ INSTRUMENT NAME... : an instrument that ships \\, or a .json file. Names of "
      "parameters are "
      "inlets for signals \\, names of outputs are outlets. Without outputs: left and right \\, 1 is full scale.;\n"
      "#X text 20 80 Messages: KEY VELOCITY (0 to 1) \\, an event \\, a parameter with its value \\, print \\, "
      "reset;\n"
      "#X connect 0 0 6 0;\n#X connect 1 0 6 0;\n#X connect 2 0 6 0;\n#X connect 3 0 6 0;\n#X connect 4 0 6 0;\n"
      "#X connect 5 0 6 0;\n#X connect 6 0 7 0;\n#X connect 6 1 7 1;\n"
      "#X text 20 240 What ships \\, with parameters \\, events and outputs:;");
  int y = 270;
  for (const char* const* name = contactspline_names(); *name != nullptr; ++name, y += 22) print_list(20, y, *name);
}
