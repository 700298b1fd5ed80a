// SPDX-License-Identifier: MIT
#include "generator/listen/note_residuals.hpp"

#include <algorithm>
#include <cmath>

namespace contactspline {
namespace {

constexpr std::size_t kBandsOfGroup = 4;
constexpr double kTogether = 8;  // levels that tell as much as an independent one: windows and bands overlap
constexpr double kLeast_db = 0.1, kLeastCents = 0.3;  // no scale is less

double level_residual(double level_db, double far_db) {
  return level_db / std::pow(1 + level_db * level_db / (far_db * far_db), 0.25);
}

double cents_residual(double cents, double far_cents) {
  return cents / std::sqrt(1 + cents * cents / (far_cents * far_cents));
}

}  // namespace

std::vector<double> gains_of(std::span<const NoteImpression> recorded, std::span<const NoteImpression> rendered,
                             bool has_common_gain) {
  std::vector<const NoteImpression*> theirs, ours;
  for (const NoteImpression& impression : recorded) theirs.push_back(&impression);
  for (const NoteImpression& impression : rendered) ours.push_back(&impression);
  if (has_common_gain) return std::vector<double>(recorded.size(), gain_between(theirs, ours));
  std::vector<double> gains;
  for (std::size_t n = 0; n < recorded.size(); ++n)
    gains.push_back(gain_between(std::span(theirs).subspan(n, 1), std::span(ours).subspan(n, 1)));
  return gains;
}

Residuals residuals_of(std::span<const NoteImpression> recorded, std::span<const NoteImpression> rendered,
                       bool has_common_gain, const ResidualScales& scales) {
  const std::vector<double> gains = gains_of(recorded, rendered, has_common_gain);
  const double of_level = 1 / (scales.level_db * std::sqrt(kTogether));
  Residuals residuals;
  for (std::size_t n = 0; n < recorded.size(); ++n) {
    const NoteDifference difference = compare(recorded[n], rendered[n], gains[n]);
    for (std::size_t i = 0; i < difference.level_db.size(); ++i) {
      residuals.values.push_back(of_level * level_residual(difference.level_db[i], scales.far_db));
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

std::size_t count_residuals(std::span<const NoteImpression> recorded) {
  std::size_t count = 0;
  for (const NoteImpression& impression : recorded) count += impression.power.size() + impression.partials.size();
  return count;
}

ResidualScales scales_of(std::span<const NoteImpression> recorded, std::span<const NoteImpression> rendered,
                         bool has_common_gain, const ResidualScales& before) {
  const std::vector<double> gains = gains_of(recorded, rendered, has_common_gain);
  double levels = 0, level_squares = 0, partials = 0, cent_squares = 0;
  for (std::size_t n = 0; n < recorded.size(); ++n) {
    const NoteDifference difference = compare(recorded[n], rendered[n], gains[n]);
    for (const double level_db : difference.level_db)
      ++levels, level_squares += std::pow(level_residual(level_db, before.far_db), 2);
    for (const double cents : difference.cents)
      ++partials, cent_squares += std::pow(cents_residual(cents, before.far_cents), 2);
  }
  return {std::max(kLeast_db, std::sqrt(level_squares / levels)),
          std::max(kLeastCents, std::sqrt(cent_squares / std::max(1.0, partials))), before.far_db, before.far_cents};
}

}  // namespace contactspline
