// SPDX-License-Identifier: MIT
#include "generator/material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/compensation.hpp"
#include "generator/json_input.hpp"
#include "generator/knots.hpp"
#include "generator/potential_quad.hpp"

namespace contactspline {
namespace {

// Wide enough for every collision in an instrument, narrow enough to catch a wrong unit.
constexpr Range kMass{1e-9, 1e4};
constexpr Range kSpeed{1e-6, 1e3};
constexpr Range kCompression{1e-9, 1};
constexpr Range kSampleRate{1e3, 1e8};
constexpr Range kCompliance{1e-15, 1};
constexpr Range kTolerance{1e-7, 0.5};
constexpr int kMaxSegments = 65536;
constexpr Range kLiveExponent{1, 10};  // convex
constexpr int kMaxMembers = 64;
constexpr int kMaxLiveSegments = 256;

// Members of the emitted C++ struct, which must not be called like it.
constexpr const char* kTaken[] = {"segments",
                                  "stiffness_n_per_m_alpha",
                                  "exponent",
                                  "loss_s_per_m",
                                  "max_compression_m",
                                  "segment_width_m",
                                  "length_scale_m",
                                  "energy_scale_j",
                                  "knots",
                                  "energies",
                                  "forces",
                                  "half_curvatures",
                                  "normalised",
                                  "regular",
                                  "loss",
                                  "live"};

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

constexpr std::array kKnots = {Knots::uniform, Knots::graded, Knots::optimal};

Knots read_knots(const JsonObject& spline) {
  constexpr auto kAllowed = "uniform, graded, optimal";
  const std::string name = spline.text("knots", kAllowed);
  const auto found = std::ranges::find(kKnots, name, name_of);
  if (found == kKnots.end()) spline.fail("spline.knots", fmt::format("'{}' is unknown", shown(name)), kAllowed);
  return *found;
}

ErrorOf read_minimise(const JsonObject& spline, Knots knots) {
  if (!spline.has("minimise")) return ErrorOf::contact_duration;
  constexpr auto kAllowed = "contact_duration, force";
  const std::string name = spline.text("minimise", kAllowed);
  if (knots != Knots::optimal)
    spline.fail("spline.minimise", fmt::format("says nothing to {} knots", name_of(knots)),
                "with optimal knots only");
  if (name != "contact_duration" && name != "force")
    spline.fail("spline.minimise", fmt::format("'{}' is unknown", shown(name)), kAllowed);
  return name == "force" ? ErrorOf::force : ErrorOf::contact_duration;
}

// What is asked for of a range of impacts cannot be met without one.
void require_impact(const JsonObject& spline, const SplineDesign& design, const std::optional<Impact>& impact) {
  if (design.knots != Knots::uniform && spline.has("max_compression_m"))
    spline.fail("spline.max_compression_m", fmt::format("{} knots end where impact does", name_of(design.knots)),
                "left out, or uniform knots");
  if (impact) return;
  if (design.knots != Knots::uniform)
    spline.fail("spline.knots", fmt::format("'{}' needs the range of impacts", name_of(design.knots)),
                "with an impact, or uniform");
  if (design.tolerance > 0)
    spline.fail("spline.tolerance", "needs the range of impacts", "with an impact, or segments in its place");
}

SplineDesign read_spline(const JsonObject& spline, const Potential& contact, const std::optional<Impact>& impact) {
  SplineDesign design{.segments = 0, .max_compression_m = 0, .knots = read_knots(spline)};
  design.minimise = read_minimise(spline, design.knots);
  const int most = design.knots == Knots::optimal ? kMostFittedSegments : kMaxSegments;
  if (spline.has("tolerance")) {
    if (spline.has("segments")) spline.fail("spline.tolerance", "stands beside segments", "one of the two");
    design.tolerance = spline.number("tolerance", kTolerance);
  } else {
    design.segments = spline.integer("segments", 1, most);
  }
  require_impact(spline, design, impact);
  design.max_compression_m = read_max_compression(spline, contact, impact);
  return design;
}

void require_compensable(const JsonObject& material, const Material& of) {
  if (of.spline.knots == Knots::uniform)
    material.fail("compensation", "uniform knots are the paper's, without it", "with graded or optimal knots");
  if (of.spline.minimise == ErrorOf::force)
    material.fail("compensation", "is of the contact duration, not of the force", "with minimise contact_duration");
  const double rate = of.compensation->sample_rate_hz, mass_kg = of.compensation->mass_kg;
  constexpr double kMostSamples = 1e4;
  const double slowest = of.impact->min_speed_m_per_s * std::sqrt(of.impact->mass_kg / mass_kg);
  const double samples = of.contact.contact_duration(mass_kg, slowest) * rate;
  const double least_rate = rate * largest_half_angle(of) / kMostHalfAngle;
  if (least_rate > rate)
    material.fail("compensation.sample_rate_hz",
                  fmt::format("{} is too low for the fastest impact of {} kg", rate, mass_kg),
                  fmt::format("at least {:.0f}", std::ceil(least_rate)));
  if (!(samples <= kMostSamples))
    material.fail("compensation.sample_rate_hz",
                  fmt::format("{} makes the slowest impact of {} kg last {:.3g} samples, which needs none", rate,
                              mass_kg, samples),
                  fmt::format("a rate at which it lasts at most {:g}", kMostSamples));
}

// In series with a softer spring the contact would be that spring.
void require_stiffer(const JsonObject& material, const Material& of) {
  const double range = of.spline.max_compression_m, own = range / of.contact.force(range);
  if (of.compensation->compliance_m_per_n > own)
    material.fail(
        "compensation.compliance_m_per_n",
        fmt::format("{} is above the contact's own at its largest compression", of.compensation->compliance_m_per_n),
        fmt::format("at most {:.4g}", own * (1 - 0.005)));
}

Compensation read_compensation(const JsonObject& compensation) {
  return {compensation.number("sample_rate_hz", kSampleRate), compensation.number("mass_kg", kMass),
          compensation.has("compliance_m_per_n") ? compensation.number("compliance_m_per_n", kCompliance) : 0};
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

LiveExponents read_live_exponent(const JsonObject& live, const Material& of) {
  const double least = live.number("least", kLiveExponent);
  const LiveExponents read{least, live.number("most", kLiveExponent), live.integer("members", 2, kMaxMembers)};
  if (!(read.most > least))
    live.fail(live.key("most"), fmt::format("{} is not above least", read.most), fmt::format("more than {}", least));
  if (of.contact.power_law() == nullptr) live.fail("live_exponent", "is for power laws", "a power law");
  if (of.compensation) live.fail("live_exponent", "is not compensated for a time step", "without compensation");
  if (of.spline.tolerance > 0)
    live.fail("live_exponent", "has its own knots, which no tolerance gives", "with segments");
  if (of.spline.segments > kMaxLiveSegments)
    live.fail("live_exponent", fmt::format("with {} segments", of.spline.segments),
              fmt::format("at most {} segments", kMaxLiveSegments));
  return read;
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
  const JsonObject material(json, file, "material",
                            {"name", "description", "contact", "impact", "spline", "compensation", "live_exponent"});
  Contact contact = read_contact(material, file, read_file);
  Material read{read_name(material, kTaken), read_description(material), std::move(contact.potential), {}, {},
                contact.loss_s_per_m,        std::move(contact.measured)};
  if (material.has("impact"))
    read.impact = read_impact(material.object("impact", {"mass_kg", "max_speed_m_per_s", "min_speed_m_per_s"}));
  read.spline =
      read_spline(material.object("spline", {"knots", "segments", "max_compression_m", "minimise", "tolerance"}),
                  read.contact, read.impact);
  require_measured(material, read);
  if (material.has("compensation")) {
    read.compensation =
        read_compensation(material.object("compensation", {"sample_rate_hz", "mass_kg", "compliance_m_per_n"}));
    require_compensable(material, read);
    require_stiffer(material, read);
  }
  if (material.has("live_exponent"))
    read.live_exponent = read_live_exponent(material.object("live_exponent", {"least", "most", "members"}), read);
  return read;
}

std::string_view name_of(Knots knots) {
  return knots == Knots::uniform ? "uniform" : knots == Knots::graded ? "graded" : "optimal";
}

}  // namespace contactspline
