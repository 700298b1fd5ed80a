// SPDX-License-Identifier: MIT
// The window of an instrument: its name and presets, the figure of its contact, its knobs, its tuning, its keys.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "window/canvas.hpp"
#include "window/contact_figure.hpp"
#include "window/keyboard.hpp"
#include "window/knob.hpp"
#include "window/plots.hpp"
#include "window/tuning_strip.hpp"
#include "window/window_source.hpp"

namespace contactspline {

/// Coordinates are those of the window at 100 %.
class InstrumentWindow {
 public:
  static constexpr unsigned kWidth = 960, kHeight = 640;

  InstrumentWindow(WindowSource& source, WindowHost& host)
      : source_(source), host_(host), table_(source.window_table()), figure_(source.window_rate_hz()) {
    values_.resize(table_.parameters.size() + table_.tuning.size());
    place_knobs();
    source_.ring().watch(true);
    take_values();
    take_keys();
  }
  InstrumentWindow(const InstrumentWindow&) = delete;
  InstrumentWindow& operator=(const InstrumentWindow&) = delete;
  ~InstrumentWindow() { source_.ring().watch(false); }

  /// Looks at the plug-in; true if the window has to be drawn again.
  [[nodiscard]] bool update() {
    source_.ring().read(samples_);
    const bool was_moving = figure_.is_moving();
    figure_.add(samples_);
    is_ground_old_ |= take_values();
    const bool is_bent = take_keys();
    return is_ground_old_ || is_bent || (!samples_.empty() && (was_moving || figure_.is_moving()));
  }

  /// What seldom changes: name, presets, panels, knobs, tuning, keys.
  void draw_ground(Canvas& canvas) {
    is_ground_old_ = false;
    canvas.text({kMargin, 10, 480, 26}, table_.title, 22, colours::kText);
    canvas.text({kMargin, 36, 640, 16}, table_.description, 12, colours::kMuted);
    plots_.draw_ground(canvas, table_);
    for (std::size_t p = 0; p < knobs_.size(); ++p)
      draw_knob(canvas, knobs_[p], table_.parameters[p], values_[p], held_knob_ == p);
    strip_.draw(canvas, std::span(values_).subspan(knobs_.size()),
                held_knob_ >= knobs_.size() ? std::optional(*held_knob_ - knobs_.size()) : std::nullopt);
    keyboard_.draw(canvas, [&](int key) { return key == pressed_key_ || cents_of(key); });
    draw_preset_button(canvas);
  }
  [[nodiscard]] bool is_ground_old() const { return is_ground_old_; }

  /// On the ground: the contact, bends, and the menu while it is open.
  void draw_figure(Canvas& canvas) {
    plots_.draw(canvas, table_, figure_);
    keyboard_.draw_bends(canvas, [&](int key) { return cents_of(key); });
    if (is_menu_open_) draw_menu(canvas);
  }

  // The mouse. Times in seconds.

  void press(double x, double y, double time_s) {
    if (is_menu_open_) return choose_preset(x, y);
    is_ground_old_ = true;
    if (!table_.presets.empty() && kPresetBox.has(x, y)) {
      is_menu_open_ = true;
    } else if (const auto knob = knob_at(x, y)) {
      press_knob(*knob, x, y, time_s);
    } else {
      move_to_key(keyboard_.at(x, y));
      is_playing_ = true;
    }
  }

  /// With `fine` a knob moves a tenth as far.
  void move(double x, double y, bool fine) {
    constexpr double kTravel = 180;
    if (held_knob_) {
      const HostScale& scale = parameter(*held_knob_).scale;
      held_part_ = std::clamp(held_part_ + (held_y_ - y) / kTravel * (fine ? 0.1 : 1), 0.0, 1.0);
      held_y_ = y;
      move_to(*held_knob_, stepped(*held_knob_, scale.value_at(held_part_), fine));
    } else if (is_playing_) {
      move_to_key(keyboard_.at(x, y));
    }
  }

  void release() {
    if (held_knob_) host_.edit(*held_knob_, false);
    held_knob_.reset();
    move_to_key({});
    is_playing_ = false;
    is_ground_old_ = true;
  }

  /// The wheel of the mouse: for each step a fiftieth of a slider, or what one step of the tuning is.
  void scroll(double x, double y, double steps) {
    const auto knob = knob_at(x, y);
    if (!knob || held_knob_ || is_menu_open_ || steps == 0) return;
    set_at_once(*knob, scrolled(*knob, steps));
  }

