// SPDX-License-Identifier: MIT
#include "generator/instrument/body_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "generator/material/named_file.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/ranges.hpp"

namespace contactspline {
namespace {

constexpr int kMaxAiryFunctions = 128;
// Each form couples a mode with all of an order or, on a rectangular plate, with a quarter of all.
constexpr int kMaxRoundModes = 1024, kMaxRectangularModes = 400;
constexpr int kMaxLongitudinalModes = 16;
constexpr double kMaxAspect = 20;  // beyond it the Airy functions of free edges need too many polynomials
constexpr Range kCoreDiameter{1e-5, 0.1}, kHeadThickness{1e-6, 0.1}, kPoisson{-0.999, 0.999};

/// Reads bodies, then places on them.
class BodyReader {
 public:
  BodyReader(InstrumentDraft& draft, const ReadFile& read) : draft_(draft), model_(draft.model), read_(read) {}

  void read() {
    for (const JsonObject& body :
         draft_.json.objects("bodies",
                             {"name", "resonator", "string", "bar", "membrane", "plate", "round_plate", "modes",
                              "mass_kg", "tuning_cents", "max_modes", "stretch"},
                             kMaxBodies))
      read_body(body);
    for (const JsonObject& place : draft_.objects("places", {"name", "body", "position_m", "angle_rad", "across_m",
                                                             "positions_m", "mean_radius_m", "shapes"}))
      read_place(place);
  }

 private:
  void read_body(const JsonObject& body) {
    InstrumentBody read{draft_.own_name(body), {}, false};
    const std::string kind =
        one_of_keys(body, {"resonator", "string", "bar", "membrane", "plate", "round_plate", "modes", "mass_kg"},
                    "kinds of body");
    if (kind == "mass_kg") {
      read.is_mass = true;
      read.resonator = {read.name, "", ModeTable{{{{0, 0, body.number("mass_kg", kModalMass_kg)}, 1, 1}}}, {}, {}, 1};
      model_.places.push_back({read.name, model_.bodies.size(), {Place{}}});
    } else if (kind == "resonator") {
      const NamedText named = read_named(body, "resonator", Shipped::kResonators, read_);
      read.resonator = parse_resonator(named.text, named.file);
    } else {
      read.resonator = {read.name, "", kind == "modes" ? read_modes(body) : read_shaped_body(body),
                        {},        {}, kMaxModes};
      read.resonator.max_modes = max_modes_of(read.resonator.body);
    }
    read_modifiers(body, read);
    model_.bodies.push_back(std::move(read));
  }

  static decltype(Resonator::body) read_modes(const JsonObject& body) {
    ModeTable table;
    for (const JsonObject& row : body.objects("modes", {"frequency_hz", "decay_per_s", "mass_kg"}, kMaxModes))
      table.rows.push_back({{2 * std::numbers::pi * row.number("frequency_hz", kModeFrequency_hz),
                             row.number("decay_per_s", kModeDecay_per_s), row.number("mass_kg", kModalMass_kg)},
                            0,
                            0});
    return table;
  }

  static void read_modifiers(const JsonObject& body, InstrumentBody& read) {
    auto* string = std::get_if<StiffString>(&read.resonator.body);
    if (string != nullptr && string->detuning_cents.size() != 1)
      body.fail(body.key(body.has("resonator") ? "resonator" : "string"), "has several strings", "one body each");
    if (body.has("tuning_cents")) {
      if (string == nullptr) body.fail(body.key("tuning_cents"), "is not for this body", "beside strings");
      string->detuning_cents.front() += body.number("tuning_cents", kTuningCents);
    }
    if (body.has("max_modes")) {
      if (read.is_mass) body.fail(body.key("max_modes"), "is not for a mass", "beside resonators");
      read.resonator.max_modes = body.integer("max_modes", 1, max_modes_of(read.resonator.body));
    }
    if (body.has("stretch")) read_stretch(body, read);
  }

