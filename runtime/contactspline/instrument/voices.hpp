// SPDX-License-Identifier: MIT
// Keys on copies of an instrument, each tuned at its note.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/data/pluck.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/step/first_push.hpp"

namespace contactspline {

/// keyed()       the ranges of its keys and the number of its voices
/// tune(cents, string)   a body or kAllStrings, from the next sample on, beside the bend of its parameter; safe on an
///               audio thread
template <typename I>
concept KeyedInstrument = Instrument<I> && requires(I& i, const I& c) {
  { c.keyed() } -> std::convertible_to<const KeyedData&>;
  i.tune(100.0, kAllStrings);
};

/// Plays the keys of an instrument on so many copies of it as it has voices; the outputs are their sums. A key takes
/// the voice that it had last; else one that is silent, the one that was released first, or the one that was struck
/// first. An event without a key plays on a voice with the pitch of the file. A bow is down while a key of its event
/// is held; where several are, the last of them tunes the string. An input pushes the first voice alone. Meets
/// Instrument.
template <KeyedInstrument I>
class Voices {
  using T = typename I::value_type;

 public:
  using value_type = T;

  /// Arguments of each copy.
  template <typename... Args>
  explicit Voices(const Args&... args) {
    voices_.emplace_back(args...);
    while (voices_.size() < first().keyed().voices) voices_.emplace_back(args...);
    for (std::size_t p = 0; p < parameters().size(); ++p) values_.push_back(first().value(p));
    key_moves_.resize(kKeys * values_.size());
    rates_.resize(values_.size());
    for (Voice& voice : voices_) {
      voice.tuners.resize(first().keyed().ranges.size(), kPlayers);
      voice.moved.resize(values_.size());
    }
    last_.resize(first().outputs().size());
    unmixed_.resize(last_.size(), std::vector<T>(kBlock));
    parts_.resize(last_.size());
    tick_parts_.resize(last_.size());
    unmixed_force_.resize(kBlock);
  }

  [[nodiscard]] const char* name() const { return first().name(); }
  [[nodiscard]] const char* description() const { return first().description(); }
  [[nodiscard]] const char* license() const { return license_of(first()); }
  [[nodiscard]] std::span<const Parameter> parameters() const { return first().parameters(); }
  [[nodiscard]] std::span<const Event> events() const { return first().events(); }
  [[nodiscard]] std::span<const Output> outputs() const { return first().outputs(); }
  [[nodiscard]] std::span<const Preset> presets() const { return first().presets(); }
  [[nodiscard]] const KeyedData& keyed() const { return first().keyed(); }
  [[nodiscard]] double input_scale_n() const { return input_scale_of(first()); }

  /// Brings all voices to rest at a sample rate; allocates. All below is safe on an audio thread.
  void prepare(double sample_rate_hz) {
    for (Voice& voice : voices_) voice.instrument.prepare(sample_rate_hz);
    for (std::size_t p = 0; p < rates_.size(); ++p)
      rates_[p] = part_of_glide(parameters()[p].glide_s, kMoveStep / sample_rate_hz);
    mix_rate_ = part_of_glide(kMixGlide_s, 1 / sample_rate_hz);
    reset();
  }

  /// Sets a parameter of all voices; those of keys that are moved alone stay beside it.
  void set(std::size_t parameter, double value) {
    for (Voice& voice : voices_) {
      const double before = voice.instrument.value(parameter), moved = voice.moved[parameter];
      voice.instrument.set(parameter, value);
      if (&voice == &voices_.front()) values_[parameter] = voice.instrument.value(parameter);
      if (moved != 0) voice.instrument.set(parameter, values_[parameter] + moved);
      if (voice.instrument.value(parameter) != before) voice.wake();
    }
  }
  [[nodiscard]] double value(std::size_t parameter) const { return values_[parameter]; }

