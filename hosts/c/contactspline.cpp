// SPDX-License-Identifier: MIT
#include "contactspline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "contactspline/data/timed_event.hpp"
#include "contactspline/host/any_instrument.hpp"
#include "contactspline/host/model_module.hpp"
#include "contactspline/host/oversampled.hpp"
#include "contactspline/host/replaceable.hpp"
#include "contactspline/host/sleeper.hpp"
#include "contactspline/host/tuned_keys.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/flush_denormals.hpp"
#include "contactspline/step/version.hpp"
#include "generator/player/tuning.hpp"
#include "generator/support/error.hpp"
#include "generator/support/sample_rates.hpp"
#include "hosts/named_instruments.hpp"

using namespace contactspline;

namespace {

constexpr std::size_t kBlock = 256;  // samples

thread_local std::string last_error;

/// What a block needs beside the caller's arrays.
template <typename T>
struct Blocks {
  explicit Blocks(std::size_t outputs) : scratch(outputs), spans(outputs) {}
  std::vector<std::array<T, kBlock>> scratch;
  std::vector<std::span<T>> spans;
  std::array<T, kBlock> force{}, input{};
};

/// An instrument of one precision with its blocks.
template <typename T>
struct Player {
  explicit Player(std::unique_ptr<Replaceable<T>> handle)
      : replaceable(*handle), sleeper(std::move(handle)), blocks(instrument().outputs().size()) {}
  [[nodiscard]] const AnyInstrument<T>& instrument() const { return sleeper.instrument(); }
  Replaceable<T>& replaceable;  // which the sleeper owns
  Sleeper<T> sleeper;
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
  for (const Event& e : events) list.push_back({e.name, static_cast<int>(action_of(e.kind)), e.number, e.parameter});
  return list;
}

template <typename Row>
const Row* row_of(const std::vector<Row>& list, std::size_t index) {
  return index < list.size() ? &list[index] : nullptr;
}

}  // namespace

struct contactspline_instrument {
  template <typename T>
  contactspline_instrument(std::unique_ptr<Replaceable<T>> handle, InstrumentMaker makes, double rate_hz)
      : parameters(listed(handle->parameters())),
        outputs(listed(handle->outputs())),
        events(listed(handle->events())),
        player(std::in_place_type<Player<T>>, std::move(handle)),
        maker(std::move(makes)),
        sample_rate_hz(rate_hz) {}

  [[nodiscard]] bool has(int action, std::size_t number) const {
    return std::ranges::any_of(events, [&](const auto& e) { return e.action == action && e.number == number; });
  }

  // Is there what an event plays, and is its value a number?
  [[nodiscard]] bool can_play(const contactspline_timed_event& event) const {
    if (!is_number(event.value)) return false;
    switch (event.action) {
      case CONTACTSPLINE_STRIKE:
      case CONTACTSPLINE_RELEASE:
        return has(CONTACTSPLINE_STRIKE, event.number);
      case CONTACTSPLINE_PLUCK:
        return has(CONTACTSPLINE_PLUCK, event.number) && is_number(event.rise_s);
      case CONTACTSPLINE_BOW:
        return has(CONTACTSPLINE_BOW, event.number);
      case CONTACTSPLINE_SET:
        return event.number < parameters.size();
      default:
        return event.action >= CONTACTSPLINE_NOTE_ON && event.action <= CONTACTSPLINE_PLACE_KEY && event.number < 128;
    }
  }

  void play(const contactspline_timed_event& event) {
    if (!can_play(event)) return;
    const TimedEvent played{0, Action{event.action}, event.number, event.value, event.rise_s};
    std::visit([&](auto& of) { tuned_keys.take(played, [&](const TimedEvent& of_key) { of.sleeper.play(of_key); }); },
               player);
  }

  std::vector<contactspline_parameter> parameters;
  std::vector<contactspline_output> outputs;
  std::vector<contactspline_event> events;
  std::variant<Player<double>, Player<float>> player;
  TunedKeys tuned_keys = {};
  InstrumentMaker maker;
  double sample_rate_hz;
  std::atomic<std::size_t> latency = 0;
};

