// SPDX-License-Identifier: MIT
#include "generator/listen/note_impression.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "generator/fit/recorded_note.hpp"

namespace contactspline {
namespace {

constexpr double kWindow_s = 0.046, kBefore_s = 0.003;
constexpr double kLowest_hz = 60, kHighest_hz = 16000, kHighest = 0.45;  // of the sample rate
constexpr double kPartialsBegin_s = 0.02, kPartialsWindow_s = 0.4;

constexpr double kDecibelsOfE = 10 / std::numbers::ln10;

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

  // Of weights whose sum is 1, where noise correlates neighbouring bins behind a Hann window by 2/3 and 1/6.
  [[nodiscard]] double freedom() const {
    constexpr double kSquares[] = {1, 4.0 / 9, 1.0 / 36};
    double squares = 0;
    for (std::size_t i = 0; i < weights.size(); ++i)
      for (std::size_t lag = 0; lag <= std::min<std::size_t>(i, 2); ++lag)
        squares += (lag > 0 ? 2 : 1) * kSquares[lag] * weights[i] * weights[i - lag];
    return 1 / squares;
  }
};

std::vector<Band> bands_of(double sample_rate_hz, double recorded_rate_hz, std::size_t length) {
  const double lowest = mel(kLowest_hz), highest = mel(std::min(kHighest_hz, kHighest * recorded_rate_hz));
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

// All peaks that stand out, from 20 ms after the onset on, with the level of a sine of amplitude 2 as 0 dB.
std::vector<Partial> partials_of(std::span<const double> samples, std::size_t onset, double sample_rate_hz) {
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
    found.push_back({(static_cast<double>(i) + 0.5 * (a - c) / (a - 2 * b + c)) * bin_hz,
                     b - 20 * std::log10(static_cast<double>(window + 1) / 2)});
  }
  return found;
}

// The strongest, by falling level.
std::vector<Partial> strongest(std::vector<Partial> partials, double depth_db, std::size_t max_partials) {
  std::ranges::sort(partials, std::ranges::greater(), &Partial::level_db);
  std::erase_if(partials,
                [&](const Partial& partial) { return partial.level_db < partials.front().level_db - depth_db; });
  if (partials.size() > max_partials) partials.resize(max_partials);
  return partials;
}

// Takes away the partials that sound before the onset, too, by less than 6 dB softer: hum.
void erase_hum(std::vector<Partial>& partials, std::span<const double> before, double sample_rate_hz) {
  constexpr double kShortest_s = 0.1, kSofter_db = 6;
  const double before_s = static_cast<double>(before.size()) / sample_rate_hz;
  if (before_s < kShortest_s) return;
  const double length_s = std::min(before_s - kPartialsBegin_s, kPartialsWindow_s);
  const std::vector<Partial> hum = partials_of(before, 0, sample_rate_hz);
  std::erase_if(partials, [&](const Partial& partial) {
    return std::ranges::any_of(hum, [&](const Partial& other) {
      return std::abs(other.frequency_hz - partial.frequency_hz) < 1 / length_s &&
             other.level_db > partial.level_db - kSofter_db;
    });
  });
}

// Adds the mean power of each band before the onset, from the windows that fit there.
void add_noise(NoteImpression& impression, Spectrum& spectrum, const std::vector<Band>& bands,
               std::span<const double> samples, std::ptrdiff_t onset, std::ptrdiff_t window) {
  std::vector<double> noise(bands.size());
  double frames = 0;
  for (std::ptrdiff_t begin = onset - window; begin >= 0; begin -= window / 2) {
    const std::vector<double>& power = spectrum.from(samples, begin);
    for (std::size_t b = 0; b < bands.size(); ++b) noise[b] += bands[b].power(power);
    ++frames;
  }
  for (double& power : noise) power /= std::max(frames, 1.0);
  impression.noise = std::move(noise);
  impression.noise_frames = frames;
}

/// A level, and how much noise scatters it.
struct ExpectedLevel {
  double level_db, noise_db;
};

/// A frame and a band of both impressions.
struct Cell {
  double recorded, rendered, noise, floor;
  double freedom, noise_frames;

  [[nodiscard]] double recorded_db() const { return decibels(recorded + floor); }

  // The power of a sound of known power in noise has the mean and the variance of a sum of squares of normal numbers.
  // As that of a gamma distribution its logarithm has the mean log(shape) + digamma and the variance trigamma, which
  // are taken by their asymptotic series.
  [[nodiscard]] ExpectedLevel expected(double gain) const {
    const double sound = gain * rendered, all = sound + noise + floor;
    const double spread = noise * (2 * sound + noise) / (freedom * all * all);  // 1/shape
    const double of_estimate = noise_frames > 0 ? noise * noise / (freedom * noise_frames * all * all) : 0;
    const double mean = -spread * (0.5 + spread / 12), variance = spread * (1 + spread * (0.5 + spread / 6));
    return {decibels(all) + kDecibelsOfE * mean, kDecibelsOfE * std::sqrt(variance + of_estimate)};
  }
};

template <typename Take>
void for_cells(const NoteImpression& recorded, const NoteImpression& rendered, const Take& take) {
  const double floor = recorded.loudest() * std::pow(10, NoteImpression::kFloor_db / 10);
  for (std::size_t i = 0; i < recorded.power.size(); ++i) {
    const double power = i < rendered.power.size() ? rendered.power[i] : 0;
    const std::size_t band = i % NoteImpression::kBands;
    take(Cell{recorded.power[i], power, recorded.noise[band], floor, recorded.freedom[band], recorded.noise_frames});
  }
}

}  // namespace

