// SPDX-License-Identifier: MIT
#include "generator/listen/note_impression.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace contactspline {
namespace {

constexpr double kWindow_s = 0.046, kBefore_s = 0.003;
constexpr double kLowest_hz = 60, kHighest_hz = 16000, kHighest = 0.45;  // of the sample rate
constexpr double kPartialsBegin_s = 0.02, kPartialsWindow_s = 0.4;

double decibels(double power) {
  return 10 * std::log10(power);
}

double mel(double frequency_hz) {
  return 2595 * std::log10(1 + frequency_hz / 700);
}

double frequency_of(double mel) {
  return 700 * (std::pow(10, mel / 2595) - 1);
}

/// Powers of the spectrum of windowed samples.
class Spectrum {
 public:
  /// later: the window begins by this part of a sample later, 0 to 1, so that spectra follow an onset without steps.
  Spectrum(std::size_t window, std::size_t length, double later = 0) : window_(window), part_(length) {
    for (std::size_t i = 0; i < window; ++i) {
      const double phase = (static_cast<double>(i) + 1 - later) / static_cast<double>(window + 1);
      window_[i] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * phase);
    }
    fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  }

  /// From a sample on; there is silence beyond both ends.
  const std::vector<double>& from(std::span<const double> samples, std::ptrdiff_t begin) {
    for (std::size_t i = 0; i < window_.size(); ++i) {
      const std::ptrdiff_t at = begin + static_cast<std::ptrdiff_t>(i);
      part_[i] = at >= 0 && at < std::ssize(samples) ? window_[i] * samples[static_cast<std::size_t>(at)] : 0;
    }
    fft_.fwd(bins_, part_);
    power_.resize(bins_.size());
    std::ranges::transform(bins_, power_.begin(), [](const std::complex<double>& bin) { return std::norm(bin); });
    return power_;
  }

 private:
  Eigen::FFT<double> fft_;
  std::vector<double> window_, part_, power_;
  std::vector<std::complex<double>> bins_;
};

/// Weights of the bins of a spectrum in one band.
struct Band {
  double middle_hz;
  std::size_t first;
  std::vector<double> weights;

  [[nodiscard]] double power(const std::vector<double>& bins) const {
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * bins[first + i];
    return sum;
  }
};

std::vector<Band> bands_of(double sample_rate_hz, std::size_t length) {
  const double lowest = mel(kLowest_hz), highest = mel(std::min(kHighest_hz, kHighest * sample_rate_hz));
  const double bin_hz = sample_rate_hz / static_cast<double>(length);
  const auto edge = [&](std::size_t i) {
    return frequency_of(lowest + (highest - lowest) * static_cast<double>(i) / (NoteImpression::kBands + 1));
  };
  std::vector<Band> bands;
  for (std::size_t b = 0; b < NoteImpression::kBands; ++b) {
    const double low = edge(b), middle = edge(b + 1), high = edge(b + 2);
    Band band{middle, static_cast<std::size_t>(std::ceil(low / bin_hz)), {}};
    double sum = 0;
    for (std::size_t i = band.first; static_cast<double>(i) * bin_hz < high; ++i) {
      const double hz = static_cast<double>(i) * bin_hz;
      band.weights.push_back(hz < middle ? (hz - low) / (middle - low) : (high - hz) / (high - middle));
      sum += band.weights.back();
    }
    for (double& weight : band.weights) weight /= sum;
    bands.push_back(std::move(band));
  }
  return bands;
}

// Does the peak at a bin stand out of the bins on both sides, beyond the lobe of the window?
bool stands_out(const std::vector<double>& power, std::size_t at, std::size_t lobe) {
  constexpr double kStandingOut = 15.8;  // 12 dB
  std::vector<double> beside;
  for (std::size_t i = lobe + 1; i <= 5 * lobe; ++i) {
    if (at >= i) beside.push_back(power[at - i]);
    if (at + i < power.size()) beside.push_back(power[at + i]);
  }
  const auto middle = beside.begin() + std::ssize(beside) / 2;
  std::ranges::nth_element(beside, middle);
  return power[at] >= kStandingOut * *middle;
}

