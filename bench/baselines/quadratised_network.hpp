// SPDX-License-Identifier: MIT
// A two-step modal string over several contacts with quadratised contact energies V = psi^2 / 2, one psi for each
// contact: one linear system per sample, no iteration (Ducceschi and Bilbao, DAFx 2019; Ducceschi et al., JSV 2021).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <experimental/simd>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/step/contact.hpp"

namespace contactspline::bench {

/// A string over contacts with the ground, and a spring with a damper between string and ground. Compression of a
/// contact: displacement at its place minus gap. Shapes: one number for each mode.
struct StringOverContacts {
  using Shapes = std::vector<double>;
  std::vector<Mode> modes;
  SegmentTable<double> table;    ///< must outlive the schemes
  std::vector<Shapes> contacts;  ///< shapes at each
  std::vector<double> gaps_m;    ///< one for each contact
  double weight = 1;             ///< multiplies the stiffness of each
  Shapes spring;                 ///< its place
  double spring_n_per_m = 0, resistance_n_s_per_m = 0;
  double spring_gap_m = 0;  ///< displacement at which it is relaxed
  Shapes push;              ///< where a force acts from outside
};

/// The gradient g of a contact that has opened while its psi is not 0.
enum class OpenGradient {
  zero,         ///< psi stays until the contact closes again, as first published
  free_motion,  ///< -2 psi/s_free, with which psi becomes nearly 0 (Ducceschi et al.)
  limited,      ///< psi would become 0 if no other contact had a force, as in EXP-3 (van Walstijn et al., JSV 2023)
};

/// The scheme. y(n+1) - y(n-1) = s = s_free - Q f. psi lives between samples: psi_next = psi + g s/2 and
/// f = g (psi + psi_next)/2, with the gradient g of psi = sqrt(2 V) at y(n). The energy with psi is exact.
/// Contacts that cannot touch soon are not computed. Only contacts that touch or hold energy enter the linear system.
template <OpenGradient kOpen>
class QuadratisedNetwork {
 public:
  QuadratisedNetwork(const StringOverContacts& problem, double sample_rate_hz)
      : table_(problem.table),
        weight_(problem.weight),
        blocks_((problem.modes.size() + kLanes - 1) / kLanes),
        modes_(blocks_),
        gaps_(problem.gaps_m),
        contacts_(problem.contacts.size()) {
    for (std::size_t i = 0; i < problem.modes.size(); ++i) {
      const auto constants = contactspline::detail::mode_constants(problem.modes[i], sample_rate_hz);
      const bool audible = problem.modes[i].angular_frequency_rad_per_s < std::numbers::pi * sample_rate_hz;
      Modes& mode = modes_[i / kLanes];
      mode.keep[i % kLanes] = 1 - constants.loss;
      mode.pull[i % kLanes] = constants.stiffness;
      mode.gain[i % kLanes] = audible ? 2 * constants.receptance : 0;
    }
    for (const auto& shapes : problem.contacts) add_row(shapes);
    add_row(problem.spring);
    add_row(problem.push);
    const std::size_t count = contacts_.size(), spring = count, push = count + 1;
    spring_gain_ = std::sqrt(problem.spring_n_per_m);
    spring_psi_ = -spring_gain_ * problem.spring_gap_m;
    resistance_ = problem.resistance_n_s_per_m * sample_rate_hz / 2;
    spring_slope_ = problem.spring_n_per_m / 4 + resistance_;
    spring_receptance_ = receptance(spring, spring);
    spring_per_push_ = receptance(spring, push);
    const double eliminated = spring_slope_ / (1 + spring_slope_ * spring_receptance_);
    for (std::size_t k = 0; k < count; ++k) {
      Contact& c = contacts_[k];
      c.y = -gaps_[k];
      c.is_awake = true;
      c.per_push = receptance(k, push);
      c.per_spring = receptance(k, spring);
      c.spring_fraction = eliminated * c.per_spring;
      for (const double shape : problem.contacts[k]) c.max_shape = std::max(c.max_shape, std::abs(shape));
    }
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t l = 0; l < count; ++l)
        receptances_.push_back(receptance(k, l) - contacts_[k].per_spring * contacts_[l].spring_fraction);
    for (auto* list : {&g_, &free_, &psi_, &next_, &moved_}) list->resize(count);
    matrix_.resize(count * count);
    list_awake();
  }

  // Lists point to members.
  QuadratisedNetwork(const QuadratisedNetwork&) = delete;
  QuadratisedNetwork& operator=(const QuadratisedNetwork&) = delete;

