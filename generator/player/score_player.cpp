// SPDX-License-Identifier: MIT
#include "generator/player/score_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include "contactspline/host/engine.hpp"
#include "contactspline/midi/key_tuning.hpp"
#include "contactspline/step/flush_denormals.hpp"
#include "contactspline/step/half_band.hpp"
#include "generator/player/instrument_maker.hpp"
#include "generator/player/instrument_parts.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kColumns = 1200;
constexpr std::size_t kBlock = 4096, kMaxSteady = 1024;  // samples

// May a sample be a part of a sound? All voices together must fit single precision, in which sounds are stored.
bool is_bounded(double sample) {
  return std::abs(sample) < 1e30;
}

template <typename T>
double largest_of(std::span<const T> samples) {
  T largest = 0;
  for (const T sample : samples) largest = std::max(largest, std::abs(sample));
  return double(largest);
}

// Where a sound stops being finite, it says so: in a sum of voices, or in a figure, nobody could tell what it was.
[[noreturn]] void refuse_infinite(const Score& score, const std::string& what, const PlayOptions& options,
                                  std::size_t sample) {
  refuse(
      score.file, what,
      fmt::format("its sound is not finite from {:.6g} s on", static_cast<double>(sample) / options.sample_rate_hz),
      "a material, a resonator and controls that single or double precision can hold");
}

/// Gathers what the voices play.
class Recorder {
 public:
  Recorder(const Score& score, const PlayOptions& options)
      : least_(sample_at(score.duration_s, options.sample_rate_hz)),
        samples_(sample_at(score.duration_s + options.max_ring_s, options.sample_rate_hz)),
        stretch_(std::max<std::size_t>(1, (least_ + kColumns - 1) / kColumns)),
        has_sides_(options.right_output) {
    performance_ = {options.sample_rate_hz, channels_of(score, options), {}, {}, 0, 0};
    performance_.samples.resize(samples_ * static_cast<std::size_t>(performance_.channels));
    performance_.force_n.resize((samples_ + stretch_ - 1) / stretch_);
  }

  void begin(const Voice& voice) {
    const double angle = (voice.pan + 1) * std::numbers::pi / 4;  // equal power
    strings_ = voice.strings;
    const double in_the_middle = has_sides_ ? std::numbers::sqrt2 : 1;
    left_ = performance_.channels == 1 ? 1 : in_the_middle * std::cos(angle);
    right_ = in_the_middle * std::sin(angle);
    end_contact();
  }

