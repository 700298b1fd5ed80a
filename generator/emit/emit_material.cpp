// SPDX-License-Identifier: MIT
#include "generator/emit/emit_material.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "contactspline/step/version.hpp"
#include "generator/spline/exponent_family.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/number_literal.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {
namespace {

// Four digits are enough for a reader, and they do not depend on the machine's pow() and atan().
double four_digits(double value) {
  return value < 1e-12 ? 0.0 : rounded_to(value, 4);
}

// Decibels so small are rounding errors.
double four_digits_db(double value) {
  return value < 1e-6 ? 0.0 : rounded_to(value, 4);
}

std::string percent(double value) {
  return fmt::format("{:.3g} %", 100 * four_digits(value));
}

std::vector<double> column(const Spline& spline, double Segment<double>::*member) {
  std::vector<double> values;
  for (const auto& segment : spline.segments) values.push_back(segment.*member);
  return values;
}

// The table that the step reads.
void add_table(TemplateValues& values, const Spline& spline, int indent) {
  values["KNOTS"] = literal_rows(column(spline, &Segment<double>::knot), indent);
  values["ENERGIES"] = literal_rows(column(spline, &Segment<double>::energy), indent);
  values["FORCES"] = literal_rows(column(spline, &Segment<double>::force), indent);
  values["HALF_CURVATURES"] = literal_rows(column(spline, &Segment<double>::half_curvature), indent);
}

void add_normalised(TemplateValues& values, const Spline& spline, int indent) {
  values["NORMALISED_A"] = literal_rows(spline.normalised.a, indent);
  values["NORMALISED_B"] = literal_rows(spline.normalised.b, indent);
  values["NORMALISED_C"] = literal_rows(spline.normalised.c, indent);
}

void add_regular(TemplateValues& values, const Spline& spline, int indent) {
  values["REGULAR_A"] = literal_rows(spline.regular.a, indent);
  values["REGULAR_B"] = literal_rows(spline.regular.b, indent);
  values["REGULAR_C"] = literal_rows(spline.regular.c, indent);
}

std::string quality_lines(const Design& design) {
  const Quality& q = design.quality;
  std::string text =
      fmt::format("// Worst force error {} of the largest force (rms {}), energy error {} (rms {}).",
                  percent(q.force.worst), percent(q.force.rms), percent(q.energy.worst), percent(q.energy.rms));
  if (q.impact)
    text += fmt::format(
        "\n// Impacts of {} kg at {} to {} m/s{}: contact duration within {}, max compression within {}.",
        elastic_impact(design.material).mass_kg, elastic_impact(design.material).min_speed_m_per_s,
        design.material.impact->max_speed_m_per_s, design.material.memories.empty() ? "" : ", without memory",
        percent(q.impact->contact_duration), percent(q.impact->max_compression));
  if (design.spectrum)
    text += fmt::format(
        "\n// Spectrum of their force up to {:g} Hz and down to {:g} dB: within {:.3g} dB, on average {:.3g} dB.",
        kMaxSpectrumFrequency_hz, kMinSpectrumLevel_db, four_digits_db(design.spectrum->worst_db),
        four_digits_db(design.spectrum->mean_db));
  if (const auto& compensation = design.material.compensation)
    text += fmt::format(
        "\n// Compensated for {} Hz and {} kg. The errors of impacts are those of simulated impacts. Force and "
        "energy "
        "differ on purpose.",
        compensation->sample_rate_hz, compensation->mass_kg);
  return text;
}

std::string quality_members(const Design& design) {
  const Quality& q = design.quality;
  std::string text;
  const auto add = [&](std::string_view key, double value) {
    text += fmt::format("{}    \"{}\": {}", text.empty() ? "" : ",\n", key, literal(value));
  };
  add("worst_force_error", four_digits(q.force.worst));
  add("rms_force_error", four_digits(q.force.rms));
  add("worst_energy_error", four_digits(q.energy.worst));
  add("rms_energy_error", four_digits(q.energy.rms));
  if (q.impact) add("worst_contact_duration_error", four_digits(q.impact->contact_duration));
  if (q.impact) add("worst_max_compression_error", four_digits(q.impact->max_compression));
  if (design.spectrum) add("worst_spectrum_error_db", four_digits_db(design.spectrum->worst_db));
  if (design.spectrum) add("mean_spectrum_error_db", four_digits_db(design.spectrum->mean_db));
  if (const auto& compensation = design.material.compensation)
    text += fmt::format(",\n    \"simulated_at_hz\": {},\n    \"simulated_mass_kg\": {}",
                        literal(compensation->sample_rate_hz), literal(compensation->mass_kg));
  return text;
}

// The end of the comment on the normalised form: what it depends on.
std::string normalised_note(const Design& design, std::string_view margin) {
  return design.material.spline.knots == Knots::uniform
             ? fmt::format(". That of a power law depends on exponent and number of\n{}// segments only.", margin)
             : ": free of units.";
}

// Uniform knots are in units of their distance, other knots in units of the largest compression.
std::string length_scale_name(const Design& design) {
  return design.material.spline.knots == Knots::uniform ? "segment_width" : "length_scale";
}

// The contact law, for the comment at the top of a source file.
std::string law_lines(const Material& material) {
  if (const PowerLaw* law = material.contact.power_law())
    return fmt::format("contact potential V(y) = k/(a+1) y^(a+1) with k = {} N/m^a,\n// a = {}, as",
                       literal(law->stiffness), literal(law->exponent));
  return fmt::format("contact force\n// {},\n// as", law_text(material));
}

// The constants of a power law, written with `format`; an empty text for other laws.
std::string law_constants(const Material& material, std::string_view format) {
  const PowerLaw* law = material.contact.power_law();
  return law == nullptr ? "" : fmt::format(fmt::runtime(format), literal(law->stiffness), literal(law->exponent));
}

// One number of all segments of all members. The segments of each member follow after `first`.
std::string member_rows(const ExponentFamily& family, double Segment<double>::*number,
                        const std::vector<double>& first) {
  std::vector<double> values;
  for (const auto& member : family.members) {
    values.insert(values.end(), first.begin(), first.end());
    for (const Segment<double>& segment : member) values.push_back(segment.*number);
  }
  return literal_rows(values, 6);
}

// The measured errors of a family, in the syntax of the format; an empty text if the material has no impact.
std::string family_quality(const Emitter& emitter, const Material& material, const ExponentFamily& family) {
  const auto error = measure_family(family, material);
  if (!error) return {};
  if (emitter.name == "json")
    return fmt::format(
        "    \"quality\": {{\n      \"worst_contact_duration_error\": {},\n"
        "      \"worst_max_compression_error\": {}\n    }},\n",
        literal(four_digits(error->contact_duration)), literal(four_digits(error->max_compression)));
  const auto margin = emitter.name == "cpp" ? "  " : "";
  return fmt::format(
      "{0}// At any exponent, impacts of {1} kg at {2} to {3} m/s: contact duration within {4}, max compression\n"
      "{0}// within {5}.\n",
      margin, material.impact->mass_kg, material.impact->min_speed_m_per_s, material.impact->max_speed_m_per_s,
      percent(error->contact_duration), percent(error->max_compression));
}

// The exponent family of a material in the syntax of the format; an empty text if the material has none.
std::string live_text(const Emitter& emitter, const Design& design) {
  if (!design.material.live_exponent) return {};
  const auto [min, max, members] = *design.material.live_exponent;
  const auto segments = design.spline.segments.size();
  const ExponentFamily family = exponent_family(design.material, static_cast<int>(segments));
  const bool faust = emitter.name == "faust";
  // Faust tables begin with "out of contact".
  const std::vector<double> no_contact = faust ? std::vector{0.0} : std::vector<double>{};
  TemplateValues values{{"MIN", literal(min)},
                        {"MAX", literal(max)},
                        {"MEMBERS", fmt::format("{}", members)},
                        {"QUALITY", family_quality(emitter, design.material, family)},
                        {"MAX_COMPRESSION", literal(family.max_compression_m)},
                        {"KNOTS", literal_rows(family.knots_m, 6)},
                        {"ENERGIES", member_rows(family, &Segment<double>::energy, no_contact)},
                        {"FORCES", member_rows(family, &Segment<double>::force, no_contact)},
                        {"HALF_CURVATURES", member_rows(family, &Segment<double>::half_curvature, no_contact)}};
  if (emitter.name != "json") values["SEGMENTS"] = fmt::format("{}", segments);
  if (faust) values["PROBES"] = fmt::format("{}", std::bit_width(segments));
  std::string text = fill_template(emitted_template("live", emitter.extension), values);
  text.pop_back();  // the template of the material has the last line end
  return text;
}

// Weights and relaxation times of the memories in C++; an empty text if the material has none.
std::string cpp_memory(const Material& material, std::string_view indent) {
  if (material.memories.empty()) return {};
  std::vector<std::string> weights, times;
  for (const Memory& memory : material.memories) {
    weights.push_back(literal(memory.weight));
    times.push_back(literal(memory.time_s));
  }
  return fmt::format(
      "{0}// Memory: force F(y) - sum of weight M, where M follows F(y) with the relaxation time [s].\n"
      "{0}static constexpr std::array<double, {1}> memory_weights = {{{2}}};\n"
      "{0}static constexpr std::array<double, {1}> memory_times_s = {{{3}}};\n",
      indent, weights.size(), fmt::join(weights, ", "), fmt::join(times, ", "));
}

TemplateValues common_values(const Design& design, std::string_view command) {
  const Material& material = design.material;
  return {{"VERSION", CONTACTSPLINE_VERSION},
          {"COMMAND", std::string(command)},
          {"NAME", material.name},
          {"TITLE", title_of(material)},
          {"LOSS", literal(material.loss_s_per_m)},
          {"MAX_COMPRESSION", literal(material.spline.max_compression_m)},
          {"LENGTH_SCALE_NAME", length_scale_name(design)},
          {"LENGTH_SCALE", literal(design.spline.length_scale_m)},
          {"ENERGY_SCALE", literal(design.spline.energy_scale_j)}};
}

TemplateValues source_values(const Design& design, std::string_view command) {
  TemplateValues values = common_values(design, command);
  const bool uniform = design.material.spline.knots == Knots::uniform;
  values["SEGMENTS"] = fmt::format("{}", design.spline.segments.size());
  values["END"] =
      literal(design.material.compensation ? design.spline.end_m : design.material.spline.max_compression_m);
  values["KNOT_FAMILY"] = uniform ? "" : fmt::format("{} ", name_of(design.material.spline.knots));
  values["QUALITY"] = quality_lines(design);
  values["LAW"] = law_lines(design.material);
  return values;
}

// The normalised form, of a program or a header. `margin` precedes a line of its comment.
void add_normalised_values(TemplateValues& values, const Design& design, int indent, std::string_view margin) {
  add_normalised(values, design.spline, indent);
  const bool uniform = design.material.spline.knots == Knots::uniform;
  values["SCALED_BY"] = uniform ? "y in segment widths" : "y in length scales";
  values["NORMALISED_KNOTS"] = literal_rows(design.spline.normalised_knots, 4);
  values["NORMALISED_LOSS"] = literal(design.material.loss_s_per_m * design.spline.length_scale_m);
  values["FREE_OF_UNITS"] = normalised_note(design, margin);
}

TemplateValues faust_values(const Design& design, std::string_view command) {
  TemplateValues values = source_values(design, command);
  add_table(values, design.spline, 2);
  add_normalised_values(values, design, 4, "");
  values["LAW_CONSTANTS"] = law_constants(design.material, "stiffness = {};\nexponent = {};\n");
  values["MEMORY"] = faust_memory(design.material.memories, "");
  values["NORMALISED_MEMORY"] = faust_memory(design.material.memories, "  ");
  values["PROBES"] = fmt::format("{}", std::bit_width(design.spline.segments.size()));
  return values;
}

// The normalised and the regular form in a header.
std::string cpp_forms(const Design& design) {
  TemplateValues values{{"SEGMENTS", fmt::format("{}", design.spline.segments.size())},
                        {"FORMAT_VERSION", fmt::format("{}", kFormatVersion)},
                        {"NORMALISED_MEMORY", cpp_memory(design.material, "    ")}};
  add_normalised_values(values, design, 6, "  ");
  add_regular(values, design.spline, 6);
  values["PER_LENGTH"] =
      design.material.spline.knots == Knots::uniform ? "s per segment width" : "s per length scale";
  std::string text = fill_template(emitted_template("material_forms", "hpp"), values);
  text.pop_back();  // the template of the material has the last line end
  return text;
}

TemplateValues cpp_values(const Design& design, std::string_view command) {
  TemplateValues values = source_values(design, command);
  add_table(values, design.spline, 4);
  values["FORMAT_VERSION"] = fmt::format("{}", kFormatVersion);
  values["LAW_CONSTANTS"] = law_constants(design.material,
                                          "  static constexpr double stiffness_n_per_m_alpha = {};\n"
                                          "  static constexpr double exponent = {};\n");
  values["MEMORY"] = cpp_memory(design.material, "  ");
  return values;
}

TemplateValues json_values(const Design& design, std::string_view command) {
  TemplateValues values = common_values(design, command);
  add_table(values, design.spline, 4);
  add_regular(values, design.spline, 6);
  add_normalised(values, design.spline, 6);
  values["QUALITY"] = quality_members(design);
  values["MEMORY"] =
      design.material.memories.empty() ? "" : fmt::format("  \"memory\": {},\n", json_of(design.material.memories));
  values["LAW_MEMBERS"] =
      design.material.contact.power_law() == nullptr
          ? fmt::format("  \"law\": {},\n", json_string(law_text(design.material)))
          : law_constants(design.material, "  \"stiffness_n_per_m_alpha\": {},\n  \"exponent\": {},\n");
  return values;
}

}  // namespace