  // Where things are, for tests.
  [[nodiscard]] const std::vector<Box>& knobs() const { return knobs_; }
  [[nodiscard]] const TuningStrip& strip() const { return strip_; }
  [[nodiscard]] const Keyboard& keyboard() const { return keyboard_; }
  [[nodiscard]] const WindowTable& table() const { return table_; }
  [[nodiscard]] const Box& plots_box() const { return plots_box_; }
  static constexpr Box kPresetBox{720, 14, 224, 32}, kKeyboardBox{16, 540, kWidth - 32, 84},
      kStripBox{16, 498, kWidth - 32, 26};

 private:
  static constexpr float kMargin = 16, kHeader = 62, kKnobHeight = 94, kMenuLine = 26;
  static constexpr std::size_t kKnobsInRow = 10;

  void place_knobs() {
    const std::size_t count = table_.parameters.size();
    const std::size_t rows = std::min<std::size_t>(3, (count + kKnobsInRow - 1) / kKnobsInRow);
    const std::size_t columns = (count + rows - 1) / rows;
    const float width = std::min(110.0f, (kWidth - 2 * kMargin) / static_cast<float>(columns));
    const float top = kStripBox.y - 4 - static_cast<float>(rows) * kKnobHeight;
    for (std::size_t p = 0; p < count; ++p) {
      const std::size_t row = p / columns, in_row = std::min(columns, count - row * columns);
      const float left = (kWidth - static_cast<float>(in_row) * width) / 2;
      knobs_.push_back({left + static_cast<float>(p % columns) * width, top + static_cast<float>(row) * kKnobHeight,
                        width, kKnobHeight});
    }
    plots_box_ = {kMargin, kHeader, kWidth - 2 * kMargin, top - 12 - kHeader};
    plots_.place(plots_box_);
  }

  [[nodiscard]] std::optional<std::size_t> knob_at(double x, double y) const {
    for (std::size_t p = 0; p < knobs_.size(); ++p)
      if (knobs_[p].has(x, y)) return p;
    const auto tuning = strip_.at(x, y);
    return tuning ? std::optional(knobs_.size() + *tuning) : std::nullopt;
  }
  // The knobs, and behind them the tuning, as the host counts them.
  [[nodiscard]] const WindowParameter& parameter(std::size_t number) const {
    return number < knobs_.size() ? table_.parameters[number] : table_.tuning[number - knobs_.size()];
  }

  void press_knob(std::size_t knob, double x, double y, double time_s) {
    if (!parameter(knob).entries.empty()) {
      const std::size_t list = knob - knobs_.size();
      return set_at_once(knob, strip_.clicked(list, values_[knob], x));
    }
    const bool is_double = last_knob_ == knob && time_s - last_press_s_ < 0.4;
    last_knob_ = knob;
    last_press_s_ = time_s;
    host_.edit(knob, true);
    held_knob_ = knob;
    held_part_ = parameter(knob).scale.part_of(values_[knob]);
    held_y_ = y;
    if (is_double) move_to(knob, parameter(knob).initial);
  }

  // A value of a knob, to the nearest that the mouse moves it to.
  [[nodiscard]] double stepped(std::size_t knob, double value, bool fine) const {
    if (parameter(knob).step == 0) return value;
    const double in_one = (fine ? 10 : 1) / parameter(knob).step;
    return std::round(value * in_one) / in_one;
  }
  [[nodiscard]] double scrolled(std::size_t knob, double steps) const {
    const auto& [name, unit, initial, scale, entries, step] = parameter(knob);
    const double whole = std::copysign(std::max(1.0, std::abs(steps)), steps);
    if (!entries.empty()) return strip_.stepped(knob - knobs_.size(), values_[knob], whole > 0 ? 1 : -1);
    if (step != 0) return std::clamp(values_[knob] + step * whole, scale.min, scale.max);
    return scale.value_at(std::clamp(scale.part_of(values_[knob]) + 0.02 * steps, 0.0, 1.0));
  }

  // What a knob that is held shows is not yet everywhere in the plug-in.
  bool take_values() {
    bool is_new = false;
    for (std::size_t p = 0; p < values_.size(); ++p) {
      if (held_knob_ == p) continue;
      const double value = source_.window_value(p);
      is_new |= value != values_[p];
      values_[p] = value;
    }
    return is_new;
  }

  // Looks at keys that are held and at who tunes; true if a key is bent otherwise.
  bool take_keys() {
    bool is_bent = false;
    for (const WindowKey& key : table_.keys) {
      const auto cents = source_.held_keys().cents(key.number);
      const auto whole = cents ? std::optional(static_cast<int>(std::lround(*cents))) : std::nullopt;
      std::optional<int>& shown = cents_[static_cast<std::size_t>(key.number)];
      is_ground_old_ |= whole.has_value() != shown.has_value();
      is_bent |= whole != shown;
      shown = whole;
    }
    is_ground_old_ |= strip_.is_outside() != source_.is_tuned_outside();
    strip_.tune_outside(source_.is_tuned_outside());
    return is_bent;
  }
  // Of a key that is held.
  [[nodiscard]] std::optional<int> cents_of(int key) const { return cents_[static_cast<std::size_t>(key)]; }

