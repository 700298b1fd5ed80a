// SPDX-License-Identifier: MIT
// Every class of the runtime, in both precisions, so that a compiler looks at each of its functions.
#include <faust/gui/UI.h>
#include <faust/gui/meta.h>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/data/pluck.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/host/any_instrument.hpp"
#include "contactspline/host/engine.hpp"
#include "contactspline/host/faust_dsp.hpp"
#include "contactspline/host/hosted.hpp"
#include "contactspline/host/model_module.hpp"
#include "contactspline/host/oversampled.hpp"
#include "contactspline/host/replaceable.hpp"
#include "contactspline/host/sleeper.hpp"
#include "contactspline/host/tuned_keys.hpp"
#include "contactspline/instrument/ensemble_instrument.hpp"
#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/instrument_parts.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instrument/mass_barrier_instrument.hpp"
#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/network_pickups.hpp"
#include "contactspline/instrument/network_pressure.hpp"
#include "contactspline/instrument/network_strikes.hpp"
#include "contactspline/instrument/network_tuning.hpp"
#include "contactspline/instrument/parameter_values.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/instrument/voices.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/felt_live.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/modal/force_history.hpp"
#include "contactspline/modal/form_matrix.hpp"
#include "contactspline/modal/longitudinal.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/mode.hpp"
#include "contactspline/modal/stretch_forms.hpp"
#include "contactspline/modal/stretching_bank.hpp"
#include "contactspline/modal/string_place.hpp"
#include "contactspline/modal/two_step_motion.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/bridge_load.hpp"
#include "contactspline/models/contact_on_string.hpp"
#include "contactspline/models/ensemble.hpp"
#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/key_on_body.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/models/keyboard_on_body.hpp"
#include "contactspline/models/keyboard_sound.hpp"
#include "contactspline/models/keys_on_bridge.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "contactspline/models/pressure_sound.hpp"
#include "contactspline/models/slide_string.hpp"
#include "contactspline/models/strike_constants.hpp"
#include "contactspline/network/assembly.hpp"
#include "contactspline/network/contact_group.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/following_controls.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_parts.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/network/network_receptances.hpp"
#include "contactspline/network/newton.hpp"
#include "contactspline/network/sample_law.hpp"
#include "contactspline/network/sleeping_contacts.hpp"
#include "contactspline/network/spring_elimination.hpp"
#include "contactspline/network/two_steps.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/step/friction.hpp"
#include "contactspline/step/friction_heat.hpp"
#include "contactspline/step/half_band.hpp"
#include "contactspline/step/high_pass.hpp"
#include "contactspline/step/live_exponent.hpp"
#include "contactspline/step/memory.hpp"
#include "contactspline/step/roughness.hpp"
#include "contactspline/step/splice.hpp"
#include "contactspline/tangent/bodies_tangent.hpp"
#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/contact_tangent.hpp"
#include "contactspline/tangent/force_equations.hpp"
#include "contactspline/tangent/friction_backwards.hpp"
#include "contactspline/tangent/friction_tangent.hpp"
#include "contactspline/tangent/mass_barrier_tangent.hpp"
#include "contactspline/tangent/mode_slopes.hpp"
#include "contactspline/tangent/moved_receptances.hpp"
#include "contactspline/tangent/moving_places_backwards.hpp"
#include "contactspline/tangent/network_adjoints.hpp"
#include "contactspline/tangent/network_backwards.hpp"
#include "contactspline/tangent/network_gradient.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/network_record.hpp"
#include "contactspline/tangent/network_replay.hpp"
#include "contactspline/tangent/network_tangent.hpp"
#include "contactspline/tangent/place_tangent.hpp"
#include "contactspline/tangent/shapes_history.hpp"
#include "contactspline/tangent/stretching_adjoints.hpp"
#include "contactspline/tangent/stretching_backwards.hpp"
#include "contactspline/tangent/stretching_body_tangent.hpp"
#include "contactspline/tangent/stretching_gradient.hpp"
#include "contactspline/tangent/stretching_record.hpp"
#include "contactspline/tangent/stretching_tangent.hpp"
#include "contactspline/tangent/strike_gradient.hpp"
#include "contactspline/tangent/strike_tangent.hpp"

