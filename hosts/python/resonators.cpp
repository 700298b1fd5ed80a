// SPDX-License-Identifier: MIT
#include "hosts/python/resonators.hpp"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "generator/cli/inputs.hpp"
#include "generator/cli/inspect_json.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/sample_rates.hpp"

namespace contactspline::python {
namespace {

void check_rate(const std::string& name, double rate) {
  if (!(rate >= kSampleRates_hz.min && rate <= kSampleRates_hz.max))
    refuse(name, "sample_rate_hz", fmt::format("{} is refused", rate),
           fmt::format("a number from {} to {}", kSampleRates_hz.min, kSampleRates_hz.max));
}

}  // namespace

std::string resonator_json(const std::string& source, bool is_text, double sample_rate_hz) {
  const auto resonator = is_text ? std::optional(parse_resonator(source, "resonator")) : resonator_argument(source);
  if (!resonator)
    refuse(shown(source), "resonator", "is no resonator", "the name or the file of one, such as string_c4");
  check_rate(resonator->name, sample_rate_hz);
  return json_of(*resonator, sample_rate_hz);
}

std::string keyboard_json(const std::string& source, bool is_text, double sample_rate_hz) {
  const auto keyboard = is_text ? std::optional(parse_keyboard(source, "keyboard")) : keyboard_argument(source);
  if (!keyboard) refuse(shown(source), "keyboard", "is no keyboard", "the name or the file of one, such as piano");
  check_rate(keyboard->name, sample_rate_hz);
  std::vector<KeyRow> rows;
  for (int key = keyboard->first_key; key <= keyboard->last_key; ++key)
    rows.push_back(key_row(*keyboard, key, sample_rate_hz));
  return json_of(*keyboard, rows, sample_rate_hz);
}

}  // namespace contactspline::python
