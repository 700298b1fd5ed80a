// SPDX-License-Identifier: MIT
#include "generator/material/material.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

std::string term_text(const PowerTerm& term) {
  const std::string base = term.offset_m == 0 ? "y" : fmt::format("(y - {})", term.offset_m);
  return fmt::format("{} {}^{}", term.law.stiffness, base, term.law.exponent);
}

std::string measurement_text(const Measurement& measured) {
  return fmt::format("F(y) smoothed from {} samples of {} up to {:.6g} m", measured.samples.size(), measured.file,
                     measured.samples.back().compression_m);
}

}  // namespace

Impact elastic_impact(const Impact& impact, const std::vector<Memory>& memories) {
  double slow = 1;
  for (const Memory& memory : memories) slow -= memory.weight;
  if (memories.empty()) return impact;
  return {rounded_to(impact.mass_kg / slow, 9), impact.max_speed_m_per_s,
          rounded_to(impact.min_speed_m_per_s * std::sqrt(slow), 9)};
}

Impact elastic_impact(const Material& material) {
  return elastic_impact(*material.impact, material.memories);
}

std::string json_of(const std::vector<Memory>& memories) {
  std::string rows;
  for (const Memory& memory : memories)
    rows += fmt::format("{}{{\"weight\": {}, \"relaxation_time_s\": {}}}", rows.empty() ? "" : ", ",
                        literal(memory.weight), literal(memory.time_s));
  return "[" + rows + "]";
}

std::string law_text(const Material& material) {
  if (const PowerLaw* law = material.contact.power_law())
    return fmt::format("V(y) = k/(a+1) y^(a+1), k = {} N/m^a, a = {}", law->stiffness, law->exponent);
  if (material.measured) return measurement_text(*material.measured);
  std::string text;
  if (const auto* series = std::get_if<PowerSeries>(&material.contact.law())) {
    for (const PowerLaw& layer : series->layers)
      text += fmt::format("{}(F/{})^(1/{})", text.empty() ? "y(F) = " : " + ", layer.stiffness, layer.exponent);
    return text + ", in series";
  }
  for (const PowerTerm& term : std::get<PowerSum>(material.contact.law()).terms)
    text += (text.empty() ? "F(y) = " : " + ") + term_text(term);
  return text + ", in parallel";
}

std::string_view name_of_law(const Material& material) {
  constexpr std::array<std::string_view, std::variant_size_v<ContactLaw::Law>> kNames = {"power law", "sum", "series",
                                                                                         "measured"};
  return kNames[material.contact.law().index()];
}

std::string_view name_of(Knots knots) {
  return knots == Knots::uniform ? "uniform" : knots == Knots::graded ? "graded" : "optimal";
}

std::string_view name_of(ErrorOf error) {
  return error == ErrorOf::contact_duration ? "contact_duration" : error == ErrorOf::force ? "force" : "spectrum";
}

}  // namespace contactspline
