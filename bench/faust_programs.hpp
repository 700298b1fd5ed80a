// SPDX-License-Identifier: MIT
// The Faust programs of faust/, compiled with the flags of Faust's own scripts.
#pragma once

#include <faust/dsp/dsp.h>

#include <memory>

namespace contactspline::bench {

std::unique_ptr<dsp> hammer_string_double();
std::unique_ptr<dsp> hammer_string_single();
std::unique_ptr<dsp> slide_string_single();
std::unique_ptr<dsp> fret_string_single();
std::unique_ptr<dsp> piano_single();

}  // namespace contactspline::bench
