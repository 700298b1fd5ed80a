// SPDX-License-Identifier: MIT
#include "generator/player/score_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "contactspline/body.hpp"
#include "contactspline/controls.hpp"
#include "contactspline/flush_denormals.hpp"
#include "contactspline/fret_string.hpp"
#include "contactspline/hammer_voice.hpp"
#include "contactspline/keyboard_instrument.hpp"
#include "contactspline/slide_string.hpp"
#include "generator/player/instrument_player.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kColumns = 1200;
constexpr std::size_t kBendStep = 16;  // samples between the steps of a bend

template <typename Row>
std::vector<double> each(const std::vector<Row>& modes, double Row::*member) {
  std::vector<double> values;
  for (const auto& mode : modes) values.push_back(mode.*member);
  return values;
}

template <typename T>
ModeShapes<T> shapes_in(const std::vector<ResonatorMode>& modes, double ResonatorMode::*member) {
  const std::vector<double> values = each(modes, member);
  return ModeShapes<T>(values);
}

// At the pickup or the bridge.
template <typename T>
ModeShapes<T> output_shapes(const Voice& voice, const std::vector<ResonatorMode>& modes, Signal signal) {
  if (signal != Signal::kBridge && signal != Signal::kBody) return shapes_in<T>(modes, &ResonatorMode::pickup_shape);
  const auto* string = std::get_if<StiffString>(&voice.resonator.body);
  if (string == nullptr)
    throw BadInput(
        fmt::format("--signal: bridge: {} has none; allowed: displacement, velocity, force", voice.resonator.name));
  return bridge_shapes<T>(*string, modes, voice.strings);
}

[[noreturn]] void refuse_rate(const std::string& what, const PlayOptions& options) {
  throw BadInput(fmt::format("--rate: no mode of {} lies below {} Hz; allowed: a higher rate", what,
                             options.sample_rate_hz / 2));
}

[[noreturn]] void refuse_rate(const Voice& voice, const PlayOptions& options) {
  refuse_rate(fmt::format("voice {} ({})", voice.name, voice.resonator.name), options);
}

// May a sample be a part of a sound? All voices together must fit single precision, in which sounds are stored.
bool is_bounded(double sample) {
  return std::abs(sample) < 1e30;
}

// Where a sound stops being finite, it says so: in a sum of voices, or in a figure, nobody could tell what it was.
[[noreturn]] void refuse_infinite(const Score& score, const std::string& what, const PlayOptions& options,
                                  std::size_t sample) {
  refuse(
      score.file, what,
      fmt::format("its sound is not finite from {:.6g} s on", static_cast<double>(sample) / options.sample_rate_hz),
      "a material, a resonator and controls that single or double precision can hold");
}

/// What every instrument is built of, in the precision of its model.
template <typename T>
struct Parts {
  Parts(const Voice& voice, const PlayOptions& options)
      : set(modes_of(voice.resonator, options.sample_rate_hz / 2)),
        modes(bare(set.modes)),
        output(output_shapes<T>(voice, set.modes, options.signal)),
        contact(table_in<T>(voice.contact)) {
    if (modes.empty()) refuse_rate(voice, options);
  }

  [[nodiscard]] SegmentTable<T> table() const { return contact; }
  [[nodiscard]] ModeShapes<T> strike() const { return shapes_in<T>(set.modes, &ResonatorMode::strike_shape); }
  [[nodiscard]] StringShapes<T> shapes() const {
    return StringShapes<T>(each(set.modes, &ResonatorMode::wavenumber_per_m));
  }

  ModeSet set;
  std::vector<Mode> modes;
  ModeShapes<T> output;  ///< at the pickup or the bridge
  std::vector<Segment<T>> contact;
};

/// What a block of a voice writes: output and contact force of every sample.
struct Block {
  std::span<double> output, force;
};