  /// velocity: 0 to 1, clamped; multiplies the parameter of the event, which the key multiplies within its range
  /// (KeyRange::strength). Keys that it lacks and velocities that are not a number do nothing.
  void note_on(int key, double velocity) {
    const KeyRange* range = range_of(key);
    if (range == nullptr || !is_number(velocity)) return;
    const Event& event = events()[range->event];
    const double part = std::clamp(velocity, 0.0, 1.0);
    // Which would lift the bow.
    if (event.kind == EventKind::kBow && !(part * moved_value(event.parameter, static_cast<std::size_t>(key)) > 0))
      return;
    Voice& voice = take(static_cast<std::size_t>(key));
    const ControlRange<double>& allowed = parameters()[event.parameter].allowed;
    const double strong = range->strength(key) * voice.instrument.value(event.parameter);
    const double played = part * std::clamp(strong, allowed.min, allowed.max);
    tune(voice, *range, key);
    play_event(voice.instrument, event, played);
  }
  void note_off(int key) {
    if (range_of(key) != nullptr) let_go(static_cast<std::size_t>(key));
  }
  /// Can keys be bent? Those without a pitch of their own cannot.
  [[nodiscard]] bool bends_keys() const {
    return std::ranges::any_of(keyed().ranges, [](const KeyRange& range) { return range.tuned_key >= 0; });
  }
  /// Bends a key of MIDI from its pitch, also while it sounds, beside the parameter [cents].
  void bend_key(int key, double cents) {
    const KeyRange* const range = range_of(key);
    if (range == nullptr || range->tuned_key < 0 || !is_number(cents)) return;
    key_cents_[static_cast<std::size_t>(key)] = cents;
    for (Voice& voice : voices_)
      if (voice.tuners[number_of(*range)] == static_cast<std::size_t>(key)) tune(voice, *range, key);
  }
  /// Parameters that the voice of a key can have alone: all but those of the performance.
  [[nodiscard]] bool moves_keys(std::size_t parameter) const {
    return parameter < values_.size() && parameter != keyed().bend && parameter != keyed().sustain;
  }
  /// How far above the value of all a key has a parameter, until it is moved anew. What sounds follows as fast as the
  /// parameter glides.
  void move_key(int key, std::size_t parameter, double by) {
    if (range_of(key) == nullptr || !moves_keys(parameter) || !is_number(by)) return;
    const auto [min, max] = parameters()[parameter].allowed;
    by = std::clamp(by, min - max, max - min);
    if (by == std::exchange(key_moves_[static_cast<std::size_t>(key) * values_.size() + parameter], by)) return;
    are_moved_ = true;
    for (Voice& voice : voices_)
      if (voice.player == static_cast<std::size_t>(key)) follow_moves(voice, true);
  }
  /// Gain of what a key plays, 0 to 4, and its place, -1 (left) to 1 (right), by outputs whose names begin with left_
  /// and right_; clamped.
  void level_key(int key, double gain) {
    if (range_of(key) == nullptr || !is_number(gain)) return;
    key_mixes_[static_cast<std::size_t>(key)].level = std::clamp(gain, 0.0, 4.0);
    mix(static_cast<std::size_t>(key));
  }
  void pan_key(int key, double place) {
    if (range_of(key) == nullptr || !is_number(place)) return;
    key_mixes_[static_cast<std::size_t>(key)].pan = std::clamp(place, -1.0, 1.0);
    mix(static_cast<std::size_t>(key));
  }
  /// The event that a key plays, if it plays one.
  [[nodiscard]] std::optional<std::size_t> event_of(int key) const {
    const KeyRange* const range = range_of(key);
    return range == nullptr ? std::nullopt : std::optional(range->event);
  }
  void strike(std::size_t number, T speed_m_per_s) {
    if (const auto player = player_of(EventKind::kStrike, number); player < kPlayers && is_number(speed_m_per_s))
      take_as_in_file(player).instrument.strike(number, speed_m_per_s);
  }
  void release(std::size_t number) { let_go(player_of(EventKind::kStrike, number)); }
  void pluck(std::size_t number, T force_n, double rise_s = kPluckRise_s) {
    const auto player = player_of(EventKind::kPluck, number);
    if (player >= kPlayers || !is_number(force_n)) return;
    Voice& voice = take_as_in_file(player);
    voice.players.reset(player);  // nothing lets go of it later
    voice.instrument.pluck(number, force_n, rise_s);
  }