  /// Advances one sample under a force [N] at the push that acts at its beginning.
  void tick(double push_n) {
    begin(push_n);
    solve();
    end(push_n);
    advance(push_n);
    put_to_sleep();
  }

  [[nodiscard]] std::size_t contacts() const { return contacts_.size(); }
  /// Force at the last sample [N].
  [[nodiscard]] double force(std::size_t k) const { return contacts_[k].force; }
  /// Compression at this sample [m]; the last one of a contact that is not computed.
  [[nodiscard]] double compression(std::size_t k) const { return contacts_[k].y; }
  /// Energy in psi, between the last sample and this one [J].
  [[nodiscard]] double stored(std::size_t k) const { return contacts_[k].psi * contacts_[k].psi / 2; }
  /// V at the mean of the last compression and this one [J].
  [[nodiscard]] double potential(std::size_t k) const {
    const Contact& c = contacts_[k];
    return weight_ * contactspline::potential(table_, c.y - c.last / 2);
  }
  /// Energy of the spring, between the last sample and this one [J].
  [[nodiscard]] double spring_energy() const { return spring_psi_ * spring_psi_ / 2; }
  /// Displacement of one mode [m]. Slow.
  [[nodiscard]] double displacement(std::size_t mode) const { return modes_[mode / kLanes].q[mode % kLanes]; }
  [[nodiscard]] std::size_t sleeping() const { return contacts_.size() - awake_.size(); }
  [[nodiscard]] std::size_t active() const { return active_.size(); }

 private:
  using Lanes = std::experimental::native_simd<double>;
  static constexpr std::size_t kLanes = Lanes::size();
  static constexpr int kSleepInterval = 16;
  static constexpr double kSleepingSamples = 4;
  static constexpr double kNegligible = 1e-12;  // psi [sqrt(J)]

  struct alignas(64) Modes {
    Lanes keep = 1, pull = 0, gain = 0, rest = 0, q = 0, change = 0;
  };

  struct Contact {
    double y = 0;     // compression [m]
    double last = 0;  // its last increment [m]
    double free = 0;  // its next increment without force [m]
    double psi = 0;   // [sqrt(J)]
    double force = 0;
    double per_push = 0, per_spring = 0;  // increment over two samples per newton there [m/N]
    double spring_fraction = 0;           // fraction of this force that the spring's force loses
    double max_shape = 0;
    double wake_at = 0;  // travel of the string at which a sleeping contact may touch [m]
    std::size_t segment = 0;
    bool is_awake = false;
  };

  void add_row(const std::vector<double>& shapes) {
    const std::size_t first = rows_.size();
    rows_.resize(first + blocks_, Lanes(0));
    for (std::size_t i = 0; i < shapes.size(); ++i) rows_[first + i / kLanes][i % kLanes] = shapes[i];
  }
  [[nodiscard]] const Lanes* row(std::size_t r) const { return rows_.data() + r * blocks_; }
  [[nodiscard]] std::size_t spring_row() const { return contacts_.size(); }

  // Change of the increment over two samples at one row per newton at another [m/N].
  [[nodiscard]] double receptance(std::size_t a, std::size_t b) const {
    Lanes sum = 0;
    for (std::size_t i = 0; i < blocks_; ++i) sum += modes_[i].gain * row(a)[i] * row(b)[i];
    return reduce(sum);
  }
  [[nodiscard]] double at(std::size_t r, Lanes Modes::*state) const {
    Lanes sum = 0;
    for (std::size_t i = 0; i < blocks_; ++i) sum += row(r)[i] * (modes_[i].*state);
    return reduce(sum);
  }

  // Increments over two samples without contacts, and the contacts that may have a force.
  void begin(double push) {
    const double spring_free = spring_free_ + spring_last_ + spring_per_push_ * push;
    spring_force_ =
        (spring_gain_ * spring_psi_ + spring_slope_ * spring_free) / (1 + spring_slope_ * spring_receptance_);
    active_.clear();
    for (const std::size_t k : awake_) {
      Contact& c = contacts_[k];
      c.force = 0;
      if (c.y > 0 || is_held(c)) active_.push_back(k);
    }
    for (std::size_t i = 0; i < active_.size(); ++i) {
      Contact& c = contacts_[active_[i]];
      free_[i] = c.free + c.last + c.per_push * push - c.per_spring * spring_force_;
      psi_[i] = c.psi = std::abs(c.psi);  // (g, psi) and (-g, -psi) are the same contact
      g_[i] = gradient(c, free_[i], receptances_[active_[i] * (contacts_.size() + 1)]);
    }
  }