/// Plays a hammer voice in blocks in which nothing changes. The damper falls when no note is held.
template <typename T>
class HammerStringPlayer {
 public:
  HammerStringPlayer(const Voice& voice, const PlayOptions& options)
      : resonator_(voice.resonator),
        options_(options),
        parts_(voice, options),
        place_m_(voice.resonator.strike.position_m),
        strikes_(voice.strikes, options.sample_rate_hz),
        voice_(parts_.table(), parts_.modes, parts_.strike(), parts_.output, controls_from(voice.initial),
               voice.damper, options.sample_rate_hz) {}

  void process(std::size_t begin, ControlTrack& controls, const Block& block) {
    for (std::size_t done = 0; done < block.output.size();) {
      const std::size_t sample = begin + done, left = block.output.size() - done;
      take_events(sample, controls);
      const std::size_t steady = std::min({left, controls.steady_samples(sample, Control::kDamping),
                                           controls.steady_samples(sample, Control::kBend, kBendStep),
                                           strikes_.samples_to_next(sample), is_bending_ ? kBendStep : kMaxSteady});
      process_steady({block.output.subspan(done, steady), block.force.subspan(done, steady)});
      done += steady;
    }
  }

 private:
  using Control = HammerStringControl;
  static constexpr std::size_t kMaxSteady = 1024;  // samples; a voice may fall silent after each

  static HammerStringControls<T> controls_from(std::span<const double> values) {
    return {.hammer_mass_kg = static_cast<T>(values[Control::kHammerMass]),
            .felt = {static_cast<T>(values[Control::kStiffnessRatio]), static_cast<T>(values[Control::kLoss])},
            .damping_per_s = static_cast<T>(values[Control::kDamping])};
  }

  void take_events(std::size_t sample, ControlTrack& controls) {
    const auto values = controls.at(sample);
    voice_.controls() = controls_from(values);
    bend(values[Control::kBend], sample);
    while (const auto* change = strikes_.next_until(sample)) take(*change, values[Control::kPlace]);
  }

  void take(const StrikeTrack::Change& change, double place_m) {
    if (change.strike == nullptr) {
      if (--held_ == 0) voice_.release();
      return;
    }
    ++held_;
    is_silent_ = false;
    if (place_m != place_m_) move_strike(place_m);
    const double speed = change.strike->speed_m_per_s;
    speed > 0 ? voice_.strike(static_cast<T>(speed)) : voice_.lift();
  }

  void bend(double cents, std::size_t sample) {
    is_bending_ = cents != bend_.cents();
    if (!is_bending_) return;
    const auto& string = std::get<StiffString>(resonator_.body);
    const std::span<const ResonatorMode> rows(parts_.set.modes);
    const double energy = detail::tension_energy(string, rows, voice_.model().string());
    const bool follows = bend_.follow(cents, energy, static_cast<double>(sample) / options_.sample_rate_hz);
    is_bending_ = cents != bend_.cents();
    if (!follows) return;
    std::ranges::transform(rows, parts_.modes.begin(),
                           [&](const ResonatorMode& row) { return retuned(string, row, bend_.cents()); });
    voice_.retune(parts_.modes);
  }

  void move_strike(double place_m) {
    resonator_.strike.position_m = place_m_ = place_m;
    const auto modes = modes_of(resonator_, options_.sample_rate_hz / 2).modes;
    voice_.strike_at(shapes_in<T>(modes, &ResonatorMode::strike_shape));
  }

  void process_steady(const Block& block) {
    if (is_silent_) {
      std::ranges::fill(block.output, 0);
      std::ranges::fill(block.force, 0);
    } else if (options_.signal == Signal::kVelocity) {  // the kernels know displacements only
      for (std::size_t n = 0; n < block.output.size(); ++n) {
        voice_.tick();
        block.output[n] = voice_.model().string().velocity(voice_.output_shapes());
        block.force[n] = voice_.model().force();
      }
    } else if constexpr (std::same_as<T, double>) {
      voice_.process(block.output, block.force.data());
    } else {
      std::array<T, kMaxSteady> output, force;
      voice_.process(std::span(output).first(block.output.size()), force.data());
      std::copy_n(output.begin(), block.output.size(), block.output.begin());
      std::copy_n(force.begin(), block.force.size(), block.force.begin());
    }
    if (options_.signal == Signal::kForce) std::ranges::copy(block.force, block.output.begin());
    processed_ += block.output.size();
    if (!is_silent_ && processed_ >= kMaxSteady) check_silence();
  }

