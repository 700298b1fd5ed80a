// SPDX-License-Identifier: MIT
// instructions: plays each scheme of bench/speed for a tenth of a second and prints the number of samples. Under
// valgrind's callgrind it dumps the instructions of each, as STRING/WORKLOAD/SCHEME/PRECISION (scripts/bench).
#include <valgrind/callgrind.h>

#include <cstdio>
#include <string>
#include <vector>

#include "bench/performance.hpp"
#include "bench/schemes.hpp"

namespace contactspline::bench {
namespace {

constexpr std::size_t kSamples = kSampleRate / 10;

template <std::floating_point T>
void count(const std::string& precision) {
  std::vector<T> out(kSamples);
  for (const Model& model : models())
    for (const Workload& workload : model.workloads())
      for (auto& player : players_of<T>(model, workload)) {
        Performance<T> performance(std::move(player.player), workload);
        CALLGRIND_ZERO_STATS;
        performance.process(out);
        const std::string name = model.name + "/" + workload.name + "/" + player.name + "/" + precision;
        CALLGRIND_DUMP_STATS_AT(name.c_str());
      }
}

}  // namespace
}  // namespace contactspline::bench

int main() {
  contactspline::bench::count<double>("double");
  contactspline::bench::count<float>("float");
  std::printf("%zu\n", contactspline::bench::kSamples);
}
