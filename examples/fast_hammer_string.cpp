// SPDX-License-Identifier: MIT
// faust/hammer_string.dsp with the C++ runtime. Use this class in a Faust architecture file instead of the class that
// Faust generates: contactspline_lv2(TARGET ... DSP fast_hammer_string.cpp).
#include "contactspline/faust_dsp.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"

class fast_hammer_string : public contactspline::HammerStringDsp<contactspline::materials::felt_c4,
                                                                 contactspline::resonators::string_c4, float> {
 public:
  fast_hammer_string() : HammerStringDsp("fast_hammer_string", 0.00297) {}
};
