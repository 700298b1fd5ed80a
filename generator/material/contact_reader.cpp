// SPDX-License-Identifier: MIT
#include "generator/material/contact_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>

#include "generator/contact/barrier_impact.hpp"
#include "generator/contact/hertz.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/ranges.hpp"

namespace contactspline {
namespace {

// Wide enough for every collision in an instrument, narrow enough to catch a wrong unit.
constexpr Range kPoisson{-1, 0.5};
constexpr Range kRadius{1e-5, 100};
constexpr Range kRestitution{0.05, 1};
constexpr std::size_t kMaxTerms = 8;

PowerLaw read_power_law(const JsonObject& object) {
  return {object.number("stiffness_n_per_m_alpha", ranges::kStiffness), object.number("exponent", ranges::kExponent)};
}

PowerSum read_sum(const JsonObject& contact) {
  PowerSum sum;
  for (const JsonObject& term :
       contact.objects("sum", {"stiffness_n_per_m_alpha", "exponent", "offset_m"}, kMaxTerms))
    sum.terms.push_back({read_power_law(term), term.has("offset_m") ? term.number("offset_m", ranges::kOffset) : 0});
  if (std::ranges::none_of(sum.terms, [](const PowerTerm& term) { return term.offset_m == 0; }))
    contact.fail("contact.sum", "no term has offset 0", "at least one term without offset_m, or with offset_m 0");
  return sum;
}

PowerSeries read_series(const JsonObject& contact) {
  PowerSeries series;
  for (const JsonObject& layer : contact.objects("series", {"stiffness_n_per_m_alpha", "exponent"}, kMaxTerms))
    series.layers.push_back(read_power_law(layer));
  return series;
}

ElasticBody read_body(const JsonObject& body) {
  using Shape = ElasticBody::Shape;
  constexpr auto kShapes = "sphere, cylinder, plane";
  const std::string name = body.text("shape", kShapes);
  if (name != "sphere" && name != "cylinder" && name != "plane")
    body.fail(body.key("shape"), fmt::format("'{}' is unknown", shown(name)), kShapes);
  const Shape shape = name == "sphere" ? Shape::kSphere : name == "plane" ? Shape::kPlane : Shape::kCylinder;
  if (shape == Shape::kPlane && body.has("radius_m"))
    body.fail(body.key("radius_m"), "a plane has no radius", "for a sphere or a cylinder");
  const double radius =
      shape == Shape::kPlane ? std::numeric_limits<double>::infinity() : body.number("radius_m", kRadius);
  return {shape, body.number("youngs_modulus_pa", ranges::kModulus), body.number("poisson_ratio", kPoisson), radius};
}

PowerLaw read_hertz(const JsonObject& contact) {
  const JsonObject hertz = contact.object("hertz", {"bodies"});
  std::vector<ElasticBody> bodies;
  for (const JsonObject& body :
       hertz.objects("bodies", {"shape", "radius_m", "youngs_modulus_pa", "poisson_ratio"}, 2))
    bodies.push_back(read_body(body));
  if (bodies.size() != 2) hertz.fail(hertz.key("bodies"), "has 1 entry", "two bodies");
  if (!touch_at_a_point(bodies[0], bodies[1]))
    hertz.fail(hertz.key("bodies"), "a plane touches a plane or a cylinder along a line or over an area",
               "a sphere with any body, or two cylinders, crossed at right angles");
  return hertz_law(bodies[0], bodies[1]);
}

Measurement read_measurement(const JsonObject& curve, std::optional<double> impact_speed,
                             std::string_view material_file, const ReadFile& read) {
  constexpr auto kAllowed = "the name of a CSV file, relative to the material file";
  const std::string file = curve.text("file", kAllowed);
  const bool usable = !file.empty() && file.front() != '/' && file.size() <= 200 &&
                      std::ranges::all_of(file, [](unsigned char c) { return c >= 0x20 && c != 0x7f; });
  if (!usable) curve.fail("contact.curve.file", fmt::format("'{}' is not usable", shown(file)), kAllowed);
  const auto path = std::filesystem::path(material_file).parent_path() / file;
  const std::string text = read_for_key(material_file, "contact.curve.file", file, read);
  return {file, parse_curve(text, path.string(), impact_speed), impact_speed};
}

CurveShape read_shape(const JsonObject& curve) {
  constexpr auto kAllowed = "hardening, monotone";
  const std::string shape = curve.text("shape", kAllowed);
  if (shape != "hardening" && shape != "monotone")
    curve.fail("contact.curve.shape", fmt::format("'{}' is unknown", shown(shape)), kAllowed);
  return shape == "hardening" ? CurveShape::kHardening : CurveShape::kMonotone;
}

// If the shape cannot follow the samples, or the fitted force is 0, they are not a measurement of this kind of
// contact.
void require_fit(const JsonObject& curve, const std::vector<CurveSample>& samples, const ForceCurve& smooth,
                 double loss) {
  constexpr double kMaxScatter = 0.1;
  const double scatter = relative_scatter(samples, smooth, loss);
  if (!(scatter <= kMaxScatter && smooth.force_n.back() > 0))
    curve.fail(
        "contact.curve.shape",
        fmt::format("the samples scatter by {:.2g} % of the largest force around the fitted curve", 100 * scatter),
        fmt::format("at most {} %: another shape, or a steadier curve", 100 * kMaxScatter));
}

// The loss is given directly, or by the coefficient of restitution at one speed.
double read_loss(const JsonObject& contact) {
  if (contact.has("loss_s_per_m") && contact.has("restitution"))
    contact.fail("contact.restitution", "is given together with loss_s_per_m", "one of the two");
  if (contact.has("loss_s_per_m")) return contact.number("loss_s_per_m", ranges::kLoss);
  if (!contact.has("restitution")) return 0;
  const JsonObject restitution = contact.object("restitution", {"coefficient", "speed_m_per_s"});
  const double loss = loss_for_restitution(restitution.number("coefficient", kRestitution),
                                           restitution.number("speed_m_per_s", ranges::kSpeed));
  if (!(loss <= ranges::kLoss.max))
    restitution.fail("contact.restitution", fmt::format("gives a loss of {} s/m", loss),
                     fmt::format("a loss of at most {} s/m: a higher coefficient or speed", ranges::kLoss.max));
  return loss;
}

std::vector<Memory> read_memories(const JsonObject& contact) {
  std::vector<Memory> memories;
  if (!contact.has("memory")) return memories;
  double sum = 0;
  for (const JsonObject& memory : contact.objects("memory", {"weight", "relaxation_time_s"}, kMaxMemories)) {
    memories.push_back(
        {memory.number("weight", ranges::kWeight), memory.number("relaxation_time_s", ranges::kRelaxation)});
    sum += memories.back().weight;
  }
  if (!(sum <= ranges::kWeight.max))
    contact.fail("contact.memory", fmt::format("has weights with the sum {:.6g}", sum),
                 fmt::format("a sum of at most {}", ranges::kWeight.max));
  return memories;
}

// The loss of a curve that was measured in an impact, with both branches.
double read_fitted_loss(const JsonObject& contact, const std::vector<CurveSample>& samples, CurveShape shape) {
  for (const char* key : {"loss_s_per_m", "restitution"})
    if (contact.has(key))
      contact.fail(contact.key(key), "is given together with curve.impact_speed_m_per_s",
                   "one of the two: the loss is fitted to both branches");
  const double fastest_out = -std::ranges::min(samples, {}, &CurveSample::speed_m_per_s).speed_m_per_s;
  const double loss =
      fitted_loss(samples, shape, std::min(ranges::kLoss.max, 0.99 / fastest_out));  // 1 + loss v stays positive
  if (!(loss < 0.999 * ranges::kLoss.max))
    contact.fail("contact.curve.impact_speed_m_per_s", "asks for a loss beyond all allowed ones",
                 fmt::format("a loss of at most {} s/m: a higher speed", ranges::kLoss.max));
  return loss;
}

constexpr std::array kKinds = {"stiffness_n_per_m_alpha", "hertz", "curve", "sum", "series"};

// The key of the law that is given. There must be exactly one.
std::string_view kind_of(const JsonObject& contact) {
  std::vector<std::string_view> given;
  for (const char* kind : kKinds)
    if (contact.has(kind)) given.emplace_back(kind);
  if (given.empty() && contact.has("exponent")) return kKinds[0];
  if (given.size() > 1 || (given.size() == 1 && given[0] != kKinds[0] && contact.has("exponent")))
    contact.fail("contact", "has more than one law",
                 "one of stiffness_n_per_m_alpha with exponent, hertz, curve, sum, series");
  if (given.empty())
    contact.fail("contact", "has no law", "one of stiffness_n_per_m_alpha with exponent, hertz, curve, sum, series");
  return given.front();
}

}  // namespace

std::string read_for_key(std::string_view file, std::string_view key, const std::string& path, const ReadFile& read) {
  try {
    return read(path);
  } catch (const BadInput& refused) {
    throw BadInput(fmt::format("{}: {}: {}", file, key, refused.what()));
  }
}

std::string shipped_file(const std::string& path) {
  const EmbeddedFile* found = path.ends_with(".csv") ? find_embedded(Shipped::kMaterials, path) : nullptr;
  if (found == nullptr) refuse(shown(path), "file", "no such curve ships", "a CSV file next to a material file");
  return std::string(found->content);
}

Contact read_contact(const JsonObject& material, std::string_view file, const ReadFile& read) {
  const JsonObject contact = material.object("contact", {"stiffness_n_per_m_alpha", "exponent", "hertz", "curve",
                                                         "sum", "series", "loss_s_per_m", "restitution", "memory"});
  const std::string_view kind = kind_of(contact);
  const double loss = read_loss(contact);
  std::vector<Memory> memories = read_memories(contact);
  if (kind == "hertz") return {read_hertz(contact), loss, {}, memories};
  if (kind == "series") return {read_series(contact), loss, {}, memories};
  if (kind == "sum") return {read_sum(contact), loss, {}, memories};
  if (kind == "stiffness_n_per_m_alpha") return {read_power_law(contact), loss, {}, memories};
  const JsonObject curve = contact.object("curve", {"file", "shape", "impact_speed_m_per_s"});
  const CurveShape shape = read_shape(curve);
  std::optional<double> impact_speed;
  if (curve.has("impact_speed_m_per_s") && !memories.empty())
    contact.fail("contact.memory", "is given together with curve.impact_speed_m_per_s",
                 "one of the two: both branches give a Hunt-Crossley loss");
  if (curve.has("impact_speed_m_per_s")) impact_speed = curve.number("impact_speed_m_per_s", ranges::kSpeed);
  Measurement measured = read_measurement(curve, impact_speed, file, read);
  const double curve_loss = impact_speed ? read_fitted_loss(contact, measured.samples, shape) : loss;
  ForceCurve smooth = smooth_curve(measured.samples, shape, curve_loss);
  require_fit(curve, measured.samples, smooth, curve_loss);
  return {std::move(smooth), curve_loss, std::move(measured), std::move(memories)};
}

}  // namespace contactspline
