// SPDX-License-Identifier: MIT
// What most programs need of the runtime: the contact step, modes, models and instruments. Headers that need another
// library stand alone: contactspline/host/faust_dsp.hpp (Faust) and contactspline/host/threads.hpp (oneTBB).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/host/hosted.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/string_place.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/ensemble.hpp"
#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/models/keyboard_on_body.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "contactspline/models/slide_string.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/flush_denormals.hpp"
#include "contactspline/step/live_exponent.hpp"
#include "contactspline/step/memory.hpp"
