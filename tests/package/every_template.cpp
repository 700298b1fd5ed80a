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
#include "contactspline/instrument.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "contactspline/keyboard.hpp"
#include "contactspline/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/live_exponent.hpp"
#include "contactspline/mass_barrier.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/felt_live.hpp"
#include "contactspline/modal.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/slide_string.hpp"
#include "contactspline/stiff_string.hpp"
#include "contactspline/strike_constants.hpp"
#include "contactspline/string_place.hpp"

namespace contactspline {

using String = resonators::string_c4;
using Felt = materials::felt_c4;

#define CONTACTSPLINE_EVERY_TEMPLATE(T)                                                                         \
  template struct ContactControls<T>;                                                                           \
  template struct Segment<T>;                                                                                   \
  template class detail::ContactTableStorage<T>;                                                                \
  template class detail::StrikeConstantsStorage<T>;                                                             \
  template double detail::tension_energy(const StiffString&, std::span<const StringMode>, const ModalBank<T>&); \
  template class Body<T>;                                                                                       \
  template class ContactNetwork<T>;                                                                             \
  template class CoupledContacts<T>;                                                                            \
  template class Ensemble<T>;                                                                                   \
  template class FretString<T>;                                                                                 \
  template class HammerString<T>;                                                                               \
  template class HammerStringDsp<Felt, String, T>;                                                              \
  template class HammerVoice<T>;                                                                                \
  template class KeyboardInstrument<keyboards::piano, T>;                                                       \
  template class KeyboardOnBody<T>;                                                                             \
  template class KeyboardVoice<keyboards::piano, T>;                                                            \
  template class LiveExponent<materials::felt_live, T>;                                                         \
  template class MassBarrier<T>;                                                                                \
  template class ModalBank<T>;                                                                                  \
  template class ModeShapes<T>;                                                                                 \
  template class MovingPlace<T>;                                                                                \
  template class NetworkInstrument<T>;                                                                          \
  template class instruments::trichord_c4<T>;                                                                   \
  template class InstrumentDsp<instruments::trichord_c4<T>>;                                                    \
  template class SlideString<T>;                                                                                \
  template class StringShapes<T>;

CONTACTSPLINE_EVERY_TEMPLATE(float)
CONTACTSPLINE_EVERY_TEMPLATE(double)

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
