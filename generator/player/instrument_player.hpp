// SPDX-License-Identifier: MIT
// Plays an instrument that a file describes.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <span>

#include "contactspline/instrument.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

/// Plays one voice of a score for an instrument file, which must outlive it. Throws BadInput where a body has no mode
/// below half the sample rate.
template <typename T>
class InstrumentPlayer {
 public:
  InstrumentPlayer(const Voice& voice, double sample_rate_hz)
      : strikes_(voice.strikes, sample_rate_hz),
        arrays_(sounding(*voice.model, sample_rate_hz)),
        instrument_(arrays_.view(), sample_rate_hz) {}

  /// Plays the next sample. values: one for each control of the instrument.
  void tick(std::span<const double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) instrument_.set_control(i, static_cast<T>(values[i]));
    while (const auto* change = strikes_.next_until(sample_))
      instrument_.strike(change->strike->strike, static_cast<T>(change->strike->speed_m_per_s));
    instrument_.tick();
    ++sample_;
  }

  [[nodiscard]] const NetworkInstrument<T>& instrument() const { return instrument_; }

 private:
  static InstrumentArrays sounding(const InstrumentModel& model, double sample_rate_hz) {
    if (const auto body = silent_body(model, sample_rate_hz / 2))
      throw BadInput(
          fmt::format("--rate: no mode of {} lies below {} Hz; allowed: a higher rate", *body, sample_rate_hz / 2));
    return arrays_of(model, sample_rate_hz / 2);
  }

  StrikeTrack strikes_;
  InstrumentArrays arrays_;
  NetworkInstrument<T> instrument_;
  std::size_t sample_ = 0;
};

}  // namespace contactspline
