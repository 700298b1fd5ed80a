// SPDX-License-Identifier: MIT
// Every class of the runtime, in both precisions, so that a compiler looks at each of its functions.
#include <faust/gui/UI.h>
#include <faust/gui/meta.h>

#include "contactspline/body.hpp"
#include "contactspline/contact_network.hpp"
#include "contactspline/coupled_contacts.hpp"
#include "contactspline/ensemble.hpp"
#include "contactspline/faust_dsp.hpp"
#include "contactspline/fret_string.hpp"
#include "contactspline/hammer_string.hpp"
#include "contactspline/hammer_voice.hpp"
#include "contactspline/keyboard.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/live_exponent.hpp"
#include "contactspline/mass_barrier.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/felt_live.hpp"
#include "contactspline/modal.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/slide_string.hpp"
#include "contactspline/strike_constants.hpp"
#include "contactspline/string_place.hpp"

namespace contactspline {

using String = resonators::string_c4;
using Felt = materials::felt_c4;

template struct ContactControls<float>;
template struct Segment<float>;
template class detail::ContactTableStorage<float>;
template class detail::StrikeConstantsStorage<float>;
template class Body<float>;
template class ContactNetwork<float>;
template class CoupledContacts<float>;
template class Ensemble<float>;
template class FretString<float>;
template class HammerString<float>;
template class HammerStringDsp<Felt, String, float>;
template class HammerVoice<float>;
template class KeyboardVoice<keyboards::piano, float>;
template class LiveExponent<materials::felt_live, float>;
template class MassBarrier<float>;
template class ModalBank<float>;
template class ModeShapes<float>;
template class MovingPlace<float>;
template class SlideString<float>;
template class StringShapes<float>;

template struct ContactControls<double>;
template struct Segment<double>;
template class detail::ContactTableStorage<double>;
template class detail::StrikeConstantsStorage<double>;
template class Body<double>;
template class ContactNetwork<double>;
template class CoupledContacts<double>;
template class Ensemble<double>;
template class FretString<double>;
template class HammerString<double>;
template class HammerStringDsp<Felt, String, double>;
template class HammerVoice<double>;
template class KeyboardVoice<keyboards::piano, double>;
template class LiveExponent<materials::felt_live, double>;
template class MassBarrier<double>;
template class ModalBank<double>;
template class ModeShapes<double>;
template class MovingPlace<double>;
template class SlideString<double>;
template class StringShapes<double>;

// With sizes that are known at compile time. Such a hammer-string has no process_in_kernels().
template class FretString<float, segments_of<Felt, float>.size(), String::modes>;
#ifndef CONTACTSPLINE_SIMD
template class HammerString<float, segments_of<Felt, float>.size(), String::modes>;
#endif
template class MassBarrier<float, segments_of<Felt, float>.size()>;
template class SlideString<float, segments_of<Felt, float>.size(), String::modes>;

template const std::array<Segment<float>, Felt::segments + 1> segments_of<Felt, float>;
template const std::array<Mode, String::modes> modes_in<String>;

}  // namespace contactspline
