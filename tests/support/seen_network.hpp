// SPDX-License-Identifier: MIT
// What happens inside an instrument of a file, in numbers that are no outputs. seen_network.cpp compiles the network
// for all tests that look at it.
#pragma once

#include <cstddef>
#include <span>

#include "support/by_sample.hpp"

namespace contactspline {

template <std::floating_point T>
class NetworkInstrument;

}  // namespace contactspline

namespace contactspline::testing {

/// What the file describes, on one voice. Numbers of bodies, modes, places and connections are those of the arrays.
template <std::floating_point T>
class SeenNetwork : public BySample<T> {
 public:
  SeenNetwork(const InstrumentData& data, double sample_rate_hz);

  void tune(double cents, std::size_t string = kAllStrings);
  [[nodiscard]] const KeyedData& keyed() const { return keyed_; }
  /// Is a single-precision instrument computed in double precision?
  [[nodiscard]] bool is_in_double() const;

  [[nodiscard]] std::span<const T> displacements(std::size_t body) const;  ///< of its modes [m]
  [[nodiscard]] T velocity(std::size_t body, std::size_t mode) const;      ///< [m/s]
  /// How much a mode counts in an output that has this shape there.
  [[nodiscard]] T sound_shape(std::size_t body, std::size_t mode, T shape) const;
  [[nodiscard]] T displacement(std::size_t place) const;  ///< [m]
  [[nodiscard]] T place_m(std::size_t place) const;       ///< on its string
  [[nodiscard]] T force(std::size_t connection) const;    ///< over the last sample [N]
  [[nodiscard]] T slip(std::size_t connection) const;     ///< over the last sample [m]

  [[nodiscard]] int steps() const;            ///< of the solver, in the last sample
  [[nodiscard]] std::size_t bounded() const;  ///< samples that took the bounding law
  /// Connections that the solver has computed in the last sample, springs and links included.
  [[nodiscard]] std::span<const std::size_t> active() const;
  /// Energy by which rounding may be wrong at a connection in the last sample: eps |f| (|xf| + xi |f|) [J].
  [[nodiscard]] double rounding_j(std::size_t connection) const;

 private:
  [[nodiscard]] const NetworkInstrument<T>& instrument() const;

  KeyedData keyed_;
};

/// An instrument with keys, prepared, whose voices are seen.
class SeenVoices {
 public:
  SeenVoices(const InstrumentData& data, double sample_rate_hz);

  AnyInstrument<double>* operator->() const { return played_.get(); }
  AnyInstrument<double>& operator*() const { return *played_; }
  [[nodiscard]] double energy(std::size_t voice) const;
  [[nodiscard]] double value(std::size_t voice, std::size_t parameter) const;
  [[nodiscard]] double force(std::size_t voice, std::size_t connection) const;  ///< over the last sample [N]

 private:
  Handle<double> played_;
};

}  // namespace contactspline::testing
