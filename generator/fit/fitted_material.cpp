// SPDX-License-Identifier: MIT
#include "generator/fit/fitted_material.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "generator/support/json_reader.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

/// An estimate with the key of the material file that holds it, and its unit.
struct Result {
  std::string key, unit;
  Estimate estimate;
};

// Of the material's law and loss.
std::vector<Result> results_of(const Fit& fit) {
  std::vector<Result> results = {{"stiffness_n_per_m_alpha", "N/m^a", fit.stiffness}, {"exponent", "", fit.exponent}};
  if (fit.law == kLayers) {
    results.push_back({"core_stiffness", "N/m^1.5", fit.core_stiffness});
    results.push_back({"offset_m", "m", fit.offset_m});
  }
  if (fit.loss == "hunt_crossley") results.push_back({"loss_s_per_m", "s/m", fit.loss_s_per_m});
  if (fit.loss == "memory") {
    results.push_back({"weight", "", fit.weight});
    results.push_back({"relaxation_time_s", "s", fit.time_s});
  }
  return results;
}

const char* words_of(const std::vector<ModelRow>& rows, const std::string& name) {
  return std::ranges::find(rows, name, &ModelRow::name)->words;
}

std::string words_of(const std::string& law, const std::string& loss) {
  return fmt::format("{} {}", words_of(laws(), law), words_of(losses(), loss));
}

// Downwards to four digits: what a file states is within the data.
double rounded_down(double number) {
  return rounded_to(number * (1 - 5.1e-4), 4);
}

constexpr int kDigits = 8;

double mass_of(const Fit& fit, const Measurements& measured) {
  return measured.fits_mass() ? rounded_to(fit.mass_kg.value, kDigits) : measured.mass_kg;
}

std::string choice_text(const Fit& fit) {
  std::string text =
      "chosen by the Bayesian information criterion, in which 10 more is strong evidence against a model:\n";
  for (const FittedModel& model : fit.candidates)
    text += fmt::format("  {:<46} {} parameters {:>+12.1f}{}\n", words_of(model.law, model.loss), model.parameters,
                        model.criterion, model.has_low_pass ? ", low-pass" : "");
  return text;
}

// What has no number is null: JSON knows no infinity.
std::string json_number(double number) {
  return std::isfinite(number) ? fmt::format("{}", number) : "null";
}

std::string json_numbers(const std::vector<double>& numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(json_number(number));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string json_of(const Estimate& estimate) {
  return fmt::format(R"({{ "value": {}, "low": {}, "high": {} }})", json_number(estimate.value),
                     json_number(estimate.low), json_number(estimate.high));
}

}  // namespace

std::string report_of(const Fit& fit, const Measurements& measured) {
  std::string text = words_of(fit.law, fit.loss);
  std::vector<Result> results = results_of(fit);
  if (measured.fits_mass())
    results.push_back({"mass_kg", "kg", fit.mass_kg});
  else
    text += fmt::format(", mass {} kg", measured.mass_kg);
  if (fit.low_pass_hz) results.push_back({"low_pass_hz", "Hz", *fit.low_pass_hz});
  text += '\n';
  for (const Result& result : results) {
    const bool is_given = result.key == "exponent" && fit.law == "hertz";
    text += fmt::format("  {:<24} {:.5g} {}; {}95 % interval {:.5g} to {:.5g}\n", result.key, result.estimate.value,
                        result.unit, is_given ? "given by the law, that of a power law has the " : "",
                        result.estimate.low, result.estimate.high);
  }
  text += "scatter of the data about the model:\n";
  for (const FitQuality& quality : fit.qualities)
    text += fmt::format("  {:<40} {:>13} {:>6} samples {:>8.3f} {}\n", shown(quality.file), quality.quantity,
                        quality.samples, quality.is_level() ? quality.scatter : 100 * quality.scatter,
                        quality.is_level() ? "dB" : "%");
  for (const std::string& note : fit.notes) text += fmt::format("note: {}\n", note);
  text += choice_text(fit);
  return text + fmt::format(
                    "the data reach a compression of {:.4g} m: that of an impact without loss at {:.4g} m/s, the "
                    "largest speed\nthat they allow\n",
                    fit.max_compression_m, rounded_down(fit.max_speed_m_per_s));
}

