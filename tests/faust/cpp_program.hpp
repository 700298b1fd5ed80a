// SPDX-License-Identifier: MIT
// The three names that Faust's generated C++ expects, and a program of that back end.
#pragma once

#include "faust_program.hpp"

struct dsp {
  virtual ~dsp() = default;
};

struct Meta {
  void declare(const char*, const char*) {}
};

/// Remembers where each control lives.
struct UI {
  void openVerticalBox(const char*) {}
  void openHorizontalBox(const char*) {}
  void closeBox() {}
  void declare(void*, const char*, const char*) {}
  void addButton(const char* label, void* zone) { zones[label] = zone; }
  void addHorizontalSlider(const char* label, void* zone, double, double, double, double) { zones[label] = zone; }

  std::map<std::string, void*> zones;
};

namespace contactspline::testing {

template <std::derived_from<dsp> Dsp, std::floating_point T>
class CppProgram : public FaustProgram<T> {
 public:
  explicit CppProgram(int sample_rate_hz) {
    dsp_.init(sample_rate_hz);
    dsp_.buildUserInterface(&ui_);
  }

  void set(const std::string& label, T value) override { *static_cast<T*>(ui_.zones.at(label)) = value; }

 protected:
  [[nodiscard]] std::size_t input_count() override { return static_cast<std::size_t>(dsp_.getNumInputs()); }
  [[nodiscard]] std::size_t output_count() override { return static_cast<std::size_t>(dsp_.getNumOutputs()); }
  void compute(int samples, T** inputs, T** outputs) override { dsp_.compute(samples, inputs, outputs); }

 private:
  Dsp dsp_;
  UI ui_;
};

}  // namespace contactspline::testing