  void bow(std::size_t number, T acceleration_m_per_s2) {
    const auto player = player_of(EventKind::kBow, number);
    if (player >= kPlayers || !is_number(acceleration_m_per_s2)) return;
    if (!(acceleration_m_per_s2 > 0)) return let_go(player);
    take_as_in_file(player).instrument.bow(number, acceleration_m_per_s2);
  }

  void process(Outputs<T> outputs, std::span<T> force = {}, std::span<const T> input = {}) {
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (const std::span<T> output : outputs) std::ranges::fill(output, T(0));
    std::ranges::fill(force, T(0));
    if (!(input_scale_n() > 0)) input = {};
    for (Voice& voice : voices_) {
      for (std::size_t done = 0; done < length;) {
        if (voice.is_asleep && (done += until_push(input, done)) >= length) break;
        if (voice.is_asleep) voice.wake();
        const std::size_t samples = (std::min)({length - done, kBlock, voice.until_look, until_move(voice)});
        add(voice, outputs, force, input, done, samples);
        voice.advance(samples);
        done += samples;
      }
      input = {};
    }
  }

  /// Advances samples.size() samples and writes one output. output: 0 to the number of outputs - 1.
  void process(std::span<T> samples, std::size_t output = 0) {
    for (T& sample : samples) {
      tick();
      sample = this->output(output);
    }
  }

  /// Advances one sample; then output() and contact_force() are those of this sample.
  void tick() {
    std::span<T> samples(last_);
    for (std::size_t o = 0; o < last_.size(); ++o) tick_parts_[o] = samples.subspan(o, 1);
    process(tick_parts_, {&last_force_, 1});
  }
  [[nodiscard]] T output(std::size_t output) const { return last_[output]; }
  [[nodiscard]] T contact_force() const { return last_force_; }

  /// Brings all voices to rest. Parameters stay. Does not allocate.
  void reset() {
    for (Voice& voice : voices_) {
      voice.instrument.tune(0, kAllStrings);
      std::ranges::fill(voice.tuners, kPlayers);
      voice.player = kPlayers;
      follow_moves(voice, false);
      voice.gains = voice.wanted = {};
      voice.has_sounded = false;
      voice.instrument.reset();
      voice.players.reset();
      voice.order = 0;
      voice.wake();
      voice.is_asleep = voice.instrument.is_silent(kSilent_j);
    }
    order_ = 0;
    std::ranges::fill(last_, T(0));
    last_force_ = 0;
  }

  [[nodiscard]] bool is_silent(double limit_j) const {
    return std::ranges::all_of(
        voices_, [&](const Voice& voice) { return voice.is_asleep || voice.instrument.is_silent(limit_j); });
  }
  [[nodiscard]] bool is_at_rest(double limit_j) const {
    return std::ranges::all_of(
        voices_, [&](const Voice& voice) { return voice.is_asleep || voice.instrument.is_at_rest(limit_j); });
  }
  /// The books of all voices, as in one of them.
  [[nodiscard]] double energy() const {
    return sum([](const Voice& v) { return v.instrument.energy(); });
  }
  [[nodiscard]] double work() const {
    return sum([](const Voice& v) { return v.is_asleep ? 0 : v.instrument.work(); });
  }
  [[nodiscard]] double dissipated() const {
    return sum([](const Voice& v) { return v.is_asleep ? 0 : v.instrument.dissipated(); });
  }
  /// A voice, from 0 to keyed().voices - 1.
  [[nodiscard]] const I& voice(std::size_t index) const { return voices_[index].instrument; }

 private:
  static constexpr std::size_t kBlock = 256, kLook = 1024, kMoveStep = 16;  // samples
  static constexpr double kMixGlide_s = 0.005;
  static constexpr double kArrived = 1e-7;  // of a slider's way: the end of a glide
  static constexpr double kSilent_j = 1e-14;
  static constexpr std::size_t kKeys = 128, kPlayers = 1024;  // what plays a voice: a key, or an event without a key

  // Of one key.
  struct Mix {
    double level = 1, pan = 0;
  };
  // Of the outputs of a voice.
  struct Gains {
    double left = 1, right = 1, other = 1;
    bool operator==(const Gains&) const = default;
  };

