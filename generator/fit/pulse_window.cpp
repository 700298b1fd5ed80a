// SPDX-License-Identifier: MIT
#include "generator/fit/pulse_window.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

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

/// The samples around the largest force: the first and the last one of those above another force.
struct SamplesOfContact {
  std::size_t begin, end, peak;
};

SamplesOfContact samples_above(const std::vector<double>& force, double least) {
  const auto peak = static_cast<std::size_t>(std::ranges::max_element(force) - force.begin());
  SamplesOfContact contact{peak, peak, peak};
  while (contact.begin > 0 && force[contact.begin - 1] > least) --contact.begin;
  while (contact.end + 1 < force.size() && force[contact.end + 1] > least) ++contact.end;
  return contact;
}

SamplesOfContact contact_of(const Pulse& pulse) {
  return samples_above(pulse.force_n, kThreshold * std::ranges::max(pulse.force_n));
}

void require_contact(const Pulse& pulse) {
  const auto [low, high] = std::ranges::minmax(pulse.force_n);
  if (low == high)
    refuse(pulse.file, "force", fmt::format("is {:.4g} N throughout: there is no contact", low), "one pulse");
  const double noise = white_noise_of(pulse.force_n);
  constexpr double kMinRatio = 10;
  if (!(high - low > kMinRatio * noise))
    refuse(pulse.file, "force", fmt::format("no contact stands out of noise of {:.3g} N", noise),
           "one pulse, well above the noise");
  std::vector<double> sorted = pulse.force_n;
  std::ranges::sort(sorted);
  const double rest = sorted[sorted.size() / 2];
  if (rest - low > high - rest)
    refuse(pulse.file, "force", fmt::format("reaches {:.4g} N downwards", low),
           "a force that is positive in contact: change the sign of the column");
}

void require_unit(const Pulse& pulse, const SamplesOfContact& contact) {
  const double high = pulse.force_n[contact.peak];
  if (!(high >= kMeasuredForce.min && high <= kMeasuredForce.max))
    refuse(pulse.file, "force", fmt::format("reaches {:.4g} N: a wrong unit?", high),
           fmt::format("a largest force from {} to {} N", kMeasuredForce.min, kMeasuredForce.max));
}

/// What a sensor shows without a contact: a sum of 1, of the time from -1 to 1 and of the cosine and sine of a hum,
/// as many of these as there are factors.
struct Baseline {
  double hum_hz;  ///< 0: none
  Eigen::VectorXd factors;
  double squares;  ///< of what remains outside the contact
};

Eigen::MatrixXd terms_of(const Pulse& pulse, const Eigen::ArrayXd& times, Eigen::Index count, double hum_hz) {
  const double begin = pulse.time_s.front(), end = pulse.time_s.back();
  const Eigen::ArrayXd phase = 2 * std::numbers::pi * hum_hz * (times - begin);
  Eigen::MatrixXd terms(times.size(), 4);
  terms << Eigen::VectorXd::Ones(times.size()), 2 * (times - begin) / (end - begin) - 1, phase.cos(), phase.sin();
  return terms.leftCols(count);
}

// The sum of the first `count` terms that is nearest to these samples.
Baseline baseline_through(const Pulse& pulse, const std::vector<std::size_t>& samples, Eigen::Index count,
                          double hum_hz) {
  const Eigen::Map<const Eigen::VectorXd> times(pulse.time_s.data(), std::ssize(pulse.time_s)),
      all_forces(pulse.force_n.data(), std::ssize(pulse.force_n));
  const Eigen::MatrixXd terms = terms_of(pulse, times(samples), count, hum_hz);
  const Eigen::VectorXd forces = all_forces(samples), factors = terms.householderQr().solve(forces);
  return {hum_hz, factors, (forces - terms * factors).squaredNorm()};
}

// The samples before and after the contact, `far` times as far away as it lasts above a third of its height.
std::vector<std::size_t> samples_outside(const Pulse& pulse, double far) {
  const auto& force = pulse.force_n;
  std::vector<double> sorted = force;
  std::ranges::sort(sorted);
  const double rest = sorted[sorted.size() / 4], third = rest + (sorted.back() - rest) / 3;
  const SamplesOfContact contact = samples_above(force, third);
  const double begin = pulse.time_s[contact.begin], end = pulse.time_s[contact.end], away = far * (end - begin);
  std::vector<std::size_t> outside;
  for (std::size_t i = 0; i < force.size(); ++i)
    if (force[i] < third && (pulse.time_s[i] < begin - away || pulse.time_s[i] > end + away)) outside.push_back(i);
  return outside;
}

