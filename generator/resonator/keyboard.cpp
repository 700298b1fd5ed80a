// SPDX-License-Identifier: MIT
#include "generator/resonator/keyboard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "contactspline/step/controls.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

using std::numbers::pi;

/// Two neighbouring published notes, and how far from the first to the second a key lies; beyond them below 0 or
/// above 1.
struct Between {
  const PublishedNote &low, &high;
  double part;

  template <typename Member>
  [[nodiscard]] double linear(Member member) const {
    return std::lerp(member(low), member(high), part);
  }
  template <typename Member>
  [[nodiscard]] double geometric(Member member) const {
    return std::exp(std::lerp(std::log(member(low)), std::log(member(high)), part));
  }
};

Between neighbours(const Keyboard& keyboard, int key) {
  const auto& notes = keyboard.notes;
  const auto above = std::ranges::find_if(notes, [&](const PublishedNote& note) { return note.key > key; });
  const auto last = std::prev(notes.end());
  const auto high = above == notes.begin() ? std::next(above) : above == notes.end() ? last : above;
  const auto low = std::prev(high);
  return {*low, *high, static_cast<double>(key - low->key) / (high->key - low->key)};
}

// w^2 + s^2 = (T beta^2 + EI beta^4) L/M of the first partial, solved for T.
double tension_for(double frequency_hz, const StiffString& string) {
  const double w = 2 * pi * frequency_hz, beta = pi / string.length_m;
  const double s = string.losses.decay_per_s(beta);
  return (w * w + s * s) * string.mass_kg / string.length_m / (beta * beta) -
         string.bending_stiffness_n_m2 * beta * beta;
}

double pitch_hz(const Keyboard& keyboard, int key) {
  return keyboard.concert_pitch_hz * std::exp2((key - 69) / 12.0);
}

StiffString string_of(const Keyboard& keyboard, const Between& notes, int key) {
  const auto geometric = [&](auto member) { return rounded_to(notes.geometric(member), 6); };
  const double length = geometric([](const PublishedNote& n) { return n.length_m; });
  const double density = geometric([](const PublishedNote& n) { return n.mass_kg / n.length_m; });
  StiffString string{length,
                     rounded_to(density * length, 6),
                     0,
                     geometric([](const PublishedNote& n) { return n.bending_stiffness_n_m2; }),
                     {geometric([](const PublishedNote& n) { return n.losses.constant_per_s; }),
                      geometric([](const PublishedNote& n) { return n.losses.quadratic_m2_per_s; })}};
  string.tension_n = rounded_to(tension_for(pitch_hz(keyboard, key), string), 13);
  return string;
}

int strings_of(const Keyboard& keyboard, int key) {
  return 1 + (key >= keyboard.first_double_key) + (key >= keyboard.first_triple_key);
}

// With a string's share of the hammer.
Material felt_of(const Keyboard& keyboard, const Between& notes, int key, double hammer_mass_kg) {
  const double whole = notes.geometric([](const PublishedNote& n) { return n.felt.stiffness; });
  const PowerLaw felt{rounded_to(whole / strings_of(keyboard, key), 6),
                      rounded_to(notes.linear([](const PublishedNote& n) { return n.felt.exponent; }), 6)};
  Material material{
      fmt::format("{}_felt_{}", keyboard.name, key),
      "",
      felt,
      Impact{hammer_mass_kg, keyboard.max_speed_m_per_s, keyboard.min_speed_m_per_s},
      {keyboard.segments, rounded_to(felt.max_compression(hammer_mass_kg, keyboard.max_speed_m_per_s), 6),
       Knots::optimal, ErrorOf::spectrum}};
  constexpr double kShort_s = 1e-4;  // the audible spectrum of shorter contacts is flat
  if (felt.contact_duration(hammer_mass_kg, keyboard.min_speed_m_per_s) < kShort_s) {
    material.spline.knots = Knots::graded;
    material.spline.minimise = ErrorOf::contact_duration;
  }
  return material;
}