  struct Voice {
    template <typename... Args>
    explicit Voice(const Args&... args) : instrument(args...) {}

    void wake() {
      is_asleep = false;
      until_look = kLook;
    }
    // Looks after a while whether it is silent.
    void advance(std::size_t samples) {
      until_look -= samples;
      until_move -= (std::min)(until_move, samples);
      if (until_look > 0) return;
      until_look = kLook;
      is_asleep = instrument.is_silent(kSilent_j);
    }

    I instrument;
    std::bitset<kPlayers> players;    // that hold it
    std::size_t player = kPlayers;    // the last one
    std::vector<std::size_t> tuners;  // for each range the key that has tuned its string last, or kPlayers
    std::size_t order = 0;            // of its last note or release
    std::size_t until_look = kLook;
    std::vector<double> moved;   // how far its parameters are from those of all
    std::size_t until_move = 0;  // samples until they move again
    Gains gains, wanted;
    bool has_sounded = false;  // since it was taken at rest
    bool is_moving = false, is_asleep = false;
  };

  template <typename Of>
  [[nodiscard]] double sum(Of of) const {
    double sum = 0;
    for (const Voice& voice : voices_) sum += of(voice);
    return sum;
  }
  [[nodiscard]] const I& first() const { return voices_.front().instrument; }

  [[nodiscard]] const KeyRange* range_of(int key) const {
    const auto& ranges = keyed().ranges;
    const auto found =
        std::ranges::find_if(ranges, [&](const KeyRange& r) { return r.first <= key && key <= r.last; });
    return found == ranges.end() ? nullptr : &*found;
  }

  [[nodiscard]] std::size_t number_of(const KeyRange& range) const {
    return static_cast<std::size_t>(&range - keyed().ranges.data());
  }

  // Do keys tune strings one by one?
  [[nodiscard]] bool has_strings() const {
    return std::ranges::any_of(keyed().ranges, [](const KeyRange& range) { return range.string != kAllStrings; });
  }

  // Gives the string of a range the pitch of one of its keys. A range without pitches gives all strings that of the
  // file, unless others tune them one by one.
  void tune(Voice& voice, const KeyRange& range, int key) {
    if (range.tuned_key < 0 && has_strings()) return;
    const double bend = key_cents_[static_cast<std::size_t>(key)];
    tune_string(voice, range.string, range.tuned_key < 0 ? 0 : 100.0 * (key - range.tuned_key) + bend);
    voice.tuners[number_of(range)] = static_cast<std::size_t>(key);
  }

  void tune_string(Voice& voice, std::size_t string, double cents) {
    for (std::size_t r = 0; r < voice.tuners.size(); ++r)
      if (const std::size_t other = keyed().ranges[r].string;
          other == string || other == kAllStrings || string == kAllStrings)
        voice.tuners[r] = kPlayers;
    voice.instrument.tune(cents, string);
  }

  // The part of a glide that passes in a time; without a glide all of it.
  static double part_of_glide(double glide_s, double time_s) {
    return glide_s > 0 ? -std::expm1(-time_s / glide_s) : 1;
  }

  // How far the player of a voice wants a parameter to be from that of all.
  [[nodiscard]] double wanted_move(std::size_t player, std::size_t parameter) const {
    return player < kKeys ? key_moves_[player * values_.size() + parameter] : 0;
  }
  [[nodiscard]] double moved_value(std::size_t parameter, std::size_t player) const {
    return held(values_[parameter], values_[parameter] + wanted_move(player, parameter),
                parameters()[parameter].allowed);
  }
  void move(Voice& voice, std::size_t parameter, double by) {
    voice.moved[parameter] = by;
    voice.instrument.set(parameter, values_[parameter] + by);
  }

  // Sends the parameters of a voice to where its player wants them; where nothing sounds, at once.
  void follow_moves(Voice& voice, bool glides) {
    if (!are_moved_) return;
    for (std::size_t p = 0; p < values_.size(); ++p) {
      const double wanted = wanted_move(voice.player, p);
      if (wanted == voice.moved[p]) continue;
      if (glides && voice.has_sounded && rates_[p] < 1 && parameters()[p].acts == Acts::kAtOnce)
        voice.is_moving = true;
      else
        move(voice, p, wanted);
      voice.wake();
    }
  }

