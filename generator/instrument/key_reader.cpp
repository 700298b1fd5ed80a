// SPDX-License-Identifier: MIT
#include "generator/instrument/key_reader.hpp"

#include <algorithm>
#include <cstdlib>

#include "contactspline/step/controls.hpp"

namespace contactspline {
namespace {

constexpr unsigned char kSustainController = 64;
constexpr int kMaxKey = 127, kMaxVoices = 64;
constexpr int kMaxSemitones = 24;  // that a key may tune
constexpr int kVoices = 8;         // of keys that tune

/// Reads keys, then what damps and tunes them.
class KeyReader {
 public:
  explicit KeyReader(InstrumentDraft& draft) : draft_(draft), model_(draft.model) {}

  void read() {
    for (const char* key : {"polyphony", "damper"})
      if (draft_.json.has(key) && !draft_.json.has("keys")) draft_.json.fail(key, "has no place here", "beside keys");
    const auto rows =
        draft_.objects("keys", {"key", "first", "last", "event", "tuned_key", "per_octave", "string", "bodies"});
    for (const JsonObject& row : rows) read_key(row);
    for (const JsonObject& row : rows) check_all_strings(row);
    if (model_.keys.ranges.empty()) return;
    std::ranges::sort(model_.keys.ranges, {}, &KeyRange::first);
    model_.keys.voices =
        static_cast<std::size_t>(draft_.json.has("polyphony")   ? draft_.json.integer("polyphony", 1, kMaxVoices)
                                 : model_.keys.tune() && !bow() ? kVoices
                                                                : 1);
    if (draft_.json.has("damper")) read_damper(draft_.json.object("damper", {"bodies", "damping_per_s"}));
    if (!model_.keys.tune()) return;
    model_.keys.bend = model_.parameters.size();
    model_.parameters.push_back({.name = "bend_cents",
                                 .unit = "cents",
                                 .allowed = ControlRanges<double>::bend_cents,
                                 .slider = {-200, 200},
                                 .initial = 0,
                                 .step_samples = 16});
  }

 private:
  // Keys that play one event.
  void read_key(const JsonObject& row) {
    const std::string key = one_of_keys(row, {"key", "first"}, "kinds of keys");
    if (key == "key" && row.has("last")) row.fail(row.key("last"), "stands beside key", "beside first");
    KeyRange range{row.integer(key.c_str(), 0, kMaxKey), 0, 0};
    range.last = key == "key" ? range.first : row.integer("last", range.first, kMaxKey);
    const std::string name = row.text("event", joined(names_of(model_.events)));
    range.event = index_of(row, row.key("event"), name, model_.events, "event");
    if (row.has("tuned_key")) read_tuned_key(row, range);
    if (row.has("per_octave")) {
      if (range.tuned_key < 0) row.fail(row.key("per_octave"), "has no tuned_key", "beside tuned_key");
      range.per_octave = row.number("per_octave", {0.1, 10});
    }
    if (row.has("string") || row.has("bodies")) read_tuned(row, range);
    for (const KeyRange& other : model_.keys.ranges)
      if (range.first <= other.last && other.first <= range.last)
        row.fail(row.key(key), fmt::format("key {} plays two events", std::max(range.first, other.first)),
                 "each key once");
    model_.keys.ranges.push_back(range);
  }

  // Do keys bow? A key that is held goes on with the stroke of another one.
  [[nodiscard]] bool bow() const {
    return std::ranges::any_of(model_.keys.ranges, [&](const KeyRange& range) {
      return model_.events[range.event].kind == EventKind::kBow;
    });
  }