namespace contactspline {

using String = resonators::string_c4;
using Felt = materials::felt_c4;

#define CONTACTSPLINE_EVERY_TEMPLATE(T)                                                                         \
  template struct ContactControls<T>;                                                                           \
  template struct Segment<T>;                                                                                   \
  template class ContactMemory<T>;                                                                              \
  template struct Dual<T, 3>;                                                                                   \
  template struct detail::MemoryDesign<Dual<T, 3>>;                                                             \
  template class detail::RememberedForces<Dual<T, 3>>;                                                          \
  template class detail::ContactPath<T>;                                                                        \
  template struct detail::ContactSlopes<T>;                                                                     \
  template class detail::ContactBackwards<T>;                                                                   \
  template class detail::ForceEquations<T>;                                                                     \
  template class detail::NetworkBackwards<T>;                                                                   \
  template struct detail::NetworkModes<T>;                                                                      \
  template struct detail::NetworkRecord<T>;                                                                     \
  template class detail::StrikeBackwards<T>;                                                                    \
  template class ContactTangent<T, 3>;                                                                          \
  template class MassBarrierTangent<T, 3>;                                                                      \
  template class NetworkTangent<T, 3>;                                                                          \
  template class StretchingTangent<T, 3>;                                                                       \
  template class detail::StretchingBackwards<T>;                                                                \
  template class RecordedStretching<T>;                                                                         \
  template class RecordedNetwork<T>;                                                                            \
  template class StrikeTangent<T, 3>;                                                                           \
  template T derivative(const NetworkNumbers<T>&, const NetworkNumbers<T>&);                                    \
  template T derivative(const StrikeNumbers<T>&, const StrikeNumbers<T>&);                                      \
  template class detail::TableLessLine<T>;                                                                      \
  template class detail::ContactTableStorage<T>;                                                                \
  template class detail::StrikeConstantsStorage<T>;                                                             \
  template double detail::tension_energy(const StiffString&, std::span<const StringMode>, const ModalBank<T>&); \
  template class detail::ColumnMatrix<T>;                                                                       \
  template class detail::ContactGroup<T>;                                                                       \
  template class detail::LinearSystem<T>;                                                                       \
  template class detail::SlopeSquare<T>;                                                                        \
  template class detail::BridgeLoad<T>;                                                                         \
  template class detail::KeyboardSound<T>;                                                                      \
  template class detail::KeysOnBridge<T>;                                                                       \
  template struct detail::InstrumentParts<T>;                                                                   \
  template class detail::NetworkReceptances<T>;                                                                 \
  template struct detail::NetworkParts<T>;                                                                      \
  template class detail::NetworkPickups<T>;                                                                     \
  template class detail::NetworkPressure<T>;                                                                    \
  template class detail::NetworkStrikes<T>;                                                                     \
  template class detail::FollowingControls<T>;                                                                  \
  template class detail::SleepingContacts<T>;                                                                   \
  template class detail::NewtonSolver<T>;                                                                       \
  template class detail::SampleLaw<T>;                                                                          \
  template class detail::FormMatrix<T>;                                                                         \
  template class detail::SpringElimination<T>;                                                                  \
  template class detail::StretchForms<T>;                                                                       \
  template class detail::StretchingForm<T>;                                                                     \
  template class detail::TwoStepMotion<T>;                                                                      \
  template class detail::TwoSteps<T>;                                                                           \
  template class StretchingBank<T>;                                                                             \
  template class AnyInstrument<T>;                                                                              \
  template class InstrumentBehind<NetworkInstrument<T>>;                                                        \
  template class Body<T>;                                                                                       \
  template class ContactNetwork<T>;                                                                             \
  template class CoupledContacts<T>;                                                                            \
  template class NetworkPlan<T>;                                                                                \
  template class Ensemble<T>;                                                                                   \
  template class EnsembleInstrument<T>;                                                                         \
  template class EnsembleOf<Felt, String, T>;                                                                   \
  template class Friction<T>;                                                                                   \
  template class FrictionTemperature<T>;                                                                        \
  template class RoughSurface<T>;                                                                               \
  template class FretString<T>;                                                                                 \
  template class HammerString<T>;                                                                               \
  template class InstrumentDsp<HammerStringOf<Felt, String, T>>;                                                \
  template class InstrumentDsp<MassBarrierOf<Felt, T>>;                                                         \
  template class Hosted<T>;                                                                                     \
  template class HalfBand<T>;                                                                                   \
  template class Decimator<T>;                                                                                  \
  template class Oversampled<T>;                                                                                \
  template class Replaceable<T>;                                                                                \
  template class Sleeper<T>;                                                                                    \
  template class HandleDsp<T>;                                                                                  \
  template class PedaledKeyboard<T>;                                                                            \
  template class HammerVoice<T>;                                                                                \
  template class HighPass<T>;                                                                                   \
  template class KeyboardInstrument<keyboards::piano, T>;                                                       \
  template class KeyboardOnBody<T>;                                                                             \
  template class LongitudinalModes<T>;                                                                          \
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
  template class Splice<T>;                                                                                     \
  template class StringShapes<T>;

CONTACTSPLINE_EVERY_TEMPLATE(float)
CONTACTSPLINE_EVERY_TEMPLATE(double)

// With sizes that are known at compile time.
template class FretString<float, segments_of<Felt, float>.size(), String::modes>;
#ifndef __clang__  // clang 14 also instantiates members whose constraints do not hold
template class HammerString<float, segments_of<Felt, float>.size(), String::modes>;
#endif
template class MassBarrier<float, segments_of<Felt, float>.size()>;
template class SlideString<float, segments_of<Felt, float>.size(), String::modes>;

template const std::array<Segment<float>, Felt::segments + 1> segments_of<Felt, float>;
template const std::array<Mode, String::modes> modes_in<String>;
template std::vector<Segment<float>> compensated_direction(SegmentTable<float>, float, const CompensatedFor<float>&,
                                                           std::span<const Segment<float>>, float);
template StrikeNumbers<float> strike_gradient(const HammerStrike<float>&, double, std::span<const float>,
                                              std::span<const float>);
template StrikeNumbers<double> strike_gradient(const HammerStrike<double>&, double, std::span<const double>,
                                               std::span<const double>);

}  // namespace contactspline
