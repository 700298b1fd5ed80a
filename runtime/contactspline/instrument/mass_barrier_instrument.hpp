// SPDX-License-Identifier: MIT
// A mass thrown at a rigid barrier, as an instrument.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/model_parameters.hpp"
#include "contactspline/data/string_parts.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/parameter_values.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/models/mass_barrier.hpp"

namespace contactspline {

/// A mass that bounces on a rigid barrier. Meets Instrument.
template <std::floating_point T>
class MassBarrierInstrument : public MassBarrierParameter,
                              public ParameterValues<T, MassBarrierParameter::kParameters>,
                              public PlayedByEvents<MassBarrierInstrument<T>> {
 public:
  using value_type = T;
  static constexpr std::array<Output, 2> kOutputs = {{{"displacement_m", "m", 0.01}, {"contact_force_n", "N", 50}}};

  explicit MassBarrierInstrument(MassBarrierParts parts)
      : Values(kList), contact_(table_in<T>(parts.contact)), memories_(std::move(parts.memories)) {
    this->set_initial(kMass, parts.mass_kg);
    this->set_initial(kLoss, parts.loss_s_per_m);
  }

  static const char* name() { return "mass_barrier"; }
  static const char* description() { return "Mass thrown at a rigid barrier: contact without iteration"; }
  static std::span<const Event> events() { return kEvents; }
  static std::span<const Output> outputs() { return kOutputs; }

  void prepare(double sample_rate_hz) { model_.emplace(contact_, static_cast<T>(sample_rate_hz), memories_); }

  void strike(std::size_t number, T speed_m_per_s) {
    if (number == 0) model_->throw_from(value_of(kStart), speed_m_per_s);
  }

  void process(Outputs<T> outputs, std::span<T> force = {}) {
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t n = 0; n < length; ++n) {
      model_->tick({.mass_kg = value_of(kMass),
                    .gravity_m_per_s2 = value_of(kGravity),
                    .contact = {value_of(kStiffnessRatio), value_of(kLoss)}});
      if (!outputs.empty() && !outputs[0].empty()) outputs[0][n] = model_->displacement();
      if (outputs.size() > 1 && !outputs[1].empty()) outputs[1][n] = model_->force();
      if (!force.empty()) force[n] = model_->force();
    }
  }

  void reset() {
    model_->reset();
    this->let_keys_go();
  }
  /// A mass in flight needs no sound.
  [[nodiscard]] bool is_silent(double limit_j) const { return model_->force() == 0 && energy() < limit_j; }
  /// Kinetic, of the contact, and, where gravity pulls towards the barrier, of the height.
  [[nodiscard]] double energy() const {
    const double v = double(model_->velocity()), y = double(model_->displacement());
    return this->value(kMass) * (v * v / 2 + (std::max)(0.0, -this->value(kGravity) * y)) +
           double(model_->stiffness_ratio()) *
               double(model_->memory().energy(SegmentTable<T>(contact_), model_->displacement()));
  }
  [[nodiscard]] const MassBarrier<T>& model() const { return *model_; }

 private:
  using Values = ParameterValues<T, kParameters>;
  using Values::value_of;

  std::vector<Segment<T>> contact_;
  std::vector<Memory> memories_;
  std::optional<MassBarrier<T>> model_;
};

}  // namespace contactspline
