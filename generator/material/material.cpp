// SPDX-License-Identifier: MIT
#include "generator/material/material.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string_view>
#include <variant>

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

std::string text_of(const PowerLaw& law) {
  return fmt::format("V(y) = k/(a+1) y^(a+1), k = {} N/m^a, a = {}", law.stiffness, law.exponent);
}

std::string text_of(const PowerSum& sum) {
  std::string text;
  for (const PowerTerm& term : sum.terms) text += (text.empty() ? "F(y) = " : " + ") + term_text(term);
  return text + ", in parallel";
}

std::string text_of(const PowerSeries& series) {
  std::string text;
  for (const PowerLaw& layer : series.layers)
    text += fmt::format("{}(F/{})^(1/{})", text.empty() ? "y(F) = " : " + ", layer.stiffness, layer.exponent);
  return text + ", in series";
}

std::string text_of(const ForceCurve& curve) {
  return fmt::format("F(y) through {} knots", curve.knot_m.size());
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
  if (material.measured) return measurement_text(*material.measured);
  return std::visit([](const auto& law) { return text_of(law); }, material.contact.law());
}

std::string_view name_of_law(const Material& material) {
  constexpr std::string_view kNames[] = {"power law", "sum", "series", "measured"};
  static_assert(std::size(kNames) == std::variant_size_v<ContactLaw::Law>);
  return kNames[material.contact.law().index()];
}

std::string_view name_of(Knots knots) {
  return knots == Knots::uniform ? "uniform" : knots == Knots::graded ? "graded" : "optimal";
}

std::string_view name_of(ErrorOf error) {
  return error == ErrorOf::contact_duration ? "contact_duration" : error == ErrorOf::force ? "force" : "spectrum";
}

}  // namespace contactspline
