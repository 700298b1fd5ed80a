// SPDX-License-Identifier: MIT
// The C++ models as Faust `dsp` classes, which any Faust architecture can host. Include this header after UI and Meta
// are defined, like a class that Faust generates. Architecture files define them; in other programs include
// <faust/gui/UI.h> and <faust/gui/meta.h> first.
#pragma once

#include "contactspline/cpp20.hpp"

#include <faust/dsp/dsp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/controls.hpp"
#include "contactspline/hammer_string.hpp"
#include "contactspline/instrument.hpp"

namespace contactspline {

/// A control with its Faust description. Any thread may change the value.
struct FaustControl {
  FAUSTFLOAT* value;
  const char* label;
  FAUSTFLOAT initial, min, max, step;                         ///< min == max: a button
  std::vector<std::pair<const char*, const char*>> metadata;  ///< unit, scale, midi, order
};

/// A felt hammer on a string, with the controls of `hammer_string_ui` in faust/contactspline_instruments.lib. Felt:
/// an emitted material, Resonator: an emitted string, T: precision of the model. Outputs: displacement at the pickup
/// [mm], contact force [N]. Two differences from Faust: the strike position is read when the hammer is thrown, and
/// the displacement is not one sample late. compute() allocates nothing and reads the controls once. It moves each
/// into its range and keeps the last value of one that is not a number (docs/controls.md).
template <typename Felt, typename Resonator, std::floating_point T>
class HammerStringDsp : public dsp {
 public:
  /// name: shown by hosts; the text must outlive this object. hammer_mass_kg: initial value of the control.
  HammerStringDsp(const char* name, double hammer_mass_kg)
      : name_(name), initial_mass_kg_(static_cast<FAUSTFLOAT>(hammer_mass_kg)) {
    instanceResetUserInterface();
  }

  int getNumInputs() override { return 0; }
  int getNumOutputs() override { return 2; }
  int getSampleRate() override { return sample_rate_hz_; }
  dsp* clone() override { return new HammerStringDsp(name_, static_cast<double>(initial_mass_kg_)); }

  void metadata(Meta* meta) override {
    meta->declare("name", name_);
    meta->declare("description", "Hammer on a string: contact without iteration, modes with exact poles");
    meta->declare("license", "MIT");
  }

  void buildUserInterface(UI* ui) override {
    ui->openVerticalBox(name_);
    for (const FaustControl& control : controls()) {
      for (const auto& [key, value] : control.metadata) ui->declare(control.value, key, value);
      if (control.min < control.max)
        ui->addHorizontalSlider(control.label, control.value, control.initial, control.min, control.max,
                                control.step);
      else
        ui->addButton(control.label, control.value);
    }
    ui->closeBox();
  }

  static void classInit(int) {}
  void init(int sample_rate_hz) override { instanceInit(sample_rate_hz); }
  void instanceInit(int sample_rate_hz) override {
    instanceConstants(sample_rate_hz);
    instanceResetUserInterface();
    instanceClear();
  }

  void instanceConstants(int sample_rate_hz) override {
    sample_rate_hz_ = sample_rate_hz;
    damping_rate_ = static_cast<T>(-std::expm1(-1 / (kDampingTime * sample_rate_hz)));
    at_rest_.emplace(segments_of<Felt, T>, modes_in<Resonator>, shapes_, sample_rate_hz);
    pickup_ = at_rest_->string().sound_pickup(Resonator::pickup_shapes);
    instanceClear();
  }

  void instanceResetUserInterface() override {
    for (const FaustControl& control : controls()) *control.value = control.initial;
    held_ = zones_;
  }

  void instanceClear() override {
    model_ = at_rest_;
    struck_position_ = -1;
    was_pressed_ = 0;
    damping_per_s_.reset();
  }

