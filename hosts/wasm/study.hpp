// SPDX-License-Identifier: MIT
// The slow motion of one strike or pluck from rest, sample by sample in double precision, and what the page draws of
// it.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/mass_barrier_instrument.hpp"
#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "hosts/wasm/drawn_instrument.hpp"
#include "hosts/wasm/hammer_keys.hpp"

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

inline constexpr std::size_t kPoints = kStringPoints;

namespace detail {

/// What each frame of a hammer begins with: displacements [m], contact force [N], energies [J], total less work [J].
/// throws, moves: the parameters that are the speed and the place of the strike, or null. plucks: where a string is
/// plucked, at this part of its length, and the column of its points.
inline constexpr const char* kHammerScene = R"({{
  "throws": {}, "moves": {}, "plucks": null, "force": 2, "imbalance": 9, "work": {:.17g}, "energies": [["{}", 3], ["{}", 4]{}, ["lost", 7]],
  "items": [{}{{"kind": "hammer", "name": "{}", "at": {:.17g}, "column": 0, "compression": 1}}]
}})";
inline constexpr std::size_t kHammerHead = 10;

struct HammerFrame {
  double place_m, compression_m, force_n;
  StrikeEnergies books;
  double board_j = 0, board_m = 0;

  void append_to(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(), {place_m, compression_m, force_n, books.hammer, books.felt, books.string, board_j,
                                   books.dissipated, board_m, books.total() + board_j - books.work});
  }
};

/// count: of strings side by side that move alike.
inline std::string string_item(std::size_t column, std::size_t count = 1, const char* more = "") {
  return fmt::format(R"({{"kind": "string", "name": "string", "column": {}, "points": {}, "count": {}{}}}, )", column,
                     kPoints, count, more);
}

}  // namespace detail

/// A hammer on strings with rigid ends, and how it is thrown.
struct StruckStrings {
  std::span<const Segment<double>> felt;
  std::span<const Memory> memories;
  std::vector<Mode> modes;
  std::function<ModeShapes<double>(double position)> shapes_at;  ///< at a part of the length, under the hammer
  HammerStringControls<double> controls;
  double position, speed_m_per_s;  ///< position: part of the length
};

/// throws, moves: as in kHammerScene.
inline Study study_of_strings(const StruckStrings& struck, std::string_view throws, std::string_view moves,
                              const StudyPlan& plan) {
  Study study;
  const SegmentTable<double> table(struck.felt);
  const auto strike = struck.shapes_at(struck.position);
  std::vector<ModeShapes<double>> points;
  for (std::size_t p = 0; p < kPoints; ++p)
    points.push_back(struck.shapes_at(static_cast<double>(p) / (kPoints - 1)));
  HammerString<double> model(table, struck.modes, strike, plan.sample_rate_hz, struck.memories);
  model.strike(struck.speed_m_per_s, 1e-4);
  StrikeBooks<double> books;
  books.open(model, table, struck.controls);
  for (std::size_t i = 0; i < plan.frames; ++i) {
    const double compression = model.compression();
    detail::HammerFrame{model.string().displacement(strike) + compression, compression, model.force(), books.books()}
        .append_to(study.numbers);
    for (const auto& point : points) study.numbers.push_back(model.string().displacement(point));
    model.tick(struck.controls);
    books.add_loss(model, table, struck.controls, plan.sample_rate_hz, compression);
    books.close(model, table, struck.controls);
  }
  study.scene =
      fmt::format(detail::kHammerScene, throws, moves, books.books().work, "hammer", "felt", R"(, ["string", 5])",
                  detail::string_item(detail::kHammerHead), "hammer", struck.position);
  return study;
}

/// A key of HammerKeys: a hammer with the page's material on a string with rigid ends.
inline Study study_of_key(const Material& material, std::span<const double> values, const StudyPlan& plan) {
  using P = HammerKeysParameter;
  if (!is_key(plan.key)) return {};
  const Resonator resonator(plan.key, plan.sample_rate_hz);
  const auto table = material.table<double>();
  return study_of_strings({.felt = table,
                           .memories = material.memories,
                           .modes = bare(resonator.modes),
                           .shapes_at = [&](double position) { return resonator.shapes_at<double>(position); },
                           .controls = controls_of<double>(plan.key, material, values),
                           .position = values[P::kPosition],
                           .speed_m_per_s = values[P::kSpeed] * plan.velocity},
                          std::to_string(P::kSpeed), std::to_string(P::kPosition), plan);
}

/// A mass at a barrier of a material with these memories. values: of MassBarrierParameter.
inline Study study_of_mass(std::span<const Segment<double>> table, std::span<const Memory> memories,
                           std::span<const double> values, const StudyPlan& plan) {
  using P = MassBarrierParameter;
  const SegmentTable<double> contact(table);
  const ContactControls<double> controls{values[P::kStiffnessRatio], values[P::kLoss]};
  MassBarrier<double> model(contact, plan.sample_rate_hz, memories);
  const double mass_kg = values[P::kMass], gravity = values[P::kGravity];
  model.throw_from(std::max(values[P::kStart], -1e-4), values[P::kSpeed]);
  Study study;
  StrikeEnergies books;
  const auto store = [&] {
    books.hammer = mass_kg * (model.velocity() * model.velocity() / 2 - gravity * model.displacement());
    books.felt = controls.stiffness_ratio * model.memory().energy(contact, model.displacement());
  };
  store();
  books.work = books.total();
  for (std::size_t i = 0; i < plan.frames; ++i) {
    const double y0 = model.displacement();
    detail::HammerFrame{y0, y0, model.force(), books}.append_to(study.numbers);
    model.tick({.mass_kg = mass_kg, .gravity_m_per_s2 = gravity, .contact = controls});
    books.dissipated += contact_loss(
        contact_of(contact, controls, model.memory(), model.displacement(), model.force()), plan.sample_rate_hz, y0);
    store();
  }
  study.scene = fmt::format(detail::kHammerScene, std::size_t{P::kSpeed}, "null", books.work, "mass", "contact", "",
                            R"({"kind": "wall", "name": "barrier"}, )", "mass", 0.5);
  return study;
}