  // The axial stiffness of a string (Kirchhoff and Carrier), the stiffness of the form of a membrane (Berger), or the
  // number of forms of a plate (von Karman).
  static void read_stretch(const JsonObject& body, InstrumentBody& read) {
    const auto object = [&](const std::vector<std::string>& keys, const char* example) {
      if (!body.has_object("stretch"))
        body.fail(body.key("stretch"), "is not an object", fmt::format("such as {}", example));
      return body.object("stretch", keys);
    };
    if (std::holds_alternative<StiffString>(read.resonator.body)) {
      const JsonObject stretch = object({"youngs_modulus_pa", "core_diameter_m", "longitudinal"},
                                        R"({ "youngs_modulus_pa": 2e11, "core_diameter_m": 0.0003 })");
      const double diameter = stretch.number("core_diameter_m", kCoreDiameter);
      const double section = std::numbers::pi / 4 * diameter * diameter;
      read.axial_stiffness_n = stretch.number("youngs_modulus_pa", ranges::kModulus) * section;
      if (stretch.has("longitudinal")) read_longitudinal(stretch, read);
    } else if (const auto* membrane = std::get_if<Membrane>(&read.resonator.body)) {
      const JsonObject stretch =
          object({"youngs_modulus_pa", "thickness_m", "poisson_ratio"},
                 R"({ "youngs_modulus_pa": 4.9e9, "thickness_m": 0.00025, "poisson_ratio": 0.38 })");
      const double thickness = stretch.number("thickness_m", kHeadThickness);
      const double poisson = stretch.number("poisson_ratio", kPoisson);
      read.stretch_j = stretch.number("youngs_modulus_pa", ranges::kModulus) * thickness * area_of(*membrane) /
                       (2 * (1 - poisson * poisson));
    } else if (const auto* plate = std::get_if<Plate>(&read.resonator.body)) {
      const JsonObject stretch = object({"airy_functions", "edges"}, R"({ "airy_functions": 20, "edges": "free" })");
      check_stretching_plate(body, *plate);
      if (read_word(stretch, "edges", "free", "fixed") == "fixed") read.edges = PlateEdges::kFixed;
      read_airy_functions(body, stretch, kMaxRectangularModes, read);
    } else if (std::holds_alternative<RoundPlate>(read.resonator.body)) {
      read_airy_functions(body, object({"airy_functions"}, R"({ "airy_functions": 20 })"), kMaxRoundModes, read);
    } else {
      body.fail(body.key("stretch"), fmt::format("is not for a body of the kind '{}'", kind_of(read)),
                "beside a string, a membrane, a plate or a round_plate");
    }
  }

  static void read_longitudinal(const JsonObject& stretch, InstrumentBody& read) {
    const JsonObject longitudinal =
        stretch.object("longitudinal", {"modes", "constant_loss_per_s", "quadratic_loss_m2_per_s"});
    read.longitudinal = static_cast<std::size_t>(longitudinal.integer("modes", 1, kMaxLongitudinalModes));
    read.longitudinal_losses = {longitudinal.number("constant_loss_per_s", kLongitudinalLoss),
                                longitudinal.has("quadratic_loss_m2_per_s")
                                    ? longitudinal.number("quadratic_loss_m2_per_s", kLongitudinalQuadratic)
                                    : 0};
    if (longitudinal_modes(read.as_stretching_string()).empty())
      stretch.fail(stretch.key("longitudinal"), "decays without oscillating", "smaller losses or a stiffer core");
  }

  // Throws BadInput unless it is of one material, without ribs, and not much longer than wide.
  static void check_stretching_plate(const JsonObject& body, const Plate& plate) {
    const double shear = plate.youngs_modulus_pa / (2 * (1 + plate.poisson_ratio));
    if (plate.ribbed || plate.youngs_modulus_across_pa != plate.youngs_modulus_pa ||
        std::abs(plate.shear_modulus_pa / shear - 1) > 1e-6)
      body.fail(body.key("stretch"), "is not for a plate of wood or with ribs",
                "beside a plate without youngs_modulus_across_pa, shear_modulus_pa and ribs");
    const auto [less, more] = std::minmax(plate.length_m, plate.width_m);
    if (more > kMaxAspect * less)
      body.fail(body.key("stretch"), fmt::format("stands beside a plate of {:g} m by {:g} m", more, less),
                fmt::format("length_m and width_m that differ by at most {:g} times", kMaxAspect));
  }

