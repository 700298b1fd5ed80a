// SPDX-License-Identifier: MIT
#include "contactspline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "contactspline/step/controls.hpp"
#include "contactspline/step/flush_denormals.hpp"
#include "contactspline/step/version.hpp"
#include "generator/support/error.hpp"
#include "generator/support/sample_rates.hpp"
#include "hosts/named_instruments.hpp"

using namespace contactspline;

namespace {

constexpr std::size_t kBlock = 256;  // samples

thread_local std::string last_error;

template <typename T>
using Played = std::unique_ptr<AnyInstrument<T>>;

/// What a block needs beside the caller's arrays.
template <typename T>
struct Blocks {
  explicit Blocks(std::size_t outputs) : scratch(outputs), spans(outputs) {}
  std::vector<std::array<T, kBlock>> scratch;
  std::vector<std::span<T>> spans;
  std::array<T, kBlock> force{};
};

/// An instrument of one precision with its blocks.
template <typename T>
struct Player {
  explicit Player(Played<T> played) : instrument(std::move(played)), blocks(instrument->outputs().size()) {}
  Played<T> instrument;
  Blocks<T> blocks;
};

std::vector<contactspline_parameter> listed(std::span<const Parameter> parameters) {
  std::vector<contactspline_parameter> list;
  for (const Parameter& p : parameters)
    list.push_back({p.name, p.unit, p.allowed.min, p.allowed.max, p.slider.min, p.slider.max, p.initial,
                    p.scale == Scale::kLogarithmic, p.acts == Acts::kAtNextNote, p.glide_s});
  return list;
}

std::vector<contactspline_output> listed(std::span<const Output> outputs) {
  std::vector<contactspline_output> list;
  for (const Output& o : outputs) list.push_back({o.name, o.unit, o.full_scale});
  return list;
}

std::vector<contactspline_event> listed(std::span<const Event> events) {
  std::vector<contactspline_event> list;
  for (const Event& e : events)
    list.push_back(
        {e.name, e.kind == EventKind::kStrike ? CONTACTSPLINE_STRIKE : CONTACTSPLINE_PLUCK, e.number, e.parameter});
  return list;
}

template <typename Row>
const Row* row_of(const std::vector<Row>& list, std::size_t index) {
  return index < list.size() ? &list[index] : nullptr;
}

}  // namespace

struct contactspline_instrument {
  template <typename T>
  explicit contactspline_instrument(Played<T> played)
      : parameters(listed(played->parameters())),
        outputs(listed(played->outputs())),
        events(listed(played->events())),
        player(std::in_place_type<Player<T>>, std::move(played)) {}

  [[nodiscard]] bool has(int kind, std::size_t number) const {
    return std::ranges::any_of(events, [&](const auto& e) { return e.kind == kind && e.number == number; });
  }

  std::vector<contactspline_parameter> parameters;
  std::vector<contactspline_output> outputs;
  std::vector<contactspline_event> events;
  std::variant<Player<double>, Player<float>> player;
};

