// SPDX-License-Identifier: MIT
// A panel of errors on logarithmic axes.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace contactspline {

/// The errors of one model, as fractions, over a positive quantity that rises.
struct ErrorCurve {
  std::string name;   ///< empty: neither marked nor in the key
  std::string style;  ///< of its line, as gnuplot takes it
  std::vector<double> at, error;
  std::optional<double> largest = {};  ///< what the key states, where it is known better than from these points
};

/// The point of the largest error in each of at most 40 stretches of equal ratio, so that lobes between zeros of the
/// error do not hide other curves. A curve of at most 40 points stays as it is.
[[nodiscard]] ErrorCurve envelope_of(const ErrorCurve& curve);

/// A panel of the magnitudes of errors in percent. A point marks the largest error of each curve; the key to the
/// right of the panel states it, or what the curve says is the largest. Errors more than five decades below the
/// largest are drawn at the lower border. `name` is an identifier of the panel's own.
[[nodiscard]] std::string error_panel(const std::string& name, const std::string& x_label, const std::string& y_label,
                                      const std::vector<ErrorCurve>& curves);

}  // namespace contactspline