  /// A block of a voice: what is on both sides and the contact force, of every sample.
  template <typename T>
  void add(std::size_t begin, std::span<const T> left, std::span<const T> right, std::span<const T> force) {
    for (std::size_t n = 0; n < left.size(); ++n) {
      add_sound(begin + n, left_ * double(left[n]), right_ * double(right[n]));
      add_force(begin + n, strings_ * double(force[n]));
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

  /// A contact begins where the force of the voice was 0.
  void add_force(std::size_t sample, double force_n) {
    note_force(sample, force_n);
    if (!(force_n > 0)) return end_contact();
    performance_.contacts += contact_samples_ == 0;
    performance_.contact_s += 1 / performance_.sample_rate_hz;
    ++contact_samples_;
    contact_impulse_ += force_n;
  }
  void note_force(std::size_t sample, double force_n) {
    float& largest = performance_.force_n[sample / stretch_];
    largest = std::max(largest, static_cast<float>(force_n));
    performance_.largest_force_n = std::max(performance_.largest_force_n, force_n);
  }
  void count_contacts(std::size_t contacts) { performance_.contacts += contacts; }

  /// Samples of the score, and at most of its sound.
  [[nodiscard]] std::size_t least() const { return least_; }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  /// A part has ended there; the last one ends the sound.
  void end_at(std::size_t sample) { end_ = std::max(end_, sample); }
  [[nodiscard]] Performance&& take() {
    end_contact();
    if (impulse_ > 0) performance_.mean_contact_s = impulse_samples_ / impulse_ / performance_.sample_rate_hz;
    performance_.samples.resize(end_ * static_cast<std::size_t>(performance_.channels));
    performance_.force_n.resize((end_ + stretch_ - 1) / stretch_);
    return std::move(performance_);
  }

 private:
  void end_contact() {
    impulse_ += contact_impulse_;
    impulse_samples_ += contact_impulse_ * static_cast<double>(contact_samples_);
    contact_samples_ = 0;
    contact_impulse_ = 0;
  }

  std::size_t least_, samples_, stretch_, end_ = least_;
  bool has_sides_;  // which a pan of 0 leaves as they are
  Performance performance_;
  double strings_ = 1, left_ = 1, right_ = 1;
  std::size_t contact_samples_ = 0;                                 // of the contact that lasts
  double contact_impulse_ = 0, impulse_ = 0, impulse_samples_ = 0;  // sums of forces; the last one times samples
};

using PartDone = std::function<void(std::size_t)>;

/// Plays the events of one voice on a part: an instrument, or a key of a keyboard. A part has parameters(), set(),
/// strike() and release().
template <typename Part>
class VoicePlayer {
 public:
  /// hold: a member of Strike, after which the part is released.
  VoicePlayer(Part& part, const Voice& voice, double sample_rate_hz, double Strike::*hold = &Strike::hold_s)
      : part_(part),
        parameters_(part.parameters()),
        controls_(voice, sample_rate_hz),
        strikes_(voice.strikes, sample_rate_hz, hold),
        notes_(voice.notes, sample_rate_hz),
        held_(1 + count_strikes(part)),
        bend_cents_(voice.bend_cents),
        is_tuned_(std::ranges::any_of(voice.notes, [](const Note& note) { return note.cents != 0; })) {}

  /// Takes what happens up to a sample. Returns the number of samples from there in which nothing happens.
  std::size_t take_events(std::size_t sample) {
    const auto values = controls_.at(sample);
    for (std::size_t i = 0; i < values.size(); ++i)
      part_.set(i, i == HammerStringParameter::kBend ? values[i] + bend_cents_ : values[i]);
    while (const auto* change = strikes_.next_until(sample)) take(*change);
    while (const auto* change = notes_.next_until(sample)) take(*change);
    std::size_t steady = std::min(strikes_.samples_to_next(sample), notes_.samples_to_next(sample));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (parameters_[i].acts == Acts::kAtOnce)
        steady = std::min(steady, controls_.steady_samples(sample, i, parameters_[i].step_samples));
    return steady;
  }

  /// Has something been struck since the last call?
  [[nodiscard]] bool is_struck() { return std::exchange(is_struck_, false); }

 private:
  using T = typename Part::value_type;

  static std::size_t count_strikes(const Part& part) {
    return static_cast<std::size_t>(std::ranges::count(part.events(), EventKind::kStrike, &Event::kind));
  }

  // A strike or a key that several notes hold is released by the last one.
  void take(const StrikeTrack::Change& change) {
    if (change.is_end) {
      if (--held_[change.strike->strike] == 0) release(*change.strike);
      return;
    }
    ++held_[change.strike->strike];
    is_struck_ = true;
    part_.strike(change.strike->strike, static_cast<T>(change.strike->speed_m_per_s));
  }

  void release(const Strike& strike) {
    if constexpr (requires { part_.release(strike.strike, strike.release); })
      part_.release(strike.strike, strike.release);
    else
      part_.release(strike.strike);
  }

  void take(const NoteTrack::Change& change) {
    if constexpr (Instrument<Part>) {
      int& held = held_keys_[static_cast<std::size_t>(change.strike->key)];
      if (change.is_end) {
        if (--held == 0) part_.note_off(change.strike->key);
        return;
      }
      ++held;
      is_struck_ = true;
      if (is_tuned_)
        part_.play({0, Action::kBendKey, static_cast<std::size_t>(change.strike->key), change.strike->cents});
      part_.note_on(change.strike->key, change.strike->velocity);
    }
  }

  Part& part_;
  std::span<const Parameter> parameters_;
  ControlTrack controls_;
  StrikeTrack strikes_;
  NoteTrack notes_;
  std::vector<int> held_;                   // notes that hold each strike
  std::array<int, kMidiKeys> held_keys_{};  // and each key
  double bend_cents_;                       // 0 but for a key of a keyboard
  bool is_tuned_;                           // are there notes beside the pitches of their keys?
  bool is_struck_ = false;
};

/// Says when a part has rung out: behind the score it was 60 dB below its peak for a while.
class RingOut {
 public:
  RingOut(std::size_t least, double sample_rate_hz) : least_(least), wait_(sample_at(0.1, sample_rate_hz)) {}

  /// The largest sample of a block, and where it ends.
  void hear(double largest, std::size_t end) {
    peak_ = std::max(peak_, largest);
    if (largest > 1e-3 * peak_) last_ = end;
  }
  [[nodiscard]] bool is_over(std::size_t sample) const { return sample >= least_ && sample >= last_ + wait_; }

 private:
  std::size_t least_, wait_, last_ = 0;
  double peak_ = 0;
};

/// When all that sounds stops.
class SilenceTrack {
 public:
  SilenceTrack(const Score& score, double sample_rate_hz) {
    for (const double time_s : score.silences_s) samples_.push_back(sample_at(time_s, sample_rate_hz));
  }

  /// Brings an instrument to rest where it is time. Returns the number of samples to the next silence.
  template <typename T>
  std::size_t take(AnyInstrument<T>& instrument, std::size_t sample) {
    for (; next_ < samples_.size() && samples_[next_] <= sample; ++next_) instrument.reset();
    return next_ < samples_.size() ? samples_[next_] - sample : std::numeric_limits<std::size_t>::max();
  }

 private:
  std::vector<std::size_t> samples_;
  std::size_t next_ = 0;
};

/// Skips an instrument that is silent until its next strike.
class Sleep {
 public:
  explicit Sleep(bool sleeps) : sleeps_(sleeps) {}

  /// Called before each block. Is the block silent?
  [[nodiscard]] bool skips(bool is_struck, std::size_t samples) {
    if (!sleeps_) return false;
    if (is_struck) is_asleep_ = false;
    processed_ += samples;
    return is_asleep_;
  }

  // A file is scaled to its peak, so silence is relative to the largest energy of the voice: 120 dB below.
  template <typename I>
  void look_at(const I& instrument) {
    if (processed_ < kMaxSteady) return;
    processed_ = 0;
    max_energy_j_ = std::max(max_energy_j_, instrument.books().string_j);
    is_asleep_ = instrument.is_silent(1e-12 * max_energy_j_);
  }

 private:
  bool sleeps_;
  bool is_asleep_ = true;  // until the next strike
  double max_energy_j_ = 0;
  std::size_t processed_ = 0;  // samples since the last look
};

/// Plays one voice on an instrument of its own, block by block.
template <typename T>
void play_voice(AnyInstrument<T>& instrument, const Score& score, const Voice& voice, const PlayOptions& options,
                Recorder& recorder, const PartDone& done) {
  std::vector<T> sound(kBlock), on_right(kBlock), force(kBlock);
  const std::size_t right = options.right_output.value_or(options.output);
  std::vector<std::span<T>> outputs(std::max(options.output, right) + 1);
  instrument.prepare(options.sample_rate_hz);
  VoicePlayer<AnyInstrument<T>> player(instrument, voice, options.sample_rate_hz);
  Sleep sleep(instrument.sleeps());
  SilenceTrack silences(score, options.sample_rate_hz);
  recorder.begin(voice);
  RingOut ring(recorder.least(), options.sample_rate_hz);
  std::size_t begin = 0;
  while (begin < recorder.samples() && !ring.is_over(begin)) {
    if (begin % kBlock == 0) done(begin);
    const std::size_t end = std::min(recorder.samples(), (begin / kBlock + 1) * kBlock);
    const std::size_t to_silence = silences.take(instrument, begin);
    const std::size_t samples = std::min({end - begin, to_silence, player.take_events(begin), kMaxSteady});
    const auto sound_block = std::span(sound).first(samples), force_block = std::span(force).first(samples);
    const auto right_block = options.right_output ? std::span(on_right).first(samples) : sound_block;
    if (sleep.skips(player.is_struck(), samples)) {
      for (const auto& block : {sound_block, right_block, force_block}) std::ranges::fill(block, T(0));
    } else {
      outputs[options.output] = sound_block;
      outputs[right] = right_block;
      instrument.process(outputs, force_block);
      sleep.look_at(instrument);
    }
    for (std::size_t n = 0; n < samples; ++n)
      if (!is_bounded(double(sound_block[n])) || !is_bounded(double(right_block[n])) ||
          !is_bounded(double(force_block[n])))
        refuse_infinite(score, "voice " + voice.name, options, begin + n);
    recorder.add<T>(begin, sound_block, right_block, force_block);
    begin += samples;
    ring.hear(std::max(largest_of<T>(sound_block), largest_of<T>(right_block)), begin);
  }
  recorder.end_at(begin);
}

/// A key of a keyboard as a part of its own, with the parameters of a hammer-string.
template <typename T>
class KeyPart {
 public:
  using value_type = T;
  using Control = HammerStringParameter;

  /// is_played: otherwise its damper moves without a blow.
  KeyPart(AnyInstrument<T>& keyboard, const Score& score, const Voice& voice, bool is_played)
      : keyboard_(keyboard),
        key_(voice.key),
        whole_mass_kg_(score.keys[voice.key].hammer_mass_kg),
        is_played_(is_played) {}

  // A key's damping is that of all its strings, which are advanced side by side.
  static std::span<const Parameter> parameters() {
    static constexpr auto kList = [] {
      auto list = Control::kList;
      list[Control::kDamping].step_samples = 16;
      return list;
    }();
    return kList;
  }
  static std::span<const Event> events() { return Control::kEvents; }

  void set(std::size_t parameter, double value) {
    values_[parameter] = value;
    if (parameter == Control::kDamping) keyboard_.play({0, Action::kDampKey, key_, value});
    if (parameter == Control::kBend) keyboard_.play({0, Action::kBendKey, key_, value});
  }

  void strike(std::size_t, T speed_m_per_s) {
    if (!is_played_ || speed_m_per_s == 0) return keyboard_.strike(key_, T(0));
    keyboard_.play({0, Action::kPlaceKey, key_, values_[Control::kPlace]});
    keyboard_.set(KeyboardParameter::kMassRatio, values_[Control::kHammerMass] / whole_mass_kg_);
    keyboard_.set(KeyboardParameter::kHardness, values_[Control::kStiffnessRatio]);
    keyboard_.set(KeyboardParameter::kLoss, values_[Control::kLoss]);
    keyboard_.strike(key_, speed_m_per_s);
  }
  void release(std::size_t, double velocity) { keyboard_.play({0, Action::kNoteOff, key_, velocity}); }

 private:
  AnyInstrument<T>& keyboard_;
  std::size_t key_;
  double whole_mass_kg_;
  bool is_played_;
  std::array<double, Control::kParameters> values_{};
};

/// Plays all voices on the keys of one keyboard, with its pedals, under the same calls as a plug-in makes.
template <typename T>
void play_keyboard(const Score& score, const PlayOptions& options, Recorder& recorder, const PartDone& done) {
  const Handle<T> keyboard = Engine<T>::keyboard(std::make_shared<const KeyboardParts>(keyboard_parts(score)));
  keyboard->prepare(options.sample_rate_hz);
  const std::vector<double> pedals_up(KeyboardParameter::kParameters);
  ControlTrack pedals(score.pedals, pedals_up, options.sample_rate_hz);
  std::vector<KeyPart<T>> parts;
  parts.reserve(score.voices.size());
  std::vector<VoicePlayer<KeyPart<T>>> players;
  for (std::size_t v = 0; v < score.voices.size(); ++v) {
    parts.emplace_back(*keyboard, score, score.voices[v], options.only_voice.value_or(v) == v);
    players.emplace_back(parts.back(), score.voices[v], options.sample_rate_hz, &Strike::key_hold_s);
  }
  SilenceTrack silences(score, options.sample_rate_hz);
  std::array<T, kBlock> left, right, force;
  RingOut ring(recorder.least(), options.sample_rate_hz);
  std::size_t sample = 0, reported = 0;
  while (sample < recorder.samples() && !ring.is_over(sample)) {
    if (sample >= reported) done(std::exchange(reported, sample + kBlock));
    std::size_t samples = std::min({recorder.samples() - sample, kBlock, silences.take(*keyboard, sample)});
    const auto positions = pedals.at(sample);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (!is_pedal(i)) continue;
      keyboard->set(i, positions[i]);
      samples = std::min(samples, pedals.steady_samples(sample, i, KeyboardParameter::kList[i].step_samples));
    }
    for (auto& player : players) samples = std::min(samples, player.take_events(sample));
    const std::array ears = {std::span(left).first(samples), std::span(right).first(samples)};
    keyboard->process(ears, std::span(force).first(samples));
    const bool has_failed = keyboard->books().failures > 0;
    for (std::size_t n = 0; n < samples; ++n, ++sample) {
      if (!is_bounded(double(left[n])) || !is_bounded(double(right[n])) || has_failed)
        refuse_infinite(score, "keyboard", options, sample);
      recorder.add_sound(sample, double(left[n]), double(right[n]));
      recorder.note_force(sample, double(force[n]));
    }
    ring.hear(std::max(largest_of<T>(ears[0]), largest_of<T>(ears[1])), sample);
  }
  recorder.end_at(sample);
  recorder.count_contacts(keyboard->books().contacts);
}

template <typename T>
Performance play_in(const Score& score, PlayOptions options, const Progress& progress) {
  Recorder recorder(score, options);
  if (options.is_on_body) {
    for (const Voice& voice : score.voices) (void)resonator_parts(voice, options.sample_rate_hz);  // has it modes?
    play_keyboard<T>(score, options, recorder, [&](std::size_t sample) {
      progress(static_cast<double>(sample) / static_cast<double>(recorder.samples()));
    });
    progress(1);
    return recorder.take();
  }
  const double total = static_cast<double>(recorder.samples() * score.voices.size());
  for (std::size_t v = 0; v < score.voices.size(); ++v) {
    if (options.only_voice.value_or(v) != v) continue;
    const auto instrument = maker_of_voice(score.voices[v]).template make<T>(options.sample_rate_hz);
    play_voice(*instrument, score, score.voices[v], options, recorder,
               [&](std::size_t sample) { progress(static_cast<double>(v * recorder.samples() + sample) / total); });
  }
  progress(1);
  return recorder.take();
}

// A performance at so many times the rate, without the delay of the filter.
Performance decimated(Performance performance, int factor) {
  if (factor == 1) return performance;
  const auto channels = static_cast<std::size_t>(performance.channels);
  std::vector<float> samples;
  for (std::size_t channel = 0; channel < channels; ++channel) {
    std::vector<double> high;
    for (std::size_t n = channel; n < performance.samples.size(); n += channels)
      high.push_back(performance.samples[n]);
    const std::vector<double> low = contactspline::decimated(high, factor);
    samples.resize(low.size() * channels);
    for (std::size_t n = 0; n < low.size(); ++n) samples[n * channels + channel] = static_cast<float>(low[n]);
  }
  performance.samples = std::move(samples);
  performance.sample_rate_hz /= factor;
  return performance;
}

}  // namespace