  void compute(int count, FAUSTFLOAT**, FAUSTFLOAT** outputs) override {
    for (std::size_t i = 0; i < held_.size(); ++i) held_[i] = contactspline::held(held_[i], zones_[i], kRanges[i]);
    if (held_[kStrike] > was_pressed_) throw_hammer();
    was_pressed_ = held_[kStrike];
    const T damping_per_s = control(kDamping);
    if (!damping_per_s_) damping_per_s_ = damping_per_s;
    HammerStringControls<T> live{control(kMass), {control(kStiffnessRatio), control(kLoss)}, *damping_per_s_};
    FAUSTFLOAT* const displacement = outputs[0];
    FAUSTFLOAT* const force = outputs[1];
    const auto process = [&](int begin, int samples) {
      process_block(live, {displacement + begin, static_cast<std::size_t>(samples)}, force + begin);
    };
    int i = 0;
    for (; i < count; ++i) {
      const T before = live.damping_per_s;
      live.damping_per_s += damping_rate_ * (damping_per_s - before);
      if (live.damping_per_s == before) break;  // the damping has converged: all controls are constant from here
      process(i, 1);
    }
    for (; i < count; i += kBlock) process(i, std::min(kBlock, count - i));
    damping_per_s_ = live.damping_per_s;
  }

 private:
  using Model = HammerString<T, segments_of<Felt, T>.size()>;

  static constexpr int kBlock = 256;
  static constexpr double kDampingTime = 0.005;  // s, time constant of the damping
  static constexpr T kDistance = T(1e-4);        // m, of the hammer from the string when it is thrown

  // Labels, ranges and metadata as in faust/contactspline_instruments.lib. The metadata "0" to "6" define the order.
  enum : std::size_t { kStrike, kSpeed, kMass, kStiffnessRatio, kLoss, kDamping, kPosition, kControls };
  using Values = std::array<FAUSTFLOAT, kControls>;
  static constexpr auto kFeltLoss = static_cast<FAUSTFLOAT>(Felt::loss_s_per_m);
  static constexpr std::array<ControlRange<FAUSTFLOAT>, kControls> kRanges{
      {{0, 1},
       {FAUSTFLOAT(0.05), 10},
       {FAUSTFLOAT(0.0005), FAUSTFLOAT(0.05)},
       {FAUSTFLOAT(0.001), 1000},
       {0, kFeltLoss > 2 ? kFeltLoss : FAUSTFLOAT(2)},
       {0, 1000},
       {FAUSTFLOAT(0.01), FAUSTFLOAT(0.99)}}};

  [[nodiscard]] T control(std::size_t index) const { return static_cast<T>(held_[index]); }

  /// Computes displacement [mm] and force [N] of at most kBlock samples.
  void process_block(const HammerStringControls<T>& live, std::span<FAUSTFLOAT> displacement, FAUSTFLOAT* force) {
    Model& model = *model_;
    if constexpr (std::same_as<T, FAUSTFLOAT>) {
      model.process(live, pickup_, displacement, force);
      for (FAUSTFLOAT& sample : displacement) sample *= 1000;
    } else {
      std::array<T, kBlock> moved, pushed;
      const bool may_touch = model.is_hammer_flying();
      model.process(live, pickup_, std::span(moved).first(displacement.size()), may_touch ? pushed.data() : nullptr);
      for (std::size_t i = 0; i < displacement.size(); ++i)
        displacement[i] = static_cast<FAUSTFLOAT>(1000 * moved[i]);
      if (may_touch)
        std::transform(pushed.data(), pushed.data() + displacement.size(), force,
                       [](T value) { return static_cast<FAUSTFLOAT>(value); });
      else
        std::fill_n(force, displacement.size(), FAUSTFLOAT(0));
    }
  }

