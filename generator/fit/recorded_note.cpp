// SPDX-License-Identifier: MIT
#include "generator/fit/recorded_note.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "generator/support/error.hpp"

namespace contactspline {
namespace {

using std::numbers::pi;

constexpr double kAfterOnset_s = 0.01, kMinWindow_s = 0.1, kMinPeriods = 8;
constexpr double kHighest = 0.45;       // of the sample rate
constexpr double kStandingOut_db = 20;  // from what is beside a partial

double decibels(double ratio) {
  return 20 * std::log10(ratio);
}

double peak_of(const std::vector<double>& samples) {
  double peak = 0;
  for (const double sample : samples) peak = std::max(peak, std::abs(sample));
  return peak;
}

// A converter that reaches its limit shows the same value for a while. So does the round top of a soft low note.
void require_unsaturated(const RecordedSound& recording, const std::string& file, double peak) {
  constexpr double kLoud = 0.5;
  constexpr std::size_t kRun = 5;
  std::size_t run = 0, longest = 0;
  double last = 0;
  for (const double sample : recording.samples) {
    run = std::abs(sample) >= peak * (1 - 1e-9) && sample == last ? run + 1 : 1;
    if (std::abs(sample) >= peak * (1 - 1e-9)) longest = std::max(longest, run);
    last = sample;
  }
  if (peak >= kLoud && longest >= kRun)
    refuse(file, "samples", fmt::format("{} in a row are at the peak of {:.4g}: it is saturated", longest, peak),
           "a recording below full scale");
}

/// The part of a recording that is looked at, with its window.
class Window {
 public:
  Window(const RecordedSound& recording, const std::string& file, double lowest_hz)
      : rate_hz_(recording.sample_rate_hz), length_s_(std::max(kMinWindow_s, kMinPeriods / lowest_hz)) {
    require_sounding(recording, file);
    const auto onset = recording.samples.begin() +
                       static_cast<std::ptrdiff_t>(std::max(0.0, onset_of(recording.samples, rate_hz_) * rate_hz_));
    const auto rest = static_cast<double>(recording.samples.end() - onset);
    const auto count = static_cast<std::ptrdiff_t>(length_s_ * rate_hz_);
    if (rest < (kAfterOnset_s + length_s_) * rate_hz_ + 1)
      refuse(file, "samples", fmt::format("{:.3g} s remain from the onset on", rest / rate_hz_),
             fmt::format("{:.3g} s or more", kAfterOnset_s + length_s_));
    const auto begin = onset + static_cast<std::ptrdiff_t>(kAfterOnset_s * rate_hz_);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      weights_.push_back(0.5 - 0.5 * std::cos(2 * pi * (static_cast<double>(i) + 0.5) / static_cast<double>(count)));
      weighted_.push_back(weights_.back() * begin[i]);
    }
  }

  [[nodiscard]] double resolution_hz() const { return 1 / length_s_; }

  /// Magnitude of the spectrum.
  [[nodiscard]] double at(double frequency_hz) const {
    const std::complex<double> rotation = std::polar(1.0, -2 * pi * frequency_hz / rate_hz_);
    std::complex<double> sum = 0;
    for (std::size_t i = weighted_.size(); i-- > 0;) sum = sum * rotation + weighted_[i];  // Horner
    return std::abs(sum);
  }

  /// Its magnitude at its own frequency if a partial of amplitude 1 at the onset decays so.
  [[nodiscard]] double of_decay(double decay_per_s) const {
    double sum = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i)
      sum += weights_[i] * std::exp(-decay_per_s * (kAfterOnset_s + static_cast<double>(i) / rate_hz_));
    return sum / 2;
  }

 private:
  double rate_hz_, length_s_;
  std::vector<double> weights_, weighted_;
};

// The largest magnitude between two frequencies if it is a peak, and what is beside it.
struct Peak {
  double magnitude, beside;
  bool is_inside;
};

Peak peak_between(const Window& window, double low_hz, double high_hz) {
  const double step = window.resolution_hz() / 4;
  const int count = static_cast<int>(std::ceil((high_hz - low_hz) / step));
  std::vector<double> magnitudes;
  for (int i = -1; i <= count + 1; ++i) magnitudes.push_back(window.at(low_hz + i * step));
  const auto found = std::ranges::max_element(magnitudes);
  const auto k = found - magnitudes.begin();
  if (k == 0 || k == count + 2) return {*found, *found, false};
  // The top of the parabola through the logarithms.
  const double a = std::log(found[-1]), b = std::log(found[0]), c = std::log(found[1]);
  const double top = std::exp(b - (c - a) * (c - a) / (8 * (a - 2 * b + c)));
  const double at = low_hz + static_cast<double>(k - 1) * step;
  std::vector<double> around;
  for (const double distance : {4.5, 5.5, 6.5, 7.5})  // the main lobe ends at 2
    for (const double sign : {-1, 1}) around.push_back(window.at(at + sign * distance * window.resolution_hz()));
  std::nth_element(around.begin(), around.begin() + 4, around.end());
  return {top, around[4], true};
}