  // A file is scaled to its peak, so silence is relative to the largest energy of the voice: 120 dB below.
  void check_silence() {
    processed_ = 0;
    max_energy_j_ = std::max(max_energy_j_, voice_.model().string().energy());
    is_silent_ = voice_.is_silent(1e-12 * max_energy_j_);
  }

  Resonator resonator_;
  PlayOptions options_;
  Parts<T> parts_;
  double place_m_;
  detail::Bend bend_;
  bool is_bending_ = false;  // is it still on its way?
  StrikeTrack strikes_;
  HammerVoice<T> voice_;
  int held_ = 0;           // notes
  bool is_silent_ = true;  // until the next strike
  double max_energy_j_ = 0;
  std::size_t processed_ = 0;  // samples since the last check
};

/// Plays a model whose controls move at any time, sample by sample. Derived: the player of one instrument, with
/// tick(values), model() and output().
template <typename Derived>
class TickingPlayer {
 public:
  void process(std::size_t begin, ControlTrack& controls, const Block& block) {
    auto& player = static_cast<Derived&>(*this);
    for (std::size_t n = 0; n < block.output.size(); ++n) {
      player.tick(controls.at(begin + n));
      block.force[n] = player.model().force();
      block.output[n] = signal_of(player.model(), player.output(), player.signal());
    }
  }

 private:
  template <typename Model, typename Shapes>
  static double signal_of(const Model& model, const Shapes& output, Signal signal) {
    if (signal == Signal::kForce) return model.force();
    return signal == Signal::kVelocity ? model.string().velocity(output) : model.string().displacement(output);
  }
};

template <typename T>
class SlideStringPlayer : public TickingPlayer<SlideStringPlayer<T>> {
 public:
  SlideStringPlayer(const Voice& voice, const PlayOptions& options)
      : sample_rate_hz_(options.sample_rate_hz),
        length_m_(std::get<StiffString>(voice.resonator.body).length_m),
        parts_(voice, options),
        signal_(options.signal),
        model_(parts_.table(), parts_.modes, parts_.shapes(), static_cast<T>(voice.pluck_m), options.sample_rate_hz),
        output_(model_.string().sound_pickup(parts_.output)) {
    model_.place(static_cast<T>(voice.initial[Control::kPlace]), static_cast<T>(voice.height_m));
  }

  void tick(std::span<const double> values) {
    const auto value = [&](std::size_t control) { return static_cast<T>(values[control]); };
    model_.tick({.place_m = static_cast<T>(place(values)),
                 .slide_mass_kg = value(Control::kSlideMass),
                 .hand_force_n = value(Control::kHandForce),
                 .hand_stiffness_n_per_m = value(Control::kHandStiffness),
                 .hand_resistance_n_s_per_m = value(Control::kHandResistance),
                 .rest_resistance_n_s_per_m = value(Control::kRestResistance),
                 .pluck_force_n = value(Control::kPluckForce),
                 .contact = {value(Control::kStiffnessRatio), value(Control::kLoss)}});
  }

  [[nodiscard]] const ModeShapes<T>& output() const { return output_; }
  [[nodiscard]] Signal signal() const { return signal_; }
  [[nodiscard]] const auto& model() const { return model_; }

 private:
  using Control = SlideStringControl;

  double place(std::span<const double> values) {
    phase_ += values[Control::kVibratoRate] / sample_rate_hz_;
    phase_ -= std::floor(phase_);
    const double vibrato_m = values[Control::kVibratoDepth] * std::sin(2 * std::numbers::pi * phase_);
    return std::clamp(values[Control::kPlace] + vibrato_m, 0.0, length_m_);
  }

  double sample_rate_hz_;
  double length_m_;
  Parts<T> parts_;
  Signal signal_;
  SlideString<T> model_;
  ModeShapes<T> output_;
  double phase_ = 0;  // of the vibrato, in periods
};

