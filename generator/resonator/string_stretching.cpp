// SPDX-License-Identifier: MIT
#include "generator/resonator/string_stretching.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "contactspline/data/keyboard_parts.hpp"

namespace contactspline {
namespace {

double wavenumber(const StretchingString& string, double number) {
  return number * std::numbers::pi / string.string.length_m;
}

// The square of the slope, as a sum of cosines: twice the factor of cos(m pi x/length), and the mode's own strain.
StretchForm longitudinal_form(const StretchingString& string, std::span<const int> numbers, int m) {
  StretchForm form{string.axial_stiffness_n * string.string.length_m / 16, std::vector<double>(numbers.size())};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (2 * numbers[i] == m) form.squares_per_m2[i] = std::pow(wavenumber(string, numbers[i]), 2);
    for (std::size_t j = 0; j < i; ++j)
      if (numbers[i] + numbers[j] == m || std::abs(numbers[i] - numbers[j]) == m)
        form.products.push_back({j, i, wavenumber(string, numbers[i]) * wavenumber(string, numbers[j])});
  }
  form.squares_per_m2.resize(numbers.size() + string.longitudinal);
  form.linear = {numbers.size() + static_cast<std::size_t>(m) - 1, 4 * wavenumber(string, m)};
  return form;
}

}  // namespace

std::vector<Mode> longitudinal_modes(const StretchingString& string) {
  std::vector<Mode> modes = longitudinal_modes(string.string, {string.axial_stiffness_n, string.longitudinal_losses},
                                               std::numeric_limits<double>::infinity(), string.longitudinal);
  if (modes.size() < string.longitudinal) return {};
  for (Mode& mode : modes) mode.mass_kg = string.string.mass_kg / 2;
  return modes;
}

std::vector<StretchForm> stretch_forms(const StretchingString& string, std::span<const int> numbers) {
  StretchForm even{string.axial_stiffness_n * string.string.length_m / 8, {}};
  for (const int number : numbers) even.squares_per_m2.push_back(std::pow(wavenumber(string, number), 2));
  even.squares_per_m2.resize(numbers.size() + string.longitudinal);
  std::vector<StretchForm> forms{even};
  for (int m = 1; m <= static_cast<int>(string.longitudinal); ++m)
    forms.push_back(longitudinal_form(string, numbers, m));
  return forms;
}

double end_tension_n(const StretchingString& string, std::size_t form) {
  return (form % 2 == 0 ? 1 : -1) * string.axial_stiffness_n / 4;
}

}  // namespace contactspline
