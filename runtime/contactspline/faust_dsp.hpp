// SPDX-License-Identifier: MIT
// The C++ models behind Faust's own `dsp` interface, for any Faust architecture to host. As the classes that Faust
// writes it stands after the definitions of UI and Meta: architectures bring their own, elsewhere <faust/gui/UI.h>
// and <faust/gui/meta.h> do.
#pragma once

#include <faust/dsp/dsp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/hammer_string.hpp"

namespace contactspline {

/// A control as Faust describes it: what may be changed, from outside the audio thread too, and what hosts are told.
struct FaustControl {
  FAUSTFLOAT* value;
  const char* label;
  FAUSTFLOAT initial, least, most, step;                     ///< a button where least is most
  std::vector<std::pair<const char*, const char*>> remarks;  ///< unit, scale, midi and the like
};

/// A felt hammer on a string, with the controls of `hammer_string_ui` in faust/instruments.lib. Felt: an emitted
/// material, Resonator: an emitted string, T: precision of the model. Outputs: displacement at the pickup [mm],
/// contact force [N]. The place of the strike is taken at the throw, and the displacement is not a sample late as it
/// is in Faust. compute() allocates nothing and reads the controls once.
template <typename Felt, typename Resonator, std::floating_point T>
class HammerStringDsp : public dsp {
 public:
  /// name: of the instrument, for hosts; it must outlive this. hammer_mass_kg: to begin with.
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
      for (const auto& [key, value] : control.remarks) ui->declare(control.value, key, value);
      if (control.least < control.most)
        ui->addHorizontalSlider(control.label, control.value, control.initial, control.least, control.most,
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
    instanceClear();
  }

  void instanceResetUserInterface() override {
    for (const FaustControl& control : controls()) *control.value = control.initial;
  }

  void instanceClear() override {
    model_ = at_rest_;
    struck_position_ = -1;
    was_pressed_ = 0;
    damping_per_s_.reset();
  }

  void compute(int count, FAUSTFLOAT**, FAUSTFLOAT** outputs) override {
    if (strike_ > was_pressed_) throw_hammer();
    was_pressed_ = strike_;
    const T damping_per_s = static_cast<T>(damping_);
    if (!damping_per_s_) damping_per_s_ = damping_per_s;
    HammerStringControls<T> live{
        static_cast<T>(mass_kg_), {static_cast<T>(stiffness_ratio_), static_cast<T>(loss_s_per_m_)}, *damping_per_s_};
    FAUSTFLOAT* const displacement = outputs[0];
    FAUSTFLOAT* const force = outputs[1];
    const auto play = [&](int begin, int samples) {
      play_block(live, {displacement + begin, static_cast<std::size_t>(samples)}, force + begin);
    };
    int i = 0;
    for (; i < count; ++i) {
      const T before = live.damping_per_s;
      live.damping_per_s += damping_rate_ * (damping_per_s - before);
      if (live.damping_per_s == before) break;  // the damper has come to rest: from here on all is constant
      play(i, 1);
    }
    for (; i < count; i += kBlock) play(i, std::min(kBlock, count - i));
    damping_per_s_ = live.damping_per_s;
  }

 private:
  using Model = HammerString<T, segments_of<Felt, T>.size()>;

  static constexpr int kBlock = 256;
  static constexpr double kDampingTime = 0.005;  // s, in which the damper has done 63 % of its way
  static constexpr T kDistance = T(1e-4);        // m, from which the hammer is thrown

