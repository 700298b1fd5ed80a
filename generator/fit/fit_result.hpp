// SPDX-License-Identifier: MIT
// What a fit finds: law, loss and their numbers, how well they describe the data, and what is doubtful.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "generator/fit/impact_model.hpp"
#include "generator/fit/measurements.hpp"

namespace contactspline {

/// A value, and the interval that holds the true one with 95 % if noise is the only error.
struct Estimate {
  double value, low, high;
};

/// What one source of data, a pulse, a table's column, a curve or a blow, says of the fit.
struct FitQuality {
  std::string file, quantity;  ///< the file without its folder
  std::size_t samples;
  double scatter;  ///< of the samples about the model: of a pulse or a curve in parts of the largest force, of levels
                   ///< in dB, else relative
  std::vector<double> at, measured,
      modelled;  ///< of a pulse over time [s], a table over speed [m/s], levels over frequency [Hz], else over y [m]

  [[nodiscard]] bool is_level() const { return quantity == kLevels; }
};

/// One model, fitted.
struct FittedModel {
  std::string law, loss;
  int parameters;             ///< free ones of the law and the loss
  double criterion;           ///< Bayesian information criterion, less that of the chosen model
  bool has_low_pass = false;  ///< behind a low-pass that was fitted
};

/// The chosen model and the models it was chosen among, the chosen one first.
struct Fit {
  std::string law, loss;
  ViscoelasticLaw<double> model;
  Estimate stiffness, exponent, core_stiffness, offset_m, loss_s_per_m, weight, time_s, mass_kg;
  double max_compression_m;  ///< that the data reach
  double max_speed_m_per_s;  ///< of an impact without loss that compresses as far
  double min_speed_m_per_s;  ///< of the data
  std::vector<FitQuality> qualities;
  std::vector<FittedModel> candidates;
  std::optional<Estimate> low_pass_hz = {};  ///< of the data, where they show one that the fit file does not state
  std::vector<std::string> notes = {};       ///< what makes the fit doubtful, a line each
};

}  // namespace contactspline
