// SPDX-License-Identifier: MIT
#include "generator/instrument/instrument_draft.hpp"

#include <iterator>

#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {

std::string InstrumentDraft::own_name(const JsonObject& object) {
  std::string name = read_local_name(object, kGroundName);
  if (!names_.insert(name).second)
    object.fail(object.key("name"), fmt::format("'{}' is the name of two objects", name), "once");
  return name;
}

std::string InstrumentDraft::public_name(const JsonObject& object, const char* quantity) {
  std::string name = read_local_name(object) + "_" + quantity;
  require_public(object, object.key("name"), name);
  return name;
}

void InstrumentDraft::require_public(const JsonObject& object, std::string_view key, const std::string& name) {
  if (name == model.name || !public_names_.insert(name).second)
    object.fail(key, fmt::format("'{}' stands for two things", name), "another name");
}

std::size_t InstrumentDraft::single_place(const JsonObject& object, const char* key, const std::string& name) const {
  const std::size_t place = index_of(object, object.key(key), name, model.places, "place");
  if (model.places[place].points.size() != 1)
    object.fail(object.key(key), fmt::format("'{}' has several points", name), "a place of one point");
  return place;
}

std::size_t InstrumentDraft::points_of(std::size_t place) const {
  return place == kGround ? 1 : model.places[place].points.size();
}

std::string joined(const std::vector<std::string>& names) {
  return names.empty() ? "none, for the file has no such object"
                       : shown(fmt::format("{}", fmt::join(names, ", ")), 240);
}

}  // namespace contactspline
