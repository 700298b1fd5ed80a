// SPDX-License-Identifier: MIT
// An instrument as a plug-in of the DISTRHO Plugin Framework, which makes CLAP, VST3 and LV2 of it.
#pragma once

#include <DistrhoPlugin.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <concepts>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <mutex>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "contactspline/host/oversampled.hpp"
#include "contactspline/host/replaceable.hpp"
#include "contactspline/midi/midi_meaning.hpp"
#include "contactspline/midi/midi_message.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/flush_denormals.hpp"
#include "contactspline/step/version.hpp"
#include "macros.hpp"
#include "plugin_tuning.hpp"
#include "watched_file.hpp"
#include "windowed_plugin.hpp"

namespace contactspline {

namespace detail {

/// A base that is there before the framework's class, which asks how many parameters and programs there are.
template <std::floating_point T>
struct PluginInstrument {
  explicit PluginInstrument(std::unique_ptr<Replaceable<T>> instrument)
      : replaceable(*instrument), hosted(std::move(instrument)) {
    const auto parameters = hosted.instrument().parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p)
      if (parameters[p].slider.min < parameters[p].slider.max) numbers.push_back(p);
    macros = macros_of(parameters, hosted.instrument().events(), numbers);
  }

  Replaceable<T>& replaceable;  // which `hosted` owns
  Hosted<T> hosted;
  std::vector<std::size_t> numbers;  // of the parameters that can move, which are those that hosts see
  std::vector<MacroOf> macros;
};

}  // namespace detail

/// The plug-in of an instrument. Parameters and programs are its parameters and presets, in units for people
/// (label_of); a volume, macros (macros.hpp) and the tuning are behind them. Without presets one program sets all
/// parameters to their first values. Left and right are the outputs whose names begin with left_ and right_; without
/// them the first output is on both sides. Behind the tuning stand what hosts can only read: the peak of each output,
/// in its unit, which falls within 0.3 s. The last two are the oversampling, whose change a thread of its own
/// prepares and the instrument takes while it sounds, and the latency, to read. That thread also watches the
/// instrument's file (watched_file.hpp); without one it sleeps. While a window watches, it tells it what the contacts
/// do. An audio input, of an instrument that has one, pushes its body.
template <std::floating_point T>
class InstrumentPlugin : private detail::PluginInstrument<T>, public WindowedPlugin {
 public:
  using Make = Handle<T>();

  explicit InstrumentPlugin(Make* make)
      : detail::PluginInstrument<T>(std::make_unique<Replaceable<T>>(make())),
        WindowedPlugin(
            static_cast<std::uint32_t>(this->numbers.size() + 3 + this->macros.size() + PluginTuning::kParameters +
                                       this->hosted.instrument().outputs().size()),
            static_cast<std::uint32_t>(std::max<std::size_t>(1, this->hosted.instrument().presets().size())), 0),
        make_(make),
        file_(instrument().name()),
        volume_index_(this->numbers.size()),
        tuning_index_(volume_index_ + 1 + this->macros.size()),
        peak_index_(tuning_index_ + PluginTuning::kParameters),
        oversampling_index_(peak_index_ + instrument().outputs().size()),
        factors_(all_factors()),
        values_(factors_.size()),
        moves_(kMidiKeys * factors_.size()),
        outputs_(instrument().outputs().size()),
        unheard_(outputs_.size()),
        peaks_(outputs_.size()),
        sides_(sides_of(instrument().outputs(), 0)) {
    for (std::size_t p = 0; p < values_.size(); ++p) values_[p].shown = shown(p, control(p).initial);
    for (std::size_t o = 0; o < peaks_.size(); ++o) {
      const Output& output = instrument().outputs()[o];
      peaks_[o].unit = output.full_scale * label_of(output.name).factor;
    }
  }
  ~InstrumentPlugin() override { end_thread(); }

