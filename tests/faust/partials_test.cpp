// SPDX-License-Identifier: MIT
// The partials that sound after a stroke on C4, against the formula of the stiff string: C++ and Faust, both
// precisions.
#include <complex>
#include <numbers>

#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "cpp_program.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

#define FAUSTFLOAT double
#include "hammer_string_double.hpp"
#undef FAUSTFLOAT
#define FAUSTFLOAT float
#include "hammer_string_single.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

constexpr int kRate = 44100;
constexpr std::size_t kSamples = 88200;
constexpr std::size_t kBegin = 2205;  // the hammer is long gone

/// Partial of data/resonators/string_c4.json, straight from its physical parameters.
struct Partial {
  double frequency_hz, decay_per_s, shapes;
};

Partial partial_of_c4(int i) {
  const double length = 0.62, mass = 0.00393, tension = 670, bending = 0.00983833;
  const double beta = i * pi / length;
  const double decay = 0.5 + 1e-4 * beta * beta;
  const double square = (tension * beta * beta + bending * std::pow(beta, 4)) * length / mass;
  return {std::sqrt(square - decay * decay) / (2 * pi), decay, std::sin(beta * 0.0744) * std::sin(beta * 0.248)};
}

double cents(double n) {
  return std::exp2(n / 1200) - 1;
}

/// Finds single partials in a sum of decaying ones. A window slides over the signal: what it sees of a partial z^n
/// turns and falls by exactly z per sample, so that the ratio of two views kShift apart is z^kShift, whatever the
/// window. Other partials, 260 Hz or more away, leak by the window's side lobes: below -200 dB for the Kaiser window
/// of shape 24 over 1 s, 8 Hz to each side. A whole turn of the ratio is 44 Hz, which that window does not let
/// through.
class Analyser {
 public:
  static constexpr std::size_t kShift = 1000;
  static constexpr double kShiftSeconds = static_cast<double>(kShift) / kRate;

  explicit Analyser(std::vector<double> signal) : signal_(std::move(signal)), window_(kWindow) {
    constexpr double kShape = 24;
    for (std::size_t n = 0; n < kWindow; ++n) {
      const double x = 2 * (static_cast<double>(n) + 0.5) / kWindow - 1;
      window_[n] = std::cyl_bessel_i(0, kShape * std::sqrt(1 - x * x)) / std::cyl_bessel_i(0, kShape);
    }
  }

  struct Found {
    double frequency_hz, decay_per_s, amplitude;
  };
  [[nodiscard]] Found near(double frequency_hz) const {
    const auto first = view(frequency_hz, kBegin), second = view(frequency_hz, kBegin + kShift);
    const auto ratio = second / first;
    return {frequency_hz + std::arg(ratio) / (2 * pi * kShiftSeconds), -std::log(std::abs(ratio)) / kShiftSeconds,
            std::abs(first)};
  }

 private:
  static constexpr std::size_t kWindow = 44100;

  // The signal turned back by the frequency, so that a partial there stands nearly still.
  [[nodiscard]] std::complex<double> view(double frequency_hz, std::size_t begin) const {
    const double angle = 2 * pi * frequency_hz / kRate;
    std::complex<double> sum = 0;
    for (std::size_t n = 0; n < kWindow; ++n)
      sum += window_[n] * signal_[begin + n] * std::polar(1.0, -angle * static_cast<double>(begin + n));
    return sum / static_cast<double>(kWindow);
  }

  std::vector<double> signal_, window_;
};

template <typename T>
std::vector<double> struck() {
  using String = resonators::string_c4;
  const ModeShapes<T> pickup(String::pickup_shapes);
  HammerString<T> model(std::span<const Segment<T>>(segments_of<materials::felt_c4, T>), modes_in<String>,
                        ModeShapes<T>(String::strike_shapes), kRate);
  model.strike(T(2.5), T(1e-4));
  std::vector<double> sound;
  for (std::size_t n = 0; n < kSamples; ++n) {
    model.tick({.hammer_mass_kg = T(0.00297)});
    sound.push_back(1000 * static_cast<double>(model.string().displacement(pickup)));
  }
  return sound;
}

template <typename Dsp, typename T>
std::vector<double> struck_in_faust() {
  CppProgram<Dsp, T> program(kRate);
  program.set("strike", 1);
  const auto outputs = program.run({}, kSamples);
  return {outputs[0].begin(), outputs[0].end()};
}

struct Rendering {
  const char* name;
  std::vector<double> (*sound)();
  double min_reach_hz;  ///< up to here at least every partial stands out of the noise
};

class PartialsOfC4 : public ::testing::TestWithParam<Rendering> {};

// A noise of the size n in a view turns a partial of amplitude a by n/a at most, the ratio by twice that. A partial
// is judged where this leaves its frequency sure to 0.02 cent; the noise is the largest view between it and its
// neighbours.
TEST_P(PartialsOfC4, AreWithinATenthOfACentOfTheory) {
  const Analyser analyser(GetParam().sound());
  double highest_hz = 0, worst_cents = 0, worst_decay = 0;
  int judged = 0;
  for (int i = 1; i <= 56; ++i) {
    const Partial theory = partial_of_c4(i);
    if (std::abs(theory.shapes) < 1e-6) continue;  // strike or pickup at a node
    const auto found = analyser.near(theory.frequency_hz);
    double noise = 0;
    for (const double away : {-130, -100, 100, 130})
      noise = std::max(noise, analyser.near(theory.frequency_hz + away).amplitude);
    const double sure_to_hz = 2 * noise / found.amplitude / (2 * pi * Analyser::kShiftSeconds);
    if (sure_to_hz > cents(0.02) * theory.frequency_hz) {
      EXPECT_GT(theory.frequency_hz, GetParam().min_reach_hz);
      continue;
    }
    ++judged;
    highest_hz = theory.frequency_hz;
    EXPECT_TRUE(relatively_within(found.frequency_hz, theory.frequency_hz, cents(0.1))) << "partial " << i;
    worst_cents = std::max(worst_cents, std::abs(1200 * std::log2(found.frequency_hz / theory.frequency_hz)));
    if (i <= 20) worst_decay = std::max(worst_decay, std::abs(found.decay_per_s / theory.decay_per_s - 1));
  }
  EXPECT_TRUE(within(worst_decay, 0, 1e-3));
  Measured() << GetParam().name << ": " << judged << " partials up to " << highest_hz << " Hz within " << worst_cents
             << " cent of theory, the decay of the lowest 20 within " << worst_decay << " of theirs";
}

INSTANTIATE_TEST_SUITE_P(
    Renderings, PartialsOfC4,
    ::testing::Values(Rendering{"CppDouble", struck<double>, 21000}, Rendering{"CppFloat", struck<float>, 10000},
                      Rendering{"FaustDouble", struck_in_faust<hammer_string_double, double>, 21000},
                      Rendering{"FaustFloat", struck_in_faust<hammer_string_single, float>, 10000}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace contactspline::testing
