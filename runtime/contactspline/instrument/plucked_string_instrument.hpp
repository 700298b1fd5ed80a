// SPDX-License-Identifier: MIT
// What a slide-string and a fret-string have in common as instruments: one plucked string with one contact.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/model_parameters.hpp"
#include "contactspline/data/pluck.hpp"
#include "contactspline/data/string_parts.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/parameter_values.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/modal/string_place.hpp"

namespace contactspline {

/// An instrument of a model that has string(), force(), tick(controls) and place(). Its Parameters have the list
/// kList with kPlace, kLoss and kPluckForce. Derived has controls() of the next sample, put() which places the
/// contact at rest, is_contact_at_rest(limit): does it stay where it is, with less energy than the limit? and
/// is_contact_held(limit): the same of its kinetic energy, with all controls arrived?
template <typename Derived, typename Model, std::floating_point T, typename Parameters>
class PluckedStringInstrument : public Parameters,
                                public ParameterValues<T, Parameters::kParameters>,
                                public PlayedByEvents<Derived> {
 public:
  using value_type = T;

  static std::span<const Event> events() { return Parameters::kEvents; }
  [[nodiscard]] std::span<const Output> outputs() const { return parts_.resonator.outputs(); }

  void prepare(double sample_rate_hz) {
    sample_rate_hz_ = sample_rate_hz;
    const ResonatorParts& resonator = parts_.resonator;
    model_.emplace(contact_, resonator.modes, StringShapes<T>(std::span<const double>(resonator.wavenumbers_per_m)),
                   static_cast<T>(resonator.pluck_m), sample_rate_hz, parts_.memories);
    outputs_ = detail::StringOutputs<T>(resonator, model_->string());
    reset();
  }

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
  [[nodiscard]] bool is_silent(double limit_j) const {
    return !pluck_.is_active() && this->value(Parameters::kPluckForce) == 0 && model_->string().energy() < limit_j &&
           static_cast<const Derived*>(this)->is_contact_at_rest(limit_j);
  }
  /// Does no pluck push, and do loads hold the string still, but for a kinetic energy below a limit [J]?
  [[nodiscard]] bool is_at_rest(double limit_j) const {
    const double kinetic_j = model_->string().kinetic_energy();
    return !pluck_.is_active() && kinetic_j < limit_j && is_held_by_loads(kinetic_j, model_->string().energy()) &&
           static_cast<const Derived*>(this)->is_contact_held(limit_j);
  }
  /// Of the string and of what touches it.
  [[nodiscard]] double energy() const { return model_->energy(); }
  [[nodiscard]] const Model& model() const { return *model_; }

 protected:
  explicit PluckedStringInstrument(PluckedStringParts parts)
      : ParameterValues<T, Parameters::kParameters>(Parameters::kList),
        parts_(std::move(parts)),
        contact_(table_in<T>(parts_.contact)) {
    const double length_m = parts_.resonator.length_m;
    this->limit(Parameters::kPlace, {0, length_m}, {0.02 * length_m, 0.98 * length_m});
    this->set_initial(Parameters::kPlace, length_m / 2);
    this->set_initial(Parameters::kLoss, parts_.loss_s_per_m);
  }

  // The force of a control with that of a pluck, for the next sample.
  [[nodiscard]] T plucked(std::size_t parameter) { return static_cast<T>(this->value(parameter) + pluck_.next()); }

  // Is the contact within a distance of the place that its control wants?
  [[nodiscard]] bool has_arrived(double within_m = 0) const {
    const double rounding_m = 1e-5 * parts_.resonator.length_m;
    return std::abs(double(model_->place()) - this->value(Parameters::kPlace)) <= within_m + rounding_m;
  }

  [[nodiscard]] const PluckedStringParts& parts() const { return parts_; }
  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_; }
  [[nodiscard]] Model& contact_model() { return *model_; }

 private:
  PluckedStringParts parts_;
  std::vector<Segment<T>> contact_;
  double sample_rate_hz_ = 0;
  std::optional<Model> model_;
  detail::StringOutputs<T> outputs_;
  Pluck pluck_;
};

}  // namespace contactspline