std::string faust_memory(std::span<const Memory> memories, std::string_view indent) {
  if (memories.empty()) return {};
  std::string text = fmt::format(
      "{0}// Memory, for ct.contact_with_memory: force F(y) - sum of weight M, where M follows F(y) with the "
      "relaxation\n"
      "{0}// time in seconds.\n{0}memories = {1};\n",
      indent, memories.size());
  for (std::size_t i = 0; i < memories.size(); ++i)
    text += fmt::format("{0}memory_weight({1}) = {2};\n{0}memory_time({1}) = {3};\n", indent, i,
                        literal(memories[i].weight), literal(memories[i].time_s));
  return text;
}

std::string emit(const Emitter& emitter, const Design& design, std::string_view command) {
  const auto values_of = emitter.name == "faust" ? faust_values : emitter.name == "cpp" ? cpp_values : json_values;
  const bool has_forms = emitter.name == "cpp" && emitter.all_forms;
  TemplateValues values = values_of(design, has_forms ? fmt::format("{} --all-forms", command) : command);
  values["LIVE"] = live_text(emitter, design);
  if (emitter.name == "cpp") values["FORMS"] = has_forms ? cpp_forms(design) : "";
  return fill_template(emitted_template("material", emitter.extension), values);
}

}  // namespace contactspline
