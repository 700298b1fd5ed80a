// SPDX-License-Identifier: MIT
// An instrument of the library for C as hosts of signals play it: Csound, Pd, SuperCollider.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "contactspline.h"
#include "contactspline/data/parameter.hpp"
#include "contactspline/data/pluck.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// What a host hears: an output over its full scale, or in its unit; the sum of the contact forces [N]; the stored
/// energy [J].
template <std::floating_point Sample>
struct Tap {
  std::size_t source;  ///< index of the output; behind the last one force and energy
  Sample full_scale;
};

/// Parameters, events and outputs by name, blocks of any length. create() allocates; all but the lists in words is
/// safe on an audio thread.
template <std::floating_point Sample>
class WiredInstrument {
 public:
  /// An instrument that ships, or the path of a file; nothing where contactspline_last_error() says why.
  [[nodiscard]] static std::unique_ptr<WiredInstrument> create(const char* name, double sample_rate_hz) {
    Handle handle(contactspline_create(name, sample_rate_hz, kPrecision));
    return handle ? std::unique_ptr<WiredInstrument>(new WiredInstrument(std::move(handle))) : nullptr;
  }

  [[nodiscard]] std::optional<std::size_t> parameter(std::string_view name) const {
    return find(name, contactspline_parameter_count(get()), contactspline_parameter_at);
  }
  [[nodiscard]] std::optional<std::size_t> event(std::string_view name) const {
    return find(name, contactspline_event_count(get()), contactspline_event_at);
  }

  /// "left", "right": the outputs whose names begin so, or the first one, over full scale. The name of an output, and
  /// "force_n", "energy_j": in their units.
  [[nodiscard]] std::optional<Tap<Sample>> tap(std::string_view name) const {
    if (name == "left") return scaled(side("left_", 0));
    if (name == "right") return scaled(side("right_", side("left_", 0)));
    const auto output = find(name, outputs_.size(), contactspline_output_at);
    if (output) return Tap<Sample>{*output, 1};
    if (name == "force_n") return Tap<Sample>{outputs_.size(), 1};
    if (name == "energy_j") return Tap<Sample>{outputs_.size() + 1, 1};
    return {};
  }

  /// Names of all, which allocates.
  [[nodiscard]] std::vector<std::string> parameters() const {
    return names(contactspline_parameter_count(get()), contactspline_parameter_at);
  }
  [[nodiscard]] std::vector<std::string> events() const {
    return names(contactspline_event_count(get()), contactspline_event_at);
  }

  /// Middle C, or the next key that plays.
  [[nodiscard]] int first_key() const {
    constexpr int kMiddleC = 60, kKeys = 128;
    for (int key = kMiddleC; key < kMiddleC + kKeys; ++key)
      if (contactspline_has_key(get(), key % kKeys) != 0) return key % kKeys;
    return kMiddleC;
  }
  [[nodiscard]] double value(std::size_t parameter) const { return contactspline_get(get(), parameter); }
  void set(std::size_t parameter, double value) { contactspline_set(get(), parameter, value); }

  /// Plays an event by its value [m/s or N], or by the parameter that holds it.
  void play(std::size_t event, std::optional<double> value = {}) {
    const contactspline_event* const played = contactspline_event_at(get(), event);
    if (played == nullptr) return;
    const double strength = value ? *value : this->value(played->parameter);
    const contactspline_timed_event now{0, played->action, played->number, strength, kPluckRise_s};
    contactspline_play(get(), &now);
  }

  /// A key of MIDI, 0 to 127, goes down with a velocity above 0, else up. Other keys, and a velocity that is not a
  /// number, do nothing.
  void note(double key, double velocity) {
    if (!(key >= 0 && key < 127.5) || !is_number(velocity)) return;
    const int number = static_cast<int>(std::lround(key));
    velocity > 0 ? contactspline_note_on(get(), number, velocity) : contactspline_note_off(get(), number);
  }

  void reset() { contactspline_reset(get()); }

  /// Advances `samples` samples and writes them to the arrays of the taps.
  void process(std::span<const Tap<Sample>> taps, std::span<Sample* const> sounds, std::size_t samples) {
    for (std::size_t begin = 0; begin < samples; begin += kBlock)
      process_part(taps, sounds, begin, (std::min)(kBlock, samples - begin));
  }

