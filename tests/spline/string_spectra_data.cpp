// SPDX-License-Identifier: MIT
// Prints the data of docs/figures/string_spectra.svg: the level of the partials of C4 after a soft and a loud blow.
#include <algorithm>
#include <cstdio>

#include "bench/baselines/modal_string.hpp"
#include "string_partials.hpp"

namespace contactspline::testing {
namespace {

double decibels(double velocity) {
  return 20 * std::log10(std::max(velocity, 1e-9));
}

// For each partial: frequency [Hz] and levels [dB relative to 1 m/s] before, now and of the exact law.
void print(const StruckNote& note, double speed_m_per_s) {
  const Spline uniform = note.spline_of(Knots::uniform, ErrorOf::contact_duration, 32);
  const Spline spectrum = note.spline_of(Knots::optimal, ErrorOf::spectrum, 32);
  // As in version 0.1.0.
  const auto before =
      note.velocities(bench::with_mass_kept(note.modes(), kRate_hz), uniform, speed_m_per_s, kRate_hz);
  const auto now = note.heard_velocities(spectrum, speed_m_per_s);
  const auto exact = note.exact_velocities(speed_m_per_s);
  for (std::size_t k = 0; k < exact.size(); ++k)
    if (std::abs(note.strike_shapes()[k]) > 1e-6)
      std::printf("%g %g %g %g\n", note.frequency_hz(k), decibels(before[k]), decibels(now[k]), decibels(exact[k]));
  std::printf("\n\n");
}

}  // namespace
}  // namespace contactspline::testing

int main() {
  const contactspline::testing::StruckNote c4("c4");
  for (const double speed_m_per_s : {0.5, 4.0}) contactspline::testing::print(c4, speed_m_per_s);
}
