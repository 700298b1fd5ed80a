// SPDX-License-Identifier: MIT
#include "generator/play.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "contactspline/flush_denormals.hpp"
#include "contactspline/fret_string.hpp"
#include "contactspline/hammer_string.hpp"
#include "contactspline/slide_string.hpp"
#include "generator/error.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kColumns = 1200;
constexpr double kThrowDistance = 1e-4;  // m before the string

std::size_t sample_at(double time_s, double sample_rate_hz) {
  return static_cast<std::size_t>(std::llround(time_s * sample_rate_hz));
}

/// The controls of a voice, sample by sample.
class ControlTrack {
 public:
  ControlTrack(const Voice& voice, double sample_rate_hz)
      : glides_(voice.glides), sample_rate_hz_(sample_rate_hz), values_(voice.initial), moves_(values_.size()) {}

  /// Values for a sample; to be asked for one after the other.
  std::span<const double> at(std::size_t sample) {
    for (; next_ < glides_.size() && sample_at(glides_[next_].time_s, sample_rate_hz_) <= sample; ++next_)
      begin(glides_[next_], sample);
    for (std::size_t i = 0; i < moves_.size(); ++i)
      if (moves_[i].is_under_way) values_[i] = advance(moves_[i], sample);
    return values_;
  }

 private:
  struct Move {
    bool is_under_way = false;
    std::size_t begin, length;
    double from, to;
  };

  void begin(const Glide& glide, std::size_t sample) {
    moves_[glide.control] = {true, sample, sample_at(glide.over_s, sample_rate_hz_), values_[glide.control],
                             glide.to};
  }

  // Eases in and out, so that neither place nor speed jumps.
  static double advance(Move& move, std::size_t sample) {
    move.is_under_way = sample < move.begin + move.length;
    if (!move.is_under_way) return move.to;
    const double part = static_cast<double>(sample - move.begin) / static_cast<double>(move.length);
    return move.from + (move.to - move.from) * part * part * (3 - 2 * part);
  }

  std::span<const Glide> glides_;
  double sample_rate_hz_;
  std::vector<double> values_;
  std::vector<Move> moves_;
  std::size_t next_ = 0;
};

template <typename T>
std::vector<Segment<T>> table_in(const std::vector<Segment<double>>& table) {
  std::vector<Segment<T>> cast;
  for (const auto& s : table)
    cast.push_back({static_cast<T>(s.knot), static_cast<T>(s.energy), static_cast<T>(s.force),
                    static_cast<T>(s.half_curvature)});
  return cast;
}

std::vector<Mode> bare(const std::vector<ResonatorMode>& modes) {
  std::vector<Mode> bare;
  for (const auto& mode : modes) bare.push_back(mode.mode);
  return bare;
}

std::vector<double> each(const std::vector<ResonatorMode>& modes, double ResonatorMode::*member) {
  std::vector<double> values;
  for (const auto& mode : modes) values.push_back(mode.*member);
  return values;
}

template <typename T>
ModeShapes<T> shapes_in(const std::vector<double>& values) {
  return ModeShapes<T>(std::span<const double>(values));
}

std::vector<double> bridge_shapes(const Voice& voice, const std::vector<ResonatorMode>& modes) {
  const auto* string = std::get_if<StiffString>(&voice.resonator.body);
  if (string == nullptr)
    throw BadInput(
        fmt::format("--signal: bridge: {} has none; allowed: displacement, velocity, force", voice.resonator.name));
  std::vector<double> shapes;
  for (const auto& mode : modes) shapes.push_back(voice.strings * bridge_shape(*string, mode.wavenumber_per_m));
  return shapes;
}

/// What every instrument is built of, in the precision of its model.
template <typename T>
struct Parts {
  Parts(const Voice& voice, const PlayOptions& options)
      : set(modes_of(voice.resonator, options.sample_rate_hz / 2)),
        modes(bare(set.modes)),
        heard(options.signal == Signal::kBridge ? bridge_shapes(voice, set.modes)
                                                : each(set.modes, &ResonatorMode::pickup_shape)),
        contact(table_in<T>(voice.contact)) {
    if (modes.empty())
      throw BadInput(fmt::format("--rate: no mode of {} lies below {} Hz; allowed: a higher rate",
                                 voice.resonator.name, options.sample_rate_hz / 2));
  }

  [[nodiscard]] SegmentTable<T> table() const { return contact; }
  [[nodiscard]] ModeShapes<T> strike() const { return shapes_in<T>(each(set.modes, &ResonatorMode::strike_shape)); }
  [[nodiscard]] StringShapes<T> shapes() const {
    return StringShapes<T>(each(set.modes, &ResonatorMode::wavenumber_per_m));
  }

  ModeSet set;
  std::vector<Mode> modes;
  std::vector<double> heard;  ///< shapes at the pickup or the bridge
  std::vector<Segment<T>> contact;
};

