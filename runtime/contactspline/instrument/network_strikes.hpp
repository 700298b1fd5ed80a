// SPDX-License-Identifier: MIT
// The masses that the strikes of an instrument file throw.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/network/assembly.hpp"
#include "contactspline/network/contact_network.hpp"

namespace contactspline::detail {

/// Throws the masses of strikes, and stops those that fly away. Each function that moves a mass returns its work [J].
template <std::floating_point T>
class NetworkStrikes {
 public:
  explicit NetworkStrikes(const InstrumentData& data) : masses_(data.strikes) {
    for (const std::size_t mass : masses_) sides_.push_back(side_of(data, mass));
  }

  /// Allocates.
  void prepare(const NetworkPlan<T>& plan) {
    throws_.clear();
    for (const std::size_t mass : masses_) throws_.push_back(throw_of(plan, mass));
    is_flying_.assign(throws_.size(), 0);
  }
  void reset() { std::ranges::fill(is_flying_, 0); }

  [[nodiscard]] std::size_t size() const { return throws_.size(); }
  /// The masses that a strike throws together.
  [[nodiscard]] std::span<const std::size_t> thrown(std::size_t strike) const {
    return throws_[strike].thrown.masses;
  }

  /// Throws from displacement 0, or from where the masses touch what stands in the way.
  double strike(ContactNetwork<T>& network, std::size_t strike, T speed_m_per_s) {
    const Throw& moved = throws_[strike];
    const double before = network.energy();
    for (const std::size_t mass : moved.returned) network.set_motion(mass, 0, 0);
    for (const std::size_t mass : moved.thrown.masses) network.set_motion(mass, 0, speed_m_per_s);
    if (const T start = free_start(network, moved); start != 0)
      for (const std::size_t mass : moved.thrown.masses) network.set_motion(mass, start, speed_m_per_s);
    is_flying_[strike] = !moved.thrown.is_held;
    return network.energy() - before;
  }

  /// Called before each sample: stops the masses that a strike has thrown and that have flown away.
  double stop_the_distant(ContactNetwork<T>& network) {
    double work = 0;
    for (std::size_t s = 0; s < throws_.size(); ++s) {
      if (!is_flying_[s]) continue;
      const std::vector<std::size_t>& masses = throws_[s].thrown.masses;
      if (!(std::abs(network.body(masses.front()).displacement(std::size_t{0})) > kFarAway_m)) continue;
      const double before = network.energy();
      for (const std::size_t mass : masses) network.stop(mass);
      work += network.energy() - before;
      is_flying_[s] = 0;
    }
    return work;
  }

  /// Energy of the masses that move away from all that they could touch [J].
  [[nodiscard]] double leaving_energy(const ContactNetwork<T>& network) const {
    double energy = 0;
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const ModalBank<T>& mass = network.body(masses_[s]);
      if (static_cast<T>(sides_[s]) * mass.velocity(whole_mass_) < 0) energy += network.energy(masses_[s]);
    }
    return energy;
  }

 private:
  static constexpr double kWholeMass[] = {1};
  // A struck mass that nothing holds stops at this distance.
  static constexpr T kFarAway_m = 10;

  // 1 or -1: a mass touches others where it moves to this side only. 0: to both, or it is held.
  static int side_of(const InstrumentData& data, std::size_t mass) {
    bool touches[2] = {};
    for (const InstrumentConnection& c : data.connections)
      for (const std::size_t place : {c.first, c.second}) {
        if (place == kGround || data.place_bodies[place] != mass) continue;
        if (c.kind != ConnectionKind::kContact) return 0;
        touches[place == c.first ? 0 : 1] = true;
      }
    return touches[0] == touches[1] ? 0 : touches[0] ? 1 : -1;
  }

  // Displacement of thrown masses at which no contact is pressed further than at rest; 0 if there is none.
  [[nodiscard]] static T free_start(const ContactNetwork<T>& network, const Throw& moved) {
    T back = 0, forth = 0;
    for (const Throw::Contact& contact : moved.contacts) {
      const T pressed = network.compression(contact.connection) - (std::max)(T(0), -network.gap(contact.connection));
      (contact.is_first ? back : forth) = (std::max)(contact.is_first ? back : forth, pressed);
    }
    return back > 0 && forth > 0 ? T(0) : forth - back;
  }

  std::span<const std::size_t> masses_;
  std::vector<int> sides_;
  ModeShapes<T> whole_mass_{std::span<const double>(kWholeMass)};
  std::vector<Throw> throws_;
  std::vector<char> is_flying_;  // may what a strike has thrown still fly away?
};

}  // namespace contactspline::detail
