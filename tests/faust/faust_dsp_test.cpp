// SPDX-License-Identifier: MIT
// The C++ hammer-string behind Faust's `dsp` interface: against the model itself, against the class that Faust writes
// for hammer_string.dsp, and in an architecture file of Faust's own.
#define FAUSTFLOAT double
// clang-format off
#include <faust/dsp/dsp.h>
#include <faust/gui/DecoratorUI.h>
#include <faust/gui/MapUI.h>
#include <faust/gui/UI.h>
#include <faust/gui/meta.h>
// clang-format on

#include "contactspline/host/faust_dsp.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <sstream>

#include "contactspline/instrument/instruments_of.hpp"
#include "hammer_string_double.hpp"
#include "shell.hpp"
#include "struck_c4.hpp"
#include "support/compare.hpp"
#include "support/real_time.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 44100;
constexpr std::size_t kSecond = 44100;
constexpr double kMass = 0.00297;

using StruckC4 = HammerStringOf<Felt, String, double>;

std::unique_ptr<dsp> wrapped() {
  return std::make_unique<InstrumentDsp<StruckC4>>();
}

// What the program of Faust calls the parameters.
const std::map<std::string, const char*> kNamesInFaust = {
    {"speed_m_per_s", "speed"},    {"hammer_mass_kg", "hammer mass"}, {"stiffness_ratio", "stiffness ratio"},
    {"loss_s_per_m", "felt loss"}, {"damping_per_s", "damping"},      {"strike_m", "strike position"}};
const double kLength_m = std::numbers::pi / String::wavenumbers[0];

class Player {
 public:
  explicit Player(std::unique_ptr<dsp> instrument) : instrument_(std::move(instrument)) {
    instrument_->init(kRate);
    instrument_->buildUserInterface(&controls_);
    if (is_faust())
      full_scale_n_ = 1;
    else
      set("strike_m", 0.12 * kLength_m);
  }
  /// label: that of our class.
  void set(const std::string& label, double value) {
    if (!is_faust() || label == "strike") return controls_.setParamValue(label, value);
    controls_.setParamValue(kNamesInFaust.at(label), label == "strike_m" ? value / kLength_m : value);
  }
  [[nodiscard]] bool is_faust() { return controls_.getParamZone("hammer mass") != nullptr; }
  [[nodiscard]] double full_scale_n() const { return full_scale_n_; }
  /// Displacement in mm, force over the full scale.
  void play(std::size_t samples, Sound& sound) {
    const std::size_t before = sound.force.size();
    sound.displacement.resize(before + samples);
    sound.force.resize(before + samples);
    double* outputs[] = {sound.displacement.data() + before, sound.force.data() + before};
    expect_real_time([&] { instrument_->compute(static_cast<int>(samples), nullptr, outputs); });
  }
  dsp& instrument() { return *instrument_; }

 private:
  std::unique_ptr<dsp> instrument_;
  MapUI controls_;
  double full_scale_n_ = 50;
};

Sound bare(std::size_t samples, double place_m = 0.12 * kLength_m) {
  constexpr auto& felt = segments_of<Felt, double>;
  HammerString<double, felt.size()> model(felt, modes_in<String>, ModeShapes<double>(String::strike_shapes), kRate);
  const auto pickup = model.string().sound_pickup(String::pickup_shapes);
  ModeShapes<double> shapes(String::modes);
  for (std::size_t i = 0; i < String::modes; ++i) shapes[i] = std::sin(String::wavenumbers[i] * place_m);
  model.strike_at(shapes);
  model.strike(2.5, 1e-4);
  Sound sound;
  for (std::size_t n = 0; n < samples; ++n) {
    model.tick({.hammer_mass_kg = kMass});
    sound.displacement.push_back(model.string().displacement(pickup) / 0.001);
    sound.force.push_back(model.force() / 50);
  }
  return sound;
}