std::string material_text(const Fit& fit, const Measurements& measured, std::string_view mark) {
  std::string text = fmt::format("// {}: fitted to measurements.\n// ", mark);
  std::string report = report_of(fit, measured);
  report.pop_back();
  for (const char c : report) text += c == '\n' ? "\n// " : std::string(1, c);
  text += fmt::format("\n{{\n  \"name\": \"{}\",\n", measured.name);
  if (!measured.description.empty())
    text += fmt::format("  \"description\": {},\n", json_string(measured.description));
  std::vector<std::string> law, core{fmt::format("\"exponent\": {}", kHertzExponent)}, memory, contact;
  for (const Result& result : results_of(fit)) {
    const bool is_core = result.key == "core_stiffness" || result.key == "offset_m";
    const bool is_memory = result.key == "weight" || result.key == "relaxation_time_s";
    const std::string key = result.key == "core_stiffness" ? "stiffness_n_per_m_alpha" : result.key;
    (is_core                        ? core
     : is_memory                    ? memory
     : result.key == "loss_s_per_m" ? contact
                                    : law)
        .push_back(fmt::format("\"{}\": {}", key, rounded_to(result.estimate.value, kDigits)));
  }
  if (fit.law == kLayers)
    contact.insert(contact.begin(),
                   fmt::format("\"sum\": [{{ {} }}, {{ {} }}]", fmt::join(law, ", "), fmt::join(core, ", ")));
  else
    contact.insert(contact.begin(), law.begin(), law.end());
  if (!memory.empty()) contact.push_back(fmt::format("\"memory\": [{{ {} }}]", fmt::join(memory, ", ")));
  const double max = rounded_down(fit.max_speed_m_per_s);
  text += fmt::format("  \"contact\": {{ {} }},\n", fmt::join(contact, ", "));
  text += fmt::format(
      "  \"impact\": {{ \"mass_kg\": {}, \"max_speed_m_per_s\": {}, \"min_speed_m_per_s\": {} }},\n"
      "  \"spline\": {{ \"knots\": \"graded\", \"tolerance\": 0.001 }}\n}}\n",
      mass_of(fit, measured), max, std::min(max, rounded_down(fit.min_speed_m_per_s)));
  return text;
}

std::string json_of(const Fit& fit, const Measurements& measured) {
  std::vector<std::string> results, sources, models, notes;
  if (measured.fits_mass()) results.push_back(fmt::format("    \"mass_kg\": {}", json_of(fit.mass_kg)));
  for (const Result& result : results_of(fit))
    results.push_back(fmt::format("    \"{}\": {}", result.key, json_of(result.estimate)));
  if (fit.low_pass_hz) results.push_back(fmt::format("    \"low_pass_hz\": {}", json_of(*fit.low_pass_hz)));
  for (const FitQuality& quality : fit.qualities)
    sources.push_back(fmt::format(
        "    {{ \"file\": {}, \"quantity\": \"{}\", \"samples\": {}, \"scatter\": {},\n      \"at\": [{}],\n      "
        "\"measured\": [{}],\n      \"modelled\": [{}] }}",
        json_string(quality.file), quality.quantity, quality.samples, json_number(quality.scatter),
        json_numbers(quality.at), json_numbers(quality.measured), json_numbers(quality.modelled)));
  for (const FittedModel& model : fit.candidates)
    models.push_back(
        fmt::format(R"(    {{ "law": "{}", "loss": "{}", "parameters": {}, "criterion": {}, "low_pass": {} }})",
                    model.law, model.loss, model.parameters, json_number(model.criterion), model.has_low_pass));
  for (const std::string& note : fit.notes) notes.push_back(json_string(note));
  return fmt::format(
      "{{\n  \"name\": \"{}\", \"law\": \"{}\", \"loss\": \"{}\", \"mass_kg\": {},\n  \"max_compression_m\": {}, "
      "\"max_speed_m_per_s\": {}, \"min_speed_m_per_s\": {},\n  \"estimates\": {{\n{}\n  }},\n  \"notes\": [{}],\n  "
      "\"models\": [\n{}\n  "
      "],\n  \"data\": [\n{}\n  ]\n}}\n",
      measured.name, fit.law, fit.loss, mass_of(fit, measured), fit.max_compression_m, fit.max_speed_m_per_s,
      fit.min_speed_m_per_s, fmt::join(results, ",\n"), fmt::join(notes, ", "), fmt::join(models, ",\n"),
      fmt::join(sources, ",\n"));
}

}  // namespace contactspline