template <typename T>
class FretStringPlayer : public TickingPlayer<FretStringPlayer<T>> {
 public:
  FretStringPlayer(const Voice& voice, const PlayOptions& options)
      : parts_(voice, options),
        signal_(options.signal),
        model_(parts_.table(), parts_.modes, parts_.shapes(), static_cast<T>(voice.pluck_m), options.sample_rate_hz),
        output_(model_.string().sound_pickup(parts_.output)) {
    model_.place(static_cast<T>(voice.initial[Control::kPlace]), static_cast<T>(voice.initial[Control::kGap]));
  }

  void tick(std::span<const double> values) {
    const auto value = [&](std::size_t control) { return static_cast<T>(values[control]); };
    model_.tick({.place_m = value(Control::kPlace),
                 .gap_m = value(Control::kGap),
                 .pluck_force_n = value(Control::kPluckForce),
                 .damping_per_s = value(Control::kDamping),
                 .contact = {value(Control::kStiffnessRatio), value(Control::kLoss)}});
  }

  [[nodiscard]] const ModeShapes<T>& output() const { return output_; }
  [[nodiscard]] Signal signal() const { return signal_; }
  [[nodiscard]] const auto& model() const { return model_; }

 private:
  using Control = FretStringControl;
  Parts<T> parts_;
  Signal signal_;
  FretString<T> model_;
  ModeShapes<T> output_;
};

/// Plays an instrument of a file.
template <typename T>
class FilePlayer {
 public:
  FilePlayer(const Voice& voice, const PlayOptions& options)
      : output_(options.output), player_(voice, options.sample_rate_hz) {}

  void process(std::size_t begin, ControlTrack& controls, const Block& block) {
    for (std::size_t n = 0; n < block.output.size(); ++n) {
      player_.tick(controls.at(begin + n));
      block.output[n] = player_.instrument().output(output_);
      block.force[n] = player_.instrument().contact_force();
    }
  }

 private:
  std::size_t output_;
  InstrumentPlayer<T> player_;
};

/// Gathers what the voices play.
class Recorder {
 public:
  Recorder(const Score& score, const PlayOptions& options)
      : is_on_body_(options.signal == Signal::kBody),
        samples_(sample_at(score.duration_s, options.sample_rate_hz)),
        stretch_(std::max<std::size_t>(1, (samples_ + kColumns - 1) / kColumns)) {
    performance_ = {options.sample_rate_hz, channels_of(score), {}, {}, 0, 0};
    performance_.samples.resize(samples_ * static_cast<std::size_t>(performance_.channels));
    performance_.force_n.resize((samples_ + stretch_ - 1) / stretch_);
  }

  void begin(const Voice& voice) {
    const double angle = (voice.pan + 1) * std::numbers::pi / 4;  // equal power
    strings_ = voice.strings;
    left_ = is_on_body_ || performance_.channels == 1 ? 1 : std::cos(angle);
    right_ = is_on_body_ ? 1 : std::sin(angle);
    touches_ = false;
  }

  void add(std::size_t begin, const Block& block) {
    for (std::size_t n = 0; n < block.output.size(); ++n) {
      add_sound(begin + n, left_ * block.output[n], right_ * block.output[n]);
      add_force(begin + n, strings_ * block.force[n], touches_);
    }
  }

  void add_sound(std::size_t sample, double left, double right) {
    if (performance_.channels == 1) {
      performance_.samples[sample] += static_cast<float>(left);
    } else {
      performance_.samples[2 * sample] += static_cast<float>(left);
      performance_.samples[2 * sample + 1] += static_cast<float>(right);
    }
  }

  /// `touches`: did the voice have a contact force in the sample before?
  void add_force(std::size_t sample, double force_n, bool& touches) {
    float& largest = performance_.force_n[sample / stretch_];
    largest = std::max(largest, static_cast<float>(force_n));
    performance_.largest_force_n = std::max(performance_.largest_force_n, force_n);
    performance_.contacts += force_n > 0 && !touches;
    touches = force_n > 0;
  }

  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] Performance&& take() { return std::move(performance_); }

 private:
  bool is_on_body_;  // all strings drive one bridge
  std::size_t samples_, stretch_;
  Performance performance_;
  double strings_ = 1, left_ = 1, right_ = 1;
  bool touches_ = false;
};

