// SPDX-License-Identifier: MIT
// Numbers on their way through Faust: what stands in its C++ has the very bits that were emitted.
#include <gtest/gtest.h>

#include <charconv>
#include <set>

#include "faust_command.hpp"
#include "material_under_test.hpp"

namespace contactspline::testing {
namespace {

using Table = std::vector<double>;

/// Numbers in a list such as 1.0,2.5e-05f,3.0.
Table parse_list(const std::string& list) {
  Table numbers;
  const char* at = list.data();
  const char* const end = at + list.size();
  while (at < end) {
    double number = 0;
    const auto parsed = std::from_chars(at, end, number);
    if (parsed.ec != std::errc{}) throw std::runtime_error("not a number: " + std::string(at, end));
    numbers.push_back(number);
    at = std::find(parsed.ptr, end, ',') + 1;
  }
  return numbers;
}

/// Every table in Faust's C++; equal ones come once.
std::set<Table> tables_in(const std::string& source) {
  std::set<Table> tables;
  const std::string kOpening = "] = {";
  for (auto at = source.find(kOpening); at != source.npos; at = source.find(kOpening, at)) {
    at += kOpening.size();
    tables.insert(parse_list(source.substr(at, source.find('}', at) - at)));
  }
  return tables;
}

template <typename T>
std::set<Table> columns_of(SegmentTable<T> table) {
  Table knots, energies, forces, half_curvatures;
  for (const auto& segment : table) {
    knots.push_back(segment.knot);
    energies.push_back(segment.energy);
    forces.push_back(segment.force);
    half_curvatures.push_back(segment.half_curvature);
  }
  return {knots, energies, forces, half_curvatures};
}

/// Faust's C++ of a program, as built for the other tests.
std::string source_of(const std::string& program) {
  return read_file(std::filesystem::path(kGenerated) / (program + ".hpp"));
}

std::set<Table> rounded(const std::set<Table>& tables) {
  std::set<Table> floats;
  for (Table table : tables) {
    for (double& value : table) value = static_cast<float>(value);
    floats.insert(table);
  }
  return floats;
}

class LiteralTest : public ::testing::TestWithParam<MaterialUnderTest> {};

TEST_P(LiteralTest, TablesInDoubleKeepEveryBit) {
  const auto& material = GetParam();
  EXPECT_EQ(tables_in(source_of("probe_" + material.name + "_double")), columns_of(material.in_double.table));
  EXPECT_EQ(tables_in(source_of("probe_" + material.name + "_normalised")), columns_of(material.normalised.table));
}

TEST_P(LiteralTest, TablesInSingleAreTheNearestFloats) {
  const auto& material = GetParam();
  EXPECT_EQ(rounded(tables_in(source_of("probe_" + material.name + "_single"))),
            columns_of(material.in_single.table));
}

TEST_P(LiteralTest, ConstantsInDoubleKeepEveryBit) {
  const auto& material = GetParam();
  const auto folder = empty_folder("constants_" + material.name);
  std::ofstream(folder / "constants.dsp")
      << "m = library(\"" << material.name << ".lib\");\n"
      << "process = m.max_compression, m." << material.length_scale_name << ", m.energy_scale;\n";
  const auto outcome = run_faust_compiler("-double", folder / "constants.dsp", folder / "constants.hpp");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string source = read_file(folder / "constants.hpp");
  const std::string kOutput = "[i0] = FAUSTFLOAT(";
  Table constants;
  for (auto at = source.find(kOutput); at != source.npos; at = source.find(kOutput, at)) {
    at += kOutput.size();
    constants.push_back(parse_list(source.substr(at, source.find(')', at) - at)).at(0));
  }
  EXPECT_EQ(constants, (Table{material.max_compression_m, material.length_scale_m, material.energy_scale_j}));
}

INSTANTIATE_TEST_SUITE_P(Materials, LiteralTest, ::testing::ValuesIn(materials_under_test()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace contactspline::testing