  std::vector<FaustControl> controls() {
    const auto slider = [this](std::size_t index, const char* label, FAUSTFLOAT initial, FAUSTFLOAT step,
                               std::vector<std::pair<const char*, const char*>> metadata) {
      const auto [min, max] = kRanges[index];
      return FaustControl{&zones_[index], label, initial, min, max, step, std::move(metadata)};
    };
    return {{&zones_[kStrike], "strike", 0, 0, 0, 0, {{"0", ""}}},
            slider(kSpeed, "speed", FAUSTFLOAT(2.5), FAUSTFLOAT(0.01), {{"1", ""}, {"unit", "m/s"}}),
            slider(kMass, "hammer mass", initial_mass_kg_, FAUSTFLOAT(0.00001),
                   {{"2", ""}, {"scale", "log"}, {"unit", "kg"}}),
            slider(kStiffnessRatio, "stiffness ratio", 1, FAUSTFLOAT(0.001), {{"3", ""}, {"scale", "log"}}),
            slider(kLoss, "felt loss", kFeltLoss, FAUSTFLOAT(0.001), {{"4", ""}, {"unit", "s/m"}}),
            slider(kDamping, "damping", 0, FAUSTFLOAT(0.1), {{"5", ""}, {"unit", "1/s"}}),
            slider(kPosition, "strike position", FAUSTFLOAT(0.12), FAUSTFLOAT(0.001),
                   {{"6", ""}, {"tooltip", "along the string, as part of its length"}})};
  }

  void throw_hammer() {
    if (held_[kPosition] != struck_position_) move_strike();
    model_->strike(control(kSpeed), kDistance);
  }

  void move_strike() {
    struck_position_ = held_[kPosition];
    const double place_m = static_cast<double>(struck_position_) * std::numbers::pi / Resonator::wavenumbers[0];
    for (std::size_t i = 0; i < Resonator::modes; ++i)
      shapes_[i] = static_cast<T>(std::sin(Resonator::wavenumbers[i] * place_m) / Resonator::strings);
    model_->strike_at(shapes_);
  }

  const char* name_;
  FAUSTFLOAT initial_mass_kg_;
  Values zones_{}, held_{};  // what the host wrote; what acts
  FAUSTFLOAT was_pressed_ = 0;
  FAUSTFLOAT struck_position_ = -1;  // at the last throw; -1 before the first one
  int sample_rate_hz_ = 0;
  T damping_rate_ = 0;
  std::optional<T> damping_per_s_;  // empty until the first compute(), which starts at the control's value
  ModeShapes<T> shapes_{Resonator::strike_shapes};
  ModeShapes<T> pickup_;                  // for sound
  std::optional<Model> at_rest_, model_;  // instanceClear() copies at_rest_, so it does not allocate
};

/// An instrument from a file, with its outputs as audio channels, each divided by its full_scale. Instrument: an
/// emitted class, such as instruments::trichord_c4<float>. Each control is a slider of the same name, unit, range and
/// first value. A strike is a button strike_NAME with a slider NAME_speed_m_per_s; a force with
/// release_n a button pluck_NAME with a slider NAME_release_n. A pluck is that of a score: it rises within 4 ms, is
/// added to the force of the control, and stops. compute() allocates nothing and reads the sliders once. It moves
/// each into its range and keeps the last value of one that is not a number. Forces and dampings follow with a time
/// constant of 5 ms.
template <typename Instrument>
class InstrumentDsp : public dsp {
 public:
  InstrumentDsp() {
    for (std::size_t s = 0; s < kStrikes; ++s) add_strike(s);
    for (std::size_t c = 0; c < kControls; ++c)
      if (Data::controls[c].release_n != 0) add_pluck(c);
    first_control_ = sliders_.size();
    for (std::size_t c = 0; c < kControls; ++c) add_control(c);
    for (std::size_t s = 0; s < sliders_.size(); ++s) sliders_[s].order = std::to_string(s);
    zones_.resize(sliders_.size());
    instanceResetUserInterface();
  }
  InstrumentDsp(const InstrumentDsp&) = delete;
  InstrumentDsp& operator=(const InstrumentDsp&) = delete;

  int getNumInputs() override { return 0; }
  int getNumOutputs() override { return static_cast<int>(Data::outputs.size()); }
  int getSampleRate() override { return sample_rate_hz_; }
  dsp* clone() override { return new InstrumentDsp; }