namespace {

// Calls f with the instrument of either precision; gives a value of its own for a null instrument.
template <typename Handle, typename F, typename R>
R with(Handle* handle, R otherwise, F&& f) {
  if (handle == nullptr) return otherwise;
  return std::visit([&](auto& player) -> R { return f(*player.instrument); }, handle->player);
}

template <typename F>
void with(contactspline_instrument* handle, F&& f) {
  if (handle != nullptr) std::visit([&](auto& player) { f(*player.instrument); }, handle->player);
}

template <typename T>
std::unique_ptr<AnyInstrument<T>> prepared(const InstrumentMaker& maker, double sample_rate_hz) {
  auto instrument = maker.make<T>(sample_rate_hz);
  instrument->prepare(sample_rate_hz);
  return instrument;
}

// Runs a function that makes an instrument; what it throws becomes the last error.
template <typename F>
contactspline_instrument* made(double sample_rate_hz, int precision, F&& make) noexcept {
  try {
    if (!(sample_rate_hz >= kSampleRates_hz.min && sample_rate_hz <= kSampleRates_hz.max))
      throw BadInput(
          fmt::format("contactspline: sample_rate_hz: {:.6g} is out of range; allowed: {} to {}, such as 48000",
                      sample_rate_hz, kSampleRates_hz.min, kSampleRates_hz.max));
    if (precision == CONTACTSPLINE_DOUBLE) return new contactspline_instrument(make.template operator()<double>());
    if (precision == CONTACTSPLINE_FLOAT) return new contactspline_instrument(make.template operator()<float>());
    throw BadInput(fmt::format("contactspline: precision: {} is unknown; allowed: {} for double, {} for float",
                               precision, int{CONTACTSPLINE_DOUBLE}, int{CONTACTSPLINE_FLOAT}));
  } catch (const std::bad_alloc&) {
    last_error.clear();
    last_error = "no memory";  // short: it is kept without an allocation
  } catch (const std::exception& error) {
    try {
      last_error = error.what();
    } catch (const std::bad_alloc&) {
      last_error = "no memory";
    }
  }
  return nullptr;
}

void require_text(const char* text, const char* argument) {
  if (text == nullptr) throw BadInput(fmt::format("contactspline: {}: is null; allowed: text", argument));
}

// Does anybody want what the instrument plays?
template <typename Sample>
bool is_wanted(Sample* const* outputs, const Sample* force, std::size_t count) {
  if (force != nullptr) return true;
  return outputs != nullptr && std::any_of(outputs, outputs + count, [](const Sample* output) { return output; });
}

// Advances a part of a block. Arrays of the instrument's own precision are written directly; otherwise the part has
// at most kBlock samples.
template <typename T, typename Sample>
void process_part(Player<T>& player, Sample* const* outputs, Sample* force, std::size_t begin, std::size_t samples) {
  auto& [instrument, blocks] = player;
  const auto block = [&](Sample* wanted, std::array<T, kBlock>& scratch) -> std::span<T> {
    if (wanted == nullptr) return {};
    if constexpr (std::is_same_v<T, Sample>)
      return {wanted + begin, samples};
    else
      return std::span(scratch).first(samples);
  };
  const auto hand_over = [&](Sample* wanted, std::span<const T> part) {
    if constexpr (!std::is_same_v<T, Sample>)
      std::ranges::transform(part, wanted + begin, [](T sample) { return static_cast<Sample>(sample); });
  };
  for (std::size_t o = 0; o < blocks.spans.size(); ++o)
    blocks.spans[o] = block(outputs != nullptr ? outputs[o] : nullptr, blocks.scratch[o]);
  // Something has the length of the block where nobody wants anything.
  const std::span<T> force_block = is_wanted(outputs, force, blocks.spans.size())
                                       ? block(force, blocks.force)
                                       : std::span(blocks.force).first(samples);
  instrument->process(blocks.spans, force_block);
  for (std::size_t o = 0; o < blocks.spans.size(); ++o)
    if (!blocks.spans[o].empty()) hand_over(outputs[o], blocks.spans[o]);
  if (force != nullptr) hand_over(force, force_block);
}

template <typename Sample>
void process(contactspline_instrument* handle, Sample* const* outputs, Sample* force, std::size_t samples) {
  if (handle == nullptr) return;
  const FlushDenormals flushed;
  std::visit(
      [&]<typename T>(Player<T>& player) {
        const bool is_direct = std::is_same_v<T, Sample> && is_wanted(outputs, force, player.blocks.spans.size());
        const std::size_t part = is_direct ? samples : kBlock;
        for (std::size_t begin = 0; begin < samples; begin += part)
          process_part(player, outputs, force, begin, std::min(part, samples - begin));
      },
      handle->player);
}

}  // namespace

