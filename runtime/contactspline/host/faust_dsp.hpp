// SPDX-License-Identifier: MIT
// Instruments of C++ as Faust `dsp` classes, which any Faust architecture can host. Include this header after UI and
// Meta are defined, like a class that Faust generates. Architecture files define them; in other programs include
// <faust/gui/UI.h> and <faust/gui/meta.h> first.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <faust/dsp/dsp.h>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <string>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/sliders.hpp"

namespace contactspline {

/// An instrument as Faust's dsp. Each event is a button, each parameter a slider of
/// the same name, unit, range and first value (sliders.hpp); its outputs are the instrument's, each divided by its
/// full scale. compute() allocates nothing and reads the sliders once. It keeps the last value of one that is not a
/// number.
template <std::floating_point T>
class HandleDsp : public dsp {
 public:
  using Make = Handle<T> (*)();

  /// make: the instrument. name: that hosts show, which must outlive the object; null: that of the instrument.
  explicit HandleDsp(Make make, const char* name = nullptr)
      : make_(make),
        hosted_(make()),
        name_(name != nullptr ? name : hosted_.instrument().name()),
        sliders_(sliders_of(hosted_.instrument().parameters(), hosted_.instrument().events())) {
    for (std::size_t s = 0; s < sliders_.size(); ++s) orders_.push_back(std::to_string(s));
    zones_.resize(sliders_.size());
    for (std::size_t e = 0; e < hosted_.instrument().events().size(); ++e)
      keys_.push_back("key " + std::to_string(key_of_button(e)));
    instanceResetUserInterface();
  }
  HandleDsp(const HandleDsp&) = delete;
  HandleDsp& operator=(const HandleDsp&) = delete;

  int getNumInputs() override { return 0; }
  int getNumOutputs() override { return static_cast<int>(hosted_.instrument().outputs().size()); }
  int getSampleRate() override { return sample_rate_hz_; }
  dsp* clone() override { return new HandleDsp(make_, name_); }

  void metadata(Meta* meta) override {
    meta->declare("name", name_);
    meta->declare("description", hosted_.instrument().description());
    meta->declare("license", hosted_.instrument().license());
  }

  void buildUserInterface(UI* ui) override {
    ui->openVerticalBox(name_);
    for (std::size_t s = 0; s < sliders_.size(); ++s) {
      FAUSTFLOAT* const zone = &zones_[s];
      ui->declare(zone, orders_[s].c_str(), "");
      sliders_[s].is_button ? show_button(ui, zone, sliders_[s].number) : show_slider(ui, zone, sliders_[s].number);
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
    hosted_.prepare(sample_rate_hz);
  }

  void instanceResetUserInterface() override {
    for (std::size_t s = 0; s < sliders_.size(); ++s)
      zones_[s] = sliders_[s].is_button ? 0 : static_cast<FAUSTFLOAT>(parameter(sliders_[s].number).initial);
  }

  void instanceClear() override { hosted_.reset(); }

  void compute(int count, FAUSTFLOAT**, FAUSTFLOAT** outputs) override {
    for (std::size_t s = 0; s < sliders_.size(); ++s) {
      if (sliders_[s].is_button || !is_number(zones_[s])) continue;
      const auto [min, max] = parameter(sliders_[s].number).slider;
      hosted_.set(sliders_[s].number, std::clamp(static_cast<double>(zones_[s]), min, max));
    }
    for (std::size_t s = 0; s < sliders_.size(); ++s)
      if (sliders_[s].is_button && is_number(zones_[s])) hosted_.press(sliders_[s].number, zones_[s] > 0);
    hosted_.template process<FAUSTFLOAT>({outputs, static_cast<std::size_t>(getNumOutputs())},
                                         static_cast<std::size_t>(count));
  }

 private:
  [[nodiscard]] const Parameter& parameter(std::size_t number) const {
    return hosted_.instrument().parameters()[number];
  }

  void show_button(UI* ui, FAUSTFLOAT* zone, std::size_t event) {
    ui->declare(zone, "midi", keys_[event].c_str());
    ui->addButton(hosted_.instrument().events()[event].name, zone);
  }

  void show_slider(UI* ui, FAUSTFLOAT* zone, std::size_t number) {
    const Parameter& shown = parameter(number);
    if (shown.scale == Scale::kLogarithmic) ui->declare(zone, "scale", "log");
    if (*shown.unit != 0) ui->declare(zone, "unit", shown.unit);
    ui->addHorizontalSlider(shown.name, zone, static_cast<FAUSTFLOAT>(shown.initial),
                            static_cast<FAUSTFLOAT>(shown.slider.min), static_cast<FAUSTFLOAT>(shown.slider.max),
                            static_cast<FAUSTFLOAT>(slider_step(shown)));
  }

  Make make_;
  Hosted<T> hosted_;
  const char* name_;
  std::vector<Slider> sliders_;
  std::vector<std::string> orders_, keys_;  // metadata of each slider, of each button
  std::vector<FAUSTFLOAT> zones_;           // what the host wrote
  int sample_rate_hz_ = 0;
};

/// The same of a class that meets Instrument and is built without arguments, such as an emitted one,
/// instruments::trichord_c4<float>, or HammerStringOf<...>.
template <Instrument I>
class InstrumentDsp : public HandleDsp<typename I::value_type> {
 public:
  explicit InstrumentDsp(const char* name = nullptr)
      : HandleDsp<typename I::value_type>([] { return handle_of<I>(); }, name) {}
};

}  // namespace contactspline