 private:
  using Control = contactspline::Parameter;
  static constexpr unsigned char kVolumeController = 7;
  static constexpr Control kVolume = {"volume",      "",   {0, 1},           {0, 1}, 0.5, Scale::kLinear,
                                      Acts::kAtOnce, 0.01, kVolumeController};

  static constexpr std::size_t kBlock = 256;  // samples
  static constexpr double kPeakTime_s = 0.3;
  static constexpr double kMaxRate_hz = 768000;          // of an instrument
  static constexpr std::chrono::milliseconds kLook{20};  // at the file
  static constexpr std::chrono::milliseconds kLongestSleep{1000};

  // What a host has set, on any thread.
  struct HostValue {
    std::atomic<float> shown = 0;        ///< in the unit for people
    std::atomic<double> modulation = 0;  ///< beside it, which hosts do not show
    std::atomic<bool> is_new = false;    ///< not yet passed on
  };

  // The largest magnitude of an output, which falls with its time constant.
  struct Peak {
    double unit = 1;               ///< shown value of full scale
    float fallen = 0;              ///< of full scale
    std::atomic<float> shown = 0;  ///< in the unit for people
  };

  [[nodiscard]] const AnyInstrument<T>& instrument() const { return this->hosted.instrument(); }
  [[nodiscard]] const Control& control(std::size_t index) const {
    if (is_macro(index)) return this->macros[index - volume_index_ - 1].macro->parameter;
    return index == volume_index_ ? kVolume : instrument().parameters()[this->numbers[index]];
  }
  [[nodiscard]] bool is_macro(std::size_t index) const { return index > volume_index_ && index < tuning_index_; }
  [[nodiscard]] float shown(std::size_t index, double value) const {
    return static_cast<float>(value * factors_[index]);
  }

  const char* getLabel() const override { return CONTACTSPLINE_PLUGIN_LABEL; }
  const char* getDescription() const override { return instrument().description(); }
  const char* getMaker() const override { return DISTRHO_PLUGIN_BRAND; }
  const char* getLicense() const override { return instrument().license(); }
  std::uint32_t getVersion() const override { return d_version(kVersionMajor, kVersionMinor, kVersionPatch); }
  std::int64_t getUniqueId() const override { return CONTACTSPLINE_PLUGIN_UNIQUE_ID; }

  void initAudioPort(bool is_input, std::uint32_t index, DISTRHO_NAMESPACE::AudioPort& port) override {
    Plugin::initAudioPort(is_input, index, port);
    if (is_input) {  // hosts offer it as a side chain: they play the instrument with none
      port.hints = DISTRHO_NAMESPACE::kAudioPortIsSidechain;
      port.name = "body";
      return;
    }
    port.groupId = DISTRHO_NAMESPACE::kPortGroupStereo;
    port.name = index == 0 ? "left" : "right";
  }

  void initParameter(std::uint32_t index, DISTRHO_NAMESPACE::Parameter& parameter) override {
    using namespace DISTRHO_NAMESPACE;
    if (index == oversampling_index_) return describe_oversampling(parameter);
    if (index > oversampling_index_) return describe_latency(parameter);
    if (index >= peak_index_) return describe_peak(instrument().outputs()[index - peak_index_], parameter);
    if (index >= tuning_index_) return PluginTuning::describe(index - tuning_index_, parameter);
    const Control& c = control(index);
    const Label label = label_of(c.name);
    parameter.hints = kParameterIsAutomatable | (c.scale == Scale::kLogarithmic ? kParameterIsLogarithmic : 0u);
    parameter.name = name_of(index).c_str();
    parameter.symbol = c.name;
    parameter.unit = label.unit.c_str();
    parameter.ranges = {shown(index, c.initial), shown(index, c.slider.min), shown(index, c.slider.max)};
    parameter.midiCC = c.controller < kPressureController ? c.controller : 0;
  }