  // Moves the parameters of a voice by a step, if it is time; samples until the next step.
  std::size_t until_move(Voice& voice) {
    if (!voice.is_moving) return kBlock;
    if (voice.until_move > 0) return voice.until_move;
    voice.is_moving = false;
    for (std::size_t p = 0; p < values_.size(); ++p) {
      const double wanted = wanted_move(voice.player, p), now = voice.moved[p];
      if (wanted == now) continue;
      const double next = now + rates_[p] * (wanted - now);
      const auto [low, high] = parameters()[p].slider;
      const bool arrives = std::abs(wanted - next) <= kArrived * (high - low);
      move(voice, p, arrives ? wanted : next);
      voice.is_moving |= !arrives;
    }
    return voice.until_move = kMoveStep;
  }

  // The gains that the player of a voice wants; a balance.
  [[nodiscard]] Gains gains_of(std::size_t player) const {
    const Mix mix = player < kKeys ? key_mixes_[player] : Mix{};
    return {mix.level * (std::min)(1.0, 1 - mix.pan), mix.level * (std::min)(1.0, 1 + mix.pan), mix.level};
  }
  void mix(std::size_t player) {
    for (Voice& voice : voices_) {
      if (voice.player != player) continue;
      voice.wanted = gains_of(player);
      if (!voice.has_sounded) voice.gains = voice.wanted;
    }
  }

  [[nodiscard]] std::size_t player_of(EventKind kind, std::size_t number) const {
    for (std::size_t e = 0; e < events().size(); ++e)
      if (events()[e].kind == kind && events()[e].number == number) return (std::min)(kKeys + e, kPlayers);
    return kPlayers;
  }

  // The voice that a player gets, held by it.
  Voice& take(std::size_t player) {
    auto found = std::ranges::find(voices_, player, &Voice::player);
    if (found == voices_.end())
      found = std::ranges::min_element(voices_, {}, [](const Voice& voice) {
        return std::tuple(voice.players.any(), !voice.is_asleep, voice.order);
      });
    if (voices_.size() > 1 && found->player != player) evict(*found);
    found->players.set(player);
    found->player = player;
    found->order = orders_[player] = ++order_;
    found->has_sounded &= !found->is_asleep;
    follow_moves(*found, true);
    mix(player);
    found->wake();
    return *found;
  }

  // The voice of an event without a key. Its strings, or all, have the pitch of the file.
  Voice& take_as_in_file(std::size_t player) {
    Voice& voice = take(player);
    if (!has_strings()) tune_string(voice, kAllStrings, 0);
    for (const KeyRange& range : keyed().ranges)
      if (range.event == event_played_by(player) && range.string != kAllStrings) tune_string(voice, range.string, 0);
    return voice;
  }

  // Takes a voice away from those that hold it.
  void evict(Voice& voice) {
    if (voice.players.none()) return;
    voice.players.reset();
    for (const Event& event : events())
      if (event.kind == EventKind::kBow) play_event(voice.instrument, event, 0);
  }

  void let_go(std::size_t player) {
    if (player >= kPlayers) return;
    for (Voice& voice : voices_) {
      if (!voice.players[player]) continue;
      voice.players.reset(player);
      if (const std::size_t e = event_played_by(player); events()[e].kind == EventKind::kBow) lift(voice, player, e);
      if (voice.players.any()) continue;
      voice.instrument.release(0);
      voice.order = ++order_;
    }
  }

  // The event that a player plays: a key, or the event itself.
  [[nodiscard]] std::size_t event_played_by(std::size_t player) const {
    return player < kKeys ? range_of(static_cast<int>(player))->event : player - kKeys;
  }