double NoteImpression::loudest() const {
  return std::ranges::max(power);
}

NoteImpression impression_of(const Sound& sound, double seconds, double depth_db, std::size_t max_partials) {
  const auto& [samples, sample_rate_hz, recorded_rate_hz] = sound;
  const std::size_t window = std::bit_ceil(static_cast<std::size_t>(0.75 * kWindow_s * sample_rate_hz));
  const auto hop = static_cast<std::ptrdiff_t>(window / 4);
  const std::vector<Band> bands = bands_of(sample_rate_hz, recorded_rate_hz, window);
  const double exact_begin = (onset_of(samples, sample_rate_hz) - kBefore_s) * sample_rate_hz;
  const auto begin = static_cast<std::ptrdiff_t>(std::floor(exact_begin));
  const auto end = std::min(std::ssize(samples), begin + static_cast<std::ptrdiff_t>(seconds * sample_rate_hz));
  NoteImpression impression;
  impression.frame_s = static_cast<double>(hop) / sample_rate_hz;
  Spectrum spectrum(window, window, exact_begin - static_cast<double>(begin));
  for (const Band& band : bands) {
    impression.band_hz.push_back(band.middle_hz);
    impression.freedom.push_back(band.freedom());
  }
  for (std::ptrdiff_t at = begin; at + static_cast<std::ptrdiff_t>(window) <= end; at += hop) {
    const std::vector<double>& power = spectrum.from(samples, at);
    for (const Band& band : bands) impression.power.push_back(band.power(power));
  }
  add_noise(impression, spectrum, bands, samples, begin, static_cast<std::ptrdiff_t>(window));
  const auto onset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(begin, 0));
  std::vector<Partial> partials = partials_of(samples, onset, sample_rate_hz);
  erase_hum(partials, samples.first(onset), sample_rate_hz);
  impression.partials = strongest(std::move(partials), depth_db, max_partials);
  return impression;
}

double gain_between(const ComparedNotes& notes) {
  constexpr int kSteps = 8;
  double theirs = 0, ours = 0;
  for (std::size_t n = 0; n < notes.recorded.size(); ++n)
    for_cells(notes.recorded[n], notes.rendered[n], [&](const Cell& cell) {
      theirs += cell.recorded + cell.floor;
      ours += cell.rendered;
    });
  double gain_db = decibels(theirs / ours);
  for (int step = 0; step < kSteps; ++step) {
    const double gain = std::pow(10, gain_db / 10);
    double slope = 0, squares = 0;  // of the levels rendered over the gain
    for (std::size_t n = 0; n < notes.recorded.size(); ++n) {
      std::size_t i = 0;
      for_cells(notes.recorded[n], notes.rendered[n], [&](const Cell& cell) {
        const double part = gain * cell.rendered / (gain * cell.rendered + cell.noise + cell.floor);
        const double weight = notes.weights.empty() ? part : part * notes.weights[n][i++];
        slope += weight * (cell.recorded_db() - cell.expected(gain).level_db);
        squares += weight * part;
      });
    }
    gain_db += slope / squares;
  }
  return gain_db;
}

NoteDifference compare(const NoteImpression& recorded, const NoteImpression& rendered, double gain_db) {
  constexpr double kFarthest_cents = 2400;
  const double gain = std::pow(10, gain_db / 10);
  NoteDifference difference;
  for_cells(recorded, rendered, [&](const Cell& cell) {
    const ExpectedLevel expected = cell.expected(gain);
    difference.level_db.push_back(cell.recorded_db() - expected.level_db);
    difference.noise_db.push_back(expected.noise_db);
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

LevelDistance level_distance(const NoteImpression& recorded, const NoteImpression& rendered, double gain_db) {
  const double gain = std::pow(10, gain_db / 10), of_normal = std::sqrt(2 / std::numbers::pi);
  LevelDistance sum{0, 0};
  double count = 0;
  for_cells(recorded, rendered, [&](const Cell& cell) {
    const ExpectedLevel expected = cell.expected(gain);
    if (std::max(cell.recorded, gain * cell.rendered + cell.noise) <= cell.floor) return;
    sum.all_db += std::abs(cell.recorded_db() - expected.level_db);
    sum.noise_db += of_normal * expected.noise_db;
    ++count;
  });
  count = std::max(count, 1.0);
  return {sum.all_db / count, sum.noise_db / count};
}

}  // namespace contactspline
