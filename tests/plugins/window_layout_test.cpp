// SPDX-License-Identifier: MIT
// Nothing in a window is cut or lies on something else, at any scale.
#include <gtest/gtest.h>

#include <Application.hpp>
#include <NanoVG.hpp>
#include <StandaloneWindow.hpp>

#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instruments/prepared_piano.hpp"
#include "contactspline/instruments/snare.hpp"
#include "contactspline/instruments/tanpura.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "plugins/virtual_display.hpp"
#include "window/instrument_window.hpp"

namespace contactspline::testing {
namespace {

// An instrument's table with values at which texts are long.
class Source : public WindowSource {
 public:
  template <Instrument I>
  static Source of(const I& instrument) {
    std::vector<std::size_t> numbers(instrument.parameters().size());
    for (std::size_t p = 0; p < numbers.size(); ++p) numbers[p] = p;
    return Source(window_table_of(instrument, numbers, 0));
  }
  // All keys are held, and bent.
  explicit Source(WindowTable table) : table_(std::move(table)) {
    table_.tuning = window_tuning();
    KeyCents cents{};
    for (std::size_t key = 0; key < kMidiKeys; ++key) cents[key] = 37.0 * static_cast<double>(key * key % 31) - 500;
    held_keys_->write(cents);
  }

  [[nodiscard]] WindowTable window_table() const override { return table_; }
  [[nodiscard]] double window_value(std::size_t p) const override {
    if (p == table_.parameters.size() + kTemperament) return 2;  // of the longest name
    const bool is_tuning = p >= table_.parameters.size();
    return (is_tuning ? table_.tuning[p - table_.parameters.size()] : table_.parameters[p])
        .scale.value_at(0.987654321);
  }
  [[nodiscard]] double window_rate_hz() const override { return 44100; }
  [[nodiscard]] ContactRing& ring() override { return *ring_; }
  [[nodiscard]] const HeldKeys& held_keys() const override { return *held_keys_; }
  [[nodiscard]] bool is_tuned_outside() const override { return is_outside; }

  bool is_outside = false;

 private:
  WindowTable table_;
  std::unique_ptr<ContactRing> ring_ = std::make_unique<ContactRing>();
  std::unique_ptr<HeldKeys> held_keys_ = std::make_unique<HeldKeys>();
};

struct Host : WindowHost {
  void edit(std::size_t, bool) override {}
  void set(std::size_t, double) override {}
  void play(int, int) override {}
};

// Draws once, and keeps where the texts are.
class Frame : public DGL_NAMESPACE::NanoStandaloneWindow {
 public:
  Frame(DGL_NAMESPACE::Application& application, InstrumentWindow& window, float scale)
      : NanoBaseWidget(application), window_(window), scale_(scale) {
    setSize(static_cast<unsigned>(scale * InstrumentWindow::kWidth),
            static_cast<unsigned>(scale * InstrumentWindow::kHeight));
    loadSharedResources();
  }

  std::vector<Canvas::Text> ground, figure;

 private:
  void onNanoDisplay() override {
    Canvas canvas(*this, 0, 0, scale_, getHeight());
    window_.draw_ground(canvas);
    ground = canvas.texts();
    NanoVG::endFrame();
    NanoVG::beginFrame(getWidth(), getHeight());
    Canvas on_ground(*this, 0, 0, scale_, getHeight());
    window_.draw_figure(on_ground);
    figure = on_ground.texts();
  }

