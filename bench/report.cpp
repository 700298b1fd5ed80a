// SPDX-License-Identifier: MIT
// bench_report FOLDER BUILD=FILE.json...: writes the results of bench/speed as Markdown to standard output, and the
// data files for speed.gp into FOLDER.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace {

using nlohmann::json;

const std::vector<std::string> kOthers = {"EXP-3",     "EXP-3, caught", "linearly implicit", "Newton",
                                          "fd.hammer", "string alone",  "in blocks",         "roofline"};

/// One benchmark: its name, split at the slashes, and its counters.
struct Measured {
  std::vector<std::string> name;
  std::map<std::string, double> counters;

  [[nodiscard]] std::optional<double> get(const std::string& counter) const {
    const auto found = counters.find(counter);
    if (found == counters.end()) return {};
    return found->second;
  }
};

/// All results of one build.
struct Build {
  std::string name, compiler, vector_bits, ticks, processor;
  std::vector<Measured> measured;

  [[nodiscard]] const Measured* find(const std::vector<std::string>& of) const {
    for (const Measured& one : measured)
      if (one.name == of) return &one;
    return nullptr;
  }
  /// A counter of a benchmark. Empty if the benchmark was not run or has no such counter.
  [[nodiscard]] std::optional<double> get(const std::vector<std::string>& of, const std::string& counter) const {
    const Measured* one = find(of);
    if (one == nullptr) return {};
    return one->get(counter);
  }
  /// All benchmarks of a kind in a precision, in the order in which they ran.
  [[nodiscard]] std::vector<const Measured*> all(const std::string& kind, const std::string& precision) const {
    std::vector<const Measured*> found;
    for (const Measured& one : measured)
      if (one.name.front() == kind && one.name.back() == precision) found.push_back(&one);
    return found;
  }
};

std::vector<std::string> cut(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == '/')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

Build read(const std::string& argument) {
  const auto equals = argument.find('=');
  if (equals == std::string::npos) throw std::runtime_error(argument + ": allowed: BUILD=FILE.json");
  std::ifstream file(argument.substr(equals + 1));
  if (!file) throw std::runtime_error(argument.substr(equals + 1) + ": cannot be read");
  const json root = json::parse(file);
  const json& context = root.at("context");
  const std::string processor = fmt::format("{} cores whose time stamps count at {} MHz",
                                            context.at("num_cpus").get<int>(), context.at("mhz_per_cpu").get<int>());
  Build build{argument.substr(0, equals),
              context.at("compiler"),
              context.at("vector_bits"),
              context.at("ticks"),
              processor,
              {}};
  for (const json& one : root.at("benchmarks")) {
    Measured measured{cut(one.at("name")), {}};
    measured.name.pop_back();  // the number of iterations
    for (const auto& [key, value] : one.items())
      if (value.is_number()) measured.counters[key] = value;
    build.measured.push_back(std::move(measured));
  }
  return build;
}

std::string number(std::optional<double> value, const char* format = "{:.3g}") {
  return value ? fmt::format(fmt::runtime(format), *value) : "";
}

void heading(const std::string& title, const std::vector<std::string>& columns, int left = 1) {
  fmt::print("\n{}\n\n", title);
  std::string line = "|", rule = "|";
  for (std::size_t i = 0; i < columns.size(); ++i) {
    line += " " + columns[i] + " |";
    rule += static_cast<int>(i) < left ? "---|" : "---:|";
  }
  fmt::print("{}\n{}\n", line, rule);
}

void row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  fmt::print("{}\n", line);
}

// What readers ask for: the strings of a piano.
constexpr const char* kStrings[] = {"C4", "C2"};
const std::vector<std::string> kPrecisions = {"double", "float"};

/// A counter of a benchmark in both precisions.
std::string in_both(const Build& build, std::vector<std::string> name, const std::string& counter,
                    const char* format = "{:.3g}") {
  name.emplace_back("double");
  const std::string in_double = number(build.get(name, counter), format);
  name.back() = "float";
  return in_double.empty() ? "" : in_double + "/" + number(build.get(name, counter), format);
}

void ratios(const Build& build) {
  std::vector<std::string> columns = {"string", "struck", "spline, ns"};
  columns.insert(columns.end(), kOthers.begin(), kOthers.end());
  heading(fmt::format("{}, double/float:", build.name), columns, 2);
  for (const char* string : kStrings)
    for (const Measured* one : build.all("ratios", "double")) {
      if (one->name[1] != string) continue;
      const std::vector<std::string> name(one->name.begin(), one->name.end() - 1);
      std::vector<std::string> cells = {one->name[1], one->name[2], in_both(build, name, "ns/spline")};
      for (const std::string& other : kOthers) cells.push_back(in_both(build, name, "ratio/" + other, "{:.2f}"));
      row(cells);
    }
}

