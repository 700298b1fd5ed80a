// SPDX-License-Identifier: MIT
// What a slide-string and a fret-string have in common as instruments: one plucked string with one contact.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/pluck.hpp"
#include "contactspline/instrument/resonator_parts.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/modal/string_place.hpp"

namespace contactspline {

/// An instrument of a Model<T> that has string(), force(), tick(controls) and place(). Derived has the list kList
/// with kPlace, kLoss and kPluck, controls() of the next sample, and put() which places the contact at rest.
template <typename Derived, template <typename> typename Model, std::floating_point T, std::size_t parameter_count>
class PluckedStringInstrument : public PlayedByEvents<Derived> {
 public:
  using value_type = T;
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] std::span<const Parameter> parameters() const { return list_; }
  [[nodiscard]] std::span<const Output> outputs() const { return detail::StringOutputs<T>::list(parts_.resonator); }
  static std::span<const Preset> presets() { return {}; }

  void prepare(double sample_rate_hz) {
    sample_rate_hz_ = sample_rate_hz;
    const ResonatorParts& resonator = parts_.resonator;
    model_.emplace(contact_, resonator.modes, StringShapes<T>(std::span<const double>(resonator.wavenumbers_per_m)),
                   static_cast<T>(resonator.pluck_m), sample_rate_hz);
    outputs_ = detail::StringOutputs<T>(resonator, model_->string());
    reset();
  }

  void set(std::size_t parameter, double value) {
    values_[parameter] = held(values_[parameter], value, list_[parameter].allowed);
  }
  [[nodiscard]] double value(std::size_t parameter) const { return values_[parameter]; }

  void strike(std::size_t, T) {}
  void release(std::size_t) {}
  void pluck(std::size_t number, T force_n, double rise_s = kPluckRise_s) {
    if (number == 0 && is_number(force_n)) pluck_.begin(double(force_n), rise_s, sample_rate_hz_);
  }

  void process(Outputs<T> outputs, std::span<T> force = {}) {
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t n = 0; n < length; ++n) {
      model_->tick(static_cast<Derived*>(this)->controls());
      outputs_.write(outputs, n, model_->string(), model_->force());
      if (!force.empty()) force[n] = model_->force();
    }
  }

  void reset() {
    static_cast<Derived*>(this)->put();
    model_->reset();
    pluck_.stop();
    this->let_keys_go();
  }
  [[nodiscard]] bool is_silent(double limit_j) const { return !pluck_.is_active() && energy() < limit_j; }
  /// Of the string.
  [[nodiscard]] double energy() const { return model_->string().energy(); }
  [[nodiscard]] const Model<T>& model() const { return *model_; }

 protected:
  PluckedStringInstrument(PluckedStringParts parts, const std::array<Parameter, parameter_count>& list)
      : parts_(std::move(parts)), contact_(table_in<T>(parts_.contact)), list_(list) {
    Parameter& loss = list_[Derived::kLoss];
    loss.initial = parts_.loss_s_per_m;
    loss.slider.max = std::max(2.0, parts_.loss_s_per_m);
    Parameter& place = list_[Derived::kPlace];
    const double length_m = parts_.resonator.length_m;
    place.allowed.max = length_m;
    place.slider = {0.02 * length_m, 0.98 * length_m};
    place.initial = length_m / 2;
    for (std::size_t i = 0; i < parameter_count; ++i) values_[i] = list_[i].initial;
  }

  void set_first(std::size_t parameter, double value) { values_[parameter] = list_[parameter].initial = value; }
  [[nodiscard]] T value_of(std::size_t parameter) const { return static_cast<T>(values_[parameter]); }
  // The force of a control with that of a pluck, for the next sample.
  [[nodiscard]] T plucked(std::size_t parameter) { return static_cast<T>(values_[parameter] + pluck_.next()); }

  [[nodiscard]] const PluckedStringParts& parts() const { return parts_; }
  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_; }
  [[nodiscard]] Model<T>& contact_model() { return *model_; }

 private:
  PluckedStringParts parts_;
  std::vector<Segment<T>> contact_;
  std::array<Parameter, parameter_count> list_;
  std::array<double, parameter_count> values_{};
  double sample_rate_hz_ = 0;
  std::optional<Model<T>> model_;
  detail::StringOutputs<T> outputs_;
  Pluck pluck_;
};

}  // namespace contactspline