/// When the damper is up: while any note is held.
class Damper {
 public:
  Damper(std::span<const Strike> strikes, double sample_rate_hz) {
    for (const Strike& strike : strikes) {
      changes_.push_back({sample_at(strike.time_s, sample_rate_hz), 1});
      if (std::isfinite(strike.hold_s))
        changes_.push_back({sample_at(strike.time_s + strike.hold_s, sample_rate_hz), -1});
    }
    std::ranges::stable_sort(changes_, {}, &Change::sample);
  }

  [[nodiscard]] bool is_up(std::size_t sample) {
    for (; next_ < changes_.size() && changes_[next_].sample <= sample; ++next_) held_ += changes_[next_].held;
    return held_ > 0;
  }

 private:
  struct Change {
    std::size_t sample;
    int held;
  };
  std::vector<Change> changes_;
  std::size_t next_ = 0;
  int held_ = 0;
};

template <typename T>
class HammerStringPlayer {
 public:
  HammerStringPlayer(const Voice& voice, const PlayOptions& options)
      : voice_(voice),
        sample_rate_hz_(options.sample_rate_hz),
        parts_(voice, options),
        place_m_(voice.resonator.strike.position_m),
        damper_(voice.strikes, options.sample_rate_hz),
        model_(parts_.table(), parts_.modes, parts_.strike(), options.sample_rate_hz) {}

  void tick(std::size_t sample, std::span<const double> values) {
    using Control = HammerStringControl;
    for (; next_ < voice_.strikes.size() && sample_at(voice_.strikes[next_].time_s, sample_rate_hz_) <= sample;
         ++next_)
      strike(voice_.strikes[next_].speed_m_per_s, values[Control::kPlace]);
    const double damping = values[Control::kDamping] + (damper_.is_up(sample) ? 0 : voice_.damper_per_s);
    model_.tick({.hammer_mass_kg = static_cast<T>(values[Control::kHammerMass]),
                 .felt = {static_cast<T>(values[Control::kStiffnessRatio]), static_cast<T>(values[Control::kLoss])},
                 .damping_per_s = static_cast<T>(damping)});
  }

  [[nodiscard]] ModeShapes<T> heard() const { return shapes_in<T>(parts_.heard); }
  [[nodiscard]] const auto& model() const { return model_; }

 private:
  void strike(double speed_m_per_s, double place_m) {
    if (place_m != place_m_) {
      Resonator moved = voice_.resonator;
      moved.strike.position_m = place_m_ = place_m;
      const auto modes = modes_of(moved, sample_rate_hz_ / 2).modes;
      model_.strike_at(shapes_in<T>(each(modes, &ResonatorMode::strike_shape)));
    }
    model_.strike(static_cast<T>(speed_m_per_s), static_cast<T>(kThrowDistance));
  }

  const Voice& voice_;
  double sample_rate_hz_;
  Parts<T> parts_;
  double place_m_;
  Damper damper_;
  HammerString<T> model_;
  std::size_t next_ = 0;
};

template <typename T>
class SlideStringPlayer {
 public:
  SlideStringPlayer(const Voice& voice, const PlayOptions& options)
      : sample_rate_hz_(options.sample_rate_hz),
        length_m_(std::get<StiffString>(voice.resonator.body).length_m),
        parts_(voice, options),
        model_(parts_.table(), parts_.modes, parts_.shapes(), static_cast<T>(voice.pluck_m), options.sample_rate_hz) {
    model_.place(static_cast<T>(voice.initial[Control::kPlace]), static_cast<T>(voice.height_m));
  }

  void tick(std::size_t, std::span<const double> values) {
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

  [[nodiscard]] ModeShapes<T> heard() const { return shapes_in<T>(parts_.heard); }
  [[nodiscard]] const auto& model() const { return model_; }

 private:
  using Control = SlideStringControl;

  double place(std::span<const double> values) {
    turns_ += values[Control::kVibratoRate] / sample_rate_hz_;
    turns_ -= std::floor(turns_);
    const double swing = values[Control::kVibratoDepth] * std::sin(2 * std::numbers::pi * turns_);
    return std::clamp(values[Control::kPlace] + swing, 0.0, length_m_);
  }

  double sample_rate_hz_;
  double length_m_;
  Parts<T> parts_;
  SlideString<T> model_;
  double turns_ = 0;
};

template <typename T>
class FretStringPlayer {
 public:
  FretStringPlayer(const Voice& voice, const PlayOptions& options)
      : parts_(voice, options),
        model_(parts_.table(), parts_.modes, parts_.shapes(), static_cast<T>(voice.pluck_m), options.sample_rate_hz) {
    model_.place(static_cast<T>(voice.initial[Control::kPlace]), static_cast<T>(voice.initial[Control::kGap]));
  }

  void tick(std::size_t, std::span<const double> values) {
    const auto value = [&](std::size_t control) { return static_cast<T>(values[control]); };
    model_.tick({.place_m = value(Control::kPlace),
                 .gap_m = value(Control::kGap),
                 .pluck_force_n = value(Control::kPluckForce),
                 .damping_per_s = value(Control::kDamping),
                 .contact = {value(Control::kStiffnessRatio), value(Control::kLoss)}});
  }

