// SPDX-License-Identifier: MIT
// The slow motion of one strike or pluck from rest, sample by sample in double precision, and what the page draws of
// it.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/instrument/mass_barrier_instrument.hpp"
#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "web/wasm/hammer_keys.hpp"

namespace contactspline::web {

/// What is played: how often a frame is taken, how many, and the note.
struct StudyPlan {
  double sample_rate_hz;
  std::size_t frames;
  int key;          ///< of MIDI, where the instrument has keys
  double velocity;  ///< 0 to 1, of the key
};

/// Frames of equally many numbers, and a scene: JSON that says which number is what (web/src/stage.js).
struct Study {
  std::vector<double> numbers;
  std::string scene;
};

inline constexpr std::size_t kPoints = 97;  ///< of a string

namespace detail {

/// What each frame of a hammer begins with: displacements [m], contact force [N], energies [J], total less work [J].
/// throws, moves: the parameters that are the speed and the place of the strike, or null.
inline constexpr const char* kHammerScene = R"({{
  "throws": {}, "moves": {}, "force": 2, "imbalance": 9, "work": {:.17g}, "energies": [["{}", 3], ["{}", 4]{}, ["lost", 7]],
  "items": [{}{{"kind": "hammer", "name": "{}", "at": {:.17g}, "column": 0, "compression": 1}}]
}})";
inline constexpr std::size_t kHammerHead = 10;

struct HammerFrame {
  double place_m, compression_m, force_n;
  Books books;
  double board_j = 0, board_m = 0;

  void append_to(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(), {place_m, compression_m, force_n, books.hammer, books.felt, books.string, board_j,
                                   books.dissipated, board_m, books.total() + board_j - books.work});
  }
};

inline std::string string_item(std::size_t column, const char* more = "") {
  return fmt::format(R"({{"kind": "string", "name": "string", "column": {}, "points": {}{}}}, )", column, kPoints,
                     more);
}

}  // namespace detail

/// A key of HammerKeys: a hammer with the page's material on a string with rigid ends.
inline Study study_of_key(const Material& material, std::span<const double> values, const StudyPlan& plan) {
  Study study;
  if (!is_key(plan.key)) return study;
  const Resonator resonator(plan.key, plan.sample_rate_hz);
  const auto table = material.table<double>();
  const auto controls = controls_of<double>(plan.key, material, values);
  const auto strike = resonator.shapes_at<double>(values[HammerKeysParameter::kPosition]);
  std::vector<ModeShapes<double>> points;
  for (std::size_t p = 0; p < kPoints; ++p)
    points.push_back(resonator.shapes_at<double>(static_cast<double>(p) / (kPoints - 1)));
  HammerString<double> model(SegmentTable<double>(table), bare(resonator.modes), strike, plan.sample_rate_hz);
  model.strike(values[HammerKeysParameter::kSpeed] * plan.velocity, 1e-4);
  StrikeBooks<double> books;
  books.open(model, table, controls);
  for (std::size_t i = 0; i < plan.frames; ++i) {
    const double compression = model.compression();
    detail::HammerFrame{model.string().displacement(strike) + compression, compression, model.force(), books.books()}
        .append_to(study.numbers);
    for (const auto& point : points) study.numbers.push_back(model.string().displacement(point));
    model.tick(controls);
    books.add_loss(model, table, controls, plan.sample_rate_hz, compression);
    books.close(model, table, controls);
  }
  using P = HammerKeysParameter;
  study.scene = fmt::format(detail::kHammerScene, std::size_t{P::kSpeed}, std::size_t{P::kPosition},
                            books.books().work, "hammer", "felt", R"(, ["string", 5])",
                            detail::string_item(detail::kHammerHead), "hammer", values[P::kPosition]);
  return study;
}

/// A mass at a barrier of the page's material. values: of MassBarrierParameter.
inline Study study_of_mass(std::span<const Segment<double>> table, std::span<const double> values,
                           const StudyPlan& plan) {
  using P = MassBarrierParameter;
  const SegmentTable<double> contact(table);
  const ContactControls<double> controls{values[P::kStiffnessRatio], values[P::kLoss]};
  MassBarrier<double> model(contact, plan.sample_rate_hz);
  const double mass_kg = values[P::kMass], gravity = values[P::kGravity];
  model.throw_from(std::max(values[P::kStart], -1e-4), values[P::kSpeed]);
  Study study;
  Books books;
  const auto store = [&] {
    books.hammer = mass_kg * (model.velocity() * model.velocity() / 2 - gravity * model.displacement());
    books.felt = controls.stiffness_ratio * potential(contact, model.displacement());
  };
  store();
  books.work = books.total();
  for (std::size_t i = 0; i < plan.frames; ++i) {
    const double y0 = model.displacement();
    detail::HammerFrame{y0, y0, model.force(), books}.append_to(study.numbers);
    model.tick({.mass_kg = mass_kg, .gravity_m_per_s2 = gravity, .contact = controls});
    books.dissipated += contact_loss(contact, controls, plan.sample_rate_hz, y0, model.displacement(), model.force());
    store();
  }
  study.scene = fmt::format(detail::kHammerScene, std::size_t{P::kSpeed}, "null", books.work, "mass", "contact", "",
                            R"({"kind": "wall", "name": "barrier"}, )", "mass", 0.5);
  return study;
}

