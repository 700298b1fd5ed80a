// SPDX-License-Identifier: MIT
#include "generator/player/mass_barrier_player.hpp"

#include <algorithm>
#include <cmath>

namespace contactspline {

MassBarrierMotion play_mass_barrier(std::span<const Segment<double>> table, const MassBarrierScore& score,
                                    const Progress& progress) {
  const auto samples = static_cast<std::size_t>(std::llround(score.duration_s * score.sample_rate_hz));
  const std::size_t block = std::max<std::size_t>(1, samples / 100);
  MassBarrier<double> model(table, score.sample_rate_hz);
  MassBarrierMotion motion{score.sample_rate_hz, {}, {}};
  motion.displacement_m.reserve(samples);
  motion.force_n.reserve(samples);
  model.throw_from(score.start_m, score.speed_m_per_s);
  for (std::size_t i = 0; i < samples; ++i) {
    if (i % block == 0) progress(static_cast<double>(i) / static_cast<double>(samples));
    model.tick(score.controls);
    motion.displacement_m.push_back(model.displacement());
    motion.force_n.push_back(model.force());
  }
  progress(1);
  return motion;
}

}  // namespace contactspline