  [[nodiscard]] ModeShapes<T> heard() const { return shapes_in<T>(parts_.heard); }
  [[nodiscard]] const auto& model() const { return model_; }

 private:
  using Control = FretStringControl;
  Parts<T> parts_;
  FretString<T> model_;
};

/// Gathers what the voices play.
class Recorder {
 public:
  Recorder(const Score& score, const PlayOptions& options)
      : samples_(sample_at(score.duration_s, options.sample_rate_hz)),
        stretch_(std::max<std::size_t>(1, (samples_ + kColumns - 1) / kColumns)) {
    const bool panned = std::ranges::any_of(score.voices, [](const Voice& voice) { return voice.pan != 0; });
    performance_ = {options.sample_rate_hz, panned ? 2 : 1, {}, {}, 0, 0};
    performance_.samples.resize(samples_ * static_cast<std::size_t>(performance_.channels));
    performance_.force_n.resize((samples_ + stretch_ - 1) / stretch_);
  }

  void begin(const Voice& voice) {
    const double angle = (voice.pan + 1) * std::numbers::pi / 4;  // equal power
    strings_ = voice.strings;
    left_ = performance_.channels == 1 ? 1 : std::cos(angle);
    right_ = std::sin(angle);
    touches_ = false;
  }

  void add(std::size_t sample, double value, double force_on_one) {
    const double force = strings_ * force_on_one;
    if (performance_.channels == 1) {
      performance_.samples[sample] += static_cast<float>(value);
    } else {
      performance_.samples[2 * sample] += static_cast<float>(left_ * value);
      performance_.samples[2 * sample + 1] += static_cast<float>(right_ * value);
    }
    float& largest = performance_.force_n[sample / stretch_];
    largest = std::max(largest, static_cast<float>(force));
    performance_.largest_force_n = std::max(performance_.largest_force_n, force);
    performance_.contacts += force > 0 && !touches_;
    touches_ = force > 0;
  }

  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] Performance&& take() { return std::move(performance_); }

 private:
  std::size_t samples_, stretch_;
  Performance performance_;
  double strings_ = 1, left_ = 1, right_ = 1;
  bool touches_ = false;
};

template <typename Model, typename Shapes>
double signal_of(const Model& model, const Shapes& heard, Signal signal) {
  if (signal == Signal::kForce) return model.force();
  return signal == Signal::kVelocity ? model.string().velocity(heard) : model.string().displacement(heard);
}

using PartDone = std::function<void(std::size_t)>;

template <typename Player>
void play_voice(const Voice& voice, const PlayOptions& options, Recorder& recorder, const PartDone& done) {
  ControlTrack controls(voice, options.sample_rate_hz);
  Player player(voice, options);
  const auto heard = player.heard();
  recorder.begin(voice);
  for (std::size_t i = 0; i < recorder.samples(); ++i) {
    done(i);
    player.tick(i, controls.at(i));
    recorder.add(i, signal_of(player.model(), heard, options.signal), player.model().force());
  }
}

template <typename T>
void play_in(Instrument instrument, const Voice& voice, const PlayOptions& options, Recorder& recorder,
             const PartDone& done) {
  switch (instrument) {
    case Instrument::kHammerString:
      return play_voice<HammerStringPlayer<T>>(voice, options, recorder, done);
    case Instrument::kSlideString:
      return play_voice<SlideStringPlayer<T>>(voice, options, recorder, done);
    case Instrument::kFretString:
      return play_voice<FretStringPlayer<T>>(voice, options, recorder, done);
  }
}

}  // namespace

Signal best_signal(const Score& score) {
  const auto is_string = [](const Voice& voice) { return std::holds_alternative<StiffString>(voice.resonator.body); };
  const bool has_bridge =
      score.instrument == Instrument::kHammerString && std::ranges::all_of(score.voices, is_string);
  return has_bridge ? Signal::kBridge : Signal::kVelocity;
}

Performance play(const Score& score, const PlayOptions& options, const Progress& progress) {
  const FlushDenormals flushed;
  Recorder recorder(score, options);
  const std::size_t total = recorder.samples() * score.voices.size();
  const std::size_t block = std::max<std::size_t>(1, total / 100);
  for (std::size_t v = 0; v < score.voices.size(); ++v) {
    const auto done = [&](std::size_t sample) {
      const std::size_t all = v * recorder.samples() + sample;
      if (all % block == 0) progress(static_cast<double>(all) / static_cast<double>(total));
    };
    if (options.precision == Precision::kDouble)
      play_in<double>(score.instrument, score.voices[v], options, recorder, done);
    else
      play_in<float>(score.instrument, score.voices[v], options, recorder, done);
  }
  progress(1);
  return recorder.take();
}

}  // namespace contactspline
