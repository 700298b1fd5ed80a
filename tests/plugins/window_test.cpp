// SPDX-License-Identifier: MIT
// The window of a plug-in in a host: opened, clicked, dragged, resized, photographed.
#include <gtest/gtest.h>

#include <cmath>

#include "plugins/count_pictures.hpp"
#include "plugins/open_plugin.hpp"
#include "plugins/virtual_display.hpp"
#include "window/instrument_window.hpp"

namespace contactspline::testing {
namespace {

constexpr int kWidth = InstrumentWindow::kWidth, kHeight = InstrumentWindow::kHeight;
constexpr Pixel kBackground{20, 22, 27}, kPanel{29, 32, 39}, kAccent{255, 178, 74};

class WindowInHost : public ::testing::TestWithParam<std::string> {
 protected:
  ~WindowInHost() override {
    if (is_open_) plugin_.close_window();
  }

  [[nodiscard]] static std::unique_ptr<HostedPlugin> hammer_string() {
    return open_plugin(GetParam(), "hammer_string", 44100);
  }

  void open(double scale) {
    scale_ = scale;
    host_ = std::make_unique<HostWindow>(display_, static_cast<unsigned>(scale * kWidth),
                                         static_cast<unsigned>(scale * kHeight));
    plugin_.open_window(host_->get(), scale);
    is_open_ = true;
    advance(3);
  }

  void close() {
    plugin_.close_window();
    is_open_ = false;
  }

  // Frames of 17 ms.
  HostedPlugin::Sound advance(int frames) {
    HostedPlugin::Sound sound = plugin_.run(3 * static_cast<std::size_t>(frames));
    for (int frame = 0; frame < frames; ++frame) plugin_.idle_window();
    return sound;
  }

