// SPDX-License-Identifier: MIT
// The hammer-string with the C++ runtime. Use this class in a Faust architecture file instead of a class that Faust
// generates: contactspline_lv2(TARGET ... DSP fast_hammer_string.cpp).
#include "contactspline/host/faust_dsp.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"

class fast_hammer_string : public contactspline::InstrumentDsp<contactspline::HammerStringOf<
                               contactspline::materials::felt_c4, contactspline::resonators::string_c4, float>> {
 public:
  fast_hammer_string() : InstrumentDsp("fast_hammer_string") {}
};
