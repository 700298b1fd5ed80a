// SPDX-License-Identifier: MIT
#include "generator/resonator/resonator_reader.hpp"

#include <fmt/format.h>

#include <numbers>

#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr Range kLength{1e-4, 100};
constexpr Range kMass{1e-9, 1e4};
constexpr Range kTension{1e-3, 1e6};
constexpr Range kBending{0, 1e6};
constexpr Range kMassPerArea{1e-6, 1e4};
constexpr Range kConstantLoss{0, 1e6};
constexpr Range kQuadraticLoss{0, 1e3};
constexpr Range kAngle{-7, 7};
constexpr Range kCents{-1200, 1200};
constexpr Range kFrequency{0.1, 1e6};
constexpr Range kShape{-1e6, 1e6};
constexpr std::size_t kMaxStrings = 8;
constexpr int kMaxModes = 4096;

// Member names of the emitted C++ struct; the struct itself must have another name.
constexpr const char* kMemberNames[] = {"modes",         "strings",       "angular_frequencies",
                                        "decays",        "masses",        "wavenumbers",
                                        "strike_shapes", "pickup_shapes", "format_version"};

Losses read_losses(const JsonObject& body) {
  return {body.number("constant_loss_per_s", kConstantLoss), body.number("quadratic_loss_m2_per_s", kQuadraticLoss)};
}

StiffString read_string(const JsonObject& body) {
  return {body.number("length_m", kLength),
          body.number("mass_kg", kMass),
          body.number("tension_n", kTension),
          body.number("bending_stiffness_n_m2", kBending),
          read_losses(body),
          body.has("detuning_cents") ? body.numbers("detuning_cents", kCents, kMaxStrings) : std::vector{0.0}};
}

FreeBar read_bar(const JsonObject& body) {
  return {body.number("length_m", kLength), body.number("mass_kg", kMass),
          body.number("bending_stiffness_n_m2", {1e-9, kBending.max}), read_losses(body)};
}

Membrane read_membrane(const JsonObject& body) {
  return {body.number("radius_m", kLength), body.number("mass_per_area_kg_m2", kMassPerArea),
          body.number("tension_n_per_m", kTension), read_losses(body)};
}

ModeTable read_modes(const JsonObject& resonator) {
  ModeTable table;
  for (const JsonObject& row : resonator.objects(
           "modes", {"frequency_hz", "decay_per_s", "mass_kg", "strike_shape", "pickup_shape"}, kMaxModes))
    table.rows.push_back({{2 * std::numbers::pi * row.number("frequency_hz", kFrequency),
                           row.number("decay_per_s", kConstantLoss), row.number("mass_kg", kMass)},
                          row.number("strike_shape", kShape),
                          row.number("pickup_shape", kShape)});
  return table;
}

const std::vector<std::string> kStringKeys = {"length_m",
                                              "mass_kg",
                                              "tension_n",
                                              "bending_stiffness_n_m2",
                                              "constant_loss_per_s",
                                              "quadratic_loss_m2_per_s",
                                              "detuning_cents"};
const std::vector<std::string> kBarKeys = {"length_m", "mass_kg", "bending_stiffness_n_m2", "constant_loss_per_s",
                                           "quadratic_loss_m2_per_s"};
const std::vector<std::string> kMembraneKeys = {"radius_m", "mass_per_area_kg_m2", "tension_n_per_m",
                                                "constant_loss_per_s", "quadratic_loss_m2_per_s"};

decltype(Resonator::body) read_body(const JsonObject& resonator) {
  int kinds = 0;
  for (const char* kind : {"string", "bar", "membrane", "modes"}) kinds += resonator.has(kind);
  if (kinds != 1)
    resonator.fail("string", fmt::format("{} kinds of body are given", kinds),
                   "just one of string, bar, membrane, modes");
  if (resonator.has("string")) return read_string(resonator.object("string", kStringKeys));
  if (resonator.has("bar")) return read_bar(resonator.object("bar", kBarKeys));
  if (resonator.has("membrane")) return read_membrane(resonator.object("membrane", kMembraneKeys));
  return read_modes(resonator);
}

/// The largest position on a body [m].
struct Extent {
  double operator()(const StiffString& body) const { return body.length_m; }
  double operator()(const FreeBar& body) const { return body.length_m; }
  double operator()(const Membrane& body) const { return body.radius_m; }
  double operator()(const ModeTable&) const { return 0; }
};

Place read_place(const JsonObject& resonator, const char* name, const decltype(Resonator::body)& body) {
  const bool round = std::holds_alternative<Membrane>(body);
  const auto keys =
      round ? std::vector<std::string>{"position_m", "angle_rad"} : std::vector<std::string>{"position_m"};
  const JsonObject place = resonator.object(name, keys);
  return {place.number("position_m", {0, std::visit(Extent{}, body)}),
          round ? place.number("angle_rad", kAngle) : 0.0};
}

}  // namespace

Resonator parse_resonator(std::string_view text, std::string_view file) {
  const JsonObject resonator =
      parse_json(text, file, "resonator",
                 {"name", "description", "string", "bar", "membrane", "modes", "strike", "pickup", "max_modes"});
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
  if (resonator.has("max_modes")) read.max_modes = resonator.integer("max_modes", 1, kMaxModes);
  return read;
}

}  // namespace contactspline
