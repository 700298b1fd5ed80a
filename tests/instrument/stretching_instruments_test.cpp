// SPDX-License-Identifier: MIT
// The energy of random instrument files whose strings, membranes and plates stretch, and of a cymbal of 700 modes.
// With CONTACTSPLINE_FULL_TESTS set, 2,000 of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "../runtime/stretch_terms.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/input_file.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/random.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

// One to three bodies without losses and two masses: a hammer that strikes the first body, and contacts and springs
// between whatever there is.
class RandomFile {
 public:
  explicit RandomFile(std::uint64_t seed) : random_(seed) {
    rate = random_.log_between(8000, 192000);
    speed_m_per_s = random_.log_between(0.1, 100);
    const std::size_t count = 1 + random_.below(3);
    for (std::size_t b = 0; b < count; ++b) add_body(fmt::format("body_{}", b));
    for (const char* mass : {"hammer", "bolt"})
      bodies_ += fmt::format(R"({{ "name": "{}", "mass_kg": {} }}{})", mass, random_.log_between(1e-3, 1),
                             *mass == 'h' ? ", " : "");
    add("contacts", R"("between": ["hammer", "body_0_near"], "material": "felt_c4")");
    for (std::size_t k = random_.below(4); k > 0; --k) connect(count);
  }

  [[nodiscard]] std::string text() const {
    std::string all = R"({ "name": "probe", "bodies": [ )" + bodies_ + R"( ], "places": [ )" + places_ + " ]";
    for (const auto& [kind, list] : connections_)
      if (!list.empty()) all += fmt::format(R"(, "{}": [ {} ])", kind, list);
    return all + R"(, "strikes": ["hammer"], "outputs": [ { "name": "near", "displacement_m": "body_0_near" } ] })";
  }

  double rate, speed_m_per_s;

 private:
  void add_body(const std::string& name) {
    constexpr const char* kNoLoss = R"("constant_loss_per_s": 0, "quadratic_loss_m2_per_s": 0)";
    const std::size_t modes = 2 + random_.below(30), kind = random_.below(4);
    const double length = random_.log_between(0.1, 1), width = random_.between(0.3, 1) * length;
    std::string body;
    if (kind == 0) {
      const double core = random_.log_between(2e-4, 1.2e-3), mass = 7800 * 0.785 * core * core * length;
      body = fmt::format(R"("string": {{ "length_m": {}, "mass_kg": {}, "tension_n": {}, "bending_stiffness_n_m2": 0,
        {} }}, "stretch": {{ "youngs_modulus_pa": 2e11, "core_diameter_m": {}{} }})",
                         length, mass, 4 * length * mass * std::pow(random_.log_between(40, 600), 2), kNoLoss, core,
                         random_.once_in(2) ? "" : R"(, "longitudinal": { "modes": 6, "constant_loss_per_s": 10 })");
    } else if (kind == 1) {
      body = fmt::format(R"("membrane": {{ "radius_m": {}, "mass_per_area_kg_m2": {}, "tension_n_per_m": {}, {} }},
        "stretch": {{ "youngs_modulus_pa": 4e9, "thickness_m": {}, "poisson_ratio": 0.38 }})",
                         length, random_.between(0.1, 0.6), random_.log_between(200, 4000), kNoLoss,
                         random_.log_between(1e-4, 4e-4));
    } else {
      const std::string metal =
          fmt::format(R"("thickness_m": {}, "density_kg_m3": {}, "youngs_modulus_pa": {}, "poisson_ratio": {}, {})",
                      length * random_.log_between(1e-3, 1e-2), random_.between(2000, 9000),
                      random_.log_between(1e10, 2e11), random_.between(0, 0.45), kNoLoss);
      const std::size_t functions = 1 + random_.below(10);
      const bool other = random_.once_in(2);
      if (kind == 2)
        body = fmt::format(R"("plate": {{ "length_m": {}, "width_m": {}, {} }},
          "stretch": {{ "airy_functions": {}, "edges": "{}" }})",
                           length, width, metal, functions, other ? "free" : "fixed");
      else
        body = fmt::format(R"("round_plate": {{ "radius_m": {}, {}, "rim": "{}", "symmetries": "{}" }},
          "stretch": {{ "airy_functions": {} }})",
                           length / 2, metal, other ? "free" : "clamped", random_.once_in(2) ? "one" : "both",
                           functions);
    }
    bodies_ += fmt::format(R"({{ "name": "{}", "max_modes": {}, {} }}, )", name, modes, body);
    for (const char* place : {"near", "far"}) {
      const double at = random_.between(0.03, 0.47) * length;
      std::string side;
      if (kind == 2) side = fmt::format(R"(, "across_m": {})", random_.between(0.05, 0.95) * width);
      if (kind == 1 || kind == 3) side = fmt::format(R"(, "angle_rad": {})", random_.between(-3, 3));
      places_ += fmt::format(R"({}{{ "name": "{}_{}", "body": "{}", "position_m": {}{} }})",
                             places_.empty() ? "" : ", ", name, place, name, at, side);
    }
  }

  // A place of a body, the bolt or the ground, with a place of another body.
  void connect(std::size_t bodies) {
    const std::size_t first = random_.below(bodies), second = random_.below(bodies + 2);
    if (first == second) return;
    const std::string end = fmt::format("body_{}_{}", first, random_.once_in(2) ? "near" : "far");
    const std::string other = second == bodies       ? std::string("bolt")
                              : second == bodies + 1 ? std::string("ground")
                                                     : fmt::format("body_{}_far", second);
    const std::string between = fmt::format(R"("between": ["{}", "{}"])", end, other);
    if (random_.once_in(3))
      add("springs", fmt::format(R"({}, "stiffness_n_per_m": {})", between, random_.log_between(10, 1e6)));
    else
      add("contacts",
          fmt::format(R"({}, "material": "{}", "gap_m": {})", between,
                      random_.once_in(2) ? "rubber_on_wood" : "felt_c4", random_.log_between(1e-6, 1e-2)));
  }

  void add(const std::string& kind, const std::string& what) {
    std::string& list = kind == "springs" ? connections_[1].second : connections_[0].second;
    list += fmt::format(R"({}{{ "name": "join_{}", {} }})", list.empty() ? "" : ", ", joins_++, what);
  }

  Random random_;
  std::string bodies_, places_;
  std::vector<std::pair<std::string, std::string>> connections_ = {{"contacts", ""}, {"springs", ""}};
  int joins_ = 0;
};