  WindowTable window_table() const override {
    WindowTable table = window_table_of(instrument(), this->numbers, sides_.left);
    table.title = DISTRHO_PLUGIN_NAME;
    for (std::size_t p = volume_index_; p < tuning_index_; ++p)
      table.parameters.push_back(WindowParameter::of(control(p)));
    table.tuning = window_tuning();
    return table;
  }
  void take_notes() override {
    take_values();
    for (std::span<const HostNote> rest = notes_.all(); !rest.empty(); rest = rest.subspan(1)) take(rest);
    notes_.clear();
  }
  void modulate(std::uint32_t parameter, double amount) override {
    if (!is_modulated(parameter) || !is_number(amount)) return;
    values_[parameter].modulation = amount;
    act_anew(parameter);
  }
  bool is_modulated(std::uint32_t parameter) const override {
    return parameter < volume_index_ || is_macro(parameter);
  }
  bool is_of_notes(std::uint32_t parameter) const override {
    return parameter < volume_index_ && instrument().moves_keys(this->numbers[parameter]);
  }
  double window_value(std::size_t parameter) const override {
    return getParameterValue(static_cast<std::uint32_t>(parameter));
  }
  double window_rate_hz() const override { return getSampleRate(); }
  ContactRing& ring() override { return ring_; }
  const HeldKeys& held_keys() const override { return held_keys_; }
  bool is_tuned_outside() const override { return tuning_.is_tuned_outside(); }

  // In words; with the unit where parameters differ by it alone, as the depth and the rate of a vibrato do.
  [[nodiscard]] std::string name_of(std::size_t index) const {
    const Label label = label_of(control(index).name);
    for (std::size_t p = 0; p < volume_index_; ++p)
      if (p != index && label_of(control(p).name).text == label.text) return label.text + " in " + label.unit;
    return label.text;
  }

  static void describe_peak(const Output& output, DISTRHO_NAMESPACE::Parameter& parameter) {
    const Label label = label_of(output.name);
    parameter.hints = DISTRHO_NAMESPACE::kParameterIsOutput;
    parameter.name = ("peak " + label.text).c_str();
    parameter.symbol = (std::string("peak_") + output.name).c_str();
    parameter.unit = label.unit.c_str();
    // Up to 20 dB more than what is played as 1.
    parameter.ranges = {0, 0, static_cast<float>(10 * output.full_scale * label.factor)};
  }

  static void describe_oversampling(DISTRHO_NAMESPACE::Parameter& parameter) {
    using namespace DISTRHO_NAMESPACE;
    // Without the first hint the framework writes a property into LV2 files that validators do not know.
    parameter.hints = kParameterIsAutomatable | kParameterIsInteger | kParameterIsLogarithmic;
    parameter.name = parameter.symbol = "oversampling";
    parameter.ranges = {1, 1, static_cast<float>(kOversamplings[std::size(kOversamplings) - 1])};
    parameter.enumValues.count = std::size(kOversamplings);
    parameter.enumValues.restrictedMode = true;
    parameter.enumValues.values =
        new ParameterEnumerationValue[std::size(kOversamplings)];  // the framework's to delete
    for (std::size_t i = 0; i < std::size(kOversamplings); ++i)
      parameter.enumValues.values[i] = {static_cast<float>(kOversamplings[i]), String(kOversamplings[i])};
  }
  void describe_latency(DISTRHO_NAMESPACE::Parameter& parameter) const {
    parameter.hints = DISTRHO_NAMESPACE::kParameterIsOutput | DISTRHO_NAMESPACE::kParameterIsInteger;
    parameter.name = parameter.symbol = "latency";
    parameter.unit = "samples";
    parameter.ranges = {0, 0, static_cast<float>(latencies_.back())};
  }

  void initProgramName(std::uint32_t index, DISTRHO_NAMESPACE::String& name) override {
    name = instrument().presets().empty() ? "initial" : instrument().presets()[index].name;
  }

  float getParameterValue(std::uint32_t index) const override {
    if (index == oversampling_index_) return static_cast<float>(oversampling_);
    if (index > oversampling_index_) return static_cast<float>(latency());
    if (index >= peak_index_) return peaks_[index - peak_index_].shown;
    return index >= tuning_index_ ? tuning_.value(index - tuning_index_) : values_[index].shown.load();
  }

