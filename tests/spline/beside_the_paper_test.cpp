// SPDX-License-Identifier: MIT
// The figures of docs/measurements/beside-the-paper.md, computed again at reduced length; and the schemes that it
// compares with each other.
#include "bench/beside_the_paper.hpp"

#include <fstream>
#include <sstream>

#include "contactspline/models/hammer_string.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using namespace contactspline::bench;

using Row = std::array<double, kMethods.size()>;

/// The numbers of the page's row of this name, for each of kMethods; of cells a/b the first or the second one. NaN
/// where there is none.
Row page_row(const std::string& name, bool second = false) {
  std::ifstream page(SOURCE_FOLDER "/docs/measurements/beside-the-paper.md");
  Row row;
  row.fill(NAN);
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| " + name + " |")) continue;
    std::istringstream cells(line.substr(name.size() + 4));
    for (double& value : row) {
      std::string cell;
      std::getline(cells, cell, '|');
      std::istringstream numbers(cell);
      char slash = 0;
      numbers >> value;
      if (second && !(numbers >> slash >> value)) value = NAN;
    }
  }
  return row;
}

// A reference at 32 instead of 128 times the rate has itself an error: a 64th of Newton's at 4 times the rate, which
// is up to 2.7 times that of the row.
TEST(BesideThePaper, HasTheErrorsOfThePage) {
  constexpr int kReference = 32, kPhases = 64;
  for (const PaperCase& played : paper_cases()) {
    const auto exact = exact_signal(played, kReference);
    for (const int multiple : {1, 4}) {
      const Row expected = page_row(played.model.name + " error", multiple == 4);
      for (std::size_t k = 0; k < kMethods.size(); ++k)
        EXPECT_TRUE(
            relatively_within(error(played, kMethods[k], multiple, exact, kReference, kPhases), expected[k], 0.05))
            << played.model.name << " " << kMethodNames[k] << " at " << multiple;
    }
  }
}

// A shorter run has no larger drift. It is rounding, in which compilers differ: three bits more than the page's, and
// 64 roundings.
TEST(BesideThePaper, KeepsItsEnergyAsThePageSays) {
  const auto expect = [](const std::string& name, const Row& expected, auto measure) {
    for (std::size_t k = 0; k < kMethods.size(); ++k)
      EXPECT_TRUE(within(measure(kMethods[k]), 0, 8 * expected[k] + 0x1p-47)) << name << " " << kMethodNames[k];
  };
  for (const PaperCase& played : paper_cases()) {
    const std::string name = played.model.name + " balance";
    expect(name, page_row(name), [&](Method method) { return energy_drift(played, method, 2205); });
  }
  for (const PaperCase& played : {paper_cases()[0], paper_cases()[1]}) {
    const std::string name = played.model.name + " rebound, double/single";
    expect(name, page_row(name), [&](Method method) { return rebound_error<double>(played, method, 100); });
    expect(name, page_row(name, true), [&](Method method) { return rebound_error<float>(played, method, 100); });
  }
}

// "ours" of the page is HammerString: the forces of a blow agree but for rounding.
TEST(BesideThePaper, OursIsHammerString) {
  const PaperCase played = paper_cases()[1];
  const auto table = segment_table(played.spline());
  HammerString<double> model(table, played.model.modes,
                             ModeShapes<double>(std::span<const double>(played.model.strike_shapes)), kSampleRate);
  model.strike(played.speed_m_per_s, played.distance_m);
  const auto found = signal(played, Method::ours, kSampleRate);
  std::vector<double> expected;
  while (expected.size() < found.size()) {
    model.tick({.hammer_mass_kg = played.model.hammer.mass_kg});
    expected.push_back(model.force());
  }
  EXPECT_TRUE(sequences_within<double>(found, expected, 1e-11));
}

// Both updates solve the same equations on the same potential.
TEST(BesideThePaper, TheReconstructionFindsTheForcesOfTheContactStep) {
  for (const PaperCase& played : paper_cases()) {
    if (played.model.modes.empty()) continue;  // compared by its rebound
    EXPECT_TRUE(sequences_within<double>(signal(played, Method::reconstruction, kSampleRate),
                                         signal(played, Method::our_update, kSampleRate), 1e-9))
        << played.model.name;
  }
}

}  // namespace
}  // namespace contactspline::testing
