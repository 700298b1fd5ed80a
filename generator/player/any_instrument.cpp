// SPDX-License-Identifier: MIT
#include "generator/player/any_instrument.hpp"

#include <stdexcept>
#include <utility>

#include "contactspline/instrument/fret_string_instrument.hpp"
#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/slide_string_instrument.hpp"
#include "contactspline/instrument/voices.hpp"
#include "generator/player/instrument_parts.hpp"

namespace contactspline {
namespace {

/// Arrays that an instrument only looks at.
struct OwnedArrays {
  InstrumentArrays arrays;
};

/// An instrument of a file, with its arrays.
template <Instrument I>
class OfFile : private OwnedArrays, public I {
 public:
  explicit OfFile(InstrumentArrays owned) : OwnedArrays{std::move(owned)}, I(arrays.view()) {}
};

template <std::floating_point T>
std::unique_ptr<AnyInstrument<T>> of_module(const ModelModule& module) {
  if constexpr (std::same_as<T, float>)
    if (module.make_single != nullptr) return module.make_single();
  if constexpr (std::same_as<T, double>)
    if (module.make_double != nullptr) return module.make_double();
  throw std::logic_error("instrument_of: the module computes in the other precision");
}

}  // namespace

template <std::floating_point T>
std::unique_ptr<AnyInstrument<T>> instrument_of(Model model, const Voice& voice, double sample_rate_hz) {
  switch (model) {
    case Model::kHammerString:
      return std::make_unique<InstrumentBehind<HammerStringInstrument<T>>>(
          hammer_string_parts(voice, sample_rate_hz));
    case Model::kSlideString:
      return std::make_unique<InstrumentBehind<SlideStringInstrument<T>>>(
          plucked_string_parts(voice, sample_rate_hz));
    case Model::kFretString:
      return std::make_unique<InstrumentBehind<FretStringInstrument<T>>>(plucked_string_parts(voice, sample_rate_hz));
    case Model::kFile: {
      if (voice.model->module != nullptr) return of_module<T>(*voice.model->module);
      InstrumentArrays arrays = instrument_arrays(*voice.model, sample_rate_hz);
      if (voice.model->keys.ranges.empty())
        return std::make_unique<InstrumentBehind<OfFile<NetworkInstrument<T>>>>(std::move(arrays));
      return std::make_unique<InstrumentBehind<OfFile<Voices<NetworkInstrument<T>>>>>(std::move(arrays));
    }
  }
  throw std::logic_error("instrument_of: no such model");
}

template std::unique_ptr<AnyInstrument<float>> instrument_of(Model, const Voice&, double);
template std::unique_ptr<AnyInstrument<double>> instrument_of(Model, const Voice&, double);

}  // namespace contactspline