  // On any thread.
  void setParameterValue(std::uint32_t index, float value) override {
    if (index == oversampling_index_) return set_oversampling(value);
    if (index > oversampling_index_ || (index >= peak_index_ && index < oversampling_index_)) return;
    if (index >= tuning_index_) return tuning_.set(index - tuning_index_, value);
    const auto [min, max] = control(index).slider;
    HostValue& kept = values_[index];
    kept.shown = held(kept.shown.load(), value, {shown(index, min), shown(index, max)});
    act_anew(index);
  }
  // A value, or those that a macro moves.
  void act_anew(std::size_t index) {
    if (!is_macro(index)) values_[index].is_new = true;
    if (is_macro(index))
      for (const std::size_t p : this->macros[index - volume_index_ - 1].moved) values_[p].is_new = true;
  }

  void loadProgram(std::uint32_t index) override {
    const auto presets = instrument().presets();
    if (index >= std::max<std::size_t>(1, presets.size())) return;
    for (std::size_t p = 0; p < volume_index_; ++p)
      setParameterValue(static_cast<std::uint32_t>(p),
                        shown(p, presets.empty() ? control(p).initial : presets[index].values[this->numbers[p]]));
  }

  // Of MIDI: the preset is seen in the window and by the host as if that had loaded it, but for what the performance
  // holds (is_of_performance).
  void take_program(std::size_t preset) {
    if (preset >= instrument().presets().size()) return;
    for (std::size_t p = 0; p < volume_index_; ++p)
      if (!is_of_performance(control(p).name, control(p).controller))
        setParameterValue(static_cast<std::uint32_t>(p),
                          shown(p, instrument().presets()[preset].values[this->numbers[p]]));
    take_values();
  }

  // To the nearest one on a logarithmic scale; a value that is not a number does nothing.
  void set_oversampling(float value) {
    if (!is_number(value)) return;
    int nearest = 1;
    for (const int factor : kOversamplings)
      if (value > std::numbers::sqrt2_v<float> / 2 * static_cast<float>(factor)) nearest = factor;
    oversampling_ = nearest;
    setLatency(latency());
    wake_thread();
  }
  // The same, or less where the instrument's rate would be too high.
  [[nodiscard]] int possible_oversampling() const {
    int factor = oversampling_;
    while (factor > 1 && factor * getSampleRate() > kMaxRate_hz) factor /= 2;
    return factor;
  }
  [[nodiscard]] std::uint32_t latency() const {
    return latencies_[static_cast<std::size_t>(std::ranges::find(kOversamplings, possible_oversampling()) -
                                               std::begin(kOversamplings))];
  }
  static auto all_latencies() {
    std::array<std::uint32_t, std::size(kOversamplings)> latencies;
    std::ranges::transform(kOversamplings, latencies.begin(),
                           [](int factor) { return static_cast<std::uint32_t>(Decimator<T>(factor).delay()); });
    return latencies;
  }

  // Replaces the instrument where it has another oversampling, or one of a file another rate, or its file has
  // changed. Not on the audio thread.
  void renew() {
    const int factor = possible_oversampling();
    const double rate_hz = factor * getSampleRate();
    const bool has_factor = factor == std::exchange(made_oversampling_, factor);
    const bool has_rate = rate_hz == std::exchange(made_rate_hz_, rate_hz);
    Handle<T> next = file_.changed(rate_hz);
    if (!next && !(has_factor && has_rate)) next = file_.last(rate_hz);
    if (!next && has_factor) return;
    next = std::make_unique<Oversampled<T>>(next ? std::move(next) : make_(), factor);
    next->prepare(getSampleRate());
    this->replaceable.offer(std::move(next));
  }

