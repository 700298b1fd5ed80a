// SPDX-License-Identifier: MIT
#include "generator/dataset/plan_instrument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "generator/material/named_file.hpp"
#include "generator/support/embedded_files.hpp"

namespace contactspline {
namespace {

constexpr auto kPiano = "piano";  // the one that ships plays without parts

}  // namespace

InstrumentMaker read_plan_instrument(const JsonObject& plan, const ReadFile& read) {
  if (plan.has_object("instrument")) {
    if (plan.has("parts")) plan.fail("parts", "has no meaning here", "beside the name of a model");
    return maker_of_text(plan.json("instrument"), plan.file(), read);
  }
  std::vector<std::string> names;
  for (const MadeOfParts& made : all_made_of_parts()) names.emplace_back(made.name);
  for (const std::string& shipped : shipped_names(Shipped::kInstruments)) names.push_back(shipped);
  const std::string allowed = fmt::format("a .json file, an object with the keys of one, {}", fmt::join(names, ", "));
  const std::string name = plan.text("instrument", allowed);
  if (!is_path(name) && std::ranges::find(names, name) == names.end())
    plan.fail("instrument", fmt::format("'{}' is unknown", shown(name)), allowed);
  if (const MadeOfParts* made = made_of_parts(name)) {
    if (name == kPiano && !plan.has("parts"))
      return made->make(parse_json(R"({"keyboard": "piano"})", plan.file(), "parts", made->keys), read);
    return made->make(plan.object("parts", made->keys), read);
  }
  if (plan.has("parts"))
    plan.fail("parts", fmt::format("has no meaning for {}", shown(name)), "no such key: set its parameters instead");
  const NamedText named = read_named(plan, "instrument", Shipped::kInstruments, read);
  return maker_of_text(named.text, named.file, reader_beside(named, read));
}

}  // namespace contactspline