// A hum of the mains is taken away only where it makes what remains so much less that chance is no explanation, and
// where the record shows most of a period of it.
std::optional<Baseline> baseline_of(const Pulse& pulse) {
  constexpr std::size_t kFewest = 8;
  const std::vector<std::size_t> outside = samples_outside(pulse, 0.75);
  if (outside.size() < kFewest) return std::nullopt;
  // From samples on one side alone a drift would be a guess.
  const auto peak = static_cast<std::size_t>(std::ranges::max_element(pulse.force_n) - pulse.force_n.begin());
  const auto before = std::ranges::count_if(outside, [&](std::size_t i) { return i < peak; });
  const bool is_around = before >= 3 && std::ssize(outside) - before >= 3;
  Baseline best = baseline_through(pulse, outside, is_around ? 2 : 1, 0);
  // Further away, where no contact that begins softly looks like a hum.
  const std::vector<std::size_t> far = samples_outside(pulse, 2);
  constexpr double kEvidence = 30, kPeriods = 0.8;
  if (!is_around || far.size() < 5 * kFewest) return best;
  const auto n = static_cast<double>(far.size());
  const double shown_s = pulse.time_s[far.back()] - pulse.time_s[far.front()];
  double least = baseline_through(pulse, far, 2, 0).squares * std::exp(-kEvidence / n);
  for (const double hz : {50.0, 60.0}) {
    if (!(shown_s * hz > kPeriods)) continue;
    const Baseline hum = baseline_through(pulse, far, 4, hz);
    if (hum.squares < least) best = hum, least = hum.squares;
  }
  return best;
}

// Without what the sensor shows before and after the contact: an offset, a drift, a hum. What is left of offset and
// drift is fitted.
void take_baseline_away(Pulse& pulse) {
  const auto line = baseline_of(pulse);
  if (!line) return;
  const Eigen::Map<const Eigen::VectorXd> times(pulse.time_s.data(), std::ssize(pulse.time_s));
  Eigen::Map<Eigen::VectorXd>(pulse.force_n.data(), times.size()) -=
      terms_of(pulse, times, line->factors.size(), line->hum_hz) * line->factors;
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

// Of white noise they are the root of 6 times as large.
double white_noise_of(const std::vector<double>& force) {
  std::vector<double> differences;
  for (std::size_t i = 2; i < force.size(); ++i)
    differences.push_back(std::abs(force[i] - 2 * force[i - 1] + force[i - 2]));
  const auto middle = differences.begin() + std::ssize(differences) / 2;
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle / 0.6745 / std::sqrt(6.0);
}

PulseMeasures measures_of(const Pulse& pulse) {
  const SamplesOfContact contact = contact_of(pulse);
  const double begin = pulse.time_s[contact.begin], end = pulse.time_s[contact.end], away = (end - begin) / 2;
  double impulse = 0;
  for (std::size_t i = 1; i < pulse.time_s.size(); ++i)
    if (pulse.time_s[i - 1] > begin - away && pulse.time_s[i] < end + away)
      impulse += (pulse.force_n[i] + pulse.force_n[i - 1]) / 2 * (pulse.time_s[i] - pulse.time_s[i - 1]);
  return {begin, end, pulse.force_n[contact.peak], impulse};
}

namespace {

// The means of neighbours: of many samples they tell as much, and take less time.
Pulse averaged(const Pulse& pulse) {
  constexpr std::size_t kSamples = 1500;
  const std::size_t together = (pulse.time_s.size() + kSamples - 1) / kSamples;
  if (together < 2) return pulse;
  Pulse few = pulse;
  few.recorded = pulse.time_s.size();
  few.time_s.clear(), few.force_n.clear();
  for (std::size_t i = 0; i + together <= pulse.time_s.size(); i += together) {
    double time = 0, force = 0;
    for (std::size_t k = i; k < i + together; ++k) time += pulse.time_s[k], force += pulse.force_n[k];
    few.time_s.push_back(time / static_cast<double>(together));
    few.force_n.push_back(force / static_cast<double>(together));
  }
  return few;
}

}  // namespace

Pulse contact_window(const Pulse& recorded, std::span<const std::size_t> lines, double mass_kg) {
  require_times(recorded, lines);
  require_contact(recorded);
  require_unsaturated(recorded, contact_of(recorded));
  Pulse pulse = recorded;
  take_baseline_away(pulse);
  const SamplesOfContact contact = contact_of(pulse);
  require_unit(pulse, contact);
  require_whole(pulse, contact);
  const double begin = pulse.time_s[contact.begin], end = pulse.time_s[contact.end], margin = end - begin;
  Pulse window = pulse;
  window.time_s.clear(), window.force_n.clear();
  for (std::size_t i = 0; i < pulse.time_s.size(); ++i)
    if (pulse.time_s[i] > begin - margin && pulse.time_s[i] < end + margin) {
      window.time_s.push_back(pulse.time_s[i]);
      window.force_n.push_back(pulse.force_n[i]);
    }
  require_impulse(window, mass_kg);
  return averaged(window);
}

}  // namespace contactspline