/// A key of the piano that ships: its hammer on all its strings, which move its soundboard. values: of
/// KeyboardParameter.
inline Study study_of_piano(std::span<const double> values, const StudyPlan& plan) {
  using Board = Piano::body;
  using P = KeyboardParameter;
  Study study;
  if (!is_key(plan.key)) return study;
  const std::size_t k = index_of(plan.key);
  StiffString strings = string_of<Piano>(plan.key);
  strings.losses.constant_per_s *= Board::own_loss;
  strings.losses.quadratic_m2_per_s *= Board::own_loss;
  const std::vector<StringMode> rows = modes_below(strings, plan.sample_rate_hz / 2, 80);
  const auto shapes_at = [&](double position) {
    ModeShapes<double> shapes(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) shapes[i] = std::sin(rows[i].wavenumber_per_m * position);
    return shapes;
  };
  const double count = static_cast<double>(Piano::strings[k]);
  const HammerStringControls<double> controls{
      .hammer_mass_kg = values[P::kMassRatio] * Piano::hammer_masses[k],
      .felt = {.stiffness_ratio = values[P::kHardness], .loss_s_per_m = values[P::kLoss]}};
  const SegmentTable<double> felt(felts_of<Piano, double>[k]);
  const double position_m = Piano::strike_positions[k];
  const ModeShapes<double> strike = shapes_at(position_m);
  std::vector<ModeShapes<double>> points;
  for (std::size_t p = 0; p < kPoints; ++p)
    points.push_back(shapes_at(strings.length_m * static_cast<double>(p) / (kPoints - 1)));
  HammerString<double> model(felt, bare(rows), strike, plan.sample_rate_hz);
  const auto bridge = model.bridge(bridge_shapes<double>(strings, rows, 1));
  BridgeStiffness stiffness;
  for (std::size_t other = 0; other < Piano::keys; ++other) {
    const int key = Piano::first_key + static_cast<int>(other);
    const auto ends = bridge_stiffness(string_of<Piano>(key), std::vector<StringMode>()).ends;
    stiffness.ends += ends * static_cast<double>(Piano::strings[other]);
  }
  stiffness.modes = count * bridge_stiffness(strings, rows).modes;
  Body<double> body(modes_in<Board>, ModeShapes<double>(std::span<const double>(Board::bridge_shapes)), stiffness,
                    plan.sample_rate_hz);
  model.strike(strike_speed<Piano>(plan.velocity), 1e-4);
  StrikeBooks<double> books;
  books.open(model, felt, controls);
  double lost_j = 0;
  for (std::size_t i = 0; i < plan.frames; ++i) {
    Books all = books.books();
    for (double* const energy : {&all.hammer, &all.felt, &all.string, &all.dissipated, &all.work}) *energy *= count;
    all.dissipated += lost_j;
    const double compression = model.compression();
    detail::HammerFrame{model.string().displacement(strike) + compression,
                        compression,
                        count * model.force(),
                        all,
                        body.energy(),
                        body.displacement()}
        .append_to(study.numbers);
    for (std::size_t p = 0; p < kPoints; ++p)
      study.numbers.push_back(model.string().displacement(points[p]) +
                              body.displacement() * static_cast<double>(p) / (kPoints - 1));
    body.tick(count * model.tick(controls, bridge, body.change()));
    lost_j += body.modes().dissipated();
    books.add_loss(model, felt, controls, plan.sample_rate_hz, compression);
    books.close(model, felt, controls);
  }
  study.scene =
      fmt::format(detail::kHammerScene, "null", "null", count * books.books().work, "hammer", "felt",
                  R"(, ["strings", 5], ["board", 6])", detail::string_item(detail::kHammerHead, R"(, "board": 8)"),
                  "hammer", position_m / strings.length_m);
  return study;
}

}  // namespace contactspline::web