  void read_tuned_key(const JsonObject& row, KeyRange& range) const {
    range.tuned_key = row.integer("tuned_key", 0, kMaxKey);
    const auto is_string = [](const InstrumentBody& body) {
      return std::holds_alternative<StiffString>(body.resonator.body);
    };
    if (std::ranges::none_of(model_.bodies, is_string) && !row.has("bodies"))
      row.fail(row.key("tuned_key"), "tunes nothing", "in a file with a string among its bodies, or beside bodies");
    for (const int key : {range.first, range.last})
      if (std::abs(key - range.tuned_key) > kMaxSemitones)
        row.fail(row.key("tuned_key"),
                 fmt::format("key {} is {} semitones from {}", key, std::abs(key - range.tuned_key), range.tuned_key),
                 fmt::format("at most {} semitones, such as {}", kMaxSemitones, (range.first + range.last) / 2));
  }

  // Keys that name nothing tune all strings, but no other body, which they would not leave alone.
  void check_all_strings(const JsonObject& row) const {
    if (!row.has("tuned_key") || row.has("string") || row.has("bodies")) return;
    for (const std::vector<std::size_t>& tuned : model_.keys.tuned)
      for (const std::size_t body : tuned)
        if (!std::holds_alternative<StiffString>(model_.bodies[body].resonator.body))
          row.fail(row.key("tuned_key"),
                   fmt::format("tunes all strings, while other keys tune '{}'", model_.bodies[body].name),
                   "beside string or bodies");
  }

  // What keys tune in place of all strings: one string, or bodies that go together.
  void read_tuned(const JsonObject& row, KeyRange& range) {
    const std::string named = one_of_keys(row, {"string", "bodies"}, "kinds of what is tuned");
    const std::string key = row.key(named);
    if (range.tuned_key < 0) row.fail(key, "has no tuned_key", "beside tuned_key");
    const std::string names = joined(names_of(model_.bodies));
    std::vector<std::size_t> tuned;
    for (const std::string& name :
         named == "string" ? std::vector{row.text("string", names)} : row.texts("bodies", names, kMaxBodies)) {
      const std::size_t body = index_of(row, key, name, model_.bodies, "body");
      if (named == "string" && !std::holds_alternative<StiffString>(model_.bodies[body].resonator.body))
        row.fail(key, fmt::format("'{}' is not a string", name), "a body that is a string");
      if (model_.bodies[body].is_mass)
        row.fail(key, fmt::format("'{}' is a free mass, which has no pitch", name), "bodies with modes");
      if (std::ranges::count(tuned, body) > 0) row.fail(key, fmt::format("'{}' is named twice", name), "once");
      tuned.push_back(body);
    }
    range.string = tuned.front();
    if (std::ranges::count(model_.keys.tuned, tuned) > 0) return;
    for (const auto& others : model_.keys.tuned)
      for (const std::size_t body : tuned)
        if (std::ranges::count(others, body) > 0)
          row.fail(key,
                   fmt::format("'{}' is tuned by other keys, beside other bodies or alone", model_.bodies[body].name),
                   "the same bodies in the same order, or none of them");
    model_.keys.tuned.push_back(std::move(tuned));
  }

  void read_damper(const JsonObject& damper) {
    for (const std::string& name : damper.texts("bodies", joined(names_of(model_.bodies)), kMaxBodies)) {
      const std::size_t body = index_of(damper, damper.key("bodies"), name, model_.bodies, "body");
      if (std::ranges::find(model_.keys.damped, body) != model_.keys.damped.end())
        damper.fail(damper.key("bodies"), fmt::format("'{}' is named twice", name), "once");
      model_.keys.damped.push_back(body);
    }
    model_.keys.damper_per_s = damper.number("damping_per_s", range_of(ControlQuantity::kDamping));
    model_.keys.sustain = model_.parameters.size();
    model_.parameters.push_back({.name = "sustain",
                                 .unit = "",
                                 .allowed = {0, 1},
                                 .slider = {0, 1},
                                 .initial = 0,
                                 .controller = kSustainController});
  }

  InstrumentDraft& draft_;
  InstrumentModel& model_;
};

}  // namespace

void read_keys(InstrumentDraft& draft) {
  KeyReader(draft).read();
}

}  // namespace contactspline