namespace {

// What f gives for the instrument of either precision; a value of its own for a null instrument.
template <typename F, typename R>
R with(const contactspline_instrument* handle, R otherwise, F&& f) {
  if (handle == nullptr) return otherwise;
  return std::visit([&](const auto& player) -> R { return f(player.instrument()); }, handle->player);
}

// Does what an event says, now.
void play(contactspline_instrument* handle, int action, std::size_t number, double value = 0, double rise_s = 0) {
  if (handle != nullptr) handle->play({0, action, number, value, rise_s});
}

// The number of a key. No instrument has that of a negative one.
std::size_t number_of(int key) {
  return static_cast<std::size_t>(key);
}

template <typename T>
std::unique_ptr<Replaceable<T>> prepared(const InstrumentMaker& maker, double sample_rate_hz) {
  auto instrument = std::make_unique<Replaceable<T>>(maker.make<T>(sample_rate_hz));
  instrument->prepare(sample_rate_hz);
  return instrument;
}

// The same at a multiple of the rate.
template <typename T>
std::unique_ptr<Oversampled<T>> oversampled(const contactspline_instrument& like, int factor) {
  auto made = std::make_unique<Oversampled<T>>(like.maker.make<T>(factor * like.sample_rate_hz), factor);
  made->prepare(like.sample_rate_hz);
  return made;
}

// What a function gives; what it throws becomes the last error, and gives the value of failures.
template <typename F>
auto tried(F&& make) noexcept -> decltype(make()) {
  try {
    return make();
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
  return {};
}

// Runs a function that makes an instrument.
template <typename F>
contactspline_instrument* made(double sample_rate_hz, int precision, F&& make) noexcept {
  return tried([&] {
    if (!(sample_rate_hz >= kSampleRates_hz.min && sample_rate_hz <= kSampleRates_hz.max))
      throw BadInput(
          fmt::format("contactspline: sample_rate_hz: {:.6g} is out of range; allowed: {} to {}, such as 48000",
                      sample_rate_hz, kSampleRates_hz.min, kSampleRates_hz.max));
    if (precision != CONTACTSPLINE_DOUBLE && precision != CONTACTSPLINE_FLOAT)
      throw BadInput(fmt::format("contactspline: precision: {} is unknown; allowed: {} for double, {} for float",
                                 precision, int{CONTACTSPLINE_DOUBLE}, int{CONTACTSPLINE_FLOAT}));
    const InstrumentMaker maker = make();
    if (precision == CONTACTSPLINE_DOUBLE)
      return new contactspline_instrument(prepared<double>(maker, sample_rate_hz), maker, sample_rate_hz);
    return new contactspline_instrument(prepared<float>(maker, sample_rate_hz), maker, sample_rate_hz);
  });
}

void require_text(const char* text, const char* argument) {
  if (text == nullptr) throw BadInput(fmt::format("contactspline: {}: is null; allowed: text", argument));
}

// Advances a part of a block. Arrays of the instrument's own precision are written directly; otherwise, or with an
// input, the part has at most kBlock samples. The input is read before anything is written.
template <typename T, typename Sample>
void process_part(Player<T>& player, const Sample* input, Sample* const* outputs, Sample* force, std::size_t begin,
                  std::size_t samples) {
  Blocks<T>& blocks = player.blocks;
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
  const std::span<T> force_block = block(force, blocks.force);
  std::span<const T> push;
  if (input != nullptr) {
    std::transform(input + begin, input + begin + samples, blocks.input.begin(),
                   [](Sample sample) { return static_cast<T>(sample); });
    push = std::span(blocks.input).first(samples);
  }
  player.sleeper.process(blocks.spans, force_block, samples, push);
  for (std::size_t o = 0; o < blocks.spans.size(); ++o)
    if (!blocks.spans[o].empty()) hand_over(outputs[o], blocks.spans[o]);
  if (force != nullptr) hand_over(force, force_block);
}

// Advances from one sample of a block to another.
template <typename Sample>
void advance(contactspline_instrument& handle, const Sample* input, Sample* const* outputs, Sample* force,
             std::size_t begin, std::size_t end) {
  std::visit(
      [&]<typename T>(Player<T>& player) {
        const std::size_t part = std::is_same_v<T, Sample> && input == nullptr ? end - begin : kBlock;
        for (; begin < end; begin += part)
          process_part(player, input, outputs, force, begin, std::min(part, end - begin));
      },
      handle.player);
}

template <typename Sample>
void process(contactspline_instrument* handle, std::span<const contactspline_timed_event> events, const Sample* input,
             Sample* const* outputs, Sample* force, std::size_t samples) {
  if (handle == nullptr) return;
  const FlushDenormals flushed;
  std::size_t done = 0;
  for (const contactspline_timed_event& event : events) {
    const std::size_t next = std::clamp(event.sample, done, samples);
    advance(*handle, input, outputs, force, done, next);
    handle->play(event);
    done = next;
  }
  advance(*handle, input, outputs, force, done, samples);
}

// Events of C; none where the array is null.
std::span<const contactspline_timed_event> events_in(const contactspline_timed_event* events, std::size_t count) {
  return {events, events != nullptr ? count : 0};
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
  return made(sample_rate_hz, precision, [&] {
    require_text(name, "name");
    return maker_of_name(name);
  });
}

contactspline_instrument* contactspline_create_from_json(const char* text, const char* file, double sample_rate_hz,
                                                         int precision) {
  return made(sample_rate_hz, precision, [&] {
    require_text(text, "text");
    require_text(file, "file");
    return maker_of_text(text, file);
  });
}

// For plug-ins, in C++: GetHandle in model_module.hpp.
void* contactspline_handle(const char* text, const char* file, double sample_rate_hz, int precision,
                           const ModelModule& caller) {
  return tried([&]() -> void* {
    const ModelModule own;
    if (!std::ranges::equal(own.version, caller.version) || own.layout != caller.layout ||
        std::string_view(own.compiler) != caller.compiler)
      throw BadInput(
          fmt::format("contactspline: libcontactspline {} by {} is of another build; allowed: {}.{}.{} by {}",
                      contactspline_version(), own.compiler, caller.version[0], caller.version[1], caller.version[2],
                      caller.compiler));
    const InstrumentMaker maker = maker_of_text(text, file);
    if (precision == CONTACTSPLINE_DOUBLE) return maker.make<double>(sample_rate_hz).release();
    return maker.make<float>(sample_rate_hz).release();
  });
}

int contactspline_oversample(contactspline_instrument* instrument, int factor) {
  if (instrument == nullptr) return 0;
  return tried([&] {
    if (std::ranges::find(kOversamplings, factor) == std::end(kOversamplings))
      throw BadInput(fmt::format("contactspline: factor: {} is unknown; allowed: 1, 2, 4, 8", factor));
    if (!(factor * instrument->sample_rate_hz <= kSampleRates_hz.max))
      throw BadInput(fmt::format("contactspline: factor: {} times {:.6g} Hz is out of range; allowed: up to {} Hz",
                                 factor, instrument->sample_rate_hz, kSampleRates_hz.max));
    std::visit(
        [&]<typename T>(Player<T>& player) {
          auto handle = oversampled<T>(*instrument, factor);
          instrument->latency = handle->latency();
          player.replaceable.offer(std::move(handle));
        },
        instrument->player);
    return 1;
  });
}
int contactspline_replace(contactspline_instrument* instrument, contactspline_instrument* other) {
  if (instrument == nullptr) return 0;
  return tried([&] {
    if (other == nullptr || other == instrument)
      throw BadInput(fmt::format("contactspline: other: is {}; allowed: an instrument",
                                 other == nullptr ? "null" : "the instrument itself"));
    if (other->sample_rate_hz != instrument->sample_rate_hz || other->player.index() != instrument->player.index())
      throw BadInput(fmt::format("contactspline: other: differs in rate or precision; allowed: {:.6g} Hz, in {}",
                                 instrument->sample_rate_hz, instrument->player.index() == 0 ? "double" : "float"));
    std::visit(
        [&]<typename T>(Player<T>& player) {
          player.replaceable.offer(std::get<Player<T>>(other->player).sleeper.release());
        },
        instrument->player);
    instrument->maker = std::move(other->maker);
    instrument->latency = other->latency.load();
    delete other;
    return 1;
  });
}
std::size_t contactspline_latency(const contactspline_instrument* instrument) {
  return instrument == nullptr ? 0 : instrument->latency.load();
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
  play(instrument, CONTACTSPLINE_SET, parameter, value);
}
double contactspline_get(const contactspline_instrument* instrument, std::size_t parameter) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return with(instrument, kNone,
              [&](const auto& i) { return parameter < i.parameters().size() ? i.value(parameter) : kNone; });
}
void contactspline_load_preset(contactspline_instrument* instrument, std::size_t preset) {
  const auto* const loaded = with(instrument, static_cast<const Preset*>(nullptr), [&](const auto& i) {
    return preset < i.presets().size() ? &i.presets()[preset] : nullptr;
  });
  for (std::size_t p = 0; loaded != nullptr && p < loaded->values.size(); ++p)
    play(instrument, CONTACTSPLINE_SET, p, loaded->values[p]);
}

void contactspline_note_on(contactspline_instrument* instrument, int key, double velocity) {
  play(instrument, CONTACTSPLINE_NOTE_ON, number_of(key), velocity);
}
void contactspline_note_off(contactspline_instrument* instrument, int key) {
  play(instrument, CONTACTSPLINE_NOTE_OFF, number_of(key));
}
int contactspline_read_tuning(const char* scale, const char* keymap, double a4_hz, double* cents) {
  return tried([&] {
    if (cents == nullptr) throw BadInput("contactspline: cents: is null; allowed: an array of 128 numbers");
    const auto text = [](const char* of, const char* name) {
      return of == nullptr ? std::nullopt : std::optional(TuningText{of, name});
    };
    Tuning tuning{text(scale, "scale"), text(keymap, "keymap")};
    if (a4_hz != 0) tuning.a4_hz = a4_hz;
    std::ranges::copy(key_cents(tuning), cents);
    return 1;
  });
}
int contactspline_tune(contactspline_instrument* instrument, const double* cents) {
  if (instrument == nullptr) return 0;
  const MidiSettings settings =
      std::visit([](const auto& player) { return midi_settings(player.instrument()); }, instrument->player);
  if (!std::isfinite(settings.max_cents)) return 0;
  KeyCents table{};
  if (cents != nullptr) std::copy_n(cents, table.size(), table.begin());
  instrument->tuned_keys.tune(tuned(settings, table));
  return 1;
}
void contactspline_strike(contactspline_instrument* instrument, std::size_t number, double speed_m_per_s) {
  play(instrument, CONTACTSPLINE_STRIKE, number, speed_m_per_s);
}
void contactspline_release(contactspline_instrument* instrument, std::size_t number) {
  play(instrument, CONTACTSPLINE_RELEASE, number);
}
void contactspline_pluck(contactspline_instrument* instrument, std::size_t number, double force_n, double rise_s) {
  play(instrument, CONTACTSPLINE_PLUCK, number, force_n, rise_s);
}
void contactspline_play(contactspline_instrument* instrument, const contactspline_timed_event* event) {
  if (instrument != nullptr && event != nullptr) instrument->play(*event);
}

void contactspline_process(contactspline_instrument* instrument, float* const* outputs, float* force,
                           std::size_t samples) {
  process<float>(instrument, {}, nullptr, outputs, force, samples);
}
void contactspline_process_double(contactspline_instrument* instrument, double* const* outputs, double* force,
                                  std::size_t samples) {
  process<double>(instrument, {}, nullptr, outputs, force, samples);
}
void contactspline_process_events(contactspline_instrument* instrument, const contactspline_timed_event* events,
                                  std::size_t count, float* const* outputs, float* force, std::size_t samples) {
  process<float>(instrument, events_in(events, count), nullptr, outputs, force, samples);
}
void contactspline_process_events_double(contactspline_instrument* instrument,
                                         const contactspline_timed_event* events, std::size_t count,
                                         double* const* outputs, double* force, std::size_t samples) {
  process<double>(instrument, events_in(events, count), nullptr, outputs, force, samples);
}

void contactspline_process_input(contactspline_instrument* instrument, const contactspline_timed_event* events,
                                 std::size_t count, const float* input, float* const* outputs, float* force,
                                 std::size_t samples) {
  process(instrument, events_in(events, count), input, outputs, force, samples);
}
void contactspline_process_input_double(contactspline_instrument* instrument, const contactspline_timed_event* events,
                                        std::size_t count, const double* input, double* const* outputs, double* force,
                                        std::size_t samples) {
  process(instrument, events_in(events, count), input, outputs, force, samples);
}
double contactspline_input_scale(const contactspline_instrument* instrument) {
  return with(instrument, 0.0, [](const auto& i) { return i.input_scale_n(); });
}

void contactspline_reset(contactspline_instrument* instrument) {
  if (instrument == nullptr) return;
  instrument->tuned_keys.drop_notes();
  std::visit([](auto& player) { player.sleeper.reset(); }, instrument->player);
}
double contactspline_energy(const contactspline_instrument* instrument) {
  return with(instrument, 0.0, [](const auto& i) { return i.energy(); });
}
int contactspline_is_silent(const contactspline_instrument* instrument, double limit_j) {
  return with(instrument, 1, [&](const auto& i) { return int{i.is_silent(limit_j)}; });
}
int contactspline_is_at_rest(const contactspline_instrument* instrument, double limit_j) {
  return with(instrument, 1, [&](const auto& i) { return int{i.is_at_rest(limit_j)}; });
}
contactspline_books contactspline_books_of(const contactspline_instrument* instrument) {
  return with(instrument, contactspline_books{}, [](const auto& i) {
    const Books books = i.books();
    return contactspline_books{books.stored_j, books.string_j, books.work_j,
                               books.heat_j,   books.contacts, books.failures};
  });
}
int contactspline_has_key(const contactspline_instrument* instrument, int key) {
  return with(instrument, 0, [&](const auto& i) { return int{i.has_key(key)}; });
}

}  // extern "C"
