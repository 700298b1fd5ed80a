// SPDX-License-Identifier: MIT
// A library as contactspline_model() makes it, whose class is broken as BROKEN in the environment says.
#include <array>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string_view>

#include "contactspline/host/model_module.hpp"
#include "contactspline/instrument/parameter_values.hpp"
#include "contactspline/instrument/played_by_events.hpp"

namespace {

using namespace contactspline;

bool is_broken(std::string_view how) {
  const char* const wanted = std::getenv("BROKEN");
  return wanted != nullptr && wanted == how;
}

class Broken : public ParameterValues<float, 1>, public PlayedByEvents<Broken> {
 public:
  using value_type = float;
  static constexpr std::array<Parameter, 1> kList = {{{"speed_m_per_s", "m/s", {0, 100}, {0.1, 10}, 3}}};

  Broken() : ParameterValues(kList) {
    if (is_broken("constructor")) throw std::runtime_error("two\nlines");
    events_[0] = {is_broken("event_name") ? nullptr : "strike", EventKind::kStrike, 0,
                  is_broken("event") ? std::size_t(7) : 0};
    outputs_[0] = {"displacement_m", is_broken("unit") ? nullptr : "m", is_broken("full_scale") ? 0.0 : 1e-4};
  }
  static const char* name() { return is_broken("name") ? nullptr : "broken"; }
  static const char* description() { return ""; }
  [[nodiscard]] std::span<const Event> events() const { return events_; }
  [[nodiscard]] std::span<const Output> outputs() const {
    return std::span(outputs_).first(is_broken("outputs") ? 0 : 1);
  }
  static void prepare(double) {
    if (is_broken("prepare")) throw std::runtime_error("no memory for modes");
  }
  static void strike(std::size_t, float) {}
  static void process(Outputs<float> outputs, std::span<float> force = {}) {
    for (const std::span<float> output : outputs)
      for (float& sample : output) sample = 0.1f;
    for (float& sample : force) sample = 0;
  }
  static void reset() {}
  static bool is_silent(double) { return false; }
  static double energy() { return 0; }

 private:
  std::array<Event, 1> events_{};
  std::array<Output, 1> outputs_{};
};

}  // namespace

extern "C" const ModelModule* contactspline_model_module() {
  static const ModelModule module = model_module<Broken>();
  return is_broken("module") ? nullptr : &module;
}
