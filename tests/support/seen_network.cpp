// SPDX-License-Identifier: MIT
#include "support/seen_network.hpp"

#include <cmath>
#include <limits>

#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/voices.hpp"

namespace contactspline::testing {
namespace {

template <typename T>
using Behind = InstrumentBehind<NetworkInstrument<T>>;
using BehindVoices = InstrumentBehind<Voices<NetworkInstrument<double>>>;

}  // namespace

template <std::floating_point T>
SeenNetwork<T>::SeenNetwork(const InstrumentData& data, double sample_rate_hz)
    : BySample<T>(handle_of<NetworkInstrument<T>>(data), sample_rate_hz), keyed_(data.keyed) {}

template <std::floating_point T>
const NetworkInstrument<T>& SeenNetwork<T>::instrument() const {
  return static_cast<Behind<T>&>(this->played()).instrument();
}

template <std::floating_point T>
void SeenNetwork<T>::tune(double cents, std::size_t string) {
  static_cast<Behind<T>&>(this->handle()).instrument().tune(cents, string);
}
template <std::floating_point T>
bool SeenNetwork<T>::is_in_double() const {
  return instrument().is_in_double();
}
template <std::floating_point T>
std::span<const T> SeenNetwork<T>::displacements(std::size_t body) const {
  return instrument().network().body(body).displacements();
}
template <std::floating_point T>
T SeenNetwork<T>::velocity(std::size_t body, std::size_t mode) const {
  const ModalBank<T>& bank = instrument().network().body(body);
  ModeShapes<T> one(bank.size());
  one[mode] = 1;
  return bank.velocity(one);
}
template <std::floating_point T>
T SeenNetwork<T>::sound_shape(std::size_t body, std::size_t mode, T shape) const {
  return instrument().network().body(body).sound_shape(mode, shape);
}
template <std::floating_point T>
T SeenNetwork<T>::displacement(std::size_t place) const {
  return instrument().network().displacement(place);
}
template <std::floating_point T>
T SeenNetwork<T>::place_m(std::size_t place) const {
  return instrument().network().place_m(place);
}
template <std::floating_point T>
T SeenNetwork<T>::force(std::size_t connection) const {
  return instrument().network().force(connection);
}
template <std::floating_point T>
T SeenNetwork<T>::slip(std::size_t connection) const {
  return instrument().network().slip(connection);
}

template <std::floating_point T>
int SeenNetwork<T>::steps() const {
  return instrument().network().solver().steps();
}
template <std::floating_point T>
std::size_t SeenNetwork<T>::bounded() const {
  return instrument().network().solver().bounded();
}
template <std::floating_point T>
std::span<const std::size_t> SeenNetwork<T>::active() const {
  return instrument().network().solver().active();
}
template <std::floating_point T>
double SeenNetwork<T>::rounding_j(std::size_t connection) const {
  const auto& solver = instrument().network().solver();
  const double f = std::abs(double(force(connection)));
  return std::numeric_limits<T>::epsilon() * f *
         (std::abs(double(solver[connection].free_increment)) +
          double(solver.receptance(connection, connection)) * f);
}

template class SeenNetwork<float>;
template class SeenNetwork<double>;

SeenVoices::SeenVoices(const InstrumentData& data, double sample_rate_hz)
    : played_(handle_of<Voices<NetworkInstrument<double>>>(data)) {
  played_->prepare(sample_rate_hz);
}
double SeenVoices::energy(std::size_t voice) const {
  return static_cast<BehindVoices&>(*played_).instrument().voice(voice).energy();
}
double SeenVoices::value(std::size_t voice, std::size_t parameter) const {
  return static_cast<BehindVoices&>(*played_).instrument().voice(voice).value(parameter);
}
double SeenVoices::force(std::size_t voice, std::size_t connection) const {
  return static_cast<BehindVoices&>(*played_).instrument().voice(voice).network().force(connection);
}

}  // namespace contactspline::testing