std::vector<Partial> partials_of(std::span<const double> samples, std::size_t onset, double sample_rate_hz,
                                 double depth_db, std::size_t max_partials) {
  constexpr double kLobe = 3;  // to its end and beyond, in parts of 1/window
  const std::size_t begin = onset + static_cast<std::size_t>(kPartialsBegin_s * sample_rate_hz);
  if (begin >= samples.size()) return {};
  const std::size_t window =
      std::min(samples.size() - begin, static_cast<std::size_t>(kPartialsWindow_s * sample_rate_hz));
  const std::size_t length = std::bit_ceil(window + window / 2);
  const double bin_hz = sample_rate_hz / static_cast<double>(length);
  Spectrum spectrum(window, length);
  const std::vector<double>& power = spectrum.from(samples, static_cast<std::ptrdiff_t>(begin));
  const auto lobe = static_cast<std::size_t>(kLobe * static_cast<double>(length) / static_cast<double>(window));
  const auto first = static_cast<std::size_t>(0.5 * kLowest_hz / bin_hz) + lobe;
  const auto last = std::min(power.size() - lobe - 1, static_cast<std::size_t>(kHighest * sample_rate_hz / bin_hz));
  std::vector<Partial> found;
  for (std::size_t i = first; i < last; ++i) {
    if (!(power[i] > 0) || power[i] < power[i - 1] || power[i] < power[i + 1]) continue;
    const auto around = std::span(power).subspan(i - lobe, 2 * lobe + 1);
    if (power[i] < std::ranges::max(around) || !stands_out(power, i, lobe)) continue;
    const double a = decibels(power[i - 1]), b = decibels(power[i]), c = decibels(power[i + 1]);
    found.push_back({(static_cast<double>(i) + 0.5 * (a - c) / (a - 2 * b + c)) * bin_hz, b});
  }
  std::ranges::sort(found, std::ranges::greater(), &Partial::level_db);
  std::erase_if(found, [&](const Partial& partial) { return partial.level_db < found.front().level_db - depth_db; });
  if (found.size() > max_partials) found.resize(max_partials);
  return found;
}

// The mean power of each band before the onset, from the windows that fit there.
std::vector<double> noise_before(Spectrum& spectrum, const std::vector<Band>& bands, std::span<const double> samples,
                                 std::ptrdiff_t onset, std::ptrdiff_t window) {
  std::vector<double> noise(bands.size());
  double frames = 0;
  for (std::ptrdiff_t begin = onset - window; begin >= 0; begin -= window / 2) {
    const std::vector<double>& power = spectrum.from(samples, begin);
    for (std::size_t b = 0; b < bands.size(); ++b) noise[b] += bands[b].power(power);
    ++frames;
  }
  for (double& power : noise) power /= std::max(frames, 1.0);
  return noise;
}

// A frame and a band of both impressions, as powers above the floor of the recording.
struct Cell {
  double recorded, rendered, beside;  ///< beside: what is added to both, noise to the rendered one alone
};

template <typename Take>
void for_cells(const NoteImpression& recorded, const NoteImpression& rendered, const Take& take) {
  const double floor = recorded.loudest() * std::pow(10, NoteImpression::kFloor_db / 10);
  for (std::size_t i = 0; i < recorded.power.size(); ++i) {
    const double power = i < rendered.power.size() ? rendered.power[i] : 0;
    take(Cell{recorded.power[i] + floor, power, recorded.noise[i % NoteImpression::kBands] + floor});
  }
}

}  // namespace

double NoteImpression::loudest() const {
  return std::ranges::max(power);
}

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