std::optional<double> level_of(const Window& window, const StruckResonator& struck, std::size_t i) {
  const double frequency = struck.modes[i].frequency_hz();
  double low = frequency * (1 - StruckResonator::kMistuned), high = frequency * (1 + StruckResonator::kMistuned);
  for (std::size_t k = 0; k < struck.modes.size(); ++k)
    if (k != i && struck.sounds(k)) {
      const double other = struck.modes[k].frequency_hz(), between = (frequency + other) / 2;
      (other < frequency ? low : high) = other < frequency ? std::max(low, between) : std::min(high, between);
    }
  const double min_distance = 0.5 * window.resolution_hz();
  if (high - frequency < min_distance || frequency - low < min_distance) return std::nullopt;
  const Peak peak = peak_between(window, low, high);
  if (!peak.is_inside || !(decibels(peak.magnitude / peak.beside) >= kStandingOut_db)) return std::nullopt;
  return decibels(peak.magnitude / window.of_decay(struck.modes[i].decay_per_s));
}

// The mean squares of 10 ms each.
std::vector<double> powers_of(const RecordedSound& recording) {
  const auto length = static_cast<std::size_t>(0.01 * recording.sample_rate_hz);
  std::vector<double> powers;
  for (std::size_t begin = 0; begin + length <= recording.samples.size(); begin += length) {
    const auto part = std::span(recording.samples).subspan(begin, length);
    powers.push_back(std::inner_product(part.begin(), part.end(), part.begin(), 0.0) / static_cast<double>(length));
  }
  return powers;
}

}  // namespace

double onset_of(std::span<const double> samples, double sample_rate_hz) {
  constexpr double kAverage_s = 0.005, kOnset = 0.01;
  const auto window = static_cast<std::size_t>(kAverage_s * sample_rate_hz);
  std::vector<double> sums;
  double sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sum += samples[i] * samples[i];
    if (i >= window) sum -= samples[i - window] * samples[i - window];
    sums.push_back(std::max(sum, 0.0));
  }
  const double least = kOnset * std::ranges::max(sums);
  const auto found = std::ranges::find_if(sums, [&](double power) { return power >= least; });
  const double before = found == sums.begin() ? 0 : found[-1];
  return (static_cast<double>(found - sums.begin()) - (*found - least) / (*found - before)) / sample_rate_hz;
}

void require_sounding(const RecordedSound& recording, const std::string& file) {
  const double peak = peak_of(recording.samples);
  if (peak == 0) refuse(file, "samples", "the recording is silent", "a struck note");
  require_unsaturated(recording, file, peak);
}

void require_one_sound(RecordedSound& recording, const std::string& file) {
  constexpr double kPause = 1e-3, kRounding = 1e-9;
  require_sounding(recording, file);
  std::vector<double>& samples = recording.samples;
  const double offset = std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
  for (double& sample : samples) sample -= offset;
  if (std::all_of(samples.begin(), samples.end(),
                  [&](double sample) { return std::abs(sample) <= kRounding * std::abs(offset); }))
    refuse(file, "samples", "the recording is silent", "a struck note");
  const std::vector<double> powers = powers_of(recording);
  if (powers.empty()) return;
  const auto loudest = std::max_element(powers.begin(), powers.end());
  const double onset_s = onset_of(samples, recording.sample_rate_hz);
  const auto begin =
      powers.begin() +
      std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(std::max(0.0, 100 * onset_s)), loudest - powers.begin());
  if (std::any_of(begin, loudest, [&](double power) { return power < kPause * *loudest; }))
    refuse(file, "samples",
           fmt::format("something sounds {:.2g} s before the note", 0.01 * static_cast<double>(loudest - begin)),
           "one note, without what is before it");
}

std::vector<Blow::Level> levels_of(const RecordedSound& recording, const std::string& file,
                                   const StruckResonator& struck,
                                   const std::optional<std::vector<std::size_t>>& partials) {
  const Window window(recording, file, struck.modes.front().frequency_hz());
  std::vector<Blow::Level> levels;
  for (std::size_t i = 0; i < struck.modes.size(); ++i) {
    const bool is_chosen = partials && std::ranges::find(*partials, i) != partials->end();
    if (partials && !is_chosen) continue;
    const double frequency = struck.modes[i].frequency_hz(), rate = recording.sample_rate_hz;
    if (is_chosen && frequency > kHighest * rate)
      refuse(file, "partials",
             fmt::format("partial {} of {:.6g} Hz is above {} of the sample rate of {} Hz", i + 1, frequency,
                         kHighest, rate),
             fmt::format("partials up to {} Hz", kHighest * rate));
    if (!struck.sounds(i) || frequency > kHighest * rate) continue;
    const auto level = level_of(window, struck, i);
    if (level) levels.push_back({i, *level});
    if (is_chosen && !level)
      refuse(file, "partials",
             fmt::format("partial {} of {:.6g} Hz does not stand out of the spectrum", i + 1, frequency),
             fmt::format("partials {} dB above what is beside them", kStandingOut_db));
  }
  return levels;
}

}  // namespace contactspline