  // g of an active contact.
  double gradient(Contact& c, double free, double q) {
    if (c.y > 0) {
      c.segment = contactspline::detail::relocate_segment(table_, c.segment, c.y);
      const auto& segment = table_[c.segment];
      return segment.force_at(c.y) * std::sqrt(weight_ / (2 * segment.energy_at(c.y)));
    }
    if (kOpen == OpenGradient::free_motion) return free != 0 ? -2 * c.psi / free : 0;
    const double z = -free / 2, root = std::sqrt(z * z + q * c.psi * c.psi);
    return z > 0 ? 2 * c.psi / (root + z) : 2 * (root - z) / (q * c.psi);
  }

  // Forces, and psi after this sample.
  void solve() {
    const std::size_t n = active_.size();
    if (n == 1) {
      const double g = g_[0], q = receptances_[active_[0] * (contacts_.size() + 1)];
      next_[0] = psi_[0] + g / 2 * (free_[0] - q * g * psi_[0]) / (1 + q * g * g / 4);
    } else {
      solve_linear();
    }
    for (std::size_t i = 0; i < n; ++i) {
      Contact& c = contacts_[active_[i]];
      c.force = g_[i] * (psi_[i] + next_[i]) / 2;
      c.psi = std::abs(next_[i]) > kNegligible ? next_[i] : 0;
    }
  }

