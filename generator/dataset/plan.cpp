// SPDX-License-Identifier: MIT
#include "generator/dataset/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "contactspline/data/pluck.hpp"
#include "generator/dataset/plan_instrument.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/sample_rates.hpp"

namespace contactspline {
namespace {

constexpr double kLongest_s = 3600;
constexpr int kMaxCount = 1000000000;
constexpr std::size_t kMaxTable = 65536, kMaxEvents = 1024;
constexpr auto kForce = "force_n", kEnergy = "energy_j";

// What a plan says and what its instrument has.
struct Reading {
  const JsonObject& json;
  const AnyInstrument<double>& instrument;
  double seconds;
  Plan& plan;
};

std::size_t sample_at(const Reading& reading, double time_s) {
  return static_cast<std::size_t>(std::llround(time_s * reading.plan.sample_rate_hz));
}

Range range_of(const Parameter& parameter) {
  return {parameter.allowed.min, parameter.allowed.max};
}

// A number, or a distribution: an object with one law. Adds its column and returns its place.
std::size_t read_column(const JsonObject& object, const char* name, std::string unit, Range range, Plan& plan) {
  PlanColumn column;
  column.name = object.key(name);
  column.unit = std::move(unit);
  if (const std::string own = "parameters."; column.name.starts_with(own)) column.name.erase(0, own.size());
  if (!object.has_object(name)) {
    column.low = object.number(name, range);
  } else {
    const JsonObject law = object.object(name, {"uniform", "logarithmic", "table"});
    const bool is_table = law.has("table"), is_uniform = law.has("uniform");
    if (is_table + is_uniform + law.has("logarithmic") != 1)
      law.fail(object.key(name), "has no law or several",
               fmt::format("a number, or one of uniform, logarithmic and table, such as {{\"uniform\": [{}, {}]}}",
                           range.min, range.max));
    column.law = is_table ? Law::kTable : is_uniform ? Law::kUniform : Law::kLogarithmic;
    const char* key = is_table ? "table" : is_uniform ? "uniform" : "logarithmic";
    column.table = law.numbers(key, range, kMaxTable);
    if (!is_table) {
      const std::vector<double> ends = std::exchange(column.table, {});
      const bool has_ends = ends.size() == 2 && ends[0] < ends[1];
      if (!has_ends || (column.law == Law::kLogarithmic && ends[0] <= 0))
        law.fail(law.key(key), "is no range",
                 fmt::format("two numbers from {} to {}, the smaller one first{}", range.min, range.max,
                             is_uniform ? "" : ", both above 0"));
      column.low = ends[0], column.high = ends[1];
    }
  }
  plan.columns.push_back(std::move(column));
  return plan.columns.size() - 1;
}

void read_parameters(const Reading& reading) {
  const auto parameters = reading.instrument.parameters();
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.emplace_back(parameter.name);
  const bool has_any = reading.json.has("parameters");
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = parameters[i];
    if (!has_any || !reading.json.object("parameters", names).has(parameter.name)) continue;
    reading.plan.first.push_back({i, read_column(reading.json.object("parameters", names), parameter.name,
                                                 parameter.unit, range_of(parameter), reading.plan)});
  }
}

// The one of a list of the instrument that a key names.
template <typename Row>
std::size_t read_choice(const JsonObject& object, const char* key, std::span<const Row> rows) {
  std::vector<std::string_view> names;
  for (const Row& row : rows) names.push_back(row.name);
  const std::string allowed =
      names.empty() ? "no such key: this instrument has none" : shown(fmt::format("{}", fmt::join(names, ", ")), 240);
  const std::string name = object.text(key, allowed);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) object.fail(object.key(key), fmt::format("'{}' is unknown", shown(name)), allowed);
  return static_cast<std::size_t>(found - names.begin());
}

void require_keys(const JsonObject& event, const Plan& plan, std::size_t column) {
  const PlanColumn& keys = plan.columns[column];
  const auto is_whole = [](double key) { return key == std::floor(key); };
  const bool are_whole = keys.law == Law::kTable ? std::ranges::all_of(keys.table, is_whole)
                                                 : keys.law == Law::kConstant && is_whole(keys.low);
  if (!are_whole) event.fail(event.key("key"), "is no key", "an integer from 0 to 127, or {\"table\": [60, 62, 64]}");
}

PlannedEvent read_event(const Reading& reading, const JsonObject& event) {
  const Range times{0, reading.seconds};
  const bool plays = event.has("event"), sets = event.has("parameter");
  if (plays + sets + event.has("key") != 1)
    event.fail(event.key("event"), "nothing happens, or several things", "one of event, key and parameter");
  PlannedEvent planned{sample_at(reading, event.number("time_s", times)), PlannedEvent::kKey, 0};
  if (plays) {
    const Event& played = reading.instrument.events()[read_choice(event, "event", reading.instrument.events())];
    planned.kind = PlannedEvent::kPlay;
    planned.action = action_of(played.kind);
    planned.number = played.number;
  } else if (sets) {
    planned.kind = PlannedEvent::kSet;
    planned.number = read_choice(event, "parameter", reading.instrument.parameters());
    const Parameter& parameter = reading.instrument.parameters()[planned.number];
    planned.value = read_column(event, "to", parameter.unit, range_of(parameter), reading.plan);
  } else {
    planned.key = read_column(event, "key", "", {0, 127}, reading.plan);
    require_keys(event, reading.plan, planned.key);
    if (event.has("velocity")) planned.value = read_column(event, "velocity", "", {0, 1}, reading.plan);
  }
  const auto only = [&](const char* key, bool fits, const char* where) {
    if (event.has(key) && !fits) event.fail(event.key(key), "has no meaning here", where);
    return event.has(key);
  };
  only("to", sets, "beside parameter");
  only("velocity", planned.kind == PlannedEvent::kKey, "beside key");
  const bool plucks = plays && planned.action == Action::kPluck;
  if (only("hold_s", !sets && !plucks, "beside key, or an event that strikes or bows"))
    planned.end = planned.sample + sample_at(reading, event.number("hold_s", times));
  planned.rise_s = kPluckRise_s;
  if (only("rise_s", plucks, "beside an event that plucks")) planned.rise_s = event.number("rise_s", {1e-5, 1});
  return planned;
}