int channels_of(const Score& score, const PlayOptions& options) {
  if (score.body || options.right_output) return 2;
  return std::ranges::any_of(score.voices, [](const Voice& voice) { return voice.pan != 0; }) ? 2 : 1;
}

std::vector<Output> outputs_of(const Score& score) {
  const InstrumentModel* model = model_of(score);
  if (model == nullptr) return {StringOutput::kList.begin(), StringOutput::kList.end()};
  std::vector<Output> outputs;
  for (const ModelOutput& output : model->outputs)
    outputs.push_back({output.name.c_str(), unit_of(output.name).data(), output.full_scale});
  return outputs;
}

void choose_best_output(const Score& score, PlayOptions& options) {
  options.is_on_body = score.body.has_value();
  if (model_of(score) == nullptr) {
    if (!options.is_on_body) options.output = StringOutput::kBridge;
    return;
  }
  const std::vector<Output> outputs = outputs_of(score);
  const Sides sides = sides_of(outputs, 0);
  if (sides.left == sides.right) return;
  options.output = sides.left;
  options.right_output = sides.right;
}

Output sounding_output(const Score& score, const PlayOptions& options) {
  Output output = outputs_of(score)[options.output];
  if (options.right_output) output.name += Sides::kLeft.size();
  return output;
}

Performance play(const Score& score, const PlayOptions& options, const Progress& progress) {
  const FlushDenormals flushed;
  if (options.is_on_body && !score.body)
    throw BadInput("--signal: body: the score has no body; allowed: displacement, velocity, bridge, force");
  PlayOptions finer = options;
  finer.sample_rate_hz *= options.oversampling;
  return decimated(options.precision == Precision::kDouble ? play_in<double>(score, finer, progress)
                                                           : play_in<float>(score, finer, progress),
                   options.oversampling);
}

std::vector<double> decimated(std::span<const double> samples, int factor) {
  Decimator<double> decimator(factor);
  const std::size_t length = (samples.size() + std::size_t(factor) - 1) / std::size_t(factor) + decimator.delay();
  std::vector<double> high(samples.begin(), samples.end()), low(length);
  high.resize(length * decimator.factor());
  decimator.process(high, low);
  low.erase(low.begin(), low.begin() + std::ptrdiff_t(decimator.delay()));
  return low;
}

}  // namespace contactspline