// The last place that begins at the key or below, the first one otherwise.
std::size_t bridge_place(const std::vector<BridgePlace>& places, int key) {
  const auto above = std::ranges::find_if(places, [&](const BridgePlace& place) { return place.first_key > key; });
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, above - places.begin() - 1));
}

// The shapes of a mode where keys drive the body.
std::vector<double> bridge_shapes(const Resonator& body, const NumberedMode& mode,
                                  const std::vector<BridgePlace>& places) {
  if (const auto* table = std::get_if<ModeTable>(&body.body))
    return table->rows[static_cast<std::size_t>(mode.number)].bridge_shapes;
  std::vector<double> shapes;
  Resonator driven = body;
  for (const BridgePlace& place : places) {
    driven.strike = place.place;
    shapes.push_back(strike_shape(driven, mode));
  }
  return shapes;
}

// With its strike as both the bridge and where keys knock.
std::vector<BodyMode> modes_at_ears(const Resonator& resonator, double max_frequency_hz) {
  Resonator mirrored = resonator;
  if (auto* plate = std::get_if<Plate>(&mirrored.body))
    mirrored.pickup.position_m = plate->length_m - mirrored.pickup.position_m;
  if (auto* table = std::get_if<ModeTable>(&mirrored.body))
    for (ModeTable::Row& row : table->rows) row.pickup_shape = row.right_shape;
  const auto left = modes_of(resonator, max_frequency_hz).modes, right = modes_of(mirrored, max_frequency_hz).modes;
  std::vector<BodyMode> modes;
  for (std::size_t i = 0; i < left.size(); ++i)
    modes.push_back(
        {left[i].mode, {left[i].strike_shape}, left[i].strike_shape, left[i].pickup_shape, right[i].pickup_shape});
  return modes;
}

}  // namespace

StiffString strings_on_body(const KeyboardNote& note, const KeyboardBody& body) {
  StiffString string = note.string;
  string.losses.constant_per_s -= note.bridge_loss_per_s;
  if (note.strings > 1) {
    string.detuning_cents = note.strings == 2 ? body.double_hz : body.triple_hz;
    for (double& detuning : string.detuning_cents) detuning = 1200 * std::log2(1 + detuning / note.pitch_hz);
  }
  return string;
}

HorizontalMotion horizontal_motion(const KeyboardNote& note, const KeyboardBody& body) {
  const auto& [strike_ratio, bridge_ratio, cents] = body.horizontal;
  return {strike_ratio * note.horizontal_ratio, bridge_ratio * note.horizontal_ratio, cents};
}

LongitudinalMotion longitudinal_motion(const KeyboardNote& note, const KeyboardBody& body, int key) {
  if (!body.longitudinal || key > body.longitudinal->last_key) return {};
  const auto& [frequency_ratio, losses, output_ratio, last_key] = *body.longitudinal;
  return {axial_stiffness(note.string.tension_n, frequency_ratio), losses, output_ratio};
}

std::vector<BodyMode> body_modes(const KeyboardResonators& resonators, double max_frequency_hz) {
  std::vector<BodyMode> modes;
  if (resonators.body) modes = modes_at_ears(*resonators.body, max_frequency_hz);
  for (BodyMode& mode : modes) mode.knock_shape = 0;
  if (modes.empty()) return modes;
  if (const auto& places = resonators.bridge_places; !places.empty()) {
    const auto numbered = numbered_modes_of(*resonators.body, max_frequency_hz).modes;
    for (std::size_t i = 0; i < modes.size(); ++i)
      modes[i].bridge_shapes = bridge_shapes(*resonators.body, numbered[i], places);
  }
  if (!resonators.knock) return modes;
  const std::vector<double> at_rest(modes.front().bridge_shapes.size());
  for (BodyMode& mode : modes_at_ears(*resonators.knock, max_frequency_hz)) {
    mode.bridge_shapes = at_rest;
    modes.push_back(mode);
  }
  return modes;
}