  // Lifts the bow of an event, unless another player holds it; the last of these keys tunes the string again.
  void lift(Voice& voice, std::size_t player, std::size_t event) {
    std::size_t last = kPlayers;
    for (std::size_t p = 0; p < (std::min)(kKeys + events().size(), kPlayers); ++p)
      if (voice.players[p] && event_played_by(p) == event && (last == kPlayers || orders_[p] > orders_[last]))
        last = p;
    if (last == kPlayers) return play_event(voice.instrument, events()[event], 0);
    if (voice.player == player) {
      voice.player = last;
      follow_moves(voice, true);
      mix(last);
    }
    if (last >= kKeys) return;
    const KeyRange& range = *range_of(static_cast<int>(last));
    const std::size_t tuner = voice.tuners[number_of(range)];
    if (tuner == player || tuner == kPlayers) tune(voice, range, static_cast<int>(last));
  }

  // Adds a part of a block of one voice.
  void add(Voice& voice, Outputs<T> outputs, std::span<T> force, std::span<const T> input, std::size_t begin,
           std::size_t samples) {
    for (std::size_t o = 0; o < outputs.size(); ++o)
      parts_[o] = outputs[o].empty() ? std::span<T>() : std::span(unmixed_[o]).first(samples);
    const auto forces = std::span(unmixed_force_).first(samples);
    process_under<I>(voice.instrument, std::span(parts_).first(outputs.size()), forces,
                     detail::part_of(input, begin, samples));
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      const std::span<T> sum = outputs[o].empty() ? std::span<T>() : outputs[o].subspan(begin, samples);
      if (voice.gains == voice.wanted && voice.gains == Gains{})
        for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += parts_[o][n];
      else
        add_by(gain_of(o), voice, sum, parts_[o]);
    }
    voice.gains = after(voice, samples);
    voice.has_sounded = true;
    for (std::size_t n = 0; n < (force.empty() ? 0 : samples); ++n) force[begin + n] += forces[n];
  }

  // Samples from one on until an input pushes, or until it ends; of none more than any block has.
  static std::size_t until_push(std::span<const T> input, std::size_t begin) {
    return input.empty() ? std::size_t(-1) / 2 : first_push(input.subspan(begin));
  }

  // Which of the gains is that of an output.
  [[nodiscard]] double Gains::*gain_of(std::size_t output) const {
    const std::string_view name = this->outputs()[output].name;
    return name.starts_with("left_") ? &Gains::left : name.starts_with("right_") ? &Gains::right : &Gains::other;
  }

  void add_by(double Gains::*gain, const Voice& voice, std::span<T> sum, std::span<const T> part) const {
    double now = voice.gains.*gain;
    for (std::size_t n = 0; n < sum.size(); ++n) {
      now += mix_rate_ * (voice.wanted.*gain - now);
      sum[n] += static_cast<T>(now) * part[n];
    }
  }

  // The gains of a voice so many samples later.
  [[nodiscard]] Gains after(const Voice& voice, std::size_t samples) const {
    if (voice.gains == voice.wanted) return voice.wanted;
    constexpr double kNear = 1e-6;
    const double rest = std::pow(1 - mix_rate_, static_cast<double>(samples));
    Gains gains;
    for (double Gains::*gain : {&Gains::left, &Gains::right, &Gains::other}) {
      const double wanted = voice.wanted.*gain, far = rest * (voice.gains.*gain - wanted);
      gains.*gain = std::abs(far) < kNear ? wanted : wanted + far;
    }
    return gains;
  }

  std::deque<Voice> voices_;            // which do not move
  std::vector<double> values_, rates_;  // of the parameters: of all voices; the part of a glide in a step
  std::vector<double> key_moves_;       // of each key the parameters, from values_
  std::array<Mix, kKeys> key_mixes_{};
  double mix_rate_ = 1;
  bool are_moved_ = false;                      // has a key ever been moved?
  std::array<double, kKeys> key_cents_{};       // of single keys
  std::array<std::size_t, kPlayers> orders_{};  // of the last note of each player
  std::size_t order_ = 0;
  std::vector<T> last_;
  T last_force_ = 0;
  std::vector<std::vector<T>> unmixed_;
  std::vector<T> unmixed_force_;
  std::vector<std::span<T>> parts_, tick_parts_;
};

}  // namespace contactspline
