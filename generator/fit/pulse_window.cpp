// SPDX-License-Identifier: MIT
#include "generator/fit/pulse_window.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kMinSamples = 16, kMinInContact = 8;
constexpr double kThreshold = 0.1;  // of the largest force: contact for sure

void require_times(const Pulse& pulse, std::span<const std::size_t> lines) {
  const auto& time = pulse.time_s;
  if (time.size() < kMinSamples)
    refuse(pulse.file, "samples", fmt::format("has {}", time.size()), fmt::format("{} or more", kMinSamples));
  for (std::size_t i = 1; i < time.size(); ++i)
    if (!(time[i] > time[i - 1]))
      refuse(pulse.file, fmt::format("line {}", lines[i]),
             fmt::format("time {:.9g} s does not rise from {:.9g} s", time[i], time[i - 1]),
             "rising times; are two columns exchanged?");
}

/// The samples of the contact: the first and the last one above a tenth of the largest force.
struct SamplesOfContact {
  std::size_t begin, end, peak;
};

SamplesOfContact contact_of(const Pulse& pulse) {
  const auto& force = pulse.force_n;
  const auto peak = static_cast<std::size_t>(std::ranges::max_element(force) - force.begin());
  SamplesOfContact contact{peak, peak, peak};
  while (contact.begin > 0 && force[contact.begin - 1] > kThreshold * force[peak]) --contact.begin;
  while (contact.end + 1 < force.size() && force[contact.end + 1] > kThreshold * force[peak]) ++contact.end;
  return contact;
}

// Second differences take the contact away and leave white noise, times the root of 6.
double noise_of(const std::vector<double>& force) {
  std::vector<double> differences;
  for (std::size_t i = 2; i < force.size(); ++i)
    differences.push_back(std::abs(force[i] - 2 * force[i - 1] + force[i - 2]));
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle / 0.6745 / std::sqrt(6.0);
}

void require_contact(const Pulse& pulse) {
  const auto [low, high] = std::ranges::minmax(pulse.force_n);
  if (low == high)
    refuse(pulse.file, "force", fmt::format("is {:.4g} N throughout: there is no contact", low), "one pulse");
  const double noise = noise_of(pulse.force_n);
  constexpr double kMinRatio = 10;
  if (!(high - low > kMinRatio * noise))
    refuse(pulse.file, "force", fmt::format("no contact stands out of noise of {:.3g} N", noise),
           "one pulse, well above the noise");
  if (-low > high)
    refuse(pulse.file, "force", fmt::format("reaches {:.4g} N downwards", low),
           "a force that is positive in contact: change the sign of the column");
  if (!(high >= kMeasuredForce.min && high <= kMeasuredForce.max))
    refuse(pulse.file, "force", fmt::format("reaches {:.4g} N: a wrong unit?", high),
           fmt::format("a largest force from {} to {} N", kMeasuredForce.min, kMeasuredForce.max));
}

void require_whole(const Pulse& pulse, const SamplesOfContact& contact) {
  const auto& force = pulse.force_n;
  if (contact.begin == 0)
    refuse(pulse.file, "force", "the record begins within the contact", "samples from before the contact on");
  if (contact.end + 1 == force.size())
    refuse(pulse.file, "force", "the record ends within the contact", "samples up to after the contact");
  if (contact.end - contact.begin + 1 < kMinInContact)
    refuse(pulse.file, "samples", fmt::format("has {} in the contact", contact.end - contact.begin + 1),
           fmt::format("{} or more: a higher sample rate", kMinInContact));
  for (std::size_t i = 0; i < force.size(); ++i)
    if ((i + 1 < contact.begin || i > contact.end + 1) && force[i] > 0.4 * force[contact.peak])
      refuse(pulse.file, "force", fmt::format("has a second contact at {:.6g} s", pulse.time_s[i]),
             "a record of one contact: cut it before the rebound");
}

// A sensor that reaches its limit shows the same value for a while; a round top does not, whatever its resolution.
void require_unsaturated(const Pulse& pulse, const SamplesOfContact& contact) {
  const double top = pulse.force_n[contact.peak];
  std::size_t equal = 0, run = 0;
  for (std::size_t i = contact.begin; i <= contact.end; ++i) {
    run = pulse.force_n[i] >= top * (1 - 1e-9) ? run + 1 : 0;
    equal = std::max(equal, run);
  }
  if (equal >= 4 && 8 * equal > contact.end - contact.begin + 1)
    refuse(pulse.file, "force", fmt::format("{} samples in a row are {:.6g} N: the sensor was saturated", equal, top),
           "a record within the range of the sensor");
}

// The wall takes up m v (1 + e), e from 0 to 1.
void require_impulse(const Pulse& pulse, double mass_kg) {
  const PulseMeasures measures = measures_of(pulse);
  const double duration = measures.end_s - measures.begin_s;
  if (!(duration >= kMeasuredDuration.min && duration <= kMeasuredDuration.max))
    refuse(pulse.file, "time", fmt::format("the contact lasts {:.4g} s: a wrong unit?", duration),
           fmt::format("{} to {} s", kMeasuredDuration.min, kMeasuredDuration.max));
  if (!pulse.speed_m_per_s || pulse.is_struck) return;  // a resonator may hold the hammer, or throw it back again
  const double ratio = measures.impulse_n_s / (mass_kg * *pulse.speed_m_per_s);
  if (!(ratio > 0.85 && ratio < 2.3))
    refuse(
        pulse.file, "force",
        fmt::format("its impulse is {:.4g} times mass times speed: is a unit, the mass or the speed wrong?", ratio),
        "1 to 2 times, for a restitution from 0 to 1");
}

}  // namespace

PulseMeasures measures_of(const Pulse& pulse) {
  const SamplesOfContact contact = contact_of(pulse);
  double impulse = 0;
  for (std::size_t i = 1; i < pulse.time_s.size(); ++i)
    impulse += (pulse.force_n[i] + pulse.force_n[i - 1]) / 2 * (pulse.time_s[i] - pulse.time_s[i - 1]);
  return {pulse.time_s[contact.begin], pulse.time_s[contact.end], pulse.force_n[contact.peak], impulse};
}

Pulse contact_window(const Pulse& pulse, std::span<const std::size_t> lines, double mass_kg) {
  require_times(pulse, lines);
  require_contact(pulse);
  const SamplesOfContact contact = contact_of(pulse);
  require_whole(pulse, contact);
  require_unsaturated(pulse, contact);
  const double begin = pulse.time_s[contact.begin], end = pulse.time_s[contact.end], margin = end - begin;
  Pulse window{pulse.file, {}, {}, pulse.speed_m_per_s, pulse.is_struck};
  for (std::size_t i = 0; i < pulse.time_s.size(); ++i)
    if (pulse.time_s[i] > begin - margin && pulse.time_s[i] < end + margin) {
      window.time_s.push_back(pulse.time_s[i]);
      window.force_n.push_back(pulse.force_n[i]);
    }
  require_impulse(window, mass_kg);
  return window;
}

}  // namespace contactspline