  /// Displacement [mm] and force [N] of at most kBlock samples.
  void play_block(const HammerStringControls<T>& live, std::span<FAUSTFLOAT> displacement, FAUSTFLOAT* force) {
    Model& model = *model_;
    if constexpr (std::same_as<T, FAUSTFLOAT>) {
      model.play(live, pickup_, displacement, force);
      for (FAUSTFLOAT& sample : displacement) sample *= 1000;
    } else {
      std::array<T, kBlock> moved, pushed;
      const bool may_touch = model.is_hammer_flying();
      model.play(live, pickup_, std::span(moved).first(displacement.size()), may_touch ? pushed.data() : nullptr);
      for (std::size_t i = 0; i < displacement.size(); ++i)
        displacement[i] = static_cast<FAUSTFLOAT>(1000 * moved[i]);
      if (may_touch)
        std::transform(pushed.data(), pushed.data() + displacement.size(), force,
                       [](T value) { return static_cast<FAUSTFLOAT>(value); });
      else
        std::fill_n(force, displacement.size(), FAUSTFLOAT(0));
    }
  }

  // Labels, ranges and remarks are those of faust/instruments.lib; the remarks "0" to "6" keep the order.
  std::vector<FaustControl> controls() {
    constexpr auto kLoss = static_cast<FAUSTFLOAT>(Felt::loss_s_per_m);
    constexpr auto kMostLoss = kLoss > 2 ? kLoss : FAUSTFLOAT(2);
    return {{&strike_, "strike", 0, 0, 0, 0, {{"0", ""}}},
            {&speed_m_per_s_,
             "speed",
             FAUSTFLOAT(2.5),
             FAUSTFLOAT(0.05),
             10,
             FAUSTFLOAT(0.01),
             {{"1", ""}, {"unit", "m/s"}}},
            {&mass_kg_,
             "hammer mass",
             initial_mass_kg_,
             FAUSTFLOAT(0.0005),
             FAUSTFLOAT(0.05),
             FAUSTFLOAT(0.00001),
             {{"2", ""}, {"scale", "log"}, {"unit", "kg"}}},
            {&stiffness_ratio_,
             "stiffness ratio",
             1,
             FAUSTFLOAT(0.001),
             1000,
             FAUSTFLOAT(0.001),
             {{"3", ""}, {"scale", "log"}}},
            {&loss_s_per_m_, "felt loss", kLoss, 0, kMostLoss, FAUSTFLOAT(0.001), {{"4", ""}, {"unit", "s/m"}}},
            {&damping_, "damping", 0, 0, 1000, FAUSTFLOAT(0.1), {{"5", ""}, {"unit", "1/s"}}},
            {&position_,
             "strike position",
             FAUSTFLOAT(0.12),
             FAUSTFLOAT(0.01),
             FAUSTFLOAT(0.99),
             FAUSTFLOAT(0.001),
             {{"6", ""}, {"tooltip", "along the string, as part of its length"}}}};
  }

  void throw_hammer() {
    if (position_ != struck_position_) move_strike();
    model_->strike(static_cast<T>(speed_m_per_s_), kDistance);
  }

  void move_strike() {
    struck_position_ = position_;
    const double place_m = static_cast<double>(position_) * std::numbers::pi / Resonator::wavenumbers[0];
    for (std::size_t i = 0; i < Resonator::modes; ++i)
      shapes_[i] = static_cast<T>(std::sin(Resonator::wavenumbers[i] * place_m) / Resonator::strings);
    model_->strike_at(shapes_);
  }

  const char* name_;
  FAUSTFLOAT initial_mass_kg_;
  FAUSTFLOAT strike_, speed_m_per_s_, mass_kg_, stiffness_ratio_, loss_s_per_m_, damping_, position_;
  FAUSTFLOAT was_pressed_ = 0;
  FAUSTFLOAT struck_position_ = -1;  // of the last throw; none yet: -1
  int sample_rate_hz_ = 0;
  T damping_rate_ = 0;
  std::optional<T> damping_per_s_;  // none yet: begins where its control is
  ModeShapes<T> shapes_{std::span<const double>(Resonator::strike_shapes)};
  const ModeShapes<T> pickup_{std::span<const double>(Resonator::pickup_shapes)};
  std::optional<Model> at_rest_, model_;  // the first for instanceClear(), which so allocates nothing
};

}  // namespace contactspline
