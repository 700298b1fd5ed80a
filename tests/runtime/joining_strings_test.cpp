// SPDX-License-Identifier: MIT
// Strings that join and leave a bridge in parts while they sound: the balance of the energy.
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
  JoiningKey(const StruckString& struck, SegmentTable<double> felt, double rate)
      : JoiningKey(struck, felt, rate, modes_below(struck.string, std::min(22050.0, rate / 2), 30)) {}

  [[nodiscard]] std::size_t size() const { return stiffness_.size(); }
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
      const double stiffness = model_.follow(bridge_, joined_, count, body.change());
      EXPECT_TRUE(relatively_within(stiffness, sum(stiffness_, joined_, count), 1e-12));
      body.join(stiffness);
      books.work += body.change() * body.change() * sum(work_per_m2_, joined_, count);
    } else {
      for (std::size_t i = count; i < joined_; ++i) books.dissipated += model_.string().energy(i);
      const double left = model_.stiffness_on(bridge_, count, joined_),
                   force = model_.bridge_force(bridge_, count, joined_);
      books.dissipated +=
          (left / 2 * body.change() - force) * body.change();  // the change that they have not followed
      body.leave(left, force);
    }
    joined_ = count;
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
      return detail::advance_strings<double>(std::span(&strings, 1), change).all;
    }
    const double force = model_.tick({.hammer_mass_kg = kMass_kg, .damping_per_s = damping_per_s}, bridge_, change);
    if (kHasLosses) books.dissipated += model_.string().dissipated();
    return force;
  }

 private:
  static constexpr double kMass_kg = 0.003;

  JoiningKey(const StruckString& struck, SegmentTable<double> felt, double rate, const std::vector<StringMode>& rows)
      : felt_(felt),
        model_(felt, bare(rows),
               Strings(struck, struck.string.detuning_cents, 30, std::min(22050.0, rate / 2)).strike, rate),
        bridge_(model_.bridge(bridge_shapes<double>(struck.string, rows, 1))) {
    for (const StringMode& row : rows) {
      const double sine = std::sin(row.mode.angular_frequency_rad_per_s / (2 * rate)),
                   shape = bridge_shape(struck.string, row);
      stiffness_.push_back(shape * shape / stiffness_of(row.mode));
      work_per_m2_.push_back(stiffness_.back() / (8 * sine * sine));
    }
  }

  static double sum(const std::vector<double>& values, std::size_t first, std::size_t last) {
    return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(first),
                           values.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
  }
  [[nodiscard]] double hammer_energy() const {
    return kMass_kg * std::pow(model_.hammer_velocity(), 2) / 2 + potential(felt_, model_.compression());
  }

  SegmentTable<double> felt_;
  HammerString<double> model_;
  BridgeShapes<double> bridge_;
  std::vector<double> stiffness_, work_per_m2_;  // of each mode; work_per_m2_: for a change of one metre
  std::size_t joined_ = 0;
};

/// Twenty keys on a board: keys join and leave at random, are struck, and ring with and without dampers.
class JoiningKeys {
 public:
  explicit JoiningKeys(double rate) : felt_(table_in<double>(felt_table(c4(), 32))), body_(body(rate)) {
    for (std::size_t k = 0; k < kKeys; ++k)
      keys_.emplace_back(strings_above_c4(static_cast<int>(k)), SegmentTable<double>(felt_), rate);
  }

  void tick() {
    const auto work = books_.work, dissipated = books_.dissipated;
    join_and_leave();
    brought_ += static_cast<double>(books_.work - work);
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
  static Body<double> body(double rate) {
    const auto modes = board(60);
    BridgeStiffness at_rest;
    for (std::size_t k = 0; k < kKeys; ++k)
      at_rest += bridge_stiffness(strings_above_c4(static_cast<int>(k)).string, std::vector<StringMode>());
    return {bare(modes), shapes<double>(modes, &ResonatorMode::strike_shape), at_rest, rate};
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
    double force = 0, stored = 0;
    for (auto& key : keys_) {
      const double damping = kHasLosses && !is_pedal_down && !key.is_struck() ? 60 : 0;
      force += key.tick(damping, body_.change(), books_);
      stored += key.energy();
    }
    body_.tick(force);
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

class JoiningStrings : public ::testing::TestWithParam<double> {};

// Bound: 1e-12 of the largest energy.
TEST_P(JoiningStrings, BalanceTheirEnergy) {
  const double rate = GetParam();
  JoiningKeys keys(rate);
  for (int n = 0; n < static_cast<int>(2 * rate); ++n) keys.tick();
  const EnergyBooks& books = keys.books();
  Measured() << rate << " Hz: " << books.worst / books.peak << " of the largest energy; joins brought "
             << keys.brought() / books.peak << ", leaves took " << keys.taken() / books.peak << " of it";
  EXPECT_GT(keys.brought(), 1e-9 * books.peak);
  EXPECT_GT(keys.taken(), 0.01 * books.peak);
  EXPECT_TRUE(within(books.worst, 0, 1e-12 * books.peak));
}

INSTANTIATE_TEST_SUITE_P(Rates, JoiningStrings, ::testing::Values(22050.0, 44100.0, 96000.0));

}  // namespace
}  // namespace contactspline::testing