  // (I + G Q G / 4) step = G (s_free - Q G psi) / 2 by a Cholesky factor; next = psi + step.
  void solve_linear() {
    const std::size_t n = active_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double* q = receptances_.data() + active_[i] * contacts_.size();
      double* a = matrix_.data() + i * n;
      for (std::size_t j = 0; j <= i; ++j) a[j] = g_[i] * g_[j] * q[active_[j]] / 4;
    }
    for (std::size_t i = 0; i < n; ++i) {
      double sum = g_[i] / 2 * free_[i];
      for (std::size_t j = 0; j <= i; ++j) sum -= 2 * matrix_[i * n + j] * psi_[j];
      for (std::size_t j = i + 1; j < n; ++j) sum -= 2 * matrix_[j * n + i] * psi_[j];
      next_[i] = sum;
    }
    for (std::size_t i = 0; i < n; ++i) {
      double* a = matrix_.data() + i * n;
      double diagonal = a[i] + 1, right = next_[i];
      for (std::size_t j = 0; j < i; ++j) {
        const double* b = matrix_.data() + j * n;
        double sum = a[j];
        for (std::size_t k = 0; k < j; ++k) sum -= a[k] * b[k];
        a[j] = sum * b[j];
        diagonal -= a[j] * a[j];
        right -= a[j] * next_[j];
      }
      a[i] =
          1 / std::sqrt(std::max(diagonal, 1.0));  // the inverse of the factor's diagonal; below 1 by rounding only
      next_[i] = right * a[i];
    }
    for (std::size_t i = n; i-- > 0;) {
      const double* a = matrix_.data() + i * n;
      next_[i] *= a[i];
      for (std::size_t k = 0; k < i; ++k) next_[k] -= a[k] * next_[i];
      next_[i] += psi_[i];
    }
  }

  // Compressions at the next sample, force and psi of the spring.
  void end(double push) {
    std::ranges::fill(moved_, 0.0);
    for (const std::size_t l : active_) add_response(l, contacts_[l].force, moved_.data());
    for (const std::size_t k : awake_) {
      Contact& c = contacts_[k];
      c.last = c.free + c.per_push * push - c.per_spring * spring_force_ - moved_[k];
      c.y += c.last;
    }
    double increment = spring_free_ + spring_per_push_ * push;
    for (const std::size_t l : active_) {
      spring_force_ -= contacts_[l].spring_fraction * contacts_[l].force;
      increment -= contacts_[l].per_spring * contacts_[l].force;
    }
    increment -= spring_receptance_ * spring_force_;
    spring_psi_ += spring_gain_ * (increment + spring_last_) / 2;
    spring_last_ = increment;
  }

  // What a force at contact l moves all contacts by.
  void add_response(std::size_t l, double force, double* __restrict moved) const {
    const double* row = receptances_.data() + l * contacts_.size();
    for (std::size_t k = 0; k < contacts_.size(); ++k) moved[k] += row[k] * force;
  }

  // Moves the modes, wakes contacts that may now touch, and computes the free increments.
  void advance(double push) {
    pushed_.clear();
    const auto add = [&](std::size_t r, double force) {
      if (force != 0) pushed_.push_back({row(r), force});
    };
    for (const std::size_t k : active_) add(k, -contacts_[k].force);
    add(spring_row(), -spring_force_);
    add(spring_row() + 1, push);
    move_modes();
    if (travel_ >= first_wake_) wake_reachable();
    std::size_t r = 0;
    for (; r + 8 <= listening_.size(); r += 8) listen<8>(r);
    if (r + 4 <= listening_.size()) listen<4>(r), r += 4;
    if (r + 2 <= listening_.size()) listen<2>(r), r += 2;
    if (r < listening_.size()) listen<1>(r);
  }

  void move_modes() {
    Lanes travel = 0;
    const std::span<const Push> pushed = pushed_;
    for (std::size_t i = 0; i < blocks_; ++i) {
      Modes& mode = modes_[i];
      Lanes force = 0;
      for (const Push& push : pushed) force += push.row[i] * push.force;
      const Lanes change = mode.rest + mode.gain * force;
      const Lanes q = mode.q + change;
      mode.rest = mode.keep * change - mode.pull * q;
      mode.q = q;
      mode.change = change;
      travel += abs(change);
    }
    last_travel_ = reduce(travel);
    travel_ += last_travel_;
  }

  // Free increments at kCount rows.
  template <std::size_t kCount>
  void listen(std::size_t first) {
    Lanes sums[kCount];
    const Lanes* rows[kCount];
    for (std::size_t r = 0; r < kCount; ++r) sums[r] = 0, rows[r] = listening_[first + r].row;
    for (std::size_t i = 0; i < blocks_; ++i) {
      const Lanes rest = modes_[i].rest;
      for (std::size_t r = 0; r < kCount; ++r) sums[r] += rows[r][i] * rest;
    }
    for (std::size_t r = 0; r < kCount; ++r) *listening_[first + r].increment = reduce(sums[r]);
  }

  void wake_reachable() {
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      Contact& c = contacts_[k];
      if (c.is_awake || c.wake_at > travel_) continue;
      c.is_awake = true;
      c.y = at(k, &Modes::q) - gaps_[k];
      c.last = at(k, &Modes::change);
    }
    list_awake();
  }

  void put_to_sleep() {
    if (++since_sleep_ < kSleepInterval) return;
    since_sleep_ = 0;
    for (const std::size_t k : awake_) {
      Contact& c = contacts_[k];
      if (-c.y <= kSleepingSamples * c.max_shape * last_travel_ || is_held(c)) continue;
      c.is_awake = false;
      c.wake_at = travel_ - 0.999 * c.y / c.max_shape;
    }
    list_awake();
  }

  // Does the contact hold energy that it may still return?
  static bool is_held(const Contact& c) { return kOpen != OpenGradient::zero && c.psi != 0; }

  void list_awake() {
    awake_.clear();
    listening_.assign(1, {row(spring_row()), &spring_free_});
    first_wake_ = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      Contact& c = contacts_[k];
      if (!c.is_awake) {
        first_wake_ = std::min(first_wake_, c.wake_at);
        continue;
      }
      awake_.push_back(k);
      listening_.push_back({row(k), &c.free});
    }
  }

  struct Push {
    const Lanes* row;
    double force;
  };
  struct Listener {
    const Lanes* row;
    double* increment;
  };

  SegmentTable<double> table_;
  double weight_;
  std::size_t blocks_;
  std::vector<Modes> modes_;
  std::vector<Lanes> rows_;  // shapes of the contacts, the spring, the push
  std::vector<double> gaps_;
  std::vector<Contact> contacts_;
  std::vector<double> receptances_;  // for each pair of contacts, with the spring eliminated [m/N]
  std::vector<std::size_t> awake_, active_;
  std::vector<Push> pushed_;
  std::vector<Listener> listening_;
  // One element for each active contact.
  std::vector<double> g_, free_, psi_, next_, matrix_;
  std::vector<double> moved_;  // one for each contact
  double spring_gain_, spring_slope_, resistance_, spring_receptance_, spring_per_push_;
  double spring_free_ = 0, spring_last_ = 0;  // next and last increment of the spring [m]
  double spring_psi_ = 0, spring_force_ = 0;
  double travel_ = 0,
         last_travel_ = 0;  // bound of the way of a place with shapes of 1: until now, in this sample [m]
  double first_wake_ = 0;
  int since_sleep_ = 0;
};

}  // namespace contactspline::bench