void read_events(const Reading& reading) {
  const std::vector<std::string> keys = {"time_s", "event", "key", "velocity", "parameter", "to", "hold_s", "rise_s"};
  for (const JsonObject& event : reading.json.objects("events", keys, kMaxEvents))
    reading.plan.events.push_back(read_event(reading, event));
  std::ranges::stable_sort(reading.plan.events, {}, &PlannedEvent::sample);
}

void read_outputs(const Reading& reading) {
  const auto outputs = reading.instrument.outputs();
  std::vector<std::string_view> names;
  for (const Output& output : outputs) names.emplace_back(output.name);
  const std::string allowed = shown(fmt::format("{}, {}, {}", fmt::join(names, ", "), kForce, kEnergy), 240);
  for (const std::string& name : reading.json.texts("outputs", allowed, outputs.size() + 2)) {
    if (std::ranges::find(reading.plan.recorded, name, &Recorded::name) != reading.plan.recorded.end())
      reading.json.fail("outputs", fmt::format("'{}' stands twice", shown(name)), "once");
    const auto found = std::ranges::find(names, name);
    if (found != names.end()) {
      const auto number = static_cast<std::size_t>(found - names.begin());
      reading.plan.recorded.push_back({name, outputs[number].unit, Recorded::kOutput, number});
    } else if (name == kForce) {
      reading.plan.recorded.push_back({name, "N", Recorded::kForce, 0});
    } else if (name == kEnergy) {
      reading.plan.recorded.push_back({name, "J", Recorded::kEnergy, 0});
    } else {
      reading.json.fail("outputs", fmt::format("'{}' is unknown", shown(name)), allowed);
    }
  }
  const bool has_energy =
      std::ranges::find(reading.plan.recorded, Recorded::kEnergy, &Recorded::kind) != reading.plan.recorded.end();
  if (has_energy != reading.json.has("energy_step_samples"))
    reading.json.fail(
        "energy_step_samples", has_energy ? "missing" : "has no meaning here",
        fmt::format("an integer from 1 to {}, such as 1, where outputs have {}", reading.plan.length, kEnergy));
  if (has_energy)
    reading.plan.energy_step = static_cast<std::size_t>(reading.json.integer(
        "energy_step_samples", 1, static_cast<int>(std::min<std::size_t>(reading.plan.length, 1u << 30))));
}

// A key whose value is one of some words.
std::size_t read_word(const JsonObject& object, const char* key, std::span<const std::string_view> words) {
  if (!object.has(key)) return 0;
  const std::string allowed = fmt::format("{}", fmt::join(words, ", "));
  const std::string word = object.text(key, allowed);
  const auto found = std::ranges::find(words, word);
  if (found == words.end()) object.fail(key, fmt::format("'{}' is unknown", shown(word)), allowed);
  return static_cast<std::size_t>(found - words.begin());
}

}  // namespace

std::size_t Plan::length_of(const Recorded& recorded_one) const {
  return recorded_one.kind == Recorded::kEnergy ? length / energy_step : length;
}

std::size_t Plan::bytes_per_sample() const {
  std::size_t bytes = columns.size() * sizeof(double);
  for (const Recorded& one : recorded)
    bytes += length_of(one) * (one.kind == Recorded::kEnergy ? sizeof(double) : sizeof(float));
  return bytes;
}

Plan parse_plan(std::string_view text, const std::string& file, const ReadFile& read) {
  const JsonObject json =
      parse_json(text, file, "plan",
                 {"name", "description", "instrument", "parts", "parameters", "events", "outputs",
                  "energy_step_samples", "sequence", "seed", "count", "seconds", "sample_rate_hz", "precision"});
  Plan plan;
  plan.file = file;
  plan.name = read_local_name(json);
  plan.text = text;
  plan.description = read_description(json);
  plan.maker = read_plan_instrument(json, [&](const std::string& path) { return plan.inputs[path] = read(path); });
  constexpr std::string_view kSequences[] = {"random", "sobol"}, kPrecisions[] = {"single", "double"};
  plan.sequence = Sequence(read_word(json, "sequence", kSequences));
  plan.is_double = read_word(json, "precision", kPrecisions) == 1;
  plan.seed = static_cast<std::uint64_t>(json.integer("seed", 0, std::numeric_limits<int>::max()));
  plan.count = static_cast<std::size_t>(json.integer("count", 1, kMaxCount));
  plan.sample_rate_hz =
      json.has("sample_rate_hz") ? json.number("sample_rate_hz", kSampleRates_hz) : plan.sample_rate_hz;
  const double seconds = json.number("seconds", {1 / plan.sample_rate_hz, kLongest_s});
  plan.length = static_cast<std::size_t>(std::llround(seconds * plan.sample_rate_hz));
  const auto instrument = plan.maker.make<double>(plan.sample_rate_hz);
  plan.instrument = instrument->name();
  plan.license = instrument->license();
  const Reading reading{json, *instrument, seconds, plan};
  read_parameters(reading);
  read_events(reading);
  read_outputs(reading);
  return plan;
}

}  // namespace contactspline
