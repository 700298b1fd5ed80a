// SPDX-License-Identifier: MIT
#include "generator/material/material_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/contact/barrier_impact.hpp"
#include "generator/support/number_literal.hpp"
#include "generator/support/ranges.hpp"

namespace contactspline {
namespace {

// Wide enough for every collision in an instrument, narrow enough to catch a wrong unit.
constexpr Range kSampleRate{1e3, 1e8};
constexpr Range kTolerance{1e-7, 0.5};
constexpr Range kTolerance_db{0.1, 20};  // the exact spectra are right to 0.07 dB (ExactSpectra)
constexpr int kMaxSegments = 65536;
constexpr Range kLiveExponent{1, 10};  // convex
constexpr int kMaxMembers = 64;
constexpr int kMaxLiveSegments = 256;

// Member names of the emitted C++ struct; the struct itself must have another name.
constexpr const char* kMemberNames[] = {
    "segments",        "stiffness_n_per_m_alpha", "exponent",       "loss_s_per_m",  "max_compression_m",
    "segment_width_m", "length_scale_m",          "energy_scale_j", "knots",         "energies",
    "forces",          "half_curvatures",         "normalised",     "regular",       "loss",
    "memory_weights",  "memory_times_s",          "live",           "format_version"};

Impact read_impact(const JsonObject& impact) {
  const Impact read{impact.number("mass_kg", ranges::kMass), impact.number("max_speed_m_per_s", ranges::kSpeed),
                    impact.number("min_speed_m_per_s", ranges::kSpeed)};
  if (read.min_speed_m_per_s > read.max_speed_m_per_s)
    impact.fail("impact.min_speed_m_per_s", fmt::format("{} is above max_speed_m_per_s", read.min_speed_m_per_s),
                fmt::format("at most {}", read.max_speed_m_per_s));
  return read;
}

double read_max_compression(const JsonObject& spline, const Material& material) {
  if (spline.has("max_compression_m")) return spline.number("max_compression_m", ranges::kCompression);
  if (!material.impact)
    spline.fail("spline.max_compression_m", "missing", "a number, or an impact to compute it from");
  const Impact impact = elastic_impact(material);
  const double compression = exact_max_compression(material.contact, impact.mass_kg, impact.max_speed_m_per_s);
  if (!(compression >= ranges::kCompression.min && compression <= ranges::kCompression.max))
    spline.fail("spline.max_compression_m",
                fmt::format("follows from impact as {} m, which is out of range", compression),
                fmt::format("a number from {} to {}", ranges::kCompression.min, ranges::kCompression.max));
  return compression;
}

constexpr std::array kKnots = {Knots::uniform, Knots::graded, Knots::optimal};

Knots read_knots(const JsonObject& spline) {
  constexpr auto kAllowed = "uniform, graded, optimal";
  const std::string name = spline.text("knots", kAllowed);
  const auto found = std::ranges::find(kKnots, name, [](Knots knots) { return name_of(knots); });
  if (found == kKnots.end()) spline.fail("spline.knots", fmt::format("'{}' is unknown", shown(name)), kAllowed);
  return *found;
}

constexpr std::array kErrors = {ErrorOf::contact_duration, ErrorOf::force, ErrorOf::spectrum};

ErrorOf read_minimise(const JsonObject& spline, Knots knots) {
  if (!spline.has("minimise")) return ErrorOf::contact_duration;
  constexpr auto kAllowed = "contact_duration, force, spectrum";
  const std::string name = spline.text("minimise", kAllowed);
  if (knots != Knots::optimal)
    spline.fail("spline.minimise", fmt::format("cannot be used with {} knots", name_of(knots)),
                "with optimal knots only");
  const auto found = std::ranges::find(kErrors, name, [](ErrorOf error) { return name_of(error); });
  if (found == kErrors.end()) spline.fail("spline.minimise", fmt::format("'{}' is unknown", shown(name)), kAllowed);
  return *found;
}

// A tolerance is relative, that of a spectrum is in decibels. Returns 0 if the spline has neither.
double read_tolerance(const JsonObject& spline, ErrorOf minimise) {
  const bool in_db = minimise == ErrorOf::spectrum;
  if (in_db && spline.has("tolerance"))
    spline.fail("spline.tolerance", "cannot bound the spectrum", "tolerance_db instead");
  if (!in_db && spline.has("tolerance_db"))
    spline.fail("spline.tolerance_db", fmt::format("cannot bound the {}", name_of(minimise)),
                "tolerance instead, or minimise spectrum");
  const auto* key = in_db ? "tolerance_db" : "tolerance";
  if (!spline.has(key)) return 0;
  if (spline.has("segments")) spline.fail(spline.key(key), "is given together with segments", "one of the two");
  return spline.number(key, in_db ? kTolerance_db : kTolerance);
}

// Graded and optimal knots and a tolerance refer to the range of impacts, so they need one.
void require_impact(const JsonObject& spline, const SplineDesign& design, const std::optional<Impact>& impact) {
  if (design.knots != Knots::uniform && spline.has("max_compression_m"))
    spline.fail("spline.max_compression_m", fmt::format("{} knots take it from impact", name_of(design.knots)),
                "without this key, or with uniform knots");
  if (impact) return;
  if (design.knots != Knots::uniform)
    spline.fail("spline.knots", fmt::format("'{}' needs a range of impacts", name_of(design.knots)),
                "with an impact, or uniform");
  if (design.tolerance > 0)
    spline.fail("spline.tolerance", "needs a range of impacts", "with an impact, or segments instead");
}

SplineDesign read_spline(const JsonObject& spline, const Material& material) {
  SplineDesign design{.segments = 0, .max_compression_m = 0, .knots = read_knots(spline)};
  design.minimise = read_minimise(spline, design.knots);
  const int max = design.knots == Knots::optimal ? kMaxFittedSegments : kMaxSegments;
  design.tolerance = read_tolerance(spline, design.minimise);
  if (design.tolerance == 0) design.segments = spline.integer("segments", 1, max);
  require_impact(spline, design, material.impact);
  design.max_compression_m = read_max_compression(spline, material);
  return design;
}

Compensation read_compensation(const JsonObject& compensation) {
  return {compensation.number("sample_rate_hz", kSampleRate), compensation.number("mass_kg", ranges::kMass)};
}

// To four digits, in one direction: a number that a message offers must be accepted.
double rounded_down(double number) {
  return rounded_to(number * (1 - 5.1e-4), 4);
}
double rounded_up(double number) {
  return rounded_to(number * (1 + 5.1e-4), 4);
}

// What would keep the spline within a curve that is measured up to there.
std::string within_curve(const Material& read, bool has_compression, double measured_m) {
  const double fewest = measured_m / 100;
  if (has_compression || !read.impact)
    return fmt::format("spline.max_compression_m from {:.4g} to {:.4g}", rounded_up(fewest),
                       rounded_down(measured_m));
  const auto speed_to = [&](double compression_m) {
    return std::sqrt(2 * read.contact.energy(compression_m) / elastic_impact(read).mass_kg);
  };
  constexpr auto kHow = "with which a blow without loss ends within the curve";
  return read.spline.max_compression_m > measured_m
             ? fmt::format("impact.max_speed_m_per_s of at most {:.4g}, {}", rounded_down(speed_to(measured_m)), kHow)
             : fmt::format("impact.max_speed_m_per_s of at least {:.4g}, {}, and beyond a hundredth of it",
                           rounded_up(speed_to(fewest)), kHow);
}

// The curve must cover the spline. If the spline uses less than a hundredth of the curve, a unit is probably
// wrong.
void require_measured(const JsonObject& material, const Material& read, bool has_compression) {
  if (!read.measured) return;
  const double measured = read.measured->samples.back().compression_m;
  const double used = read.spline.max_compression_m;
  if (!(used <= measured && used >= measured / 100))
    material.fail(
        "contact.curve",
        fmt::format(
            "measured up to {:.6g} m, and {:.6g} m are needed: a wrong unit in its header, or a wrong impact?",
            measured, used),
        within_curve(read, has_compression, measured));
  if (!(read.contact.force(used) > 0))
    material.fail("contact.curve", fmt::format("has no force up to {:.6g} m", used),
                  "a positive force at the largest compression");
}

LiveExponents read_live_exponent(const JsonObject& live, const Material& material) {
  const double min = live.number("min", kLiveExponent);
  const LiveExponents read{min, live.number("max", kLiveExponent), live.integer("members", 2, kMaxMembers)};
  if (!(read.max > min))
    live.fail(live.key("max"), fmt::format("{} is not above min", read.max), fmt::format("more than {}", min));
  if (material.contact.power_law() == nullptr) live.fail("live_exponent", "needs a power law", "with a power law");
  if (material.compensation)
    live.fail("live_exponent", "cannot be compensated for a time step", "without compensation");
  if (!material.memories.empty()) live.fail("live_exponent", "cannot have a memory", "without contact.memory");
  if (material.spline.tolerance > 0)
    live.fail("live_exponent", "needs a number of segments, not a tolerance", "with segments");
  if (material.spline.segments > kMaxLiveSegments)
    live.fail("live_exponent", fmt::format("has {} segments", material.spline.segments),
              fmt::format("at most {} segments", kMaxLiveSegments));
  return read;
}

}  // namespace

Material parse_material(std::string_view text, std::string_view file, const ReadFile& read_file) {
  const JsonObject material =
      parse_json(text, file, "material",
                 {"name", "description", "contact", "impact", "spline", "compensation", "live_exponent"});
  Contact contact = read_contact(material, file, read_file);
  Material read{read_name(material, kMemberNames),
                read_description(material),
                std::move(contact.law),
                {},
                {},
                contact.loss_s_per_m,
                std::move(contact.measured)};
  if (material.has("impact"))
    read.impact = read_impact(material.object("impact", {"mass_kg", "max_speed_m_per_s", "min_speed_m_per_s"}));
  const JsonObject spline =
      material.object("spline", {"knots", "segments", "max_compression_m", "minimise", "tolerance", "tolerance_db"});
  read.memories = std::move(contact.memories);
  read.spline = read_spline(spline, read);
  require_measured(material, read, spline.has("max_compression_m"));
  if (material.has("compensation"))
    read.compensation = read_compensation(material.object("compensation", {"sample_rate_hz", "mass_kg"}));
  if (read.compensation && !read.memories.empty())
    material.fail("compensation", "cannot compensate a contact with memory", "without contact.memory");
  if (material.has("live_exponent"))
    read.live_exponent = read_live_exponent(material.object("live_exponent", {"min", "max", "members"}), read);
  return read;
}

}  // namespace contactspline
