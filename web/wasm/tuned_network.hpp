// SPDX-License-Identifier: MIT
// An instrument of a file with strings of another pitch, as voices of a score have them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include "contactspline/instrument/network_instrument.hpp"

namespace contactspline::web {

/// What the tension adds to w0^2 of each mode [1/s^2]; 0 where the body is no hinged string. The square of mode n of
/// such a string is a n^2 + b n^4, of which a is the tension's, b that of the bending stiffness.
inline std::vector<double> tension_squares(const InstrumentData& data) {
  std::vector<double> all;
  for (std::size_t body = 0; body < data.body_ends.size(); ++body) {
    const auto frequencies = data.part_of(data.angular_frequencies, body), decays = data.part_of(data.decays, body);
    const auto square = [&](std::size_t n) { return std::pow(frequencies[n - 1], 2) + std::pow(decays[n - 1], 2); };
    const std::size_t modes = frequencies.size();
    const double b = modes < 10 ? 0 : (square(2) - 4 * square(1)) / 12, a = modes < 10 ? 0 : square(1) - b;
    bool is_string = modes >= 10;
    for (std::size_t n = 1; is_string && n <= modes; ++n)
      is_string = std::abs(square(n) - n * n * (a + b * n * n)) < 1e-6 * square(n);
    for (std::size_t n = 1; n <= modes; ++n) all.push_back(is_string ? a * n * n : 0);
  }
  return all;
}

/// The array that a TunedNetwork views; a base, so that it is made first.
struct TensionSquares {
  std::vector<double> squares;
};

/// Plays InstrumentData in single precision, its strings tuned by so many cents.
class TunedNetwork : private TensionSquares, public NetworkInstrument<float> {
 public:
  TunedNetwork(const InstrumentData& data, double cents)
      : TensionSquares{tension_squares(data)}, NetworkInstrument<float>(with(data, squares)) {
    tune(cents);
  }

 private:
  // The last places are ends of strings, where outputs take their force.
  static InstrumentData with(InstrumentData data, const std::vector<double>& squares) {
    data.keyed.tension_squares = squares;
    data.keyed.far_ends = static_cast<std::size_t>(std::ranges::count_if(
        data.outputs, [](const Output& output) { return std::string_view(output.name).ends_with("_end_force_n"); }));
    return data;
  }
};

}  // namespace contactspline::web
