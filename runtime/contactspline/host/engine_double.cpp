// SPDX-License-Identifier: MIT
#include "contactspline/host/engine-inl.hpp"

template struct contactspline::Engine<double>;