void percentiles(const Build& build, const std::string& precision) {
  const std::vector<std::string> schemes = {"spline", "EXP-3", "linearly implicit", "Newton", "fd.hammer"};
  std::vector<std::string> columns = {"string", "struck", "samples in contact"};
  columns.insert(columns.end(), schemes.begin(), schemes.end());
  heading(fmt::format("{}, {}, median/99 %/99.9 %:", build.name, precision), columns, 2);
  for (const Measured* one : build.all("percentiles", precision)) {
    if (std::ranges::find(kStrings, one->name[1]) == std::end(kStrings)) continue;
    std::vector<std::string> cells = {one->name[1], one->name[2],
                                      number(one->get("touching").value_or(0) * 100, "{:.0f} %")};
    for (const std::string& name : schemes) {
      const auto p50 = one->get("p50/" + name);
      cells.push_back(
          p50 ? fmt::format("{:.0f}/{:.0f}/{:.0f}", *p50, *one->get("p99/" + name), *one->get("p99.9/" + name)) : "");
    }
    row(cells);
  }
}

/// The number of modes against the time, in both precisions.
void scaling(const Build& build) {
  heading(fmt::format("Struck every 10 ms, ns per sample, {}, double/float:", build.name),
          {"modes", "spline", "EXP-3", "Newton", "string alone", "roofline"});
  for (const Measured* one : build.all("modes", "double")) {
    std::vector<std::string> cells = {one->name[1]};
    for (const char* scheme : {"spline", "EXP-3", "Newton", "string alone", "roofline"})
      cells.push_back(in_both(build, {"modes", one->name[1]}, std::string("ns/") + scheme));
    row(cells);
  }
}

using Ratios = std::vector<std::optional<double>>;

/// A goal for the time of the spline over others, and what was found.
struct Goal {
  std::string what;
  double max;
  Ratios found;
};

Goal against(const Build& build, const std::string& precision, const char* scheme) {
  Goal goal{fmt::format("every workload: over {}", scheme), 0.9, {}};
  for (const char* string : kStrings)
    for (const char* workload : {"every 100 ms", "every 10 ms", "every 1.36 ms", "permanent contact"})
      goal.found.push_back(build.get({"ratios", string, workload, precision}, std::string("ratio/") + scheme));
  return goal;
}

Ratios tails(const Build& build, const std::string& precision) {
  Ratios found;
  for (const Measured* one : build.all("percentiles", precision)) {
    const auto p50 = one->get("p50/spline"), last = one->get("p99.9/spline");
    if (p50 && last) found.push_back(*last / *p50);
  }
  return found;
}

Ratios segments(const Build& build, const std::string& precision) {
  Ratios found;
  for (const Measured* one : build.all("segments", precision))
    if (const auto ratio = one->get("ratio/1024")) found.push_back(1 / *ratio);
  return found;
}

std::vector<Goal> goals(const Build& build, const std::string& precision) {
  const auto ratio = [&](const char* model, const char* workload, const char* other) {
    return build.get({"ratios", model, workload, precision}, std::string("ratio/") + other);
  };
  std::vector<Goal> all = {against(build, precision, "EXP-3"),
                           against(build, precision, "EXP-3, caught"),
                           {"every 1.36 ms: over Newton",
                            0.35,
                            {ratio("C4", "every 1.36 ms", "Newton"), ratio("C2", "every 1.36 ms", "Newton")}}};
  for (const char* string : {"string alone", "in blocks"}) {
    all.push_back({fmt::format("every 100 ms: over {}", string),
                   1.15,
                   {ratio("C4", "every 100 ms", string), ratio("C2", "every 100 ms", string)}});
    all.push_back(
        {fmt::format("C2, permanent contact: over {}", string), 1.5, {ratio("C2", "permanent contact", string)}});
    all.push_back(
        {fmt::format("C4, permanent contact: over {}", string), 2.0, {ratio("C4", "permanent contact", string)}});
  }
  all.push_back({"single samples in contact, 99.9 % over median", 1.5, tails(build, precision)});
  all.push_back({"permanent contact: 1024 segments over 16", 1.3, segments(build, precision)});
  all.push_back({"80 modes, every 100 ms: over the roofline", 1.6, {ratio("80 modes", "every 100 ms", "roofline")}});
  return all;
}

/// The worst of some ratios; in bold beyond the goal.
std::string worst_of(const Goal& goal) {
  double worst = 0;
  for (const auto& ratio : goal.found) worst = std::max(worst, ratio.value_or(0));
  if (worst == 0) return "";
  return fmt::format(fmt::runtime(worst <= goal.max ? "{:.2f}" : "**{:.2f}**"), worst);
}

/// All goals with the worst that each build found, in both precisions.
void print_goals(const std::vector<Build>& all) {
  std::vector<std::string> columns = {"time of the spline", "goal, at most"};
  for (const Build& build : all) columns.push_back(build.name);
  heading("## Goals\n\nThe worst of C4 and C2, double/float; in bold what misses its goal.", columns);
  const std::vector<Goal> first = goals(all.front(), "double");
  for (std::size_t i = 0; i < first.size(); ++i) {
    std::vector<std::string> cells = {first[i].what, fmt::format("{:.2f}", first[i].max)};
    for (const Build& build : all)
      cells.push_back(worst_of(goals(build, "double")[i]) + "/" + worst_of(goals(build, "float")[i]));
    row(cells);
  }
}

