// SPDX-License-Identifier: MIT
// What the readers of the parts of an instrument file share.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/instrument/instrument.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

inline constexpr std::size_t kMaxBodies = 64;
inline constexpr std::size_t kMaxPoints = 512;  ///< for all places together; the same for connections
inline constexpr std::size_t kMaxObjects = 256;
inline constexpr Range kGap{ControlRanges<double>::gap_m.min, ControlRanges<double>::gap_m.max};
inline constexpr auto kGroundName = "ground";

/// An instrument while its file is read: the parts so far, and the names that are taken. A reader of a part needs the
/// parts that stand before it.
class InstrumentDraft {
 public:
  explicit InstrumentDraft(const JsonObject& of) : json(of) {}

  /// The objects of a list of the file; none where the file has no such list.
  [[nodiscard]] std::vector<JsonObject> objects(const char* name, const std::vector<std::string>& keys) const {
    return json.has(name) ? json.objects(name, keys, kMaxObjects) : std::vector<JsonObject>{};
  }

  /// The name of a body, place or connection, which no other one has.
  std::string own_name(const JsonObject& object);
  /// The name of a control or an output with its quantity, which no other one has.
  std::string public_name(const JsonObject& object, const char* quantity);
  /// Fails where a name of an emitted class stands for two things.
  void require_public(const JsonObject& object, std::string_view key, const std::string& name);

  /// Index of a place that has one point.
  [[nodiscard]] std::size_t single_place(const JsonObject& object, const char* key, const std::string& name) const;
  /// Number of points of a place; the ground is one.
  [[nodiscard]] std::size_t points_of(std::size_t place) const;

  const JsonObject& json;
  InstrumentModel model;
  std::set<std::pair<ControlQuantity, std::size_t>> controlled;  ///< what controls set, with its targets

 private:
  std::set<std::string> names_, public_names_;
};

/// Names in a line of an error.
[[nodiscard]] std::string joined(const std::vector<std::string>& names);

template <typename Objects>
[[nodiscard]] std::vector<std::string> names_of(const Objects& objects) {
  std::vector<std::string> names;
  for (const auto& object : objects) names.push_back(object.name);
  return names;
}

/// Index of the object that a key names.
template <typename Objects>
[[nodiscard]] std::size_t index_of(const JsonObject& json, std::string_view key, const std::string& name,
                                   const Objects& objects, const char* what) {
  const auto found = std::ranges::find(objects, name, [](const auto& object) { return object.name; });
  if (found == objects.end())
    json.fail(key, fmt::format("'{}' is no {}", shown(name), what), joined(names_of(objects)));
  return static_cast<std::size_t>(found - objects.begin());
}

}  // namespace contactspline
