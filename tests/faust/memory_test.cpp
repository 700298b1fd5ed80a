// SPDX-License-Identifier: MIT
// contact_with_memory of contactspline.lib against MassBarrier with the same memories.
#include <algorithm>
#include <vector>

#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/felt_stulov_c4.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "cpp_program.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

#define FAUSTFLOAT double
#include "memory_double.hpp"

namespace contactspline::testing {
namespace {

struct Motion {
  std::vector<double> compression, force;
};

template <typename Material>
Motion in_cpp(double rate, std::size_t samples, double mass, double loss, std::span<const Memory> memories) {
  constexpr auto& table = segments_of<Material, double>;
  MassBarrier<double> barrier(SegmentTable<double>(table), rate, memories);
  barrier.throw_from(-1e-4, 2.5);
  Motion motion;
  for (std::size_t n = 0; n < samples; ++n) {
    barrier.tick({.mass_kg = mass, .contact = {1, loss}});
    motion.compression.push_back(barrier.displacement());
    motion.force.push_back(barrier.force());
  }
  return motion;
}

double expect_equal(const std::vector<double>& faust, const std::vector<double>& cpp) {
  const double peak = *std::ranges::max_element(cpp);
  EXPECT_GT(peak, 0);
  double worst = 0;
  for (std::size_t n = 0; n < cpp.size(); ++n) worst = std::max(worst, std::abs(faust[n] - cpp[n]) / peak);
  EXPECT_TRUE(within(worst, 0, 1e-9));
  return worst;
}

TEST(Memory, OfFaustIsThatOfCpp) {
  using materials::felt_c4, materials::felt_stulov_c4;
  const std::vector<Memory> two = {{0.5, 1e-4}, {0.2, 2e-6}};
  for (const int rate : {44100, 96000, 768000}) {
    const std::size_t samples = static_cast<std::size_t>(rate) / 200;
    CppProgram<memory_double, double> program(rate);
    const auto outputs = program.run({}, samples);
    ASSERT_EQ(outputs.size(), 6u);
    const Motion motions[] = {in_cpp<felt_stulov_c4>(rate, samples, 0.008274, 0, memories_of<felt_stulov_c4>),
                              in_cpp<felt_stulov_c4>(rate, samples, 0.008274, 0.2, memories_of<felt_stulov_c4>),
                              in_cpp<felt_c4>(rate, samples, 0.00297, 0, two)};
    double worst = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      SCOPED_TRACE(::testing::Message() << rate << " Hz, blow " << k);
      worst = std::max(worst, expect_equal(outputs[2 * k], motions[k].compression));
      worst = std::max(worst, expect_equal(outputs[2 * k + 1], motions[k].force));
    }
    Measured() << rate << " Hz: " << worst << " of the peak";
  }
}

}  // namespace
}  // namespace contactspline::testing
