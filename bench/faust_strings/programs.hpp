// SPDX-License-Identifier: MIT
// The programs that Faust generates for the strings of this folder, with several options.
#pragma once

#include <faust/dsp/dsp.h>

#include <memory>
#include <string>
#include <vector>

namespace contactspline::bench {

struct FaustString {
  std::string string;     ///< c4, c2 or eighty_modes
  std::string precision;  ///< double or single
  std::string name;       ///< libraries and options used
  std::unique_ptr<dsp> (*make)();
};
const std::vector<FaustString>& faust_strings();

}  // namespace contactspline::bench
