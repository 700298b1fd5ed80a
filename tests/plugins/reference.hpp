// SPDX-License-Identifier: MIT
// What a plug-in must play: its instrument, without a framework.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "plugins/hosted_plugin.hpp"

namespace contactspline::testing {

class Reference {
 public:
  virtual ~Reference() = default;
  virtual void midi(std::span<const std::uint8_t> message) = 0;
  [[nodiscard]] virtual Hosted<float>& hosted() = 0;
  /// Left and right at the first value of the plug-in's volume, which is half.
  [[nodiscard]] virtual HostedPlugin::Sound run(std::size_t samples, const float* input = nullptr) = 0;
  /// As hosts see them; the plug-in's volume is not among them.
  [[nodiscard]] virtual std::vector<HostedParameter> parameters() const = 0;
  [[nodiscard]] virtual std::vector<HostedParameter> readings() const = 0;

  using Maker = std::unique_ptr<Reference> (*)(double sample_rate_hz);
  /// Of all instruments whose plug-ins are built, by name. CMakeLists.txt writes a source for each, which adds it.
  [[nodiscard]] static std::map<std::string, Maker>& makers() {
    static std::map<std::string, Maker> makers;
    return makers;
  }
};

class ReferenceOf : public Reference {
 public:
  // Hosts keep values in single precision, in the units for people.
  ReferenceOf(Handle<float> instrument_of_class, double sample_rate_hz) : hosted_(std::move(instrument_of_class)) {
    for (std::size_t p = 0; p < instrument().parameters().size(); ++p) {
      const Parameter& parameter = instrument().parameters()[p];
      const double factor = label_of(parameter.name).factor;
      hosted_.set(p, static_cast<double>(static_cast<float>(parameter.initial * factor)) / factor);
    }
    hosted_.prepare(sample_rate_hz);
    unheard_.resize(instrument().outputs().size());
  }

  void midi(std::span<const std::uint8_t> message) override { hosted_.midi(message); }
  [[nodiscard]] Hosted<float>& hosted() override { return hosted_; }

  [[nodiscard]] HostedPlugin::Sound run(std::size_t samples, const float* input = nullptr) override {
    HostedPlugin::Sound sound;
    for (auto& side : sound) side.resize(samples);
    const auto [left, right] = sides_of(instrument().outputs(), 0);
    std::vector<float*> outputs;
    for (auto& unheard : unheard_) {
      unheard.resize(samples);
      outputs.push_back(unheard.data());
    }
    outputs[left] = sound[0].data();
    if (right != left) outputs[right] = sound[1].data();
    hosted_.process<float>(outputs, samples, {}, input);
    if (right == left) sound[1] = sound[0];
    for (auto& side : sound)
      for (float& x : side) x *= 0.5f;
    return sound;
  }

  [[nodiscard]] std::vector<HostedParameter> parameters() const override {
    std::vector<HostedParameter> parameters;
    std::map<std::string, int> uses;
    for (const Parameter& p : instrument().parameters()) uses[label_of(p.name).text] += p.slider.min < p.slider.max;
    for (const Parameter& p : instrument().parameters()) {
      const Label label = label_of(p.name);
      if (p.slider.min < p.slider.max)
        parameters.push_back({uses[label.text] > 1 ? label.text + " in " + label.unit : label.text, label.unit,
                              p.slider.min * label.factor, p.slider.max * label.factor, p.initial * label.factor});
    }
    return parameters;
  }

  [[nodiscard]] std::vector<HostedParameter> readings() const override {
    std::vector<HostedParameter> readings;
    for (const Output& o : instrument().outputs()) {
      const Label label = label_of(o.name);
      readings.push_back({"peak " + label.text, label.unit, 0, 10 * o.full_scale * label.factor, 0});
    }
    return readings;
  }

 private:
  [[nodiscard]] const AnyInstrument<float>& instrument() const { return hosted_.instrument(); }

  Hosted<float> hosted_;
  std::vector<std::vector<float>> unheard_;
};

}  // namespace contactspline::testing
