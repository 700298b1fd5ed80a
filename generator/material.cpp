// SPDX-License-Identifier: MIT
#include "generator/material.hpp"

#include <fmt/format.h>

#include "generator/json_input.hpp"
#include "generator/potential_quad.hpp"

namespace contactspline {
namespace {

// Wide enough for every collision in an instrument, narrow enough to catch a wrong unit.
constexpr Range kMass{1e-9, 1e4};
constexpr Range kSpeed{1e-6, 1e3};
constexpr Range kCompression{1e-9, 1};
constexpr int kMaxSegments = 65536;

// Members of the emitted C++ struct, which must not be called like it.
constexpr const char* kTaken[] = {"segments",          "stiffness_n_per_m_alpha",
                                  "exponent",          "loss_s_per_m",
                                  "max_compression_m", "segment_width_m",
                                  "energy_scale_j",    "knots",
                                  "energies",          "forces",
                                  "half_curvatures",   "normalised",
                                  "regular",           "loss"};

Impact read_impact(const JsonObject& impact) {
  const Impact read{impact.number("mass_kg", kMass), impact.number("max_speed_m_per_s", kSpeed),
                    impact.number("min_speed_m_per_s", kSpeed)};
  if (read.min_speed_m_per_s > read.max_speed_m_per_s)
    impact.fail("impact.min_speed_m_per_s", fmt::format("{} is above max_speed_m_per_s", read.min_speed_m_per_s),
                fmt::format("at most {}", read.max_speed_m_per_s));
  return read;
}

// In 113 bits: what follows from it is emitted, and pow() differs between machines.
double max_compression_of(const Potential& contact, const Impact& impact) {
  const Quad energy = Quad(impact.mass_kg) * impact.max_speed_m_per_s * impact.max_speed_m_per_s / 2;
  return exact_max_compression(contact, energy).convert_to<double>();
}

double read_max_compression(const JsonObject& spline, const Potential& contact, const std::optional<Impact>& impact) {
  if (spline.has("max_compression_m")) return spline.number("max_compression_m", kCompression);
  if (!impact) spline.fail("spline.max_compression_m", "missing", "a number, or an impact that gives it by energy");
  const double compression = max_compression_of(contact, *impact);
  if (!(compression >= kCompression.least && compression <= kCompression.most))
    spline.fail("spline.max_compression_m",
                fmt::format("follows from impact as {} m, which is out of range", compression),
                fmt::format("a number from {} to {}", kCompression.least, kCompression.most));
  return compression;
}

SplineDesign read_spline(const JsonObject& spline, const Potential& contact, const std::optional<Impact>& impact) {
  const std::string knots = spline.text("knots", "uniform");
  if (knots != "uniform") spline.fail("spline.knots", fmt::format("'{}' is unknown", shown(knots)), "uniform");
  return {spline.integer("segments", 1, kMaxSegments), read_max_compression(spline, contact, impact)};
}

std::string term_text(const PowerTerm& term) {
  const std::string base = term.offset_m == 0 ? "y" : fmt::format("(y - {})", term.offset_m);
  return fmt::format("{} {}^{}", term.law.stiffness, base, term.law.exponent);
}

std::string measurement_text(const Measurement& measured) {
  return fmt::format("F(y) smoothed from {} samples of {} up to {:.6g} m", measured.samples.size(), measured.file,
                     measured.samples.back().compression_m);
}

// Nothing is known beyond what was measured; and where impacts reach next to nothing of it, a unit is wrong.
void require_measured(const JsonObject& material, const Material& read) {
  if (!read.measured) return;
  const double measured = read.measured->samples.back().compression_m;
  const double used = read.spline.max_compression_m;
  if (!(used <= measured && used >= measured / 100))
    material.fail(
        "contact.curve",
        fmt::format("measured up to {:.6g} m, and {:.6g} m are needed: a wrong unit in its header, or impacts "
                    "of another size?",
                    measured, used),
        "a curve up to the largest compression, and at most 100 times beyond");
  if (!(read.contact.force(used) > 0))
    material.fail("contact.curve", fmt::format("does not push up to {:.6g} m", used),
                  "a force before the largest compression");
}

}  // namespace

std::string law_text(const Material& material) {
  if (const PowerLaw* law = material.contact.power_law())
    return fmt::format("V(y) = k/(a+1) y^(a+1), k = {} N/m^a, a = {}", law->stiffness, law->exponent);
  if (material.measured) return measurement_text(*material.measured);
  std::string text;
  for (const PowerTerm& term : std::get<PowerSum>(material.contact.law()).terms)
    text += (text.empty() ? "F(y) = " : " + ") + term_text(term);
  return text + ", in parallel";
}

Material parse_material(std::string_view text, std::string_view file, const ReadFile& read_file) {
  const auto json = parse_json(text, file, "material");
  const JsonObject material(json, file, "material", {"name", "description", "contact", "impact", "spline"});
  Contact contact = read_contact(material, file, read_file);
  Material read{read_name(material, kTaken), read_description(material), std::move(contact.potential), {}, {},
                contact.loss_s_per_m,        std::move(contact.measured)};
  if (material.has("impact"))
    read.impact = read_impact(material.object("impact", {"mass_kg", "max_speed_m_per_s", "min_speed_m_per_s"}));
  read.spline =
      read_spline(material.object("spline", {"knots", "segments", "max_compression_m"}), read.contact, read.impact);
  require_measured(material, read);
  return read;
}

}  // namespace contactspline
