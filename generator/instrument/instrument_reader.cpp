// SPDX-License-Identifier: MIT
#include "generator/instrument/instrument_reader.hpp"

#include <fmt/format.h>

#include <utility>

#include "generator/instrument/body_reader.hpp"
#include "generator/instrument/connection_reader.hpp"
#include "generator/instrument/control_reader.hpp"
#include "generator/instrument/instrument_draft.hpp"
#include "generator/instrument/key_reader.hpp"
#include "generator/instrument/moved_masses.hpp"
#include "generator/instrument/output_reader.hpp"

namespace contactspline {
namespace {

// Members of the emitted C++ class and a parameter, which must not be called like it.
constexpr const char* kMemberNames[] = {
    "tick",    "process",   "output",         "energy",         "work",       "dissipated",    "network",
    "reset",   "strike",    "release",        "pluck",          "data",       "bow",           "speed",
    "value",   "set",       "prepare",        "name",           "events",     "contact_force", "ground",
    "samples", "is_silent", "format_version", "sample_rate_hz", "parameters", "outputs",       "presets",
    "force",   "note_on",   "description",    "value_type",     "note_off",   "tune",          "keyed",
    "voice",   "license",   "input_scale_n"};

void read_names(InstrumentDraft& draft) {
  draft.model.name = read_name(draft.json, kMemberNames);
  for (const char* prefix : {"set_", "strike_", "pluck_", "bow_"})
    if (draft.model.name.starts_with(prefix))
      draft.json.fail("name", fmt::format("begins with {}", prefix),
                      "a name that no member of the emitted class has");
  draft.model.description = read_description(draft.json);
  draft.model.license = read_license(draft.json);
}

}  // namespace

InstrumentModel parse_instrument(std::string_view text, std::string_view file, const ReadFile& read) {
  DesignedMaterials materials(read);
  return parse_instrument(text, file, read, materials);
}

InstrumentModel parse_instrument(std::string_view text, std::string_view file, const ReadFile& read,
                                 DesignedMaterials& materials) {
  const JsonObject json =
      parse_json(text, file, "instrument",
                 {"name", "description", "license", "bodies", "places", "contacts", "springs", "links", "frictions",
                  "controls", "strikes", "bows", "outputs", "input", "keys", "polyphony", "damper", "presets"});
  InstrumentDraft draft(json);
  MovedMasses masses(draft);
  read_names(draft);
  read_bodies(draft, read);
  read_connections(draft, materials, masses, read);
  read_controls(draft, masses);
  read_keys(draft);
  read_outputs(draft);
  read_input(draft);
  read_presets(draft);
  return std::move(draft.model);
}

}  // namespace contactspline