  // Waits until what it shows holds: the server draws when it can.
  template <typename Holds>
  bool shows(Holds holds) {
    for (int i = 0; i < 250; ++i) {
      plugin_.idle_window();
      if (holds(host_->photo())) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  // Points of the window at 100 %.
  void button(float x, float y, bool is_down) {
    host_->button(static_cast<int>(scale_ * x), static_cast<int>(scale_ * y), is_down);
    plugin_.idle_window();
  }
  void motion(float x, float y) {
    host_->motion(static_cast<int>(scale_ * x), static_cast<int>(scale_ * y));
    plugin_.idle_window();
  }

  VirtualDisplay display_;
  std::unique_ptr<HostedPlugin> opened_ = hammer_string();
  HostedPlugin& plugin_ = *opened_;
  std::unique_ptr<HostWindow> host_;
  double scale_ = 1;
  bool is_open_ = false;
};

INSTANTIATE_TEST_SUITE_P(Of, WindowInHost, ::testing::Values("clap", "vst3", "lv2"),
                         [](const auto& test) { return test.param; });

double energy(const HostedPlugin::Sound& sound) {
  double sum = 0;
  for (const float x : sound[0]) sum += static_cast<double>(x) * static_cast<double>(x);
  return sum;
}

bool is_drawn(const Photo& photo) {
  const std::size_t all = photo.pixels.size();
  return photo.count(kBackground) > all / 5 && photo.count(kPanel) > all / 4;
}

TEST_P(WindowInHost, AClickOnAKeySoundsANote) {
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  EXPECT_EQ(energy(advance(10)), 0);
  const std::size_t before = host_->photo().count(kAccent);
  button(480, 600, true);
  const auto sound = advance(20);
  EXPECT_GT(energy(sound), 1e-3);
  // The curves of motion, force and energy.
  EXPECT_TRUE(shows([&](const Photo& photo) { return photo.count(kAccent) > before + 500; }));
  button(480, 600, false);
  advance(20);  // the damper
  EXPECT_LT(energy(advance(30)), 0.2 * energy(sound));
}

TEST_P(WindowInHost, ADragMovesTheParameterOfTheHost) {
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  const double before = plugin_.value("hammer mass");
  button(150, 354, true);
  motion(150, 354 - 45);  // a quarter of the way
  advance(1);
  button(150, 354 - 45, false);
  advance(1);
  ASSERT_EQ(plugin_.told().size(), 1u);
  const double told = plugin_.told().back().second, moved = plugin_.value("hammer mass");
  EXPECT_EQ(moved, told);
  // The slider of 0.5 to 50 g is logarithmic.
  EXPECT_NEAR(std::log(moved / before), std::log(100.0) / 4, 0.01);
  // What the host moves is seen: the value at the knob changes.
  const Photo photo = host_->photo();
  plugin_.set("hammer mass", 1);
  (void)plugin_.run(1);
  EXPECT_TRUE(shows([&](const Photo& now) { return now.pixels != photo.pixels; }));
}

TEST_P(WindowInHost, ThePresetMenuMovesAllParameters) {
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  const Box& presets = InstrumentWindow::kPresetBox;
  const double before = plugin_.value("stiffness ratio");
  button(presets.x + 20, presets.y + 15, true);
  button(presets.x + 20, presets.y + 15, false);
  // The third of the lines of 26: "hard hammer".
  button(presets.x + 20, presets.y + presets.height + 8 + 2.5f * 26, true);
  button(presets.x + 20, presets.y + presets.height + 8 + 2.5f * 26, false);
  advance(1);
  EXPECT_EQ(plugin_.told().size(), plugin_.parameters().size() - 6 - kTuning.size());  // volume, macros, oversampling
  EXPECT_NE(plugin_.value("stiffness ratio"), before);
}

constexpr Box kKeys = InstrumentWindow::kKeyboardBox, kStrip = InstrumentWindow::kStripBox;

// The places within a box of pixels that are as asked, from left to right.
template <typename Is>
std::vector<int> places_of(Is is, const Photo& photo, const Box& box) {
  std::vector<int> places;
  for (int x = static_cast<int>(box.x); x < static_cast<int>(box.x + box.width); ++x)
    for (int y = static_cast<int>(box.y); y < static_cast<int>(box.y + box.height); ++y)
      if (is(photo.at(x, y))) places.push_back(x);
  return places;
}
bool is_orange(const Pixel& pixel) {
  return pixel.red > pixel.blue + 60;
}
bool is_blue(const Pixel& pixel) {
  return pixel.blue > pixel.red + 60;
}
bool is_bright(const Pixel& pixel) {
  return pixel.red > 160;
}
double middle_of(const std::vector<int>& places) {
  return places.empty() ? -1 : (places.front() + places.back()) / 2.0;
}

// Keys that MIDI holds, and a bend of a tone, which is marked on the key that has this pitch.
TEST_P(WindowInHost, ShowsWhichKeysAreHeldAndBent) {
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  const Box numbers{kKeys.x, kKeys.y - 15, kKeys.width, 15};
  const auto shows_held = [&](bool is_held) {
    (void)plugin_.run(1);
    return shows([&](const Photo& photo) { return places_of(is_orange, photo, kKeys).empty() != is_held; });
  };
  const auto shows_bent = [&](bool is_bent) {
    (void)plugin_.run(1);
    return shows([&](const Photo& photo) {
      return places_of(is_blue, photo, kKeys).empty() != is_bent &&
             places_of(is_blue, photo, numbers).empty() != is_bent;
    });
  };
  EXPECT_TRUE(shows_held(false));
  plugin_.send(0, {0x90, 62, 100});
  ASSERT_TRUE(shows_held(true));
  const double d4 = middle_of(places_of(is_orange, host_->photo(), kKeys));
  plugin_.send(0, {0x80, 62, 0});
  EXPECT_TRUE(shows_held(false));
  plugin_.send(0, {0x90, 60, 100});
  ASSERT_TRUE(shows_held(true));
  EXPECT_TRUE(shows_bent(false));
  const double c4 = middle_of(places_of(is_orange, host_->photo(), kKeys));
  plugin_.send(0, {0xe0, 0x7f, 0x7f});  // by the bend range
  ASSERT_TRUE(shows_bent(true));
  EXPECT_NEAR(middle_of(places_of(is_blue, host_->photo(), kKeys)), d4, 1);
  plugin_.send(0, {0xe0, 0, 0x60});  // by half of it, to C sharp
  EXPECT_TRUE(((void)plugin_.run(1), shows([&](const Photo& photo) {
                 return std::abs(middle_of(places_of(is_blue, photo, kKeys)) - (c4 + d4) / 2) <= 1;
               })));
  plugin_.send(0, {0xe0, 0, 0x40});
  EXPECT_TRUE(shows_bent(false));
  EXPECT_TRUE(shows_held(true));
  plugin_.send(0, {0x80, 60, 0});
  EXPECT_TRUE(shows_held(false));
}

// Clicks and drags in the strip move parameters of the host, which the strip follows.
TEST_P(WindowInHost, TheStripMovesTheTuning) {
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  const std::vector<WindowParameter> tuning = window_tuning();
  const std::vector<Box> cells = TuningStrip(tuning, kStrip).cells();
  const float y = kStrip.y + kStrip.height / 2, temperament_x = cells[2].x + cells[2].width - 10;
  const auto click = [&](float x) {
    button(x, y, true);
    button(x, y, false);
    advance(2);
  };
  button(cells[0].x + 20, y, true);
  motion(cells[0].x + 20, y - 45);  // a quarter of the way
  advance(1);
  button(cells[0].x + 20, y - 45, false);
  advance(2);
  click(temperament_x);
  click(temperament_x);
  click(cells[3].x + 0.3f * cells[3].width);  // back, around the end
  const std::vector<std::pair<std::string, double>> expected = {
      {"bend range", 26}, {"temperament", 1}, {"temperament", 2}, {"tonic", 11}};
  ASSERT_EQ(plugin_.told().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(plugin_.told()[i].first, expected[i].first);
    EXPECT_NEAR(plugin_.told()[i].second, expected[i].second, 1e-5);
  }
  EXPECT_NEAR(plugin_.value("bend range"), 26, 1e-5);
  EXPECT_EQ(plugin_.value("temperament"), 2);
  EXPECT_EQ(plugin_.value("tonic"), 11);
  const auto a4_of = [&](const Photo& photo) { return places_of(is_bright, photo, cells[1]); };
  const auto before = a4_of(host_->photo());
  EXPECT_FALSE(before.empty());
  plugin_.set("pitch of A4", 415);
  (void)plugin_.run(1);
  EXPECT_TRUE(shows([&](const Photo& photo) { return a4_of(photo) != before; }));
}

// Only the bend range is left while MTS-ESP tunes (mts_stub.cpp).
TEST_P(WindowInHost, SaysThatMtsEspTunes) {
  Library library{"libMTS.so"};
  const auto set_master = library.symbol<void(bool)>("stub_set_master");
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  const auto says = [&](bool is_said) {
    (void)plugin_.run(1);
    return shows([&](const Photo& photo) { return places_of(is_orange, photo, kStrip).empty() != is_said; });
  };
  EXPECT_TRUE(says(false));
  const std::vector<WindowParameter> tuning = window_tuning();
  const Box temperament = TuningStrip(tuning, kStrip).cells()[2];
  const auto click = [&] {
    for (const bool is_down : {true, false}) button(temperament.x + 250, temperament.y + 10, is_down);
    advance(2);
  };
  set_master(true);
  EXPECT_TRUE(says(true));
  click();
  EXPECT_TRUE(plugin_.told().empty());
  set_master(false);
  EXPECT_TRUE(says(false));
  click();
  EXPECT_EQ(plugin_.told().size(), 1u);
}

// At 150 and 200 % the same figure in more pixels: each block of the ground has the same colour.
TEST_P(WindowInHost, GrowsWithTheWindowOfTheHost) {
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  const Photo first = host_->photo();
  for (const double scale : {1.5, 2.0}) {
    SCOPED_TRACE(scale);
    const int width = static_cast<int>(scale * kWidth), height = static_cast<int>(scale * kHeight);
    host_->resize(static_cast<unsigned>(width), static_cast<unsigned>(height));
    if (GetParam() == "lv2") host_->resize_inner(static_cast<unsigned>(width), static_cast<unsigned>(height));
    plugin_.resize_window(static_cast<unsigned>(width), static_cast<unsigned>(height));
    scale_ = scale;
    const auto is_alike = [&](const Photo& photo) {
      std::size_t same = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          same +=
              first.at(x, y) == photo.at(static_cast<int>(scale * (x + 0.5)), static_cast<int>(scale * (y + 0.5)));
      return same > first.pixels.size() * 95 / 100;
    };
    EXPECT_TRUE(shows(is_alike));
    EXPECT_EQ(host_->inner_size(), std::pair(width, height));
    EXPECT_EQ(plugin_.window_size(),
              std::pair(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)));
  }
  // Keys are where they are drawn.
  button(480, 600, true);
  EXPECT_GT(energy(advance(20)), 1e-3);
}

TEST_P(WindowInHost, OpensAtTheScaleOfTheHost) {
  open(2);
  EXPECT_EQ(host_->inner_size(), std::pair(2 * kWidth, 2 * kHeight));
  if (GetParam() != "lv2") {  // whose hosts look at the window itself
    EXPECT_EQ(plugin_.window_size(), std::pair(2u * kWidth, 2u * kHeight));
  }
  EXPECT_TRUE(shows(is_drawn));
}

// Time is spent on pictures that differ from the last one only.
TEST_P(WindowInHost, ShowsNoPictureWhileNothingMoves) {
  open(1);
  ASSERT_TRUE(shows(is_drawn));
  plugin_.send(0, {0x90, 60, 100});
  const int before = pictures;
  EXPECT_TRUE(shows([&](const Photo&) { return (void)plugin_.run(3), pictures > before + 20; }));
  plugin_.send(0, {0x80, 60, 0});
  const auto is_still = [&] {  // for 30 frames, in each of which much is played
    const int shown = pictures;
    for (int frame = 0; frame < 30; ++frame) {
      (void)plugin_.run(30);
      plugin_.idle_window();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // until the server draws
    }
    return pictures == shown;
  };
  bool was_still = false;
  for (int i = 0; i < 30 && !was_still; ++i) was_still = is_still();
  EXPECT_TRUE(was_still && is_still());
}

// What is played does not depend on who watches.
TEST_P(WindowInHost, SoundsTheSameWhileItIsOpen) {
  const auto other = hammer_string();
  open(1);
  const auto until = plugin_.run(1), other_until = other->run(1);
  for (HostedPlugin* plugin : {&plugin_, other.get()}) plugin->send(5, {0x90, 60, 100});
  EXPECT_EQ(plugin_.run(100), other->run(10 * 10));
}

TEST_P(WindowInHost, OpensAgainAfterItWasClosed) {
  for (int i = 0; i < 5; ++i) {
    open(1);
    EXPECT_TRUE(shows(is_drawn)) << i;
    button(480, 600, true);
    advance(2);
    close();
    EXPECT_TRUE(std::isfinite(energy(plugin_.run(4))));
  }
}

}  // namespace
}  // namespace contactspline::testing