  static void read_airy_functions(const JsonObject& body, const JsonObject& stretch, int max_modes,
                                  InstrumentBody& read) {
    read.airy_functions = static_cast<std::size_t>(stretch.integer("airy_functions", 1, kMaxAiryFunctions));
    if (read.resonator.max_modes > max_modes)
      body.fail(body.key("max_modes"), fmt::format("is missing or too large beside `stretch` of a {}", kind_of(read)),
                fmt::format("1 to {}, such as 64", max_modes));
  }

  void read_place(const JsonObject& place) {
    InstrumentPlace read{draft_.own_name(place), 0, {}};
    const std::string name = place.text("body", joined(names_of(model_.bodies)));
    read.body = index_of(place, place.key("body"), name, model_.bodies, "body");
    const InstrumentBody& body = model_.bodies[read.body];
    if (body.is_mass)
      place.fail(place.key("body"), fmt::format("'{}' is a mass", name), "a resonator; a mass is itself a place");
    if (const auto* table = std::get_if<ModeTable>(&body.resonator.body)) {
      for (const char* key : {"position_m", "positions_m", "angle_rad", "across_m", "mean_radius_m"})
        if (place.has(key)) place.fail(place.key(key), "has no meaning on a table of modes", "shapes");
      read.shapes = place.numbers("shapes", kModeShape, kMaxModes);
      if (read.shapes.size() != table->rows.size())
        place.fail(place.key("shapes"), fmt::format("has {} entries", read.shapes.size()),
                   fmt::format("one for each of the {} modes", table->rows.size()));
      read.points.emplace_back();
    } else {
      read_points(place, body, read);
    }
    points_ += read.points.size();
    if (points_ > kMaxPoints)
      place.fail(place.key("name"), fmt::format("the places have more than {} points", kMaxPoints), "fewer points");
    model_.places.push_back(std::move(read));
  }

  static void read_points(const JsonObject& place, const InstrumentBody& body, InstrumentPlace& read) {
    if (place.has("shapes")) place.fail(place.key("shapes"), "is not for this body", "position_m or positions_m");
    const bool has_angle = is_round(body.resonator.body);
    if (place.has("mean_radius_m")) {
      if (!std::holds_alternative<Membrane>(body.resonator.body))
        place.fail(place.key("mean_radius_m"), "is not for this body", "on a membrane");
      for (const char* key : {"position_m", "positions_m", "angle_rad"})
        if (place.has(key)) place.fail(place.key(key), "stands beside mean_radius_m", "one of the two");
      read.points.push_back(
          {.position_m = 0, .mean_radius_m = place.number("mean_radius_m", {1e-6, extent_of(body.resonator.body)})});
      return;
    }
    if (place.has("angle_rad") && !has_angle)
      place.fail(place.key("angle_rad"), "is not for this body", "on a membrane or a round_plate");
    const auto* plate = std::get_if<Plate>(&body.resonator.body);
    if (place.has("across_m") && plate == nullptr)
      place.fail(place.key("across_m"), "is not for this body", "on a plate");
    const double across = plate != nullptr ? place.number("across_m", {0, plate->width_m}) : 0;
    const double angle = place.has("angle_rad") ? place.number("angle_rad", kPlaceAngle_rad) : 0;
    // A negative radius lies on the other side of the centre.
    const double extent = extent_of(body.resonator.body);
    const Range range{has_angle ? -extent : 0, extent};
    const std::string key = one_of_keys(place, {"position_m", "positions_m"}, "kinds of position");
    const auto positions = key == "position_m" ? std::vector{place.number("position_m", range)}
                                               : place.numbers("positions_m", range, kMaxPoints);
    for (const double position : positions)
      read.points.push_back({std::abs(position), position < 0 ? angle + std::numbers::pi : angle, across});
  }

  InstrumentDraft& draft_;
  InstrumentModel& model_;
  const ReadFile& read_;
  std::size_t points_ = 0;
};

}  // namespace

void read_bodies(InstrumentDraft& draft, const ReadFile& read) {
  BodyReader(draft, read).read();
}

}  // namespace contactspline