  void metadata(Meta* meta) override {
    meta->declare("name", Names::instrument);
    meta->declare("description",
                  "Instrument from a file: contacts that are solved together, with exact energy balance");
    meta->declare("license", "MIT");
  }

  void buildUserInterface(UI* ui) override {
    ui->openVerticalBox(Names::instrument);
    for (std::size_t i = 0; i < sliders_.size(); ++i) {
      const Slider& slider = sliders_[i];
      FAUSTFLOAT* const zone = &zones_[i];
      ui->declare(zone, slider.order.c_str(), "");
      if (!slider.key.empty()) ui->declare(zone, "midi", slider.key.c_str());
      if (slider.is_logarithmic) ui->declare(zone, "scale", "log");
      if (!slider.unit.empty()) ui->declare(zone, "unit", slider.unit.c_str());
      const auto [min, max] = slider.range;
      if (slider.is_button)
        ui->addButton(slider.label.c_str(), zone);
      else
        ui->addHorizontalSlider(slider.label.c_str(), zone, slider.initial, min, max, slider.step());
    }
    ui->closeBox();
  }

  static void classInit(int) {}
  void init(int sample_rate_hz) override { instanceInit(sample_rate_hz); }
  void instanceInit(int sample_rate_hz) override {
    instanceConstants(sample_rate_hz);
    instanceResetUserInterface();
    instanceClear();
  }

  void instanceConstants(int sample_rate_hz) override {
    sample_rate_hz_ = sample_rate_hz;
    glide_rate_ = static_cast<T>(-std::expm1(-1 / (kGlideTime_s * sample_rate_hz)));
    pluck_length_ = std::max(1, static_cast<int>(std::lround(kPluckRise_s * sample_rate_hz)));
    model_.emplace(sample_rate_hz);
    instanceClear();
  }

  void instanceResetUserInterface() override {
    for (std::size_t i = 0; i < sliders_.size(); ++i) zones_[i] = sliders_[i].initial;
    held_ = zones_;
  }

  void instanceClear() override {
    if (model_) model_->reset();
    for (Throw& strike : throws_) strike.was_pressed = 0;
    for (Pluck& pluck : plucks_) {
      pluck.was_pressed = 0;
      pluck.sample = pluck_length_;
    }
    is_new_ = true;
  }

  void compute(int count, FAUSTFLOAT**, FAUSTFLOAT** outputs) override {
    for (std::size_t i = 0; i < sliders_.size(); ++i)
      held_[i] = contactspline::held(held_[i], zones_[i], sliders_[i].range);
    for (std::size_t s = 0; s < kStrikes; ++s)
      if (has_risen(throws_[s])) model_->strike(s, static_cast<T>(held_[throws_[s].value]));
    for (Pluck& pluck : plucks_)
      if (has_risen(pluck)) pluck.sample = 0;
    if (std::exchange(is_new_, false))
      for (std::size_t c = 0; c < kControls; ++c) values_[c] = control(c);
    for (int n = 0; n < count; ++n) {
      set_controls();
      model_->tick();
      for (std::size_t o = 0; o < Data::outputs.size(); ++o)
        outputs[o][n] = static_cast<FAUSTFLOAT>(model_->output(o) / static_cast<T>(Data::outputs[o].full_scale));
    }
  }

 private:
  using T = typename Instrument::value_type;
  using Data = typename Instrument::data;
  using Names = typename Instrument::names;
  static constexpr std::size_t kControls = Data::controls.size(), kStrikes = Data::strikes.size();
  static constexpr double kGlideTime_s = 0.005, kPluckRise_s = 0.004;
  static constexpr int kFirstKey = 60;

  struct Slider {
    std::string label, unit;
    FAUSTFLOAT initial = 0;
    ControlRange<FAUSTFLOAT> range{0, 1};
    bool is_button = false, is_logarithmic = false;
    std::string key = {}, order = {};

