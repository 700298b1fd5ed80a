// SPDX-License-Identifier: MIT
// The sliders of the Faust instruments, moved at random and one at a time: nothing blows up, nothing clicks.
#include <map>
#include <memory>
#include <random>

#include "cpp_program.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

#define FAUSTFLOAT double
#include "fret_string_ui.hpp"
#include "hammer_string_double.hpp"
#include "slide_string_ui.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 44100;
constexpr std::size_t kAfter = 2205;  // 50 ms

// The sharpest edge that counts as no click, against the note's peak: a step of a thousandth, and no sharper than a
// pluck makes by itself (-60 to -65 dB).
constexpr double kNoClick = 1e-3;

/// A slider and where it may go.
struct Slider {
  const char* label;
  double low, high;
  bool is_logarithmic = false;
  bool is_for_the_next_throw = false;  ///< not to be moved while the hammer touches the string
};

struct Instrument {
  const char* name;
  std::unique_ptr<FaustProgram<double>> (*make)();
  const char* trigger;
  std::vector<Slider> sliders;
  double largest_mm;  ///< largest displacement at the pickup
  std::map<std::string, double> at_first = {};
};

template <typename Dsp>
std::unique_ptr<FaustProgram<double>> make() {
  return std::make_unique<CppProgram<Dsp, double>>(kRate);
}

// Largest displacements: twice what the hardest blow, 50 g at 10 m/s, can bend C4 at the pickup, sqrt(2 E C) = 33 mm
// with the compliance C = 0.24 L/T; what all forces at once bend a guitar string in the middle, C = L/(4 T) = 2.2
// mm/N.
std::vector<Instrument> instruments() {
  return {{"HammerString",
           make<hammer_string_double>,
           "strike",
           {{"speed", 0.05, 10, true},
            {"hammer mass", 0.0005, 0.05, true},
            {"stiffness ratio", 0.001, 1000, true},
            {"felt loss", 0, 2},
            {"damping", 0, 1000},
            {"strike position", 0.01, 0.99, false, true}},
           66},
          {"SlideString",
           make<slide_string_ui>,
           "pluck",
           {{"pluck force", 0, 5},
            {"place", 0.02, 0.98},
            {"vibrato depth", 0, 10},
            {"vibrato rate", 0.1, 10},
            {"hand force", -2, 10},
            {"slide mass", 0.001, 0.2, true},
            {"hand stiffness", 0, 10000},
            {"hand resistance", 0, 20},
            {"damping behind the slide", 0, 20},
            {"stiffness ratio", 0.001, 1000, true},
            {"contact loss", 0, 2}},
           33},
          {"FretString",
           make<fret_string_ui>,
           "pluck",
           {{"pluck force", 0, 10},
            {"place", 0.01, 0.99},
            {"gap", -2, 5},
            {"damping", 0, 1000},
            {"stiffness ratio", 0.001, 1000, true},
            {"contact loss", 0, 2}},
           27,
           {{"gap", -0.5}}}};
}

class Player {
 public:
  double somewhere(const Slider& slider) {
    if (slider.is_logarithmic) return std::exp(between(std::log(slider.low), std::log(slider.high)));
    return between(slider.low, slider.high);
  }
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }

 private:
  std::mt19937 engine_{7};
};

class FaustLiveControl : public ::testing::TestWithParam<int> {
 protected:
  const Instrument instrument = instruments()[static_cast<std::size_t>(GetParam())];
};

TEST_P(FaustLiveControl, OfAllSlidersAtRandomStaysBounded) {
  const auto program = instrument.make();
  Player player;
  double largest = 0;
  for (std::size_t n = 0; n < 20 * kRate;) {
    const Slider& slider =
        instrument
            .sliders[static_cast<std::size_t>(player.between(0, static_cast<double>(instrument.sliders.size())))];
    program->set(slider.label, player.somewhere(slider));
    program->set(instrument.trigger, player.between(0, 1) < 0.3);
    const auto samples = static_cast<std::size_t>(player.between(1, 1000));
    n += samples;
    const auto outputs = program->run({}, samples);
    for (const double u : outputs.front()) {
      ASSERT_TRUE(std::isfinite(u));
      largest = std::max(largest, std::abs(u));
    }
  }
  Measured() << instrument.name << ": at most " << largest << " mm";
  EXPECT_LE(largest, instrument.largest_mm);
}

/// The sharpest edge in a signal: the fourth difference, which passes little of what is slow, and 3 h at most of a
/// step h.
double sharpest_edge(const std::vector<double>& u) {
  double sharpest = 0;
  for (std::size_t n = 4; n < u.size(); ++n)
    sharpest = std::max(sharpest, std::abs(u[n] - 4 * u[n - 1] + 6 * u[n - 2] - 4 * u[n - 3] + u[n - 4]) / 3);
  return sharpest;
}

/// The edge that a move makes, over the note's peak. Two programs play the same note, one of them with the move.
/// Edges that the notes have themselves do not count: where a move shifts the high partials, the difference has those
/// of both. A contact made or broken by the move ends the comparison: that is a sound of its own.
double edge_of_a_move(const Instrument& instrument, const Slider& slider, Player& player) {
  const auto still = instrument.make(), moved = instrument.make();
  const double moment = slider.is_for_the_next_throw ? player.between(4000, 9000) : player.between(20, 9000);
  std::vector<double> note;
  for (auto* program : {still.get(), moved.get()}) {
    for (const auto& [label, value] : instrument.at_first) program->set(label, value);
    program->set(instrument.trigger, 1);
    note = program->run({}, static_cast<std::size_t>(moment)).front();
  }
  moved->set(slider.label, player.somewhere(slider));
  const auto a = still->run({}, kAfter), b = moved->run({}, kAfter);
  note.insert(note.end(), a[0].begin(), a[0].end());
  double peak = 0;
  for (const double u : note) peak = std::max(peak, std::abs(u));
  const bool touches = a[1].front() > 0;
  std::vector<double> note_from_here(3), difference(3);
  for (std::size_t n = 0; n < kAfter && (a[1][n] > 0) == touches && (b[1][n] > 0) == touches; ++n) {
    note_from_here.push_back(a[0][n]);
    difference.push_back(b[0][n] - a[0][n]);
  }
  note_from_here.erase(note_from_here.begin(), note_from_here.begin() + 3);  // its beginning is no edge
  return std::max(0.0, sharpest_edge(difference) - 2 * sharpest_edge(note_from_here)) / peak;
}

TEST_P(FaustLiveControl, MakesNoClick) {
  Player player;
  for (const Slider& slider : instrument.sliders) {
    double worst = 0;
    for (int trial = 0; trial < 8; ++trial) worst = std::max(worst, edge_of_a_move(instrument, slider, player));
    EXPECT_TRUE(within(worst, 0, kNoClick)) << slider.label;
    Measured() << instrument.name << ", " << slider.label << ": " << 20 * std::log10(worst) << " dB";
  }
}

INSTANTIATE_TEST_SUITE_P(Instruments, FaustLiveControl, ::testing::Values(0, 1, 2),
                         [](const auto& test) { return instruments()[static_cast<std::size_t>(test.param)].name; });

}  // namespace
}  // namespace contactspline::testing
