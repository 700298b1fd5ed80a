// SPDX-License-Identifier: MIT
// One key of a keyboard on its body: strings, hammer, damper and bend.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/modal/longitudinal.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/simd/kernel_data.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// One key of a KeyboardOnBody.
template <std::floating_point T>
struct KeyOnBody {
  StiffString strings;             ///< each by itself: one for each detuning
  double strike_position_m;        ///< from the end that does not move
  SegmentTable<T> felt;            ///< of one string; must outlive the instrument
  HammerStringControls<T> hammer;  ///< mass and stiffness ratio of one string; KeyboardOnBody sets loss and damping
  Damper damper;                   ///< damping 0: there is none
  std::span<const Memory> memories = {};  ///< of the felt
  /// How far the bridge moves where these strings end, as a ratio of its motion at the body's bridge shapes.
  double bridge_ratio = 1;
  double output_ratio = 1;           ///< weight of these strings' force on the bridge in the sound (Listening)
  HorizontalMotion horizontal = {};  ///< below detail::SoundingKey::kSympathy_hz
  std::size_t bridge_place = 0;      ///< number of the body's place where these strings end, below Body::places()
  LongitudinalMotion longitudinal = {};
};

namespace detail {

/// One key of a KeyboardOnBody as it sounds. The first modes of all its strings stand first, then the second ones,
/// and so on, in whole lines: a number of them can be advanced alone.
template <std::floating_point T>
struct SoundingKey {
  // Modes that join and leave together: whole cache lines in both precisions.
  static constexpr std::size_t kLine = kLineSize<float>;
  static constexpr double kSympathy_hz = 5000;

  SoundingKey(const KeyOnBody<T>& key, double sample_rate_hz, std::size_t max_modes)
      : SoundingKey(key, rows_of(key, sample_rate_hz / 2, max_modes), sample_rate_hz) {}

  struct Row {
    Mode mode;
    double wavenumber_per_m;
    std::size_t string;               // one more than the last: the horizontal motion of all strings
    double bridge_weight;             // of bridge_shape()
    double tension_square = 0;        // square_by_tension()
    double bridge_per_stiffness = 0;  // what at_bridge() is for each N/m of the mode
  };

