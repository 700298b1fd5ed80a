// SPDX-License-Identifier: MIT
// beside_the_paper [--errors | --curves]: the tables of docs/measurements/beside-the-paper.md on standard output.
// --errors: without times; --curves: the numbers of its figure (scripts/figures).
#include "bench/beside_the_paper.hpp"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <string_view>

#include "bench/paired_timer.hpp"

namespace contactspline::bench {
namespace {

constexpr int kReference = 128, kPhases = 64, kRounds = 1001;

void print_head(std::string_view first) {
  fmt::print("\n| {} |", first);
  for (const char* name : kMethodNames) fmt::print(" {} |", name);
  fmt::print("\n|---|---:|---:|---:|---:|\n");
}

/// A row of pairs: first(method)/second(method).
template <typename First, typename Second>
void print_pairs(const std::string& name, First first, Second second) {
  fmt::print("| {} |", name);
  for (const Method method : kMethods) fmt::print(" {:.3g}/{:.3g} |", first(method), second(method));
  fmt::print("\n");
}

void print_errors() {
  print_head("at 44.1/176.4 kHz");
  for (const PaperCase& played : paper_cases()) {
    const auto exact = exact_signal(played, kReference);
    const auto at = [&](int multiple) {
      return [&, multiple](Method method) { return error(played, method, multiple, exact, kReference, kPhases); };
    };
    print_pairs(played.model.name + " error", at(1), at(4));
  }
}

void print_energies() {
  print_head("energy");
  for (const PaperCase& played : paper_cases()) {
    fmt::print("| {} balance |", played.model.name);
    for (const Method method : kMethods) fmt::print(" {:.2g} |", energy_drift(played, method, kSampleRate / 5));
    fmt::print("\n");
  }
  for (const PaperCase& played : {paper_cases()[0], paper_cases()[1]})
    print_pairs(
        played.model.name + " rebound, double/single",
        [&](Method method) { return rebound_error<double>(played, method, 1000); },
        [&](Method method) { return rebound_error<float>(played, method, 1000); });
}

/// Plays a tenth of a second.
std::function<void()> task_of(const PaperCase& played, Method method, double speed, double distance) {
  return visit_scheme<double>(played, method, kSampleRate, [&](auto& scheme, const auto&, const auto&) {
    const auto player = std::make_shared<std::remove_reference_t<decltype(scheme)>>(scheme);
    const int between = played.between;
    return std::function<void()>([=] {
      std::vector<double> out(static_cast<std::size_t>(between));
      for (int n = 0; n < kSampleRate / 10; n += between) {
        player->strike(speed, distance);
        player->process(out);
      }
    });
  });
}

void print_times(PaperCase played, const char* workload, double speed, double distance) {
  std::vector<TimedTask<std::function<void()>>> tasks;
  for (const Method method : {Method::ours, Method::reconstruction, Method::exp3, Method::newton})
    tasks.push_back({"", task_of(played, method, speed, distance)});
  PairedTimer<std::function<void()>, ThreadClock> timer(tasks, kSampleRate / 10);
  for (int i = 0; i < kRounds; ++i) timer.round();
  fmt::print("| {} | {} | {:.1f} | {:.2f} | {:.2f} | {:.2f} |\n", played.model.name, workload, timer.nanoseconds(0),
             timer.ratio(1), timer.ratio(2), timer.ratio(3));
}

void print_all_times() {
  fmt::print("\n| case | thrown | ours, ns | reconstruction | EXP-3 | Newton |\n|---|---|---:|---:|---:|---:|\n");
  for (PaperCase played : paper_cases()) {
    if (!played.model.modes.empty())
      print_times(played, played.press_n > 0 ? "every 100 ms" : "every 10 ms", played.speed_m_per_s,
                  played.distance_m);
    if (played.press_n > 0) continue;
    played.model.hammer.mass_kg *= 1e6;
    print_times(played, "permanent contact", played.model.press_speed_m_per_s, 0);
  }
}

/// A block for each case: multiple of 44.1 kHz, then the error of each method.
void print_curves() {
  for (const PaperCase& played : paper_cases()) {
    const auto exact = exact_signal(played, kReference);
    for (const int multiple : {1, 2, 4, 8, 16}) {
      fmt::print("{}", multiple);
      for (const Method method : kMethods)
        fmt::print(" {:.4g}", error(played, method, multiple, exact, kReference, kPhases));
      fmt::print("\n");
    }
    fmt::print("\n\n");
  }
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  using namespace contactspline::bench;
  const std::string_view option = argc > 1 ? argv[1] : "";
  if (option != "" && option != "--errors" && option != "--curves") {
    fmt::print(stderr, "beside_the_paper: {}; allowed: --errors, --curves\n", option);
    return 2;
  }
  if (option == "--curves") return print_curves(), 0;
  print_errors();
  print_energies();
  if (option == "") print_all_times();
}
