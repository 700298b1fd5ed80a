// SPDX-License-Identifier: MIT
#include "generator/material.hpp"

#include <fmt/format.h>

#include "generator/json_input.hpp"
#include "generator/quad.hpp"

namespace contactspline {
namespace {

// Wide enough for every collision in an instrument, narrow enough to catch a wrong unit.
constexpr Range kStiffness{1e-3, 1e18};
constexpr Range kExponent{0.1, 10};
constexpr Range kMass{1e-9, 1e4};
constexpr Range kSpeed{1e-6, 1e3};
constexpr Range kCompression{1e-9, 1};
constexpr int kMaxSegments = 65536;

// Members of the emitted C++ struct, which must not be called like it.
constexpr const char* kTaken[] = {"segments",        "stiffness_n_per_m_alpha", "exponent",   "max_compression_m",
                                  "segment_width_m", "energy_scale_j",          "knots",      "energies",
                                  "forces",          "half_curvatures",         "normalised", "regular"};

Impact read_impact(const JsonObject& impact) {
  const Impact read{impact.number("mass_kg", kMass), impact.number("max_speed_m_per_s", kSpeed),
                    impact.number("min_speed_m_per_s", kSpeed)};
  if (read.min_speed_m_per_s > read.max_speed_m_per_s)
    impact.fail("impact.min_speed_m_per_s", fmt::format("{} is above max_speed_m_per_s", read.min_speed_m_per_s),
                fmt::format("at most {}", read.max_speed_m_per_s));
  return read;
}

// PowerLaw::max_compression in 113 bits: what follows from it is emitted, and pow() differs between machines.
double max_compression_of(const PowerLaw& contact, const Impact& impact) {
  const Quad energy = Quad(impact.mass_kg) * impact.max_speed_m_per_s * impact.max_speed_m_per_s / 2;
  const Quad power = Quad(contact.exponent) + 1;
  return Quad(pow(Quad(power * energy / contact.stiffness), 1 / power)).convert_to<double>();
}

double read_max_compression(const JsonObject& spline, const PowerLaw& contact, const std::optional<Impact>& impact) {
  if (spline.has("max_compression_m")) return spline.number("max_compression_m", kCompression);
  if (!impact) spline.fail("spline.max_compression_m", "missing", "a number, or an impact that gives it by energy");
  const double compression = max_compression_of(contact, *impact);
  if (!(compression >= kCompression.least && compression <= kCompression.most))
    spline.fail("spline.max_compression_m",
                fmt::format("follows from impact as {} m, which is out of range", compression),
                fmt::format("a number from {} to {}", kCompression.least, kCompression.most));
  return compression;
}

SplineDesign read_spline(const JsonObject& spline, const PowerLaw& contact, const std::optional<Impact>& impact) {
  const std::string knots = spline.text("knots", "uniform");
  if (knots != "uniform") spline.fail("spline.knots", fmt::format("'{}' is unknown", shown(knots)), "uniform");
  return {spline.integer("segments", 1, kMaxSegments), read_max_compression(spline, contact, impact)};
}

}  // namespace

Material parse_material(std::string_view text, std::string_view file) {
  const auto json = parse_json(text, file, "material");
  const JsonObject material(json, file, "material", {"name", "description", "contact", "impact", "spline"});
  const JsonObject contact = material.object("contact", {"stiffness_n_per_m_alpha", "exponent"});
  Material read{read_name(material, kTaken),
                read_description(material),
                {contact.number("stiffness_n_per_m_alpha", kStiffness), contact.number("exponent", kExponent)},
                {},
                {}};
  if (material.has("impact"))
    read.impact = read_impact(material.object("impact", {"mass_kg", "max_speed_m_per_s", "min_speed_m_per_s"}));
  read.spline =
      read_spline(material.object("spline", {"knots", "segments", "max_compression_m"}), read.contact, read.impact);
  return read;
}

}  // namespace contactspline
