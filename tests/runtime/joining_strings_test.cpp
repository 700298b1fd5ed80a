// SPDX-License-Identifier: MIT
// Strings that join and leave a bridge of one place or several, in parts and with bends, while they sound: the
// balance of the energy.
#include <numbers>
#include <numeric>
#include <random>

#include "contactspline/models/body.hpp"
#include "energy.hpp"
#include "strings_on_body.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr std::size_t kKeys = 20;
constexpr std::size_t kLine = 8;  // modes, which the kernels advance together

constexpr int kLargestBend = 200;  // cents

// Below it modes stay below half the sample rate under all bends.
double highest_hz(double rate) {
  return std::min(22050.0, rate / 2 * std::exp2(-kLargestBend / 1200.0));
}

/// Struck strings without loss, `semitones` above C4: one, two or three of them.
StruckString strings_above_c4(int semitones) {
  StruckString struck = c4();
  struck.string.losses = {0, 0};
  struck.string.length_m *= std::exp2(-semitones / 12.0);
  struck.string.detuning_cents.clear();
  for (int s = 0; s <= semitones % 3; ++s) struck.string.detuning_cents.push_back(0.7 * s);
  return struck;
}

/// A key of which the lowest modes are on the bridge. A mode that joins follows the bridge at once and brings what
/// moves: (change of the bridge)^2 K/(2 |1 - z|^2) without loss, K = 2 (T + EI beta^2)/L.
class JoiningKey {
 public:
  JoiningKey(const StruckString& struck, SegmentTable<double> felt, double rate, std::size_t place)
      : JoiningKey(struck, felt, rate, place, modes_below(struck.string, highest_hz(rate), 30)) {}

  [[nodiscard]] std::size_t size() const { return stiffness_.size(); }
  [[nodiscard]] std::size_t place() const { return place_; }
  [[nodiscard]] std::size_t joined() const { return joined_; }
  [[nodiscard]] bool is_struck() const { return model_.is_hammer_flying(); }
  [[nodiscard]] double energy() const {
    double energy = hammer_energy();
    for (std::size_t i = 0; i < joined_; ++i) energy += model_.string().energy(i);
    return energy;
  }

  /// Puts the lowest `count` modes onto the bridge, and only these.
  void join(std::size_t count, Body<double>& body, EnergyBooks& books) {
    if (count > joined_) {
      const double change = body.change(place_), stiffness = model_.follow(bridge_, joined_, count, change);
      EXPECT_TRUE(relatively_within(stiffness, sum(stiffness_, joined_, count), 1e-12));
      body.join(stiffness, place_);
      books.work += change * change * sum(work_per_m2_, joined_, count);
    } else {
      for (std::size_t i = count; i < joined_; ++i) books.dissipated += model_.string().energy(i);
      const double left = model_.stiffness_on(bridge_, count, joined_),
                   force = model_.bridge_force(bridge_, count, joined_);
      const double change = body.change(place_);  // which they have not followed
      books.dissipated += (left / 2 * change - force) * change;
      body.leave(left, force, place_);
    }
    joined_ = count;
  }

  /// Changes the tension. The modes keep displacement and velocity, so the work is that on their stiffness and on the
  /// ends of the strings: (k' - k) r^2/2 each, (T' - T)/L w^2/2, and what the change c of the bridge, which they have
  /// not followed, adds: (K' - K) c^2/2 - (F' - F) c.
  void bend(double cents, Body<double>& body, EnergyBooks& books) {
    std::vector<Mode> modes;
    for (const StringMode& row : rows_) modes.push_back(retuned(string_, row, cents));
    for (std::size_t i = 0; i < joined_; ++i)
      books.work += (contactspline::stiffness_of(modes[i]) - contactspline::stiffness_of(tuned_[i])) *
                    std::pow(model_.string().displacement(i), 2) / 2;
    const double stiffness = model_.stiffness_on(bridge_, 0, joined_),
                 force = model_.bridge_force(bridge_, 0, joined_);
    model_.retune(tuned_ = modes);
    tune_bridge();
    const double gained = model_.stiffness_on(bridge_, 0, joined_) - stiffness,
                 pulled = model_.bridge_force(bridge_, 0, joined_) - force,
                 ends = ends_ * (std::exp2(cents / 600) - std::exp2(cents_ / 600));
    const double w = body.displacement(place_), change = body.change(place_);
    books.work += ends * w * w / 2 + (gained / 2 * change - pulled) * change;
    body.retune({ends, gained}, pulled, place_);
    cents_ = cents;
  }

  void strike(EnergyBooks& books) {
    const double before = hammer_energy();
    model_.strike(2, 1e-4);
    books.work += hammer_energy() - before;
  }

  /// Plays a sample, by tick() where all modes are on the bridge, else by the code of the kernels or its portable
  /// twin. Returns the force on the bridge [N].
  double tick(double damping_per_s, double change, EnergyBooks& books) {
    if (joined_ < size()) {
      const auto strings = model_.on_bridge(bridge_, joined_, 1);
      return detail::kernels<double>.advance_on_bridge(std::span(&strings, 1), change).all;
    }
    const double force = model_.tick({.hammer_mass_kg = kMass_kg, .damping_per_s = damping_per_s}, bridge_, change);
    if (has_losses()) books.dissipated += model_.string().dissipated();
    return force;
  }

 private:
  static constexpr double kMass_kg = 0.003;

  JoiningKey(const StruckString& struck, SegmentTable<double> felt, double rate, std::size_t place,
             std::vector<StringMode> rows)
      : rate_(rate),
        place_(place),
        string_(struck.string),
        ends_(bridge_stiffness(string_, std::vector<StringMode>()).ends),
        rows_(std::move(rows)),
        tuned_(bare(rows_)),
        felt_(felt),
        model_(felt, tuned_, Strings(struck, struck.string.detuning_cents, 30, highest_hz(rate)).strike, rate),
        stiffness_(rows_.size()),
        work_per_m2_(rows_.size()) {
    tune_bridge();
  }