using PartDone = std::function<void(std::size_t)>;

void require_finite(const Score& score, const Voice& voice, const PlayOptions& options, std::size_t begin,
                    const Block& block) {
  for (std::size_t n = 0; n < block.output.size(); ++n)
    if (!is_bounded(block.output[n]) || !is_bounded(block.force[n]))
      refuse_infinite(score, "voice " + voice.name, options, begin + n);
}

template <typename Player>
void play_voice(const Score& score, const Voice& voice, const PlayOptions& options, Recorder& recorder,
                const PartDone& done) {
  constexpr std::size_t kBlock = 4096;
  std::vector<double> output(kBlock), force(kBlock);
  ControlTrack controls(voice, options.sample_rate_hz);
  Player player(voice, options);
  recorder.begin(voice);
  for (std::size_t begin = 0; begin < recorder.samples(); begin += kBlock) {
    done(begin);
    const std::size_t samples = std::min(kBlock, recorder.samples() - begin);
    const Block block{std::span(output).first(samples), std::span(force).first(samples)};
    player.process(begin, controls, block);
    require_finite(score, voice, options, begin, block);
    recorder.add(begin, block);
  }
}

template <typename T>
void play_in(const Score& score, const Voice& voice, const PlayOptions& options, Recorder& recorder,
             const PartDone& done) {
  switch (score.instrument) {
    case Instrument::kHammerString:
      return play_voice<HammerStringPlayer<T>>(score, voice, options, recorder, done);
    case Instrument::kSlideString:
      return play_voice<SlideStringPlayer<T>>(score, voice, options, recorder, done);
    case Instrument::kFretString:
      return play_voice<FretStringPlayer<T>>(score, voice, options, recorder, done);
    case Instrument::kFile:
      return play_voice<FilePlayer<T>>(score, voice, options, recorder, done);
  }
}

// The shapes of all modes of a body at its bridge or at an ear.
template <typename T>
ModeShapes<T> body_shapes(const std::vector<BodyMode>& modes, double BodyMode::*shape) {
  return ModeShapes<T>(each(modes, shape));
}

/// The keyboard of a score on its body, with the pedals, under the same calls as a plug-in makes.
template <typename T>
class KeyboardPlayer {
 public:
  KeyboardPlayer(const Score& score, const PlayOptions& options, Recorder& recorder)
      : score_(score),
        options_(options),
        recorder_(recorder),
        felts_(felts_of(score, options)),
        keyboard_(keyboard_of(score, felts_, options)),
        pedals_(score.pedals, {0, 0, 0}, options.sample_rate_hz) {
    keyboard_.set_soft_ratio(score.una_corda_stiffness_ratio);
    for (std::size_t v = 0; v < score.voices.size(); ++v)
      voices_.emplace_back(score.voices[v], options.only_voice.value_or(v) == v, options.sample_rate_hz);
  }

  void play(const PartDone& done) {
    std::array<T, kMaxSteady> left, right;
    for (std::size_t sample = 0; sample < recorder_.samples();) {
      if (sample >= reported_) done(std::exchange(reported_, sample + kMaxSteady));
      const std::size_t end = sample + std::min(recorder_.samples() - sample, take_events(sample));
      while (sample < end) {
        // While a hammer flies, its force is recorded in each sample.
        const bool flies = keyboard_.is_hammer_flying();
        const std::size_t samples = flies ? 1 : end - sample;
        keyboard_.process(std::span(left).first(samples), std::span(right).first(samples));
        for (std::size_t n = 0; n < samples; ++n, ++sample) record(sample, left[n], right[n]);
        if (flies)
          for (PlayedKey& played : voices_)
            recorder_.add_force(sample - 1, static_cast<double>(keyboard_.force(played.voice.key)), played.touches);
      }
    }
  }

 private:
  using Control = HammerStringControl;
  static constexpr std::size_t kMaxSteady = 4096;

