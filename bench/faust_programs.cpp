// SPDX-License-Identifier: MIT
#include "faust_programs.hpp"

#include <faust/gui/UI.h>
#include <faust/gui/meta.h>

#include "fret_string_single.hpp"
#include "hammer_string_double.hpp"
#include "hammer_string_single.hpp"
#include "piano_single.hpp"
#include "slide_string_single.hpp"

namespace contactspline::bench {

std::unique_ptr<dsp> hammer_string_double() {
  return std::make_unique<::hammer_string_double>();
}
std::unique_ptr<dsp> hammer_string_single() {
  return std::make_unique<::hammer_string_single>();
}
std::unique_ptr<dsp> slide_string_single() {
  return std::make_unique<::slide_string_single>();
}
std::unique_ptr<dsp> fret_string_single() {
  return std::make_unique<::fret_string_single>();
}
std::unique_ptr<dsp> piano_single() {
  return std::make_unique<::piano_single>();
}

}  // namespace contactspline::bench