  SoundingKey(const KeyOnBody<T>& key, std::vector<Row> sorted, double sample_rate_hz)
      : rows(std::move(sorted)),
        tuned(bare(rows)),
        model(key.felt, tuned, ModeShapes<T>(rows.size()), sample_rate_hz, key.memories),
        output(static_cast<T>(key.output_ratio / key.bridge_ratio)),
        bridge(model.bridge(at_bridge(key.strings, rows))),
        bridge_place(key.bridge_place),
        strike(rows.size()),
        shapes(rows.size()),
        stiffness((rows.size() + kLine - 1) / kLine + 1),
        ends_n_per_m(ends_of(key)),
        damper(key.damper, sample_rate_hz),
        hammer(key.hammer),
        controls(key.hammer),
        string(key.strings),
        strings(key.strings.detuning_cents.size()),
        horizontal_strike(key.horizontal.strike_ratio / std::sqrt(static_cast<double>(strings))),
        has_damper(key.damper.damping_per_s > 0),
        longitudinal_output(static_cast<T>(key.output_ratio * key.longitudinal.output_ratio)) {
    if (key.longitudinal.axial_stiffness_n > 0)
      longitudinal.emplace(string, key.longitudinal, std::span<const Row>(rows), sample_rate_hz);
    strike_at(key.strike_position_m);
    sum_stiffness();
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i].mode.angular_frequency_rad_per_s < 2 * std::numbers::pi * kSympathy_hz) sympathetic = i + 1;
    sympathetic = in_lines(sympathetic);
    damper.move_to(1);
    damper.finish();
  }

  // N strings that move horizontally as one: by a displacement of 1/sqrt(N) each, they have the energy of one string.
  static std::vector<Row> rows_of(const KeyOnBody<T>& key, double max_frequency_hz, std::size_t max_modes) {
    std::vector<Row> rows;
    const auto add = [&](double detuning_cents, double bridge_weight, std::size_t number, double below_hz) {
      StiffString one = key.strings;
      one.detuning_cents = {detuning_cents};
      for (const StringMode& mode : modes_below(one, below_hz, max_modes))
        rows.push_back({mode.mode, mode.wavenumber_per_m, number, bridge_weight});
    };
    const std::vector<double>& detuning = key.strings.detuning_cents;
    for (std::size_t s = 0; s < detuning.size(); ++s) add(detuning[s], key.bridge_ratio, s, max_frequency_hz);
    const auto count = static_cast<double>(detuning.size());
    if (key.horizontal.strike_ratio > 0 && key.horizontal.bridge_ratio > 0)
      add(std::accumulate(detuning.begin(), detuning.end(), 0.0) / count + key.horizontal.cents,
          key.bridge_ratio * key.horizontal.bridge_ratio * std::sqrt(count), detuning.size(),
          (std::min)(max_frequency_hz, kSympathy_hz));
    for (Row& row : rows) {
      row.tension_square = square_by_tension(key.strings, row);
      row.bridge_per_stiffness =
          row.bridge_weight * bridge_shape(key.strings, row) / contactspline::stiffness_of(row.mode);
    }
    std::ranges::stable_sort(rows, {}, [](const Row& row) {
      return std::pair(row.wavenumber_per_m, row.mode.angular_frequency_rad_per_s);
    });
    return rows;
  }

  // Stiffness of the ends of a key's strings as the bridge feels it: force and displacement there both count
  // bridge_ratio times.
  static double ends_of(const KeyOnBody<T>& key) {
    const double along = key.horizontal.strike_ratio > 0 ? key.horizontal.bridge_ratio : 0;
    return key.bridge_ratio * key.bridge_ratio * (1 + along * along) *
           bridge_stiffness(key.strings, std::vector<StringMode>()).ends;
  }

  static T at_bridge(const StiffString& string, const Row& row, const Mode& tuned) {
    return static_cast<T>(row.bridge_weight * bridge_shape(string, StringMode{tuned, row.wavenumber_per_m}));
  }
  static ModeShapes<T> at_bridge(const StiffString& string, const std::vector<Row>& rows) {
    ModeShapes<T> shapes(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) shapes[i] = at_bridge(string, rows[i], rows[i].mode);
    return shapes;
  }

  // A number of modes, up to the end of its line.
  [[nodiscard]] std::size_t in_lines(std::size_t count) const {
    return (std::min)(in_whole_lines<float>(count), model.string().size());
  }
  // Stiffness that the lowest modes add to the bridge, in whole lines or all [N/m].
  [[nodiscard]] double stiffness_of(std::size_t count) const { return stiffness[(count + kLine - 1) / kLine]; }

  void sum_stiffness() {
    double sum = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (i % kLine == 0) stiffness[i / kLine] = sum;
      sum += model.stiffness_on(bridge, i, i + 1);
    }
    stiffness.back() = sum;
  }

  void strike_at(double position_m) {
    const double place = held(position, position_m, {0, string.length_m});
    if (place == std::exchange(position, place)) return;
    for (std::size_t i = 0; i < shapes.size(); ++i)
      shapes[i] = static_cast<T>(std::sin(rows[i].wavenumber_per_m * position));
    struck_part = -1;
  }

  // Energy that its tension stores in its first modes, at the pitch of the key [J].
  [[nodiscard]] double tension_energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < modes; ++i) {
      const double q = double(model.string().displacement(i));
      sum += rows[i].mode.mass_kg * rows[i].tension_square * q * q / 2;
    }
    return sum;
  }

  // Takes the tension of its bend. A mode rests per displacement of the bridge where it did before.
  void retune() {
    if (tuned_cents == bend.cents()) return;
    tuned_cents = bend.cents();
    const double change = tension_change(tuned_cents);
    for (std::size_t i = 0; i < rows.size(); ++i)
      tuned[i] = retuned_by(rows[i].mode, change * rows[i].tension_square);
    model.retune(tuned);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      bridge.shapes[i] = static_cast<T>(rows[i].bridge_per_stiffness * contactspline::stiffness_of(tuned[i]));
      bridge.rests[i] = static_cast<T>(model.string().compliance(i) * double(bridge.shapes[i]));
    }
    sum_stiffness();
  }

  // Under the soft pedal the hammer strikes the last of several strings in part, and the felt is as stiff as that
  // of the strings it strikes.
  void prepare_strike(double una_corda, double soft_ratio, T mass_ratio, const ContactControls<T>& felt) {
    const double last = strings > 1 ? 1 - una_corda : 1, all = static_cast<double>(strings - 1) + last;
    if (last != struck_part) {
      struck_part = last;
      for (std::size_t i = 0; i < shapes.size(); ++i)
        strike[i] = shapes[i] * static_cast<T>(rows[i].string == strings       ? horizontal_strike
                                               : rows[i].string + 1 == strings ? last / all
                                                                               : 1 / all);
      model.strike_at(strike);
    }
    controls.hammer_mass_kg = mass_ratio * static_cast<T>(static_cast<double>(strings)) * hammer.hammer_mass_kg;
    controls.felt.stiffness_ratio = felt.stiffness_ratio *
                                    static_cast<T>(all * std::lerp(1.0, soft_ratio, una_corda)) *
                                    hammer.felt.stiffness_ratio;
    controls.felt.loss_s_per_m = felt.loss_s_per_m;
  }

  void rest() {
    model.reset();
    rest_longitudinally();
    modes = 0;
    checks = 0;
    energy_j = 0;
    is_struck = is_down = is_held = touches = false;
  }

  // Lets the strings move along themselves, if they do so at all. Returns what begins to sound [N].
  T move_longitudinally() {
    if (!longitudinal || std::exchange(is_longitudinal, true)) return 0;
    return longitudinal_output * longitudinal->begin(model.string().displacements().first(modes));
  }
  // Advances this motion one sample, after the strings. Returns what sounds [N].
  T tick_longitudinally() {
    return longitudinal_output * longitudinal->tick(model.string().displacements().first(modes));
  }
  // Ends it. Returns what sounded [N].
  T rest_longitudinally() {
    if (!std::exchange(is_longitudinal, false)) return 0;
    return longitudinal_output * longitudinal->force();
  }

  std::vector<Row> rows;
  std::vector<Mode> tuned;  // the same at the tension of tuned_cents
  HammerString<T> model;
  T output;  // weight of the force on the bridge, which counts bridge_ratio times in `bridge`
  BridgeShapes<T> bridge;
  std::size_t bridge_place;       // on the body
  ModeShapes<T> strike;           // of the whole hammer
  std::vector<T> shapes;          // where the hammer strikes
  std::vector<double> stiffness;  // of the modes below each line
  double ends_n_per_m;            // stiffness of the ends of the strings, without a bend
  FallingDamper damper;
  HammerStringControls<T> hammer, controls;
  StiffString string;
  std::size_t strings;
  double horizontal_strike;  // shape of the horizontal motion under the hammer
  std::size_t sympathetic = 0;
  bool has_damper;
  std::optional<LongitudinalModes<T>> longitudinal = {};
  T longitudinal_output;    // weight of their force
  double struck_part = -1;  // of the last string
  double position = 0;      // of the strike [m]
  double cents = 0;         // the control of the bend
  Bend bend;                // that the bridge feels
  double tuned_cents = 0;   // the same of the modes: keys that sleep take it when they wake
  T extra_damping_per_s = 0;
  // State of the sound:
  std::size_t modes = 0;  // that are at the bridge; 0: the key sleeps
  std::size_t checks = 0;
  double energy_j = 0;  // at the last check
  // Did a hammer fly at the last check? Not asked more often, so that where blocks are cut has no effect.
  bool is_struck = false;
  bool is_down = false, is_held = false;  // by the key; by the sostenuto pedal
  bool touches = false;                   // does the hammer touch?
  bool is_longitudinal = false;           // from a strike until the key sleeps
};

}  // namespace detail

}  // namespace contactspline