struct Balance {
  double error = 0, bound = 0;  ///< of the energy, in parts of its peak
  double stretching = 0;        ///< largest part of the energy in stretching
};

// The energy of all forms over the last two samples, and what it were if all terms had one sign.
template <typename T>
class Stretching {
 public:
  explicit Stretching(std::vector<std::vector<StretchForm>> forms) : forms_(std::move(forms)), last_(forms_.size()) {}

  void follow(const SeenNetwork<T>& instrument) {
    stored = of_terms = 0;
    for (std::size_t b = 0; b < forms_.size(); ++b) {
      const auto now = instrument.displacements(b);
      std::vector<double>& before = last_[b];
      before.resize(now.size());
      of_terms += energy_of_terms<T>(forms_[b], now);
      for (const StretchForm& form : forms_[b]) {
        const auto& [mode, per_m] = form.linear;
        double stretch = per_m == 0 ? 0 : per_m * (before[mode] + double(now[mode])) / 2;
        for (std::size_t i = 0; i < now.size(); ++i) stretch += form.squares_per_m2[i] * before[i] * double(now[i]);
        for (const auto& [i, j, factor] : form.products)
          stretch += factor * (before[i] * double(now[j]) + before[j] * double(now[i]));
        stored += form.stiffness_j / 4 * stretch * stretch;
      }
      before.assign(now.begin(), now.end());
    }
  }

  double stored = 0, of_terms = 0;

 private:
  std::vector<std::vector<StretchForm>> forms_;
  std::vector<std::vector<double>> last_;
};

