// SPDX-License-Identifier: MIT
// write_classes CLASSES HELP: writes ContactInstruments.sc with a class for each instrument that ships into one
// folder, and the help of each into another.
#include <cctype>
#include <fstream>
#include <string>
#include <vector>

#include "hosts/wired_instrument.hpp"

namespace {

using Instrument = contactspline::WiredInstrument<float>;

// lap_steel: ContactLapSteel.
std::string class_name(const std::string& name) {
  std::string result = "Contact";
  bool is_first = true;
  for (const char c : name) {
    if (c != '_') result += is_first ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    is_first = c == '_';
  }
  return result;
}

void write_class(std::ostream& file, const std::string& name, const Instrument& instrument) {
  file << "\n" << class_name(name) << " {\n\t*ar { |gate = 0, key = " << instrument.first_key() << ", velocity = 0.7";
  for (const std::string& event : instrument.events()) file << ", " << event;
  for (const std::string& parameter : instrument.parameters()) file << ", " << parameter;
  file << ", outputs|\n\t\t^ContactInstrument.ar(\"" << name << "\", [[gate, key, velocity]], [";
  for (const std::string& event : instrument.events()) file << "[\\" << event << ", " << event << "], ";
  file << "], [";
  for (const std::string& parameter : instrument.parameters()) file << "\\" << parameter << ", " << parameter << ", ";
  file << "], outputs)\n\t}\n}\n";
}

void write_help(std::ostream& file, const std::string& name, const Instrument& instrument) {
  const std::vector<std::string> lines = instrument.lines();
  file << "TITLE:: " << class_name(name) << "\nsummary:: " << lines.front()
       << "\ncategories:: UGens>Generators>PhysicalModels\nrelated:: Classes/ContactInstrument\n\nDESCRIPTION::\n"
          "What the arguments do stands in the help of link::Classes/ContactInstrument::. Arguments that are not "
          "given keep "
          "their first values. An event is a trigger.\n\nlist::\n";
  for (std::size_t i = 1; i < lines.size(); ++i) file << "## " << lines[i] << "\n";
  file << "::\n\nCLASSMETHODS::\n\nMETHOD:: ar\n\nEXAMPLES::\ncode::\n{ " << class_name(name)
       << ".ar(gate: 1) }.play;\n::\n";
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 2;
  std::ofstream classes(std::string(arguments[1]) + "/ContactInstruments.sc");
  classes << "// SPDX-"
             "License-Identifier: MIT\n// The instruments that ship. Written by write_classes.cpp from their "
             "lists.\n";
  for (const char* const* name = contactspline_names(); *name != nullptr; ++name) {
    const auto instrument = Instrument::create(*name, 48000);
    write_class(classes, *name, *instrument);
    std::ofstream help(std::string(arguments[2]) + "/" + class_name(*name) + ".schelp");
    write_help(help, *name, *instrument);
    if (!help.flush()) return 1;
  }
  return classes.flush() ? 0 : 1;
}