TEST(HammerStringDsp, IsTheModelToTheLastBit) {
  Player player(wrapped());
  player.set("strike", 1);
  Sound sound;
  for (int block = 0; block < 100; ++block) player.play(441, sound);
  const Sound expected = bare(kSecond);
  EXPECT_GT(*std::ranges::max_element(expected.force), 0.2);
  EXPECT_EQ(sound.displacement, expected.displacement);
  EXPECT_EQ(sound.force, expected.force);
}

// Struck again and again, every control moved between the throws. Faust's displacement comes a sample later. Its
// strike position acts at once, that of C++ at the throw, so it is moved together with the throw.
TEST(HammerStringDsp, SoundsAsTheClassThatFaustWrites) {
  Player ours(wrapped()), faust(std::make_unique<hammer_string_double>());
  Sound found, expected;
  for (int i = 0; i < 12; ++i) {
    for (Player* player : {&ours, &faust}) {
      Sound& sound = player == &ours ? found : expected;
      player->set("strike", 0);
      player->set("damping_per_s", i % 3 == 2 ? 40 : 0);
      player->play(2000 + 37 * static_cast<std::size_t>(i), sound);
      player->set("speed_m_per_s", 1 + 0.3 * i);
      player->set("hammer_mass_kg", kMass * (1 + 0.1 * i));
      player->set("stiffness_ratio", 0.5 + 0.2 * i);
      player->set("loss_s_per_m", 0.03 * i);
      player->set("strike_m", (0.1 + 0.01 * i) * kLength_m);
      player->set("strike", 1);
      player->play(1500, sound);
    }
  }
  double peak_mm = 0, peak_n = 0;
  for (std::size_t n = 0; n < found.force.size(); ++n) {
    peak_mm = std::max(peak_mm, std::abs(found.displacement[n]));
    peak_n = std::max(peak_n, found.force[n]);
  }
  EXPECT_GT(peak_mm, 0.1);
  EXPECT_GT(peak_n, 0.2);
  for (double& force : expected.force) force /= ours.full_scale_n();
  const Sound earlier{{expected.displacement.begin() + 1, expected.displacement.end()}, {}};
  found.displacement.pop_back();
  EXPECT_TRUE(sequences_within<double>(found.displacement, earlier.displacement, 1e-9));
  EXPECT_TRUE(sequences_within<double>(found.force, expected.force, 1e-9));
}