// The forms of each body of the arrays.
std::vector<std::vector<StretchForm>> forms_of(const InstrumentArrays& arrays) {
  std::vector<std::vector<StretchForm>> forms(arrays.body_ends.size());
  auto square = arrays.stretch_squares.begin();
  auto product = arrays.stretch_products.begin();
  for (const InstrumentForm& form : arrays.stretch_forms) {
    const std::size_t modes = arrays.body_ends[form.body] - (form.body == 0 ? 0 : arrays.body_ends[form.body - 1]);
    StretchForm& read = forms[form.body].emplace_back(StretchForm{form.stiffness_j, {}, {}, form.linear});
    for (std::size_t i = 0; i < modes; ++i) read.squares_per_m2.push_back(*square++);
    for (std::size_t i = 0; i < form.products; ++i) read.products.push_back(*product++);
  }
  return forms;
}

template <typename T>
Balance balance_of(const InstrumentArrays& arrays, double rate, double speed_m_per_s, int samples) {
  Stretching<T> stretching(forms_of(arrays));
  SeenNetwork<T> instrument(arrays.view(), rate);
  long double received = instrument.energy();
  instrument.strike(0, static_cast<T>(speed_m_per_s));
  double peak = 0, of_terms = 0;
  Balance balance;
  for (int n = 0; n < samples; ++n) {
    instrument.tick();
    received += static_cast<long double>(instrument.work()) - instrument.dissipated();
    const double energy = instrument.energy(), error = std::abs(static_cast<double>(energy - received));
    if (!is_finite(error)) return {std::numeric_limits<double>::infinity(), 0, 0};
    balance.error = std::max(balance.error, error);
    peak = std::max(peak, energy);
    stretching.follow(instrument);
    of_terms = std::max(of_terms, stretching.of_terms);
    balance.stretching = std::max(balance.stretching, stretching.stored / energy);
  }
  balance.error /= peak;
  balance.bound = rounding_bound<T>(samples, of_terms, peak);
  EXPECT_EQ(instrument.bounded(), 0U);
  return balance;
}

TEST(StretchingInstruments, KeepTheirEnergy) {
  const unsigned count = std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr ? 2000 : 150;
  double worst = 0, worst_in_single = 0, stretching = 0;
  unsigned cancelling = 0, mostly = 0;
  for (unsigned seed = 0; seed < count; ++seed) {
    const RandomFile file(seed);
    const InstrumentArrays arrays = arrays_of(parse_instrument(file.text(), "probe.json"), file.rate / 2);
    const Balance balance = balance_of<double>(arrays, file.rate, file.speed_m_per_s, 500);
    const bool cancels = balance.bound > 1e-12;
    EXPECT_TRUE(within(balance.error, 0, cancels ? balance.bound : 1e-12)) << "file " << seed << ": " << file.text();
    cancelling += cancels;
    mostly += balance.stretching > 0.5;
    if (!cancels) worst = std::max(worst, balance.error);
    stretching = std::max(stretching, balance.stretching);
    const Balance in_single = balance_of<float>(arrays, file.rate, file.speed_m_per_s, 500);
    EXPECT_TRUE(is_finite(in_single.error)) << "file " << seed;
    worst_in_single = std::max(worst_in_single, in_single.error);
  }
  Measured() << "largest error of the energy " << worst << ", in single precision " << worst_in_single << "; "
             << cancelling << " whose terms cancel; up to " << stretching
             << " of the energy in stretching, more than half of it in " << mostly;
  EXPECT_GT(mostly, count / 10);
  EXPECT_LT(cancelling, count / 20);
}

// The crash cymbal among the examples, within its blow, without losses.
TEST(StretchingInstruments, KeepTheirEnergyWithHundredsOfModes) {
  InstrumentModel crash = parse_instrument(read_input(EXAMPLES_FOLDER "/crash.json"), "crash.json");
  std::get<RoundPlate>(crash.bodies[0].resonator.body).losses = {0, 0};
  crash.outputs.clear();
  const InstrumentArrays arrays = arrays_of(crash, 22050);
  EXPECT_EQ(arrays.body_ends[0], 700U);
  const Balance balance = balance_of<double>(arrays, 44100, 10, 800);
  Measured() << "error of the energy " << balance.error << ", bound " << balance.bound << ", up to "
             << balance.stretching << " of it in stretching";
  EXPECT_TRUE(within(balance.error, 0, 1e-12));
  EXPECT_GT(balance.stretching, 0.1);
}

}  // namespace
}  // namespace contactspline::testing