std::vector<BodyArrays::Ear> radiation_at_ears(const KeyboardResonators& resonators,
                                               const std::vector<BodyMode>& modes, double sample_rate_hz) {
  std::vector<BodyArrays::Ear> outputs;
  if (resonators.ears.empty()) return outputs;
  double nearest_m = std::numeric_limits<double>::max();
  for (const ListeningPlace& ear : resonators.ears)
    nearest_m = std::min(nearest_m, reach_of(resonators.body->body, ear).nearest_m);
  std::vector<std::vector<double>> driven(modes.front().bridge_shapes.size());
  for (std::size_t place = 0; place < driven.size(); ++place)
    for (const BodyMode& mode : modes) driven[place].push_back(mode.bridge_shapes[place]);
  const auto numbered = numbered_modes_of(*resonators.body, sample_rate_hz / 2).modes;
  const RadiationTiming timing = radiation_timing(nearest_m, sample_rate_hz);
  for (const ListeningPlace& ear : resonators.ears) {
    Radiation radiation = rounded(radiation_of(*resonators.body, numbered, ear, timing, driven));
    outputs.push_back({std::move(radiation.of_velocity), std::move(radiation.of_displacement), {}});
    for (const std::vector<double>& taps : radiation.taps)
      std::ranges::copy(taps, std::back_inserter(outputs.back().taps));
  }
  return outputs;
}

std::vector<double> bridge_shapes_of(const std::vector<BodyMode>& modes) {
  std::vector<double> shapes;
  for (std::size_t place = 0; !modes.empty() && place < modes.front().bridge_shapes.size(); ++place)
    for (const BodyMode& mode : modes) shapes.push_back(mode.bridge_shapes[place]);
  return shapes;
}

double strike_speed(const Keyboard& keyboard, double velocity) {
  if (!is_number(velocity)) return velocity;
  return keyboard.min_speed_m_per_s *
         std::pow(keyboard.max_speed_m_per_s / keyboard.min_speed_m_per_s, std::clamp(velocity, 0.0, 1.0));
}

KeyboardNote note_of(const Keyboard& keyboard, int key) {
  const Between notes = neighbours(keyboard, key);
  const int strings = strings_of(keyboard, key);
  const double whole_hammer = notes.linear([](const PublishedNote& n) { return n.hammer_mass_kg; });
  const double hammer_mass = rounded_to(whole_hammer / strings, 6);
  const double bridge_ratio = rounded_to(notes.geometric([](const PublishedNote& n) { return n.bridge_ratio; }), 6);
  StiffString string = string_of(keyboard, notes, key);
  const double mobility = keyboard.body ? keyboard.body->listening.mobility_m_per_n_s : 0;
  const double impedance = std::sqrt(string.tension_n * string.mass_kg / string.length_m);
  const double bridge_loss =
      rounded_to(strings * 2 * pitch_hz(keyboard, key) * impedance * mobility * bridge_ratio * bridge_ratio, 6);
  string.losses.constant_per_s += bridge_loss;
  return {string,
          rounded_to(notes.geometric([](const PublishedNote& n) { return n.strike_position_m; }), 6),
          strings,
          hammer_mass,
          felt_of(keyboard, notes, key, hammer_mass),
          pitch_hz(keyboard, key),
          bridge_ratio,
          rounded_to(notes.geometric([](const PublishedNote& n) { return n.output_ratio; }), 6),
          rounded_to(notes.geometric([](const PublishedNote& n) { return n.horizontal_ratio; }), 6),
          bridge_loss,
          keyboard.body ? bridge_place(keyboard.body->bridge_places, key) : 0};
}

std::vector<ResonatorMode> modes_of(const KeyboardNote& note, double max_frequency_hz) {
  std::vector<ResonatorMode> modes;
  for (const StringMode& mode : modes_below(note.string, max_frequency_hz))
    modes.push_back({mode.mode, mode.wavenumber_per_m, std::sin(mode.wavenumber_per_m * note.strike_position_m),
                     bridge_shape(note.string, mode)});
  return modes;
}

}  // namespace contactspline