  struct PlayedKey {
    PlayedKey(const Voice& of, bool is_struck, double sample_rate_hz)
        : voice(of),
          throws(is_struck),
          controls(of, sample_rate_hz),
          strikes(of.strikes, sample_rate_hz, &Strike::key_hold_s) {}

    const Voice& voice;
    bool throws;  // otherwise its damper moves without a blow
    ControlTrack controls;
    StrikeTrack strikes;
    int held = 0;  // notes
    bool touches = false;
  };

  using Felts = std::vector<std::vector<Segment<T>>>;

  // Of each key; empty where no voice plays it.
  static Felts felts_of(const Score& score, const PlayOptions& options) {
    Felts felts(score.keys.size());
    for (const Voice& voice : score.voices) {
      if (modes_of(voice.resonator, options.sample_rate_hz / 2).modes.empty()) refuse_rate(voice, options);
      felts[voice.key] = table_in<T>(voice.contact);
    }
    return felts;
  }

  static KeyboardOnBody<T> keyboard_of(const Score& score, const Felts& felts, const PlayOptions& options) {
    std::vector<KeyOnBody<T>> keys;
    for (std::size_t k = 0; k < felts.size(); ++k) {
      const auto& [strings, position_m, no_felt, hammer, damper] = score.keys[k];
      const auto& felt = felts[felts[k].empty() ? score.voices.front().key : k];  // any, where nothing is struck
      keys.push_back({strings, position_m, felt, {.hammer_mass_kg = static_cast<T>(hammer.hammer_mass_kg)}, damper});
    }
    const auto modes = body_modes(*score.body, options.sample_rate_hz / 2);
    if (modes.empty()) refuse_rate(score.body->name, options);
    const auto bridge = each(modes, &BodyMode::bridge_shape), left = each(modes, &BodyMode::left_shape),
               right = each(modes, &BodyMode::right_shape);
    const auto board = bare(modes);
    return KeyboardOnBody<T>(keys, {board, bridge, left, right}, options.sample_rate_hz);
  }

  // Returns the number of samples to the next event.
  std::size_t take_events(std::size_t sample) {
    std::size_t steady = kMaxSteady;
    move_pedals(pedals_.at(sample));
    for (std::size_t pedal = 0; pedal < positions_.size(); ++pedal)
      steady = std::min(steady, pedals_.steady_samples(sample, pedal, kBendStep));
    for (PlayedKey& played : voices_) {
      const auto values = played.controls.at(sample);
      keyboard_.bend(played.voice.key, values[Control::kBend]);
      keyboard_.damp(played.voice.key, static_cast<T>(values[Control::kDamping]));
      while (const auto* change = played.strikes.next_until(sample)) take(*change, played, values);
      steady = std::min({steady, played.controls.steady_samples(sample, Control::kDamping, kBendStep),
                         played.controls.steady_samples(sample, Control::kBend, kBendStep),
                         played.strikes.samples_to_next(sample)});
    }
    return steady;
  }

  void move_pedals(std::span<const double> positions) {
    for (std::size_t pedal = 0; pedal < positions_.size(); ++pedal) {
      const double to = positions[pedal];
      if (to == std::exchange(positions_[pedal], to)) continue;
      if (pedal == PedalControl::kSustain) keyboard_.sustain(to);
      if (pedal == PedalControl::kSostenuto) keyboard_.sostenuto(to >= 0.5);
      if (pedal == PedalControl::kUnaCorda) keyboard_.una_corda(to);
    }
  }

  void take(const StrikeTrack::Change& change, PlayedKey& played, std::span<const double> values) {
    const std::size_t key = played.voice.key;
    if (change.strike == nullptr) {
      if (--played.held == 0) keyboard_.release(key);
      return;
    }
    ++played.held;
    if (!played.throws || change.strike->speed_m_per_s == 0) return keyboard_.press(key);
    keyboard_.strike_at(key, values[Control::kPlace]);
    keyboard_.set_hammers(static_cast<T>(values[Control::kHammerMass] / score_.keys[key].hammer.hammer_mass_kg),
                          {static_cast<T>(values[Control::kStiffnessRatio]), static_cast<T>(values[Control::kLoss])});
    keyboard_.strike(key, static_cast<T>(change.strike->speed_m_per_s));
  }

