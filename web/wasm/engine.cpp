// SPDX-License-Identifier: MIT
// The instruments that the page plays on its audio thread, in single precision with kernels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "web/wasm/door.hpp"
#include "web/wasm/hammer_keys.hpp"
#include "web/wasm/instruments.hpp"
#include "web/wasm/playable.hpp"

namespace contactspline::web {
namespace {

constexpr std::size_t kBlock = 128;

Material material;
std::unique_ptr<Playable> playing;
std::array<float, 3 * kBlock> outputs;
std::array<double, 5> shown_books;
std::array<std::uint8_t, 3> message;

using Maker = std::function<std::unique_ptr<Playable>()>;

template <typename I, std::size_t sound = 0, typename... Args>
Maker maker(Args&... args) {
  return [&args...] { return std::make_unique<PlayableBehind<I, sound>>(args...); };
}

const std::vector<Maker>& instruments() {
  static const std::vector<Maker> all = [] {
    constexpr std::size_t kBridge = detail::StringOutputs<float>::kBridge, kForce = 1;
    std::vector<Maker> makers = {maker<HammerKeys>(material), maker<KeyboardInstrument<Piano, float>>(),
                                 maker<MassBarrierOf<materials::felt_c4, float>, kForce>(),
                                 maker<SlideGuitar<float>, kBridge>(), maker<FretGuitar<float>, kBridge>()};
    each_instrument_of_a_file([&]<template <typename> typename I>() { makers.push_back(maker<I<float>>()); });
    return makers;
  }();
  return all;
}

std::unique_ptr<Playable> instrument(int number) {
  if (number < 0 || number >= static_cast<int>(instruments().size())) return nullptr;
  return instruments()[static_cast<std::size_t>(number)]();
}

}  // namespace

/// The instruments, as a JSON list (playable.hpp). Their numbers are their places in it.
CONTACTSPLINE_WEB(const char*, engine_instruments) {
  std::vector<std::string> all;
  for (const Maker& make : instruments()) all.push_back(make()->described());
  return keep(fmt::format("[{}]", fmt::join(all, ", ")));
}

/// Makes an instrument, at rest, which the functions below play. 0 if there is none of this number. Allocates.
CONTACTSPLINE_WEB(int, engine_choose, int number, double sample_rate_hz) {
  auto next = instrument(number);
  if (!next) return 0;
  next->prepare(sample_rate_hz);
  playing = std::move(next);
  return 1;
}

/// The largest sample of a note of middle C, which is also the first event, with the first values of all parameters,
/// relative to full scale. It tells how loud an instrument is.
CONTACTSPLINE_WEB(double, engine_peak, int number, double seconds, double sample_rate_hz) {
  const auto played = instrument(number);
  if (!played) return 0;
  played->prepare(sample_rate_hz);
  played->watch_none();
  played->note_on(kMiddleC, played->velocity());
  float peak = 0;
  for (double left = seconds * sample_rate_hz; left > 0; left -= kBlock) {
    played->process(std::span(outputs).first(kBlock), std::span(outputs).subspan(kBlock, kBlock), {});
    for (std::size_t i = 0; i < 2 * kBlock; ++i) peak = std::max(peak, std::abs(outputs[i]));
  }
  return peak;
}

/// Where the page writes the rows of a table: knot, energy, force, half curvature of each segment.
CONTACTSPLINE_WEB(double*, engine_rows) {
  return material.rows.data();
}

/// Takes the rows as the material of all later strikes of the first instrument. 0 if there are too many.
CONTACTSPLINE_WEB(int, engine_use_material, int segments, double mass_kg, double loss_s_per_m) {
  return material.use(segments, mass_kg, loss_s_per_m) ? 1 : 0;
}

CONTACTSPLINE_WEB(void, engine_set, int parameter, double value) {
  playing->set(static_cast<std::size_t>(parameter), value);
}

CONTACTSPLINE_WEB(void, engine_note_on, int key, double velocity) {
  playing->note_on(key, velocity);
}

CONTACTSPLINE_WEB(void, engine_note_off, int key) {
  playing->note_off(key);
}

/// Three bytes of MIDI.
CONTACTSPLINE_WEB(void, engine_midi, int status, int first, int second) {
  message = {static_cast<std::uint8_t>(status), static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(second)};
  playing->midi(message);
}

CONTACTSPLINE_WEB(void, engine_watch_none) {
  playing->watch_none();
}

/// Plays up to 128 samples. Returns left, right and the contact force, 128 samples each.
CONTACTSPLINE_WEB(const float*, engine_process, int samples) {
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(samples, 0)), 0, kBlock);
  const std::span<float> all = outputs;
  playing->process(all.first(count), all.subspan(kBlock, count), all.subspan(2 * kBlock, count));
  return outputs.data();
}

/// The books of the last strike: hammer, felt, string, dissipated, work [J]. Null where none are kept.
CONTACTSPLINE_WEB(const double*, engine_books) {
  const Books* const books = playing->books();
  if (books == nullptr) return nullptr;
  shown_books = {books->hammer, books->felt, books->string, books->dissipated, books->work};
  return shown_books.data();
}

}  // namespace contactspline::web