  /// Names, units, ranges and first values, a line each.
  [[nodiscard]] std::vector<std::string> lines() const {
    std::vector<std::string> lines{std::string(contactspline_name(get())) + ": " + contactspline_description(get())};
    const auto number = [](double x) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), "%.6g", x);
      return std::string(text.data());
    };
    const auto unit = [](const char* text) { return *text == '\0' ? std::string() : std::string(" ") + text; };
    for (std::size_t i = 0; i < contactspline_parameter_count(get()); ++i) {
      const contactspline_parameter& p = *contactspline_parameter_at(get(), i);
      lines.push_back("parameter " + std::string(p.name) + ": " + number(p.slider_min) + " to " +
                      number(p.slider_max) + unit(p.unit) + ", at first " + number(p.initial) +
                      (p.acts_at_next_note != 0 ? ", acts at the next note" : ""));
    }
    for (std::size_t i = 0; i < contactspline_event_count(get()); ++i) {
      const contactspline_event& e = *contactspline_event_at(get(), i);
      lines.push_back("event " + std::string(e.name) + ": value of " +
                      contactspline_parameter_at(get(), e.parameter)->name);
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      const contactspline_output& o = *contactspline_output_at(get(), i);
      lines.push_back("output " + std::string(o.name) + ":" + unit(o.unit) + ", full scale " + number(o.full_scale));
    }
    lines.emplace_back("output left, right: 1 is full scale; force_n: N; energy_j: J");
    return lines;
  }

 private:
  struct Destroy {
    void operator()(contactspline_instrument* instrument) const { contactspline_destroy(instrument); }
  };
  using Handle = std::unique_ptr<contactspline_instrument, Destroy>;
  static constexpr int kPrecision = std::is_same_v<Sample, float> ? CONTACTSPLINE_FLOAT : CONTACTSPLINE_DOUBLE;
  static constexpr std::size_t kBlock = 64;  // samples

  explicit WiredInstrument(Handle handle)
      : handle_(std::move(handle)), outputs_(contactspline_output_count(get())), scratch_(outputs_.size() + 1) {}

  [[nodiscard]] contactspline_instrument* get() const { return handle_.get(); }

  template <typename At>
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name, std::size_t count, At at) const {
    for (std::size_t i = 0; i < count; ++i)
      if (name == at(get(), i)->name) return i;
    return {};
  }

  template <typename At>
  [[nodiscard]] std::vector<std::string> names(std::size_t count, At at) const {
    std::vector<std::string> list;
    for (std::size_t i = 0; i < count; ++i) list.emplace_back(at(get(), i)->name);
    return list;
  }

  [[nodiscard]] std::size_t side(std::string_view beginning, std::size_t otherwise) const {
    for (std::size_t o = 0; o < outputs_.size(); ++o)
      if (std::string_view(contactspline_output_at(get(), o)->name).starts_with(beginning)) return o;
    return otherwise;
  }

  [[nodiscard]] Tap<Sample> scaled(std::size_t output) const {
    return {output, static_cast<Sample>(contactspline_output_at(get(), output)->full_scale)};
  }

  void process_part(std::span<const Tap<Sample>> taps, std::span<Sample* const> sounds, std::size_t begin,
                    std::size_t samples) {
    std::ranges::fill(outputs_, nullptr);
    Sample* force = nullptr;
    for (const auto& tap : taps) {
      if (tap.source < outputs_.size()) outputs_[tap.source] = scratch_[tap.source].data();
      if (tap.source == outputs_.size()) force = scratch_.back().data();
    }
    if constexpr (std::is_same_v<Sample, float>)
      contactspline_process(get(), outputs_.data(), force, samples);
    else
      contactspline_process_double(get(), outputs_.data(), force, samples);
    for (std::size_t t = 0; t < taps.size(); ++t) {
      Sample* const sound = sounds[t] + begin;
      if (taps[t].source > outputs_.size())
        std::fill_n(sound, samples, static_cast<Sample>(contactspline_energy(get())));
      else
        std::transform(scratch_[taps[t].source].data(), scratch_[taps[t].source].data() + samples, sound,
                       [&](Sample x) { return x / taps[t].full_scale; });
    }
  }

  Handle handle_;
  std::vector<Sample*> outputs_;  // that are wanted in this block
  std::vector<std::array<Sample, kBlock>> scratch_;
};

/// A signal that moves a parameter. One that is not a number moves nothing.
template <std::floating_point Sample>
struct Wire {
  std::size_t parameter;
  std::optional<Sample> last = {};

  [[nodiscard]] bool moves(Sample value) const { return is_number(value) && value != last; }
  void move(WiredInstrument<Sample>& instrument, Sample value) {
    if (!moves(value)) return;
    last = value;
    instrument.set(parameter, value);
  }
};

}  // namespace contactspline