namespace detail {

/// One of the strings of a key of the piano that ships, at its board, where its loss is its own.
class PianoString {
 public:
  PianoString(int key, double sample_rate_hz) : string_(string_of<Piano>(key)) {
    string_.losses.constant_per_s -= Piano::bridge_losses[static_cast<std::size_t>(key - Piano::first_key)];
    rows_ = modes_below(string_, sample_rate_hz / 2, 80);
  }

  [[nodiscard]] const StiffString& string() const { return string_; }
  [[nodiscard]] const std::vector<StringMode>& rows() const { return rows_; }
  [[nodiscard]] ModeShapes<double> shapes_at(double position_m) const {
    ModeShapes<double> shapes(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) shapes[i] = std::sin(rows_[i].wavenumber_per_m * position_m);
    return shapes;
  }

  /// The board under all strings, of which so many like this one move.
  [[nodiscard]] Body<double> board(double count, double sample_rate_hz) const {
    using Board = Piano::body;
    BridgeStiffness stiffness;
    for (std::size_t k = 0; k < Piano::keys; ++k) {
      const StiffString other = string_of<Piano>(Piano::first_key + static_cast<int>(k));
      const double ends = bridge_stiffness(other, std::vector<StringMode>()).ends;
      stiffness.ends += ends * static_cast<double>(Piano::strings[k]);
    }
    stiffness.modes = count * bridge_stiffness(string_, rows_).modes;
    return Body<double>(modes_in<Board>, ModeShapes<double>(std::span<const double>(Board::bridge_shapes)), stiffness,
                        sample_rate_hz);
  }

 private:
  StiffString string_;
  std::vector<StringMode> rows_;
};

/// The books of so many strings that do the same, with what their board lost beside.
inline StrikeEnergies times(StrikeEnergies books, double count, double lost_j) {
  for (double* const energy : {&books.hammer, &books.felt, &books.string, &books.dissipated, &books.work})
    *energy *= count;
  books.dissipated += lost_j;
  return books;
}

}  // namespace detail

/// A key of the piano that ships: its hammer on its strings, all of the same pitch here, which move its soundboard.
/// values: of KeyboardParameter.
inline Study study_of_piano(std::span<const double> values, const StudyPlan& plan) {
  using P = KeyboardParameter;
  Study study;
  if (!is_key(plan.key)) return study;
  const std::size_t k = index_of(plan.key);
  const double count = static_cast<double>(Piano::strings[k]), position_m = Piano::strike_positions[k];
  const detail::PianoString string(plan.key, plan.sample_rate_hz);
  const double length_m = string.string().length_m;
  const ModeShapes<double> strike = string.shapes_at(position_m);
  std::vector<ModeShapes<double>> points;
  for (std::size_t p = 0; p < kPoints; ++p)
    points.push_back(string.shapes_at(length_m * static_cast<double>(p) / (kPoints - 1)));
  const HammerStringControls<double> controls{
      .hammer_mass_kg = values[P::kMassRatio] * Piano::hammer_masses[k],
      .felt = {.stiffness_ratio = values[P::kHardness], .loss_s_per_m = values[P::kLoss]}};
  const SegmentTable<double> felt(felts_of<Piano, double>[k]);
  HammerString<double> model(felt, bare(string.rows()), strike, plan.sample_rate_hz);
  const auto bridge = model.bridge(bridge_shapes<double>(string.string(), string.rows(), 1));
  Body<double> board = string.board(count, plan.sample_rate_hz);
  model.strike(strike_speed<Piano>(plan.velocity), 1e-4);
  StrikeBooks<double> books;
  books.open(model, felt, controls);
  double lost_j = 0;
  for (std::size_t i = 0; i < plan.frames; ++i) {
    const double compression = model.compression(), board_m = board.displacement();
    const StrikeEnergies all = detail::times(books.books(), count, lost_j);
    detail::HammerFrame{model.string().displacement(strike) + compression,
                        compression,
                        count * model.force(),
                        all,
                        board.energy(),
                        board_m}
        .append_to(study.numbers);
    for (std::size_t p = 0; p < kPoints; ++p)
      study.numbers.push_back(model.string().displacement(points[p]) +
                              board_m * static_cast<double>(p) / (kPoints - 1));
    board.tick(count * model.tick(controls, bridge, board.change()));
    lost_j += board.modes().dissipated();
    books.add_loss(model, felt, controls, plan.sample_rate_hz, compression);
    books.close(model, felt, controls);
  }
  study.scene = fmt::format(detail::kHammerScene, "null", "null", count * books.books().work, "hammer", "felt",
                            R"(, ["strings", 5], ["board", 6])",
                            detail::string_item(detail::kHammerHead, Piano::strings[k], R"(, "board": 8)"), "hammer",
                            position_m / length_m);
  return study;
}

}  // namespace contactspline::web
