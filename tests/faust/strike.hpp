// SPDX-License-Identifier: MIT
// A strike of the mass-barrier model: the same input for a Faust program and for its C++ twin.
#pragma once

#include <ostream>

#include "contactspline/models/mass_barrier.hpp"
#include "faust_program.hpp"

namespace contactspline::testing {

/// Stands for a loss that nobody sets.
inline constexpr double kMaterialsLoss = -1;

/// Controls of mass_barrier.dsp, and how long it runs.
struct Strike {
  int sample_rate_hz = 44100;
  double speed_m_per_s = 1;
  double start_m = 0;
  double mass_kg = 1;
  double stiffness_ratio = 1;
  double loss_s_per_m = 0;
  double gravity_m_per_s2 = 0;
  std::size_t samples = 0;
};

inline std::ostream& operator<<(std::ostream& out, const Strike& strike) {
  return out << strike.speed_m_per_s << " m/s at " << strike.sample_rate_hz << " Hz, stiffness ratio "
             << strike.stiffness_ratio << ", loss " << strike.loss_s_per_m << ", gravity " << strike.gravity_m_per_s2;
}

/// Displacement [m] and contact force [N].
template <std::floating_point T>
struct Motion {
  std::vector<T> displacement;
  std::vector<T> force;
};

template <std::floating_point T>
[[nodiscard]] MassBarrierControls<T> controls_of(const Strike& strike) {
  return {static_cast<T>(strike.mass_kg),
          static_cast<T>(strike.gravity_m_per_s2),
          {static_cast<T>(strike.stiffness_ratio), static_cast<T>(strike.loss_s_per_m)}};
}

template <std::floating_point T>
[[nodiscard]] Motion<T> run_twin(MassBarrier<T>& model, const Strike& strike) {
  model.throw_from(static_cast<T>(strike.start_m), static_cast<T>(strike.speed_m_per_s));
  const auto controls = controls_of<T>(strike);
  Motion<T> motion;
  for (std::size_t i = 0; i < strike.samples; ++i) {
    model.tick(controls);
    motion.displacement.push_back(model.displacement());
    motion.force.push_back(model.force());
  }
  return motion;
}

template <std::floating_point T>
[[nodiscard]] Motion<T> run_twin(SegmentTable<T> table, const Strike& strike) {
  MassBarrier<T> model(table, static_cast<T>(strike.sample_rate_hz));
  return run_twin(model, strike);
}

template <std::floating_point T>
[[nodiscard]] Motion<T> run_faust(FaustProgram<T>& program, const Strike& strike) {
  program.set("throw", 1);
  program.set("speed", static_cast<T>(strike.speed_m_per_s));
  program.set("start", static_cast<T>(strike.start_m));
  program.set("mass", static_cast<T>(strike.mass_kg));
  program.set("stiffness ratio", static_cast<T>(strike.stiffness_ratio));
  if (strike.loss_s_per_m != kMaterialsLoss) program.set("loss", static_cast<T>(strike.loss_s_per_m));
  program.set("gravity", static_cast<T>(strike.gravity_m_per_s2));
  Signals<T> outputs = program.run({}, strike.samples);
  return {std::move(outputs.at(0)), std::move(outputs.at(1))};
}

}  // namespace contactspline::testing
