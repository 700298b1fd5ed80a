// SPDX-License-Identifier: MIT
#include "hosts/python/makers.hpp"

#include <vector>

#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"
#include "generator/support/json_reader.hpp"
#include "hosts/named_instruments.hpp"

namespace contactspline::python {

InstrumentMaker maker_of(const std::string& source, bool is_text, const std::string& parts_text) {
  const std::vector<std::string> given = json_keys(parts_text, source, "instrument");
  if (given.empty()) return is_text ? maker_of_text(source, "instrument") : maker_of_name(source);
  const MadeOfParts* made = is_text ? nullptr : made_of_parts(source);
  if (made != nullptr) return made->make(parse_json(parts_text, source, "instrument", made->keys), read_input);
  if (!is_text) (void)maker_of_name(source);  // refuses a name that nothing has
  refuse(is_text ? "instrument" : source, given.front(), "is no part of this instrument",
         "no keys: set its parameters instead");
}

}  // namespace contactspline::python
