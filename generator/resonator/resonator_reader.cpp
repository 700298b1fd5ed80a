// SPDX-License-Identifier: MIT
#include "generator/resonator/resonator_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>

#include "contactspline/data/keyboard_parts.hpp"
#include "generator/resonator/ribbed_plate.hpp"
#include "generator/resonator/undercut_bar.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/ranges.hpp"

namespace contactspline {
namespace {

constexpr Range kLength{1e-4, 100};
constexpr Range kBending{0, 1e6};
constexpr Range kMassPerArea{1e-6, 1e4};
constexpr Range kConstantLoss{0, 1e6};
constexpr Range kQuadraticLoss{0, 1e3};
constexpr Range kThickness{1e-6, 1};
constexpr Range kDensity{1, 3e4};
constexpr Range kPoisson{-0.999, 0.999};
constexpr Range kRoundPoisson{0, 0.499};
constexpr Range kThicknessRatio{0.05, 1};
constexpr std::size_t kMaxStrings = 8;
constexpr Range kMassPerLength{0, 1e3};
constexpr std::size_t kMaxRibs = 64;
constexpr double kMinRibLength_m = 1e-3;
constexpr double kMaxRibRatio = 1e6;  // of a rib to the whole plate; beyond it the equations lose their digits
constexpr Range kListeningDistance_m{0.05, 20};
constexpr Range kListeningAngle_rad{-1.5, 1.5};
constexpr Range kListeningSide_m{-5, 5};
constexpr double kMinListeningHeight_m = 0.05;  // nearer to it the integrals would need more points
// What listening costs the generator: a filter as long as sound takes for so far, and an integral for each mode.
constexpr double kMaxReach_m = 2;
constexpr double kMaxListeningExtent_m = 3;
constexpr std::size_t kMaxListeningModes = 1024;
constexpr double kListening_hz = 24e3;

// Member names of the emitted C++ struct; the struct itself must have another name.
constexpr const char* kMemberNames[] = {"modes",          "strings",          "angular_frequencies", "decays",
                                        "masses",         "wavenumbers",      "strike_shapes",       "pickup_shapes",
                                        "format_version", "strike_position_m"};

Losses read_losses(const JsonObject& body) {
  return {body.number("constant_loss_per_s", kConstantLoss), body.number("quadratic_loss_m2_per_s", kQuadraticLoss)};
}

StiffString read_string(const JsonObject& body) {
  return {body.number("length_m", kLength),
          body.number("mass_kg", ranges::kMass),
          body.number("tension_n", ranges::kTension),
          body.number("bending_stiffness_n_m2", kBending),
          read_losses(body),
          body.has("detuning_cents") ? body.numbers("detuning_cents", kTuningCents, kMaxStrings) : std::vector{0.0}};
}

// In the order of BarEnd.
constexpr const char* kBarEnds[] = {"free", "clamped", "supported"};
constexpr std::string_view kAllowedEnds = R"(two of free, clamped, supported, such as ["clamped", "free"])";

std::array<BarEnd, 2> read_ends(const JsonObject& body) {
  const std::vector<std::string> names = body.texts("ends", kAllowedEnds, 2);
  if (names.size() != 2) body.fail(body.key("ends"), "names one end", kAllowedEnds);
  std::array<BarEnd, 2> ends{};
  for (std::size_t e = 0; e < 2; ++e) {
    const auto* const found = std::ranges::find(kBarEnds, names[e]);
    if (found == std::end(kBarEnds))
      body.fail(fmt::format("{}[{}]", body.key("ends"), e), fmt::format("'{}' is no end of a bar", shown(names[e])),
                kAllowedEnds);
    ends[e] = static_cast<BarEnd>(found - std::begin(kBarEnds));
  }
  return ends;
}

Bar read_bar(const JsonObject& body) {
  Bar bar{body.number("length_m", kLength), body.number("mass_kg", ranges::kMass),
          body.number("bending_stiffness_n_m2", {1e-9, kBending.max}), read_losses(body)};
  if (body.has("ends")) bar.ends = read_ends(body);
  if (!body.has("undercut")) return bar;
  const JsonObject undercut = body.object("undercut", {"length_m", "thickness_ratio"});
  if (bar.ends != std::array{BarEnd::kFree, BarEnd::kFree})
    body.fail(body.key("undercut"), "is not for a bar that is held at an end", "beside two free ends");
  bar.undercut = std::make_shared<const UndercutBar>(
      bar, Undercut{undercut.number("length_m", {0.05 * bar.length_m, bar.length_m}),
                    undercut.number("thickness_ratio", kThicknessRatio)});
  return bar;
}

Membrane read_membrane(const JsonObject& body) {
  return {body.number("radius_m", kLength), body.number("mass_per_area_kg_m2", kMassPerArea),
          body.number("tension_n_per_m", ranges::kTension), read_losses(body)};
}

// The smallest of along c^4 + 2 mixed c^2 s^2 + across s^4 over all directions, c^2 + s^2 = 1; mixed >= 0.
double softest(double along, double across, double mixed) {
  const double smaller = std::min(along, across);
  return mixed < smaller ? (along * across - mixed * mixed) / (along + across - 2 * mixed) : smaller;
}

// A place on a plate, seen from its corner.
std::array<double, 2> read_corner(const JsonObject& rib, const char* key, const Plate& plate) {
  const std::array<double, 2> extent = {plate.length_m, plate.width_m};
  const std::string allowed = fmt::format("a place on the plate, such as [{:g}, {:g}]", extent[0] / 2, extent[1] / 2);
  const std::vector<double> read = rib.numbers(key, {0, std::max(extent[0], extent[1])}, 2);
  if (read.size() != 2) rib.fail(rib.key(key), "has one number", allowed);
  for (std::size_t i = 0; i < 2; ++i)
    if (read[i] > extent[i])
      rib.fail(fmt::format("{}[{}]", rib.key(key), i),
               fmt::format("{:g} is beyond the plate's {:g} m", read[i], extent[i]), allowed);
  return {read[0], read[1]};
}

// A number of a rib, at most kMaxRibRatio times that of a plate whose mass or stiffness were along a line as long as
// the rib.
double read_of_rib(const JsonObject& rib, const char* key, Range range, double of_plate) {
  const double read = rib.number(key, range), max = kMaxRibRatio * of_plate;
  if (read > max)
    rib.fail(rib.key(key), fmt::format("{:g} is {:.3g} times as much as the plate has", read, read / of_plate),
             fmt::format("at most {:.4g}", max));
  return read;
}

std::vector<Rib> read_ribs(const JsonObject& body, const Plate& plate) {
  const auto [along, across, mixed] = bending_stiffness(plate);
  const double area_m2 = plate.length_m * plate.width_m;
  std::vector<Rib> ribs;
  for (const JsonObject& rib :
       body.objects("ribs", {"from_m", "to_m", "mass_per_length_kg_m", "bending_stiffness_n_m2"}, kMaxRibs)) {
    const auto [from, from_across] = read_corner(rib, "from_m", plate);
    const auto [to, to_across] = read_corner(rib, "to_m", plate);
    const double length_m = std::hypot(to - from, to_across - from_across), width_m = area_m2 / length_m;
    if (length_m < kMinRibLength_m)
      rib.fail(rib.key("to_m"), fmt::format("is {:g} m from from_m", length_m),
               fmt::format("at least {:g} m", kMinRibLength_m));
    ribs.push_back(
        {from, from_across, to, to_across,
         read_of_rib(rib, "mass_per_length_kg_m", kMassPerLength, plate.density_kg_m3 * plate.thickness_m * width_m),
         read_of_rib(rib, "bending_stiffness_n_m2", kBending, std::min(along, across) * width_m)});
  }
  return ribs;
}

[[noreturn]] void refuse_critical_loss(const JsonObject& plate, const Losses& losses, double critical) {
  plate.fail(plate.key("quadratic_loss_m2_per_s"), fmt::format("{} is critical", losses.quadratic_m2_per_s),
             fmt::format("less than {:.4g}, with which no mode would sound", critical));
}

// Without the second modulus the material is isotropic: G = E/(2 (1 + nu)).
Plate read_plate(const JsonObject& body) {
  Plate plate{body.number("length_m", kLength),
              body.number("width_m", kLength),
              body.number("thickness_m", kThickness),
              body.number("density_kg_m3", kDensity),
              body.number("youngs_modulus_pa", ranges::kModulus),
              0,
              0,
              body.number("poisson_ratio", kPoisson),
              read_losses(body)};
  const bool orthotropic = body.has("youngs_modulus_across_pa");
  if (orthotropic != body.has("shear_modulus_pa"))
    body.fail(body.key(orthotropic ? "shear_modulus_pa" : "youngs_modulus_across_pa"), "missing",
              "both youngs_modulus_across_pa and shear_modulus_pa, or none of them");
  plate.youngs_modulus_across_pa =
      orthotropic ? body.number("youngs_modulus_across_pa", ranges::kModulus) : plate.youngs_modulus_pa;
  plate.shear_modulus_pa = orthotropic ? body.number("shear_modulus_pa", ranges::kModulus)
                                       : plate.youngs_modulus_pa / (2 * (1 + plate.poisson_ratio));
  const double square = plate.poisson_ratio * plate.poisson_ratio * plate.youngs_modulus_across_pa;
  if (!(square < plate.youngs_modulus_pa))
    body.fail(body.key("poisson_ratio"), fmt::format("{} is too large for these moduli", plate.poisson_ratio),
              "poisson_ratio^2 youngs_modulus_across_pa < youngs_modulus_pa");
  const auto [along, across, mixed] = bending_stiffness(plate);
  if (mixed < 0)
    body.fail(body.key("poisson_ratio"), fmt::format("{} needs a larger shear modulus", plate.poisson_ratio),
              "frequencies that rise with both mode numbers: poisson_ratio D_across + G thickness^3/6 >= 0");
  const double critical = std::sqrt(softest(along, across, mixed) / (plate.density_kg_m3 * plate.thickness_m));
  if (!(plate.losses.quadratic_m2_per_s < critical)) refuse_critical_loss(body, plate.losses, critical);
  if (body.has("ribs")) plate.ribbed = std::make_shared<const RibbedPlate>(plate, read_ribs(body, plate));
  return plate;
}

RoundPlate read_round_plate(const JsonObject& body) {
  RoundPlate plate{body.number("radius_m", kLength),
                   body.number("thickness_m", kThickness),
                   body.number("density_kg_m3", kDensity),
                   body.number("youngs_modulus_pa", ranges::kModulus),
                   body.number("poisson_ratio", kRoundPoisson),
                   read_losses(body)};
  if (const double critical = frequency_at(plate, plate.radius_m); !(plate.losses.quadratic_m2_per_s < critical))
    refuse_critical_loss(body, plate.losses, critical);
  if (read_word(body, "rim", "free", "clamped") == "clamped") plate.rim = PlateRim::kClamped;
  plate.has_both_symmetries = read_word(body, "symmetries", "one", "both") == "both";
  return plate;
}

ModeTable read_modes(const JsonObject& resonator) {
  ModeTable table;
  for (const JsonObject& row : resonator.objects(
           "modes",
           {"frequency_hz", "decay_per_s", "mass_kg", "strike_shape", "pickup_shape", "right_shape", "bridge_shapes"},
           kMaxModes)) {
    table.rows.push_back({{2 * std::numbers::pi * row.number("frequency_hz", kModeFrequency_hz),
                           row.number("decay_per_s", kModeDecay_per_s), row.number("mass_kg", kModalMass_kg)},
                          row.number("strike_shape", kModeShape),
                          row.number("pickup_shape", kModeShape)});
    ModeTable::Row& read = table.rows.back();
    if (row.has("right_shape")) read.right_shape = row.number("right_shape", kModeShape);
    if (row.has("bridge_shapes")) read.bridge_shapes = row.numbers("bridge_shapes", kModeShape, kMaxBridgePlaces);
    if (const std::size_t places = table.rows.front().bridge_shapes.size(); read.bridge_shapes.size() != places)
      row.fail(row.key("bridge_shapes"), fmt::format("has {} entries", read.bridge_shapes.size()),
               fmt::format("{} numbers, as in modes[0]", places));
  }
  return table;
}

const std::vector<std::string> kStringKeys = {"length_m",
                                              "mass_kg",
                                              "tension_n",
                                              "bending_stiffness_n_m2",
                                              "constant_loss_per_s",
                                              "quadratic_loss_m2_per_s",
                                              "detuning_cents"};
const std::vector<std::string> kBarKeys = {
    "length_m", "mass_kg", "bending_stiffness_n_m2", "constant_loss_per_s", "quadratic_loss_m2_per_s",
    "ends",     "undercut"};
const std::vector<std::string> kMembraneKeys = {"radius_m", "mass_per_area_kg_m2", "tension_n_per_m",
                                                "constant_loss_per_s", "quadratic_loss_m2_per_s"};

const std::vector<std::string> kRoundPlateKeys = {
    "radius_m",      "thickness_m",         "density_kg_m3",           "youngs_modulus_pa",
    "poisson_ratio", "constant_loss_per_s", "quadratic_loss_m2_per_s", "rim",
    "symmetries"};
const std::vector<std::string> kPlateKeys = {"length_m",
                                             "width_m",
                                             "thickness_m",
                                             "density_kg_m3",
                                             "youngs_modulus_pa",
                                             "youngs_modulus_across_pa",
                                             "shear_modulus_pa",
                                             "poisson_ratio",
                                             "constant_loss_per_s",
                                             "quadratic_loss_m2_per_s",
                                             "ribs"};

decltype(Resonator::body) read_body(const JsonObject& resonator) {
  int kinds = 0;
  for (const char* kind : {"string", "bar", "membrane", "plate", "round_plate", "modes"})
    kinds += resonator.has(kind);
  if (kinds != 1)
    resonator.fail("string", fmt::format("{} kinds of body are given", kinds),
                   "just one of string, bar, membrane, plate, round_plate, modes");
  return resonator.has("modes") ? read_modes(resonator) : read_shaped_body(resonator);
}

/// The largest position on a body [m].
struct Extent {
  double operator()(const StiffString& body) const { return body.length_m; }
  double operator()(const Bar& body) const { return body.length_m; }
  double operator()(const Membrane& body) const { return body.radius_m; }
  double operator()(const Plate& body) const { return body.length_m; }
  double operator()(const RoundPlate& body) const { return body.radius_m; }
  double operator()(const ModeTable&) const { return 0; }
};

Place read_place(const JsonObject& resonator, const char* name, const decltype(Resonator::body)& body) {
  const auto* plate = std::get_if<Plate>(&body);
  const bool round = is_round(body);
  std::vector<std::string> keys = {"position_m"};
  if (round) keys.emplace_back("angle_rad");
  if (plate != nullptr) keys.emplace_back("across_m");
  const JsonObject place = resonator.object(name, keys);
  return {place.number("position_m", {0, extent_of(body)}), round ? place.number("angle_rad", kPlaceAngle_rad) : 0,
          plate != nullptr ? place.number("across_m", {0, plate->width_m}) : 0};
}

}  // namespace

std::string read_word(const JsonObject& object, const char* key, std::string_view first, std::string_view second) {
  if (!object.has(key)) return std::string(first);
  const std::string allowed = fmt::format("{} or {}", first, second);
  std::string word = object.text(key, allowed);
  if (word != first && word != second)
    object.fail(object.key(key), fmt::format("'{}' is unknown", shown(word)), allowed);
  return word;
}

decltype(Resonator::body) read_shaped_body(const JsonObject& object) {
  if (object.has("string")) return read_string(object.object("string", kStringKeys));
  if (object.has("bar")) return read_bar(object.object("bar", kBarKeys));
  if (object.has("plate")) return read_plate(object.object("plate", kPlateKeys));
  if (object.has("round_plate")) return read_round_plate(object.object("round_plate", kRoundPlateKeys));
  return read_membrane(object.object("membrane", kMembraneKeys));
}

ListeningPlace read_listening_place(const JsonObject& object) {
  ListeningPlace place{object.number("distance_m", kListeningDistance_m)};
  if (object.has("angle_rad")) place.angle_rad = object.number("angle_rad", kListeningAngle_rad);
  if (object.has("around_rad")) place.around_rad = object.number("around_rad", kPlaceAngle_rad);
  if (object.has("side_m")) place.side_m = object.number("side_m", kListeningSide_m);
  if (const double before_m = place.distance_m * std::cos(place.angle_rad); before_m < kMinListeningHeight_m)
    object.fail(object.key("angle_rad"),
                fmt::format("puts the place {:.3g} m before the plane of the body", before_m),
                fmt::format("at least {:g} m", kMinListeningHeight_m));
  return place;
}

void check_radiation(const Resonator& resonator, std::string_view file, std::string_view key) {
  if (!radiates(resonator.body))
    refuse(file, key, fmt::format("names a body of the kind '{}'", name_of(resonator.body)),
           "a plate, a round_plate or a membrane, whose shapes are known everywhere");
  const auto* plate = std::get_if<Plate>(&resonator.body);
  const double extent_m =
      plate != nullptr ? std::max(plate->length_m, plate->width_m) : 2 * extent_of(resonator.body);
  if (extent_m > kMaxListeningExtent_m)
    refuse(file, key, fmt::format("names a body of {:.3g} m", extent_m),
           fmt::format("at most {:g} m", kMaxListeningExtent_m));
  const std::size_t modes = numbered_modes_of(resonator, kListening_hz).modes.size();
  if (modes > kMaxListeningModes)
    refuse(file, key, fmt::format("names a body of {} modes below {:g} Hz", modes, kListening_hz),
           fmt::format("at most {}, by max_modes", kMaxListeningModes));
}

void check_reach(const Reach& reach, std::string_view file, std::string_view key) {
  if (const double span_m = reach.farthest_m - reach.nearest_m; span_m > kMaxReach_m)
    refuse(file, key, fmt::format("is {:.3g} m farther from one point of the body than from another", span_m),
           fmt::format("at most {:g} m: a smaller body", kMaxReach_m));
}

int max_modes_of(const decltype(Resonator::body)& body) {
  const auto* plate = std::get_if<Plate>(&body);
  if (plate != nullptr && plate->ribbed) return static_cast<int>(RibbedPlate::kModes);
  const auto* bar = std::get_if<Bar>(&body);
  return bar != nullptr && bar->undercut ? static_cast<int>(UndercutBar::kModes) : kMaxModes;
}

double extent_of(const decltype(Resonator::body)& body) {
  return std::visit(Extent{}, body);
}

Resonator parse_resonator(std::string_view text, std::string_view file) {
  const JsonObject resonator = parse_json(text, file, "resonator",
                                          {"name", "description", "string", "bar", "membrane", "plate", "round_plate",
                                           "modes", "strike", "pickup", "max_modes"});
  Resonator read{
      read_name(resonator, kMemberNames), read_description(resonator), read_body(resonator), {}, {}, kMaxModes};
  if (std::holds_alternative<ModeTable>(read.body)) {
    for (const char* place : {"strike", "pickup"})
      if (resonator.has(place))
        resonator.fail(place, "cannot be used with modes", "strike_shape and pickup_shape of each mode");
  } else {
    read.strike = read_place(resonator, "strike", read.body);
    read.pickup = read_place(resonator, "pickup", read.body);
  }
  read.max_modes = max_modes_of(read.body);
  if (resonator.has("max_modes")) read.max_modes = resonator.integer("max_modes", 1, read.max_modes);
  return read;
}

}  // namespace contactspline