NoteImpression impression_of(std::span<const double> samples, double sample_rate_hz, double seconds, double depth_db,
                             std::size_t max_partials) {
  const std::size_t window = std::bit_ceil(static_cast<std::size_t>(0.75 * kWindow_s * sample_rate_hz));
  const auto hop = static_cast<std::ptrdiff_t>(window / 4);
  const std::vector<Band> bands = bands_of(sample_rate_hz, window);
  const double exact_begin = (onset_of(samples, sample_rate_hz) - kBefore_s) * sample_rate_hz;
  const auto begin = static_cast<std::ptrdiff_t>(std::floor(exact_begin));
  const auto end = std::min(std::ssize(samples), begin + static_cast<std::ptrdiff_t>(seconds * sample_rate_hz));
  NoteImpression impression{static_cast<double>(hop) / sample_rate_hz, {}, {}, {}, {}};
  Spectrum spectrum(window, window, exact_begin - static_cast<double>(begin));
  for (const Band& band : bands) impression.band_hz.push_back(band.middle_hz);
  for (std::ptrdiff_t at = begin; at + static_cast<std::ptrdiff_t>(window) <= end; at += hop) {
    const std::vector<double>& power = spectrum.from(samples, at);
    for (const Band& band : bands) impression.power.push_back(band.power(power));
  }
  impression.noise = noise_before(spectrum, bands, samples, begin, static_cast<std::ptrdiff_t>(window));
  impression.partials = partials_of(samples, static_cast<std::size_t>(std::max<std::ptrdiff_t>(begin, 0)),
                                    sample_rate_hz, depth_db, max_partials);
  return impression;
}

double gain_between(std::span<const NoteImpression* const> recorded,
                    std::span<const NoteImpression* const> rendered) {
  constexpr int kSteps = 8;
  double theirs = 0, ours = 0;
  for (std::size_t n = 0; n < recorded.size(); ++n)
    for_cells(*recorded[n], *rendered[n], [&](const Cell& cell) {
      theirs += cell.recorded;
      ours += cell.rendered;
    });
  double gain_db = decibels(theirs / ours);
  for (int step = 0; step < kSteps; ++step) {
    const double gain = std::pow(10, gain_db / 10);
    double slope = 0, squares = 0;  // of the levels rendered over the gain
    for (std::size_t n = 0; n < recorded.size(); ++n)
      for_cells(*recorded[n], *rendered[n], [&](const Cell& cell) {
        const double all = gain * cell.rendered + cell.beside, weight = gain * cell.rendered / all;
        slope += weight * decibels(cell.recorded / all);
        squares += weight * weight;
      });
    gain_db += slope / squares;
  }
  return gain_db;
}

NoteDifference compare(const NoteImpression& recorded, const NoteImpression& rendered, double gain_db) {
  constexpr double kFarthest_cents = 2400;
  const double gain = std::pow(10, gain_db / 10);
  NoteDifference difference;
  for_cells(recorded, rendered, [&](const Cell& cell) {
    difference.level_db.push_back(decibels(cell.recorded / (gain * cell.rendered + cell.beside)));
  });
  for (const Partial& partial : recorded.partials) {
    double nearest = kFarthest_cents;
    for (const Partial& other : rendered.partials) {
      const double cents = 1200 * std::log2(other.frequency_hz / partial.frequency_hz);
      if (std::abs(cents) < std::abs(nearest)) nearest = cents;
    }
    difference.cents.push_back(nearest);
  }
  return difference;
}

double distance_db(const NoteImpression& recorded, const NoteImpression& rendered, double gain_db) {
  const double floor = recorded.loudest() * std::pow(10, NoteImpression::kFloor_db / 10),
               gain = std::pow(10, gain_db / 10);
  double sum = 0;
  for (std::size_t i = 0; i < recorded.power.size(); ++i) {
    const double power = i < rendered.power.size() ? rendered.power[i] : 0;
    sum += std::abs(decibels(std::max(recorded.power[i], floor) / std::max(gain * power, floor)));
  }
  return sum / static_cast<double>(recorded.power.size());
}

}  // namespace contactspline