// A control that is no number, while the others play: as if it had stayed. One out of range acts as the end of its
// slider. Everything is heard again when the control recovers, and init() is not needed.
TEST(HammerStringDsp, HoldsItsControlsInTheirRanges) {
  const auto played = [](const char* label, double value) {
    Player player(wrapped());
    Sound sound;
    for (int i = 0; i < 4; ++i) {
      player.set("strike", 0);
      player.play(100, sound);
      if (i == 2) player.set("damping_per_s", 0);
      if (i == 1) player.set(label, value);
      player.set("strike", 1);
      player.play(500, sound);
    }
    return sound.force;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto left_alone = played("speed_m_per_s", 2.5);
  for (const char* label : {"speed_m_per_s", "hammer_mass_kg", "stiffness_ratio", "loss_s_per_m", "strike_m"}) {
    EXPECT_EQ(played(label, nan), left_alone) << label;
    EXPECT_EQ(played(label, infinity), played(label, 1e30)) << label;
    EXPECT_EQ(played(label, -infinity), played(label, -1e30)) << label;
    EXPECT_NE(played(label, infinity), left_alone) << label;
  }
  EXPECT_EQ(played("speed_m_per_s", 1e30), played("speed_m_per_s", 10));
  EXPECT_EQ(played("strike_m", 1e30), played("strike_m", kLength_m));
  EXPECT_EQ(played("damping_per_s", nan), left_alone);
  EXPECT_EQ(played("damping_per_s", infinity), played("damping_per_s", 1000));
}

// A strike that is no number is no strike, and the next one is.
TEST(HammerStringDsp, IsStruckAfterAStrikeThatIsNoNumber) {
  Player player(wrapped());
  Sound sound;
  player.set("strike", std::numeric_limits<double>::quiet_NaN());
  player.play(500, sound);
  EXPECT_EQ(*std::ranges::max_element(sound.force), 0);
  player.set("strike", 1);
  player.play(500, sound);
  EXPECT_GT(*std::ranges::max_element(sound.force), 0.2);
}

/// What a host is told, line by line; zones by the order in which they come.
class Transcript : public GenericUI {
 public:
  void openVerticalBox(const char* label) override { text_ << "box " << label << '\n'; }
  void closeBox() override { text_ << "end\n"; }
  void addButton(const char* label, FAUSTFLOAT* zone) override { text_ << "button " << label << number(zone); }
  void addHorizontalSlider(const char* label, FAUSTFLOAT* zone, FAUSTFLOAT initial, FAUSTFLOAT min, FAUSTFLOAT max,
                           FAUSTFLOAT step) override {
    text_ << "slider " << label << ' ' << initial << ' ' << min << ' ' << max << ' ' << step << ' ' << *zone
          << number(zone);
  }
  void declare(FAUSTFLOAT* zone, const char* key, const char* value) override {
    text_ << key << '=' << value << number(zone);
  }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::string number(FAUSTFLOAT* zone) {
    return " #" + std::to_string(zones_.try_emplace(zone, zones_.size()).first->second) + '\n';
  }
  std::ostringstream text_;
  std::map<FAUSTFLOAT*, std::size_t> zones_;
};

// Each parameter is a slider of its name, unit, range and first value; each event a button.
TEST(HammerStringDsp, TellsHostsItsTable) {
  const auto told = [](dsp& instrument) {
    instrument.init(kRate);
    Transcript transcript;
    instrument.buildUserInterface(&transcript);
    return transcript.text();
  };
  const auto ours = wrapped();
  const std::string text = told(*ours);
  EXPECT_NE(text.find("button strike #"), std::string::npos) << text;
  for (const Parameter& parameter : StruckC4().parameters()) {
    std::ostringstream slider;
    slider << "slider " << parameter.name << ' ' << parameter.initial << ' ' << parameter.slider.min << ' '
           << parameter.slider.max << ' ' << slider_step(parameter) << ' ' << parameter.initial << " #";
    EXPECT_NE(text.find(slider.str()), std::string::npos) << slider.str() << " in\n" << text;
    const std::string unit = std::string("unit=") + parameter.unit + " #";
    EXPECT_TRUE(*parameter.unit == 0 || text.find(unit) != std::string::npos) << unit;
  }
  EXPECT_EQ(ours->getNumInputs(), 0);
  EXPECT_EQ(ours->getNumOutputs(), 2);
  EXPECT_EQ(ours->getSampleRate(), kRate);
  const std::unique_ptr<dsp> copy(ours->clone());
  EXPECT_EQ(told(*copy), text);
}

TEST(HammerStringDsp, IsSilentUntilItsThrowAndAfterItIsCleared) {
  Player player(wrapped());
  Sound sound;
  player.play(1000, sound);
  player.set("strike", 1);
  Sound first, second;
  player.play(2000, first);
  expect_real_time([&] { player.instrument().instanceClear(); });
  player.set("strike", 0);
  player.play(1000, sound);
  for (std::size_t n = 0; n < sound.force.size(); ++n) EXPECT_TRUE(sound.displacement[n] == 0 && sound.force[n] == 0);
  player.set("strike", 1);
  player.play(2000, second);
  EXPECT_EQ(first.displacement, second.displacement);
}

// plot.cpp, unmodified, prints so many digits that each number is read back as it was.
TEST(HammerStringDsp, IsTheModelInAnArchitectureFileOfFaust) {
  constexpr std::size_t kSamples = 3000;
  const Outcome outcome = run(PLOT " -strike 1 -n " + std::to_string(kSamples));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  std::istringstream numbers(outcome.output);
  Sound printed;
  for (std::string displacement, force; numbers >> displacement >> force;) {
    printed.displacement.push_back(std::stod(displacement));
    printed.force.push_back(std::stod(force));
  }
  const Sound expected = bare(kSamples, String::strike_position_m);
  EXPECT_EQ(printed.displacement, expected.displacement);
  EXPECT_EQ(printed.force, expected.force);
}

}  // namespace
}  // namespace contactspline::testing
