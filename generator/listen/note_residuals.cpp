// SPDX-License-Identifier: MIT
#include "generator/listen/note_residuals.hpp"

#include <algorithm>
#include <cmath>

namespace contactspline {
namespace {

constexpr std::size_t kBandsOfGroup = 4;
constexpr double kTogether = 8;  // levels that tell as much as an independent one: windows and bands overlap
constexpr double kFirst_db = 3;
constexpr double kLeast_db = 0.1, kMost_db = 30, kLeastCents = 0.03;  // no scale is less or more

double level_residual(double scales, double far) {
  return scales / std::pow(1 + scales * scales / (far * far), 0.25);
}

double cents_residual(double cents, double far_cents) {
  return cents / std::sqrt(1 + cents * cents / (far_cents * far_cents));
}

// The likeliest scale that all levels have beside their noise: those with little noise tell it.
double common_scale(std::span<const NoteDifference> differences) {
  constexpr int kHalvings = 30;
  const auto is_too_small = [&](double scale_db) {
    double excess = 0;
    for (const NoteDifference& difference : differences)
      for (std::size_t i = 0; i < difference.level_db.size(); ++i) {
        const double variance = scale_db * scale_db + difference.noise_db[i] * difference.noise_db[i];
        excess += (difference.level_db[i] * difference.level_db[i] / variance - 1) / variance;
      }
    return excess > 0;
  };
  double low = kLeast_db, high = kMost_db;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    (is_too_small(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

std::vector<double> gains_of(const NotesToMatch& notes, std::span<const NoteImpression> rendered) {
  std::vector<std::vector<double>> weights = notes.scales.level_db;
  for (std::vector<double>& of_note : weights)
    for (double& weight : of_note) weight = 1 / (weight * weight);
  const ComparedNotes all{notes.recorded, rendered, weights};
  if (notes.has_common_gain) return std::vector<double>(notes.recorded.size(), gain_between(all));
  std::vector<double> gains;
  for (std::size_t n = 0; n < notes.recorded.size(); ++n)
    gains.push_back(gain_between({all.recorded.subspan(n, 1), all.rendered.subspan(n, 1),
                                  weights.empty() ? all.weights : all.weights.subspan(n, 1)}));
  return gains;
}

Residuals residuals_of(const NotesToMatch& notes, std::span<const NoteImpression> rendered) {
  const std::vector<double> gains = gains_of(notes, rendered);
  const ResidualScales& scales = notes.scales;
  const double of_level = 1 / std::sqrt(kTogether);
  Residuals residuals;
  for (std::size_t n = 0; n < notes.recorded.size(); ++n) {
    const NoteDifference difference = compare(notes.recorded[n], rendered[n], gains[n]);
    for (std::size_t i = 0; i < difference.level_db.size(); ++i) {
      const double scale_db = scales.level_db.empty() ? kFirst_db : scales.level_db[n][i];
      residuals.values.push_back(of_level * level_residual(difference.level_db[i] / scale_db, scales.far_levels));
      residuals.groups.push_back(residuals.group_count + i % NoteImpression::kBands / kBandsOfGroup);
    }
    residuals.group_count += NoteImpression::kBands / kBandsOfGroup;
    for (const double cents : difference.cents) {
      residuals.values.push_back(cents_residual(cents, scales.far_cents) / scales.cents);
      residuals.groups.push_back(residuals.group_count++);
    }
  }
  return residuals;
}

std::size_t count_residuals(const NotesToMatch& notes) {
  std::size_t count = 0;
  for (const NoteImpression& impression : notes.recorded)
    count += impression.power.size() + impression.partials.size();
  return count;
}

void set_scales(NotesToMatch& notes, std::span<const NoteImpression> rendered) {
  const std::vector<double> gains = gains_of(notes, rendered);
  std::vector<NoteDifference> differences;
  for (std::size_t n = 0; n < notes.recorded.size(); ++n)
    differences.push_back(compare(notes.recorded[n], rendered[n], gains[n]));
  const double scale_db = common_scale(differences);
  notes.scales.level_db.clear();
  double partials = 0, squares = 0;
  for (const NoteDifference& difference : differences) {
    notes.scales.level_db.emplace_back();
    for (const double noise_db : difference.noise_db)
      notes.scales.level_db.back().push_back(std::hypot(scale_db, noise_db));
    for (const double cents : difference.cents)
      ++partials, squares += std::pow(cents_residual(cents, notes.scales.far_cents), 2);
  }
  notes.scales.cents = std::max(kLeastCents, std::sqrt(squares / std::max(1.0, partials)));
}

}  // namespace contactspline