    [[nodiscard]] FAUSTFLOAT step() const {
      return is_logarithmic ? range.min / 10 : (range.max - range.min) / FAUSTFLOAT(1e4);
    }
  };
  // A button with the slider of its value.
  struct Throw {
    std::size_t button, value;
    FAUSTFLOAT was_pressed = 0;
  };
  struct Pluck : Throw {
    std::size_t control;
    int sample = 0;  // since it began; pluck_length_ once it has ended
  };

  void add_control(std::size_t c) {
    const InstrumentControl& control = Data::controls[c];
    const auto range = control_range<FAUSTFLOAT>(control);
    const bool is_logarithmic = range.min > 0 && range.max >= 100 * range.min;
    sliders_.push_back({Names::controls[c], unit_of(control.quantity), static_cast<FAUSTFLOAT>(control.initial),
                        range, false, is_logarithmic});
  }

  void add_strike(std::size_t s) {
    const std::string name = Names::strikes[s];
    throws_[s] = {add_button("strike_" + name), sliders_.size()};
    sliders_.push_back({name + "_speed_m_per_s", "m/s", FAUSTFLOAT(2.5), {0, 10}});
  }

  void add_pluck(std::size_t c) {
    const InstrumentControl& control = Data::controls[c];
    std::string name = Names::controls[c];
    name.resize(name.size() - std::string("_force_n").size());
    plucks_.push_back({{add_button("pluck_" + name), sliders_.size()}, c});
    sliders_.push_back(
        {name + "_release_n", "N", static_cast<FAUSTFLOAT>(control.release_n), control_range<FAUSTFLOAT>(control)});
  }

  // A button, which MIDI hosts press by the next key from the middle C on.
  std::size_t add_button(std::string label) {
    const std::string key = "key " + std::to_string(kFirstKey + buttons_++);
    sliders_.push_back({std::move(label), "", 0, {0, 1}, true, false, key});
    return sliders_.size() - 1;
  }

  static std::string unit_of(ControlQuantity quantity) {
    constexpr std::array kUnits = {"N", "1/s", "", "s/m", "m", "N/m", "N s/m"};  // in the order of ControlQuantity
    return kUnits[static_cast<std::size_t>(quantity)];
  }

  // What the host wants of a control.
  [[nodiscard]] T control(std::size_t c) const { return static_cast<T>(held_[first_control_ + c]); }

  bool has_risen(Throw& button) const {
    return held_[button.button] > std::exchange(button.was_pressed, held_[button.button]);
  }

  void set_controls() {
    for (std::size_t c = 0; c < kControls; ++c) {
      const auto quantity = Data::controls[c].quantity;
      const T target = control(c);
      const bool glides = quantity == ControlQuantity::kForce || quantity == ControlQuantity::kDamping;
      const T next = glides ? values_[c] + glide_rate_ * (target - values_[c]) : target;
      values_[c] = next == values_[c] ? target : next;  // what rounds away ends the glide
      model_->set_control(c, values_[c]);
    }
    for (Pluck& pluck : plucks_) {
      if (pluck.sample >= pluck_length_) continue;
      const T part = static_cast<T>(pluck.sample++) / static_cast<T>(pluck_length_);
      const T rise = part * part * (3 - 2 * part);
      model_->set_control(pluck.control, values_[pluck.control] + static_cast<T>(held_[pluck.value]) * rise);
    }
  }

  std::vector<Slider> sliders_;  // and buttons, in the order of their display
  std::size_t first_control_ = 0;
  std::array<Throw, kStrikes> throws_{};
  std::vector<Pluck> plucks_;
  int buttons_ = 0;
  std::vector<FAUSTFLOAT> zones_, held_;  // what the host wrote; what acts
  std::array<T, kControls> values_{};     // of the controls, which glide
  int sample_rate_hz_ = 0, pluck_length_ = 0;
  T glide_rate_ = 0;
  bool is_new_ = true;
  std::optional<Instrument> model_;
};

}  // namespace contactspline
