// SPDX-License-Identifier: MIT
// The C4 hammer-string in double precision, for Faust's architecture file plot.cpp.
#include "contactspline/host/faust_dsp.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"

class mydsp : public contactspline::InstrumentDsp<contactspline::HammerStringOf<
                  contactspline::materials::felt_c4, contactspline::resonators::string_c4, double>> {};
