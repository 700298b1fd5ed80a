// SPDX-License-Identifier: MIT
// What Faust writes for the hammer-strings of this folder, by several options.
#pragma once

#include <faust/dsp/dsp.h>

#include <memory>
#include <string>
#include <vector>

namespace contactspline::bench {

struct FaustString {
  std::string string;     ///< c4, c2 or eighty_modes
  std::string precision;  ///< double or single
  std::string name;       ///< by whose libraries and options
  std::unique_ptr<dsp> (*make)();
};
const std::vector<FaustString>& faust_strings();

}  // namespace contactspline::bench