  void move_to(std::size_t knob, double value) {
    values_[knob] = value;
    is_ground_old_ = true;
    host_.set(knob, value);
  }
  void set_at_once(std::size_t knob, double value) {
    host_.edit(knob, true);
    move_to(knob, value);
    host_.edit(knob, false);
  }

  void move_to_key(std::optional<Keyboard::Press> press) {
    const auto key = press ? std::optional(press->key) : std::nullopt;
    if (key == pressed_key_) return;
    if (pressed_key_) host_.play(*pressed_key_, 0);
    if (press) host_.play(press->key, press->velocity);
    pressed_key_ = key;
    is_ground_old_ = true;
  }

  // Presets: a button, and a menu below it while it is open.

  [[nodiscard]] bool is_loaded(const WindowPreset& preset) const {
    for (std::size_t p = 0; p < preset.values.size(); ++p) {
      const HostScale& scale = table_.parameters[p].scale;
      if (std::abs(scale.part_of(values_[p]) - scale.part_of(preset.values[p])) > 1e-4) return false;
    }
    return true;
  }

  [[nodiscard]] Box menu_box() const {
    return {kPresetBox.x, kPresetBox.y + kPresetBox.height + 4, kPresetBox.width,
            static_cast<float>(table_.presets.size()) * kMenuLine + 8};
  }
  [[nodiscard]] Box menu_line(std::size_t preset) const {
    const Box menu = menu_box();
    return {menu.x + 4, menu.y + 4 + static_cast<float>(preset) * kMenuLine, menu.width - 8, kMenuLine};
  }

  void choose_preset(double x, double y) {
    is_menu_open_ = false;
    is_ground_old_ = true;
    for (std::size_t i = 0; i < table_.presets.size(); ++i) {
      if (!menu_line(i).has(x, y)) continue;
      for (std::size_t p = 0; p < table_.presets[i].values.size(); ++p) set_at_once(p, table_.presets[i].values[p]);
    }
  }

  // The index of the preset that all knobs are at; the number of presets where there is none.
  [[nodiscard]] std::size_t loaded() const {
    const auto found = std::find_if(table_.presets.begin(), table_.presets.end(),
                                    [&](const WindowPreset& preset) { return is_loaded(preset); });
    return static_cast<std::size_t>(found - table_.presets.begin());
  }

  void draw_preset_button(Canvas& canvas) {
    if (table_.presets.empty()) return;
    canvas.lay(kPresetBox, colours::kPanel);
    const Box inner = kPresetBox.inner(10);
    const std::size_t preset = loaded();
    const bool is_one = preset < table_.presets.size();
    canvas.text({inner.x, inner.y, inner.width - 20, inner.height}, is_one ? table_.presets[preset].name : "presets",
                13, is_one ? colours::kText : colours::kMuted);
    const float x = inner.x + inner.width - 8, y = inner.y + inner.height / 2;
    canvas.line(x - 5, y - 2, x, y + 3, colours::kMuted, 1.6f);
    canvas.line(x, y + 3, x + 5, y - 2, colours::kMuted, 1.6f);
  }

  void draw_menu(Canvas& canvas) {
    const Box menu = menu_box();
    canvas.fill({menu.x - 1, menu.y - 1, menu.width + 2, menu.height + 2}, colours::kLine);
    canvas.fill(menu, colours::kPanel);
    const std::size_t current = loaded();
    for (std::size_t i = 0; i < table_.presets.size(); ++i)
      canvas.text(menu_line(i).inner(6), table_.presets[i].name, 13,
                  i == current ? colours::kAccent : colours::kText);
  }

  WindowSource& source_;
  WindowHost& host_;
  WindowTable table_;
  ContactFigure figure_;
  Plots plots_;
  std::vector<ContactSample> samples_;
  std::vector<double> values_;
  Keyboard keyboard_{table_, kKeyboardBox};
  TuningStrip strip_{table_.tuning, kStripBox};
  std::vector<Box> knobs_;
  Box plots_box_{};

  bool is_ground_old_ = true, is_menu_open_ = false, is_playing_ = false;
  std::optional<std::size_t> held_knob_, last_knob_;
  double held_part_ = 0, held_y_ = 0, last_press_s_ = -1;
  std::optional<int> pressed_key_;
  std::array<std::optional<int>, kMidiKeys> cents_ = {};  // of the keys that are held
};

}  // namespace contactspline