  // What fails is a line on standard error: hosts do not expect that a plug-in throws.
  template <typename F>
  static void attempt(const F& work) {
    try {
      work();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "contactspline: %s\n", error.what());
    }
  }

  // Without the lock, for the audio thread: what the thread misses it finds within kLongestSleep.
  void wake_thread() {
    ++wakes_;
    woken_.notify_one();
  }
  void end_thread() {
    {
      const std::scoped_lock lock(mutex_);
      is_active_ = false;
    }
    woken_.notify_one();
    if (thread_.joinable()) thread_.join();
  }
  void renew_while_active() {
    for (int seen = wakes_; is_active_; seen = wakes_) {
      attempt([this] { renew(); });
      std::unique_lock lock(mutex_);
      woken_.wait_for(lock, file_.is_there() ? kLook : kLongestSleep, [&] { return !is_active_ || wakes_ != seen; });
    }
  }
  void deactivate() override {
    end_thread();
    tuning_.set_active(false);
    held_keys_.write(HeldKeys::none());
  }

  // Not on the audio thread.
  void activate() override {
    end_thread();
    for (HostValue& value : values_) value.is_new = true;
    for (HostValue& value : values_) value.modulation = 0;
    notes_.clear();
    take_values();
    attempt([this] { renew(); });
    setLatency(latency());
    attempt([this] { this->hosted.prepare(getSampleRate()); });
    tuning_.set_active(true);
    is_active_ = true;
    attempt([this] { thread_ = std::thread([this] { renew_while_active(); }); });
    volume_ = volume_target_;
    for (Peak& peak : peaks_) peak.fallen = 0;
    volume_rate_ = static_cast<float>(-std::expm1(-1 / (kVolume.glide_s * getSampleRate())));
  }

  void run(const float** inputs, float** outputs, std::uint32_t samples, const DISTRHO_NAMESPACE::MidiEvent* events,
           std::uint32_t count) override {
    const FlushDenormals flushed;
    take_values();
    const float* const input = DISTRHO_PLUGIN_NUM_INPUTS > 0 ? inputs[0] : nullptr;
    std::size_t done = 0;
    const auto play_until = [&](std::uint32_t frame) {
      const std::size_t time = std::clamp<std::size_t>(frame, done, samples);
      play(input, outputs, done, time);
      done = time;
    };
    std::span<const HostNote> rest = notes_.all();
    for (const DISTRHO_NAMESPACE::MidiEvent& event : std::span(events, count)) {
      for (; !rest.empty() && rest.front().frame < event.frame; rest = rest.subspan(1)) {
        play_until(rest.front().frame);
        take(rest);
      }
      play_until(event.frame);
      take({event.size > DISTRHO_NAMESPACE::MidiEvent::kDataSize ? event.dataExt : event.data, event.size});
    }
    for (; !rest.empty(); rest = rest.subspan(1)) {
      play_until(rest.front().frame);
      take(rest);
    }
    notes_.clear();
    play(input, outputs, done, samples);
    if (ring_.is_watched()) show_keys();
  }

  // Passes on what the host has set since the last block: a controller that MIDI has moved stays until then.
  void take_values() {
    tuning_.take(this->hosted);
    for (std::size_t p = 0; p <= volume_index_; ++p) {
      if (!values_[p].is_new.load(std::memory_order_relaxed) || !values_[p].is_new.exchange(false)) continue;
      const float value = values_[p].shown;
      if (p == volume_index_)
        volume_target_ = value;
      else
        this->hosted.set(this->numbers[p],
                         moved_by_macros(p, value / factors_[p]) + values_[p].modulation / factors_[p]);
    }
  }
  [[nodiscard]] double moved_by_macros(std::size_t p, double value) const {
    for (std::size_t m = 0; m < this->macros.size(); ++m) {
      const auto& [macro, moved] = this->macros[m];
      const HostValue& knob = values_[volume_index_ + 1 + m];
      const double amount = std::clamp(knob.shown + knob.modulation, -1.0, 1.0);
      if (std::ranges::find(moved, p) != moved.end()) value = moved_by(*macro, amount, control(p), value);
    }
    return value;
  }

  // The first of some notes. What is said at the same sample of one that begins acts before it sounds.
  void take(std::span<const HostNote> notes_of_block) {
    using Kind = HostNote::Kind;
    const HostNote& note = notes_of_block.front();
    if (note.kind != Kind::kBegin) return take(note);
    begin(note.name.key, note.name.channel);
    this->hosted.begin_note(note.name, note.value, note.cents, [&] {
      this->hosted.each_note(note.name, [this](int key) { forget(key); });
      for (const HostNote& other : notes_of_block.subspan(1)) {
        if (other.frame != note.frame) return;
        if (other.kind >= Kind::kExpress && !is_of_all(other.name) && other.name.means(note.name)) take(other);
      }
    });
  }

  // A note begins on a key without what was said of the one before.
  void forget(int key) { std::ranges::fill(moves_of(key), NoteMove{}); }
  [[nodiscard]] std::span<NoteMove> moves_of(int key) {
    return std::span(moves_).subspan(static_cast<std::size_t>(key) * factors_.size(), factors_.size());
  }

  void take(const HostNote& note) {
    using Kind = HostNote::Kind;
    switch (note.kind) {
      case Kind::kMidi:
        return take(note.bytes);
      case Kind::kBegin:
        return;
      case Kind::kEnd:
      case Kind::kEndFirst:
        return this->hosted.end_note(note.name, note.value, note.kind == Kind::kEndFirst);
      case Kind::kExpress:
        return this->hosted.express(note.name, note.expression, note.value);
      case Kind::kSet:
      case Kind::kModulate:
        return move(note);
    }
  }

  // A note of MIDI.
  void begin(int key, int channel) {
    ++begun_;
    if (key >= 0 && key < static_cast<int>(kMidiKeys)) tuning_.before_note(this->hosted, key, channel);
  }

  // A parameter of single notes, or beside its value for all. What a host says of a note contains what it says of
  // all.
  void move(const HostNote& note) {
    if (!is_modulated(note.parameter) || !is_number(note.value)) return;
    if (is_macro(note.parameter) && note.kind == HostNote::Kind::kSet) return;  // it has no notes
    if (is_of_all(note.name) || is_macro(note.parameter)) {
      modulate(note.parameter, note.value);
      return take_values();
    }
    const std::size_t p = note.parameter;
    this->hosted.each_note(note.name, [&](int key) {
      NoteMove& moved = moves_of(key)[p];
      if (note.kind == HostNote::Kind::kSet)
        moved.set = (note.value - static_cast<double>(values_[p].shown)) / factors_[p];
      else
        moved.modulated = (note.value - values_[p].modulation) / factors_[p];
      this->hosted.move_key(key, this->numbers[p], moved.set + moved.modulated);
    });
  }

  // One message; in CLAP each has three bytes.
  void take(std::span<const std::uint8_t> bytes) {
    if (bytes.size() == 3 && bytes[0] >= 0x80 && bytes[0] < 0xf0) bytes = bytes.first(1 + midi_data_bytes(bytes[0]));
    if (bytes.size() == 2 && (bytes[0] & 0xf0) == 0xc0 && bytes[1] < 0x80) return take_program(bytes[1]);
    const auto message = midi_message(bytes);
    if (message && message->status == 0x90 && message->second > 0) begin(message->first, message->channel);
    if (message && message->status == 0xb0 && message->first == kVolumeController)
      volume_target_ = static_cast<float>(message->second) / 127;
    else
      this->hosted.midi(bytes);
  }

  void play(const float* input, float** outputs, std::size_t begin, std::size_t end) {
    for (; begin < end; begin += kBlock) play_piece(input, outputs, begin, (std::min)(kBlock, end - begin));
  }

  // The input may be an output, too: of each piece it is read before the outputs are written.
  void play_piece(const float* input, float** outputs, std::size_t begin, std::size_t samples) {
    for (std::size_t o = 0; o < outputs_.size(); ++o) outputs_[o] = unheard_[o].data();
    float* const left = outputs_[sides_.left] = outputs[0] + begin;
    float* const right = outputs[1] + begin;
    if (sides_.right != sides_.left) outputs_[sides_.right] = right;
    const bool is_watched = ring_.is_watched();
    const std::span force(forces_.data(), is_watched ? samples : 0);
    this->hosted.template process<float>(outputs_, samples, force, input == nullptr ? nullptr : input + begin);
    if (is_watched) show(force);
    for (std::size_t o = 0; o < outputs_.size(); ++o) measure(peaks_[o], {outputs_[o], samples});
    for (std::size_t n = 0; n < samples; ++n) {
      volume_ += volume_rate_ * (volume_target_ - volume_);
      if (sides_.right == sides_.left) right[n] = left[n];
      left[n] *= volume_;
      right[n] *= volume_;
    }
  }

  void show(std::span<const T> force) {
    std::array<float, kBlock> in_single;
    std::transform(force.begin(), force.end(), in_single.begin(), [](auto f) { return static_cast<float>(f); });
    ring_.write({outputs_[sides_.left], force.size()}, std::span(in_single).first(force.size()),
                static_cast<float>(instrument().energy()), begun_);
  }

  void show_keys() {
    KeyCents cents = HeldKeys::none();
    this->hosted.each_held(
        [&](int key, double of_key) { cents[static_cast<std::size_t>(key)] = is_bent_ ? of_key : 0; });
    held_keys_.write(cents);
    tuning_.look();
  }

  void measure(Peak& peak, std::span<const float> sound) {
    constexpr float kNothing = 1e-9f;  // 180 dB below full scale
    peak.fallen *= static_cast<float>(std::exp(-static_cast<double>(sound.size()) / (kPeakTime_s * getSampleRate())));
    for (const float x : sound) peak.fallen = (std::max)(peak.fallen, std::abs(x));
    if (peak.fallen < kNothing) peak.fallen = 0;
    peak.shown.store(static_cast<float>(peak.fallen * peak.unit), std::memory_order_relaxed);
  }

  [[nodiscard]] std::vector<double> all_factors() const {
    std::vector<double> factors;
    for (std::size_t p = 0; p < tuning_index_; ++p) factors.push_back(label_of(control(p).name).factor);
    return factors;
  }

  Make* make_;
  WatchedFile<T> file_;
  std::size_t volume_index_, tuning_index_, peak_index_, oversampling_index_;
  PluginTuning tuning_;
  const std::array<std::uint32_t, std::size(kOversamplings)> latencies_ = all_latencies();  // samples
  std::atomic<int> oversampling_ = 1;                                                       // that the host wants
  int made_oversampling_ = 1;
  double made_rate_hz_ = 0;
  std::atomic<bool> is_active_ = false;
  std::atomic<int> wakes_ = 0;  // of the thread
  // Not std::atomic::wait: for Windows, libstdc++ 12 and before lose wakes of it (their bug 106183).
  std::mutex mutex_;
  std::condition_variable woken_;
  std::thread thread_;           // while it is active
  std::vector<double> factors_;  // unit for people over the instrument's
  std::vector<HostValue> values_;
  std::vector<NoteMove> moves_;  // of each key the parameters
  std::vector<float*> outputs_;
  std::vector<std::array<float, kBlock>> unheard_;  // of outputs that are on neither side
  std::vector<Peak> peaks_;
  Sides sides_;
  ContactRing ring_;
  HeldKeys held_keys_;
  const bool is_bent_ = instrument().bends_keys() ||  // by MIDI
                        std::ranges::any_of(instrument().parameters(), [](const Control& c) {
                          return std::string_view(c.name) == "bend_cents";
                        });
  std::array<T, kBlock> forces_ = {};
  std::uint32_t begun_ = 0;  // notes
  float volume_ = 0, volume_target_ = 0, volume_rate_ = 0;
};

}  // namespace contactspline