  void tune_bridge() {
    ModeShapes<double> shapes(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double sine = std::sin(tuned_[i].angular_frequency_rad_per_s / (2 * rate_));
      shapes[i] = bridge_shape(string_, StringMode{tuned_[i], rows_[i].wavenumber_per_m});
      stiffness_[i] = shapes[i] * shapes[i] / contactspline::stiffness_of(tuned_[i]);
      work_per_m2_[i] = stiffness_[i] / (8 * sine * sine);
    }
    bridge_ = model_.bridge(shapes);
  }

  static double sum(const std::vector<double>& values, std::size_t first, std::size_t last) {
    return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(first),
                           values.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
  }
  [[nodiscard]] double hammer_energy() const {
    return kMass_kg * std::pow(model_.hammer_velocity(), 2) / 2 + potential(felt_, model_.compression());
  }

  double rate_;
  std::size_t place_;
  StiffString string_;
  double ends_, cents_ = 0;
  std::vector<StringMode> rows_;
  std::vector<Mode> tuned_;
  SegmentTable<double> felt_;
  HammerString<double> model_;
  BridgeShapes<double> bridge_;
  std::vector<double> stiffness_, work_per_m2_;  // of each mode; work_per_m2_: for a change of one metre
  std::size_t joined_ = 0;
};

/// Twenty keys at some places of a board: keys join and leave at random, are struck, bend their strings, and ring
/// with and without dampers.
class JoiningKeys {
 public:
  JoiningKeys(double rate, std::size_t places)
      : felt_(table_in<double>(felt_table(c4(), 32))), body_(body(rate, places)) {
    for (std::size_t k = 0; k < kKeys; ++k)
      keys_.emplace_back(strings_above_c4(static_cast<int>(k)), SegmentTable<double>(felt_), rate, k % places);
  }

  void tick() {
    const auto work = books_.work, dissipated = books_.dissipated;
    join_and_leave();
    brought_ += static_cast<double>(books_.work - work);
    if (sample_ % 997 == 0)
      any_key().bend(static_cast<double>(below(2 * kLargestBend + 1)) - kLargestBend, body_, books_);
    taken_ += static_cast<double>(books_.dissipated - dissipated);
    if (sample_ % 1201 == 0) {
      JoiningKey& key = any_key();
      key.join(key.size(), body_, books_);
      key.strike(books_);
    }
    play();
    ++sample_;
  }

  [[nodiscard]] const EnergyBooks& books() const { return books_; }
  /// Energy that came with modes that joined, and that went with those that left [J].
  [[nodiscard]] double brought() const { return brought_; }
  [[nodiscard]] double taken() const { return taken_; }

 private:
  static Body<double> body(double rate, std::size_t places) {
    std::vector<BridgeStiffness> at_rest(places);
    for (std::size_t k = 0; k < kKeys; ++k)
      at_rest[k % places] +=
          bridge_stiffness(strings_above_c4(static_cast<int>(k)).string, std::vector<StringMode>());
    return {bare(board(60)), bridge_of_board<double>(60, places), at_rest, rate};
  }

  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  JoiningKey& any_key() { return keys_[below(kKeys)]; }

  void join_and_leave() {
    if (sample_ % 97 == 0) {
      JoiningKey& key = any_key();
      if (!key.is_struck()) key.join(std::min(kLine * below(13), key.size()), body_, books_);
    }
    if (sample_ % 5000 == 0)
      for (auto& key : keys_)
        if (key.is_struck() || key.joined() < 10) key.join(key.size(), body_, books_);
  }

  void play() {
    const bool is_pedal_down = sample_ / 7001 % 2 == 0;
    double stored = 0;
    std::vector<double> forces(body_.places());
    for (auto& key : keys_) {
      const double damping = has_losses() && !is_pedal_down && !key.is_struck() ? 60 : 0;
      forces[key.place()] += key.tick(damping, body_.change(key.place()), books_);
      stored += key.energy();
    }
    body_.tick(forces);
    books_.dissipated += body_.modes().dissipated();
    books_.close(stored + body_.energy());
  }

  std::vector<Segment<double>> felt_;
  std::vector<JoiningKey> keys_;
  Body<double> body_;
  EnergyBooks books_;
  std::mt19937_64 random_{11};
  int sample_ = 0;
  double brought_ = 0, taken_ = 0;
};

class JoiningStrings : public ::testing::TestWithParam<std::tuple<double, std::size_t>> {};

// Bound: 1e-12 of the largest energy.
TEST_P(JoiningStrings, BalanceTheirEnergy) {
  const auto [rate, places] = GetParam();
  JoiningKeys keys(rate, places);
  for (int n = 0; n < static_cast<int>(2 * rate); ++n) keys.tick();
  const EnergyBooks& books = keys.books();
  Measured() << rate << " Hz, " << places << " places: " << books.worst / books.peak
             << " of the largest energy; joins brought " << keys.brought() / books.peak << ", leaves took "
             << keys.taken() / books.peak << " of it";
  EXPECT_GT(keys.brought(), 1e-9 * books.peak);
  EXPECT_GT(keys.taken(), 0.01 * books.peak);
  EXPECT_TRUE(within(books.worst, 0, 1e-12 * books.peak));
}

INSTANTIATE_TEST_SUITE_P(Rates, JoiningStrings,
                         ::testing::Combine(::testing::Values(22050.0, 44100.0, 96000.0),
                                            ::testing::Values(1, kMaxBridgePlaces)));

}  // namespace
}  // namespace contactspline::testing
