// SPDX-License-Identifier: MIT
// The C4 hammer-string in double precision, for Faust's architecture file plot.cpp.
#include "contactspline/faust_dsp.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"

class mydsp : public contactspline::HammerStringDsp<contactspline::materials::felt_c4,
                                                    contactspline::resonators::string_c4, double> {
 public:
  mydsp() : HammerStringDsp("hammer_string", 0.00297) {}
};
