// SPDX-License-Identifier: MIT
// The instruments that the page plays: handles of the engine, and what these do not tell.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/host/engine.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "generated/cello.hpp"
#include "generated/classical_guitar.hpp"
#include "generated/dulcimer.hpp"
#include "generated/felt_c4.hpp"
#include "generated/fret_guitar.hpp"
#include "generated/gong.hpp"
#include "generated/kalimba.hpp"
#include "generated/kit.hpp"
#include "generated/lap_steel.hpp"
#include "generated/marimba.hpp"
#include "generated/piano.hpp"
#include "generated/prepared_piano.hpp"
#include "generated/slap_bass.hpp"
#include "generated/snare.hpp"
#include "generated/steel_guitar.hpp"
#include "generated/tanpura.hpp"
#include "generated/tom.hpp"
#include "generated/trichord_c4.hpp"
#include "generated/violin.hpp"
#include "hosts/wasm/hammer_keys.hpp"
#include "hosts/wasm/packed_instrument.hpp"

namespace contactspline::web {

/// A handle with what the page asks for beside it.
struct PageInstrument {
  Handle<float> handle;
  std::size_t output = 0;                    ///< that sounds, where none is called left_... or right_...
  std::span<const KeyRange> ranges = {};     ///< of the keys of a file
  double velocity = 1;                       ///< of a key that is struck without one
  double (*speed_of)(double) = nullptr;      ///< of a velocity [m/s], where the softest key has a speed, too
  HammerKeys* with_page_material = nullptr;  ///< the same instrument, where it takes the page's material
};

/// The files of data/instruments, in the order of the page's list.
inline constexpr std::array kFiles = {
    instruments::tanpura<float>::data::view,      instruments::classical_guitar<float>::data::view,
    instruments::steel_guitar<float>::data::view, instruments::fret_guitar<float>::data::view,
    instruments::lap_steel<float>::data::view,    instruments::slap_bass<float>::data::view,
    instruments::trichord_c4<float>::data::view,  instruments::prepared_piano<float>::data::view,
    instruments::marimba<float>::data::view,      instruments::kalimba<float>::data::view,
    instruments::dulcimer<float>::data::view,     instruments::snare<float>::data::view,
    instruments::tom<float>::data::view,          instruments::gong<float>::data::view,
    instruments::kit<float>::data::view,          instruments::violin<float>::data::view,
    instruments::cello<float>::data::view};

/// What a file describes; `arrays` owns what `data` views, or is null where that lives for ever.
[[nodiscard]] inline PageInstrument instrument_of(const InstrumentData& data,
                                                  std::shared_ptr<const void> arrays = nullptr) {
  return {.handle = Engine<float>::network(data, std::move(arrays)), .ranges = data.keyed.ranges};
}

/// What packed() has written.
[[nodiscard]] inline PageInstrument instrument_of(const Bytes& bytes) {
  const auto unpacked = std::make_shared<const UnpackedInstrument>(bytes);
  return instrument_of(unpacked->data(), unpacked);
}

/// The instruments of no file, which stand before them in the list. material: as HammerKeys takes it.
inline constexpr std::size_t kModels = 3;
[[nodiscard]] inline PageInstrument model_of(std::size_t number, const Material& material) {
  if (number == 0) {
    auto keys = std::make_unique<InstrumentBehind<HammerKeys>>(material);
    HammerKeys& played = keys->instrument();
    return {.handle = std::move(keys), .with_page_material = &played};
  }
  constexpr double kVelocity = 0.7;
  if (number == 1)
    return {.handle = compiled<KeyboardInstrument<Piano, float>>(),
            .velocity = kVelocity,
            .speed_of = KeyboardInstrument<Piano, float>::speed_of};
  constexpr std::size_t kForce = 1;
  return {.handle = compiled<MassBarrierOf<materials::felt_c4, float>>(), .output = kForce};
}

}  // namespace contactspline::web