/// Writes the data files for speed.gp from the first build: one column for each scheme.
void draw(const Build& build, const std::string& folder) {
  const std::vector<std::string> schemes = {"spline",    "EXP-3",        "linearly implicit", "Newton",
                                            "fd.hammer", "string alone", "roofline"};
  const auto cell = [](std::optional<double> value) {
    return value ? fmt::format("{}", *value) : std::string("NaN");
  };
  for (const std::string& precision : kPrecisions) {
    for (const char* model : kStrings) {
      std::ofstream file(fmt::format("{}/{}_{}.dat", folder, model, precision));
      fmt::print(file, "workload");
      for (const std::string& scheme : schemes) fmt::print(file, " \"{}\"", scheme);
      fmt::print(file, "\n");
      for (const Measured* one : build.all("ratios", precision)) {
        if (one->name[1] != model) continue;
        fmt::print(file, "\"{}\"", one->name[2]);
        for (const std::string& scheme : schemes) fmt::print(file, " {}", cell(one->get("ns/" + scheme)));
        fmt::print(file, "\n");
      }
    }
    std::ofstream modes(fmt::format("{}/modes_{}.dat", folder, precision));
    for (const Measured* one : build.all("modes", precision)) {
      fmt::print(modes, "{}", one->name[1]);
      for (const std::string& scheme : schemes) fmt::print(modes, " {}", cell(one->get("ns/" + scheme)));
      fmt::print(modes, "\n");
    }
    std::ofstream segments(fmt::format("{}/segments_{}.dat", folder, precision));
    for (int count = 4; count <= 4096; count *= 2) {
      fmt::print(segments, "{}", count);
      for (const Measured* one : build.all("segments", precision))
        fmt::print(segments, " {}", cell(one->get(fmt::format("ns/{}", count))));
      fmt::print(segments, "\n");
    }
    std::ofstream voices(fmt::format("{}/voices_{}.dat", folder, precision));
    for (const Measured* one : build.all("voices", precision)) {
      fmt::print(voices, "{}", one->name[1]);
      for (const char* scheme : {"spline", "EXP-3", "string alone"})
        fmt::print(voices, " {}", cell(one->get(std::string("ns/") + scheme)));
      fmt::print(voices, "\n");
    }
  }
}

void write(const std::vector<Build>& all, const std::string& folder) {
  fmt::print(
      "# Speed\n\n"
      "`scripts/bench` writes this page; do not edit it. Every scheme plays the same hammer on the same string, in "
      "one "
      "program and with the same compiler flags, a tenth of a second in each round. A ratio is the time of the "
      "spline "
      "divided by the time of the other scheme, the median over the rounds. Below 1 the spline is faster.\n\n"
      "| scheme | what it is |\n"
      "|---|---|\n"
      "| spline | `HammerString`, 32 segments (MB1: 64) |\n"
      "| EXP-3 | the explicit scheme of van Walstijn et al. (JSV 2023) on the two-step modal string |\n"
      "| EXP-3, caught | the same, but a hammer that has moved 5 cm back stops, as in `HammerString` |\n"
      "| linearly implicit | the scheme of Ducceschi and Bilbao |\n"
      "| Newton | the spline's own time step, solved by iteration on the power law to 1e-12 |\n"
      "| fd.hammer | from the Faust libraries, on a grid of points |\n"
      "| string alone | modes and pickup without hammer, sample by sample, as a contact needs them |\n"
      "| in blocks | the string alone by `HammerString` at rest, 64 samples at a time |\n"
      "| roofline | the loads, stores and multiply-adds of a struck modal string, none of which waits for another |\n"
      "\n"
      "C4 has 56 modes, C2 204. Permanent contact: a hammer of a million times the mass leans on the string. MB1 is "
      "a "
      "mass at a rigid barrier, without modes. Measured on {}; one core was used.\n\n"
      "| build | compiler | bits of a vector in the baselines |\n|---|---|---|\n",
      all.front().processor);
  for (const Build& build : all) fmt::print("| {} | {} | {} |\n", build.name, build.compiler, build.vector_bits);

  fmt::print("\n![time of a sample by scheme and workload](../figures/speed.svg)\n\n## Ratios\n");
  ratios(all.front());
  print_goals(all);
  fmt::print(
      "\n## Single samples\n\nSamples that find the felt in contact, in {}. A sample starts only after the one "
      "before "
      "is done, and the time of the stopwatch is subtracted.\n",
      all.front().ticks);
  percentiles(all.front(), "double");
  fmt::print("\n## Scaling\n\n![scaling in modes, segments and voices](../figures/speed_scaling.svg)\n");
  scaling(all.front());
  draw(all.front(), folder);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) throw std::runtime_error("allowed: bench_report FOLDER BUILD=FILE.json...");
  std::vector<Build> builds;
  for (int i = 2; i < argc; ++i) builds.push_back(read(argv[i]));
  write(builds, argv[1]);
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_report: {}\n", error.what());
  return 2;
}