  void record(std::size_t sample, T left, T right) {
    if (!is_bounded(double(left)) || !is_bounded(double(right)) || keyboard_.failures() > 0)
      refuse_infinite(score_, "keyboard", options_, sample);
    recorder_.add_sound(sample, static_cast<double>(left), static_cast<double>(right));
  }

  const Score& score_;
  const PlayOptions& options_;
  Recorder& recorder_;
  Felts felts_;
  KeyboardOnBody<T> keyboard_;
  ControlTrack pedals_;
  std::array<double, 3> positions_ = {};  // of the pedals
  std::vector<PlayedKey> voices_;
  std::size_t reported_ = 0;  // sample
};

/// What a sound is where a force drives a body: its velocity at both ears. The body moves no string.
template <typename T>
void drive_body(const Score& score, const PlayOptions& options, Performance& performance) {
  const auto modes = body_modes(*score.body, options.sample_rate_hz / 2);
  if (modes.empty()) refuse_rate(score.body->name, options);
  ModalBank<T> bank(bare(modes), options.sample_rate_hz);
  const auto bridge = body_shapes<T>(modes, &BodyMode::bridge_shape);
  const auto left = bank.sound_pickup(body_shapes<T>(modes, &BodyMode::left_shape));
  const auto right = bank.sound_pickup(body_shapes<T>(modes, &BodyMode::right_shape));
  for (std::size_t n = 0; n < performance.samples.size(); n += 2) {
    bank.predict();
    bank.push(bridge, static_cast<T>(performance.samples[n]));
    bank.commit();
    performance.samples[n] = static_cast<float>(bank.velocity(left));
    performance.samples[n + 1] = static_cast<float>(bank.velocity(right));
    if (!is_bounded(performance.samples[n]) || !is_bounded(performance.samples[n + 1]))
      refuse_infinite(score, "body", options, n / 2);
  }
}

}  // namespace

int channels_of(const Score& score) {
  if (score.body) return 2;
  return std::ranges::any_of(score.voices, [](const Voice& voice) { return voice.pan != 0; }) ? 2 : 1;
}

Signal best_signal(const Score& score) {
  if (score.body) return Signal::kBody;
  const auto is_string = [](const Voice& voice) { return std::holds_alternative<StiffString>(voice.resonator.body); };
  const bool has_bridge =
      score.instrument == Instrument::kHammerString && std::ranges::all_of(score.voices, is_string);
  return has_bridge ? Signal::kBridge : Signal::kVelocity;
}

Performance play(const Score& score, const PlayOptions& options, const Progress& progress) {
  const FlushDenormals flushed;
  Recorder recorder(score, options);
  const bool is_on_body = options.signal == Signal::kBody;
  if (is_on_body && !score.body)
    throw BadInput("--signal: body: the score has no body; allowed: displacement, velocity, bridge, force");
  if (is_on_body && score.instrument == Instrument::kHammerString) {
    const auto done = [&](std::size_t sample) {
      progress(static_cast<double>(sample) / static_cast<double>(recorder.samples()));
    };
    options.precision == Precision::kDouble ? KeyboardPlayer<double>(score, options, recorder).play(done)
                                            : KeyboardPlayer<float>(score, options, recorder).play(done);
    progress(1);
    return recorder.take();
  }
  const double total = static_cast<double>(recorder.samples() * score.voices.size());
  for (std::size_t v = 0; v < score.voices.size(); ++v) {
    if (options.only_voice.value_or(v) != v) continue;
    const auto done = [&](std::size_t sample) {
      progress(static_cast<double>(v * recorder.samples() + sample) / total);
    };
    if (options.precision == Precision::kDouble)
      play_in<double>(score, score.voices[v], options, recorder, done);
    else
      play_in<float>(score, score.voices[v], options, recorder, done);
  }
  progress(1);
  Performance performance = recorder.take();
  if (is_on_body)
    options.precision == Precision::kDouble ? drive_body<double>(score, options, performance)
                                            : drive_body<float>(score, options, performance);
  return performance;
}

}  // namespace contactspline