extern "C" {

const char* contactspline_version() {
  static const std::string version = fmt::format("{}.{}.{}", kVersionMajor, kVersionMinor, kVersionPatch);
  return version.c_str();
}

const char* contactspline_last_error() {
  return last_error.c_str();
}

const char* const* contactspline_names() {
  static const std::vector<std::string> names = instrument_names();
  static const std::vector<const char*> list = [] {
    std::vector<const char*> pointers;
    for (const std::string& name : names) pointers.push_back(name.c_str());
    pointers.push_back(nullptr);
    return pointers;
  }();
  return list.data();
}

contactspline_instrument* contactspline_create(const char* name, double sample_rate_hz, int precision) {
  return made(sample_rate_hz, precision, [&]<typename T>() {
    require_text(name, "name");
    return prepared<T>(maker_of_name(name), sample_rate_hz);
  });
}

contactspline_instrument* contactspline_create_from_json(const char* text, const char* file, double sample_rate_hz,
                                                         int precision) {
  return made(sample_rate_hz, precision, [&]<typename T>() {
    require_text(text, "text");
    require_text(file, "file");
    return prepared<T>(maker_of_text(text, file), sample_rate_hz);
  });
}

void contactspline_destroy(contactspline_instrument* instrument) {
  delete instrument;
}

const char* contactspline_name(const contactspline_instrument* instrument) {
  return with(instrument, static_cast<const char*>(nullptr), [](const auto& i) { return i.name(); });
}
const char* contactspline_description(const contactspline_instrument* instrument) {
  return with(instrument, static_cast<const char*>(nullptr), [](const auto& i) { return i.description(); });
}
const char* contactspline_license(const contactspline_instrument* instrument) {
  return with(instrument, static_cast<const char*>(nullptr), [](const auto& i) { return i.license(); });
}

std::size_t contactspline_parameter_count(const contactspline_instrument* instrument) {
  return instrument != nullptr ? instrument->parameters.size() : 0;
}
const contactspline_parameter* contactspline_parameter_at(const contactspline_instrument* instrument,
                                                          std::size_t index) {
  return instrument != nullptr ? row_of(instrument->parameters, index) : nullptr;
}
std::size_t contactspline_output_count(const contactspline_instrument* instrument) {
  return instrument != nullptr ? instrument->outputs.size() : 0;
}
const contactspline_output* contactspline_output_at(const contactspline_instrument* instrument, std::size_t index) {
  return instrument != nullptr ? row_of(instrument->outputs, index) : nullptr;
}
std::size_t contactspline_event_count(const contactspline_instrument* instrument) {
  return instrument != nullptr ? instrument->events.size() : 0;
}
const contactspline_event* contactspline_event_at(const contactspline_instrument* instrument, std::size_t index) {
  return instrument != nullptr ? row_of(instrument->events, index) : nullptr;
}
std::size_t contactspline_preset_count(const contactspline_instrument* instrument) {
  return with(instrument, std::size_t{0}, [](const auto& i) { return i.presets().size(); });
}
const char* contactspline_preset_name(const contactspline_instrument* instrument, std::size_t index) {
  return with(instrument, static_cast<const char*>(nullptr),
              [&](const auto& i) { return index < i.presets().size() ? i.presets()[index].name : nullptr; });
}

void contactspline_set(contactspline_instrument* instrument, std::size_t parameter, double value) {
  with(instrument, [&](auto& i) {
    if (parameter < i.parameters().size() && is_number(value)) i.set(parameter, value);
  });
}
double contactspline_get(const contactspline_instrument* instrument, std::size_t parameter) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return with(instrument, kNone,
              [&](const auto& i) { return parameter < i.parameters().size() ? i.value(parameter) : kNone; });
}
void contactspline_load_preset(contactspline_instrument* instrument, std::size_t preset) {
  with(instrument, [&](auto& i) {
    if (preset >= i.presets().size()) return;
    const auto& values = i.presets()[preset].values;
    for (std::size_t p = 0; p < values.size(); ++p) i.set(p, values[p]);
  });
}

void contactspline_note_on(contactspline_instrument* instrument, int key, double velocity) {
  with(instrument, [&](auto& i) {
    if (is_number(velocity)) i.note_on(key, velocity);
  });
}
void contactspline_note_off(contactspline_instrument* instrument, int key) {
  with(instrument, [&](auto& i) { i.note_off(key); });
}
void contactspline_strike(contactspline_instrument* instrument, std::size_t number, double speed_m_per_s) {
  if (instrument == nullptr || !instrument->has(CONTACTSPLINE_STRIKE, number) || !is_number(speed_m_per_s)) return;
  std::visit([&]<typename T>(Player<T>& player) { player.instrument->strike(number, static_cast<T>(speed_m_per_s)); },
             instrument->player);
}
void contactspline_release(contactspline_instrument* instrument, std::size_t number) {
  if (instrument == nullptr || !instrument->has(CONTACTSPLINE_STRIKE, number)) return;
  with(instrument, [&](auto& i) { i.release(number); });
}
void contactspline_pluck(contactspline_instrument* instrument, std::size_t number, double force_n, double rise_s) {
  if (instrument == nullptr || !instrument->has(CONTACTSPLINE_PLUCK, number)) return;
  if (!is_number(force_n) || !is_number(rise_s)) return;
  std::visit(
      [&]<typename T>(Player<T>& player) { player.instrument->pluck(number, static_cast<T>(force_n), rise_s); },
      instrument->player);
}

void contactspline_process(contactspline_instrument* instrument, float* const* outputs, float* force,
                           std::size_t samples) {
  process(instrument, outputs, force, samples);
}
void contactspline_process_double(contactspline_instrument* instrument, double* const* outputs, double* force,
                                  std::size_t samples) {
  process(instrument, outputs, force, samples);
}

void contactspline_reset(contactspline_instrument* instrument) {
  with(instrument, [](auto& i) { i.reset(); });
}
double contactspline_energy(const contactspline_instrument* instrument) {
  return with(instrument, 0.0, [](const auto& i) { return i.energy(); });
}
int contactspline_is_silent(const contactspline_instrument* instrument, double limit_j) {
  return with(instrument, 1, [&](const auto& i) { return int{i.is_silent(limit_j)}; });
}

}  // extern "C"