  InstrumentWindow& window_;
  float scale_;
};

bool overlap(const Box& a, const Box& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

void expect_readable(Source source, float scale) {
  SCOPED_TRACE(source.window_table().title + " at " + std::to_string(scale));
  Host host;
  InstrumentWindow window(source, host);
  DGL_NAMESPACE::Application application(true);
  Frame frame(application, window, scale);
  frame.show();
  for (int i = 0; i < 2000 && frame.ground.empty(); ++i) {  // until the server draws
    frame.repaint();
    application.idle();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  frame.close();
  std::vector<Canvas::Text> texts = frame.ground;
  texts.insert(texts.end(), frame.figure.begin(), frame.figure.end());
  // Title, description, three panels, a name and a value for each knob; the tuning, and at least a bend.
  const std::size_t tuning = source.is_outside ? 3 : 8;
  ASSERT_GE(texts.size(), 2 + 3 + 2 * window.table().parameters.size() + tuning + 1);
  EXPECT_TRUE(std::ranges::any_of(texts, [](const Canvas::Text& text) { return text.text[0] == '-'; }));
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto& [words, box, size] = texts[i];
    EXPECT_GE(box.x, 0) << words;
    EXPECT_GE(box.y, 0) << words;
    EXPECT_LE(box.x + box.width, InstrumentWindow::kWidth) << words;
    EXPECT_LE(box.y + box.height, InstrumentWindow::kHeight) << words;
    EXPECT_GE(size, 8.5) << words;
    for (std::size_t other = 0; other < i; ++other)
      EXPECT_FALSE(overlap(box, texts[other].box)) << words << " and " << texts[other].text;
  }
  // Boxes: knobs neither on each other nor on the figure or the keys.
  const auto& knobs = window.knobs();
  const Box& strip = InstrumentWindow::kStripBox;
  for (const Box& cell : window.strip().cells()) {
    EXPECT_GE(cell.x, strip.x);
    EXPECT_LE(cell.x + cell.width, strip.x + strip.width + 0.01f);
    for (const Box& other : window.strip().cells()) EXPECT_TRUE(&cell == &other || !overlap(cell, other));
  }
  for (const WindowKey& key : window.table().keys)
    EXPECT_FALSE(overlap(strip, window.keyboard().box_of(key.number))) << key.number;
  const Box& plots = window.plots_box();
  EXPECT_GT(plots.height, 100);
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    EXPECT_FALSE(overlap(knobs[k], plots)) << k;
    EXPECT_FALSE(overlap(knobs[k], strip)) << k;
    for (std::size_t other = 0; other < k; ++other) EXPECT_FALSE(overlap(knobs[k].inner(0.01f), knobs[other])) << k;
    for (const WindowKey& key : window.table().keys)
      EXPECT_FALSE(overlap(knobs[k], window.keyboard().box_of(key.number))) << k << " and key " << key.number;
  }
}

TEST(WindowLayout, NothingIsCutOrCovered) {
  const VirtualDisplay display;
  using Hammer = HammerStringOf<materials::felt_c4, resonators::string_c4, float>;
  for (const float scale : {1.0f, 1.5f, 2.0f}) {
    expect_readable(Source::of(Hammer()), scale);
    expect_readable(Source::of(KeyboardInstrument<keyboards::piano, float>()), scale);
    expect_readable(Source::of(instruments::tanpura<float>()), scale);
    expect_readable(Source::of(instruments::trichord_c4<float>()), scale);
    expect_readable(Source::of(instruments::snare<float>()), scale);
    expect_readable(Source::of(instruments::prepared_piano<float>()), scale);
  }
}

// An instrument of one's own with many parameters of long names, and with events as buttons.
TEST(WindowLayout, ManyKnobsAndButtonsFindTheirPlace) {
  const VirtualDisplay display;
  WindowTable table{
      .title = "many", .description = "knobs", .motion = "displacement of the place", .motion_unit = "mm"};
  for (int p = 0; p < 30; ++p)
    table.parameters.push_back({"second bridge stiffness ratio " + std::to_string(p), "N s/m", 1, {1e-4, 1e6, true}});
  for (int key = 60; key < 68; ++key) table.keys.push_back({key, "strike hammer " + std::to_string(key)});
  table.has_buttons = true;
  for (const float scale : {1.0f, 2.0f}) expect_readable(Source(table), scale);
}

TEST(WindowLayout, SaysWhoTunesElse) {
  const VirtualDisplay display;
  Source source = Source::of(KeyboardInstrument<keyboards::piano, float>());
  source.is_outside = true;
  expect_readable(std::move(source), 1);
}

}  // namespace
}  // namespace contactspline::testing
