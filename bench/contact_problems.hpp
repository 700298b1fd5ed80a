// SPDX-License-Identifier: MIT
// Strings over several contacts, for schemes to play: a tanpura and a fretted guitar string.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "bench/baselines/quadratised_network.hpp"
#include "contactspline/instruments/tanpura.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/resonators/guitar_d3.hpp"

namespace contactspline::bench {

/// A string that a finger plucks again and again: its force rises linearly and ends at once.
struct PluckedString {
  std::string name;
  StringOverContacts string;
  double force_n, rise_s;

  /// Force of the finger at a time since the pluck began [N].
  [[nodiscard]] double force_at(double time_s) const { return time_s < rise_s ? force_n * time_s / rise_s : 0; }
};

namespace detail {

inline constexpr auto& kSteel = segments_of<materials::steel_on_steel, double>;

}  // namespace detail

/// The tanpura that ships: 120 modes, a bridge of 24 points, a thread between them.
inline PluckedString plucked_tanpura() {
  using Data = instruments::tanpura<double>::data;
  const std::size_t modes = Data::masses.size();
  PluckedString plucked{"tanpura", {}, 0.45, 0.012};
  StringOverContacts& string = plucked.string;
  string.table = detail::kSteel;
  const auto shapes_at = [&](std::size_t place) {
    const auto* first = Data::shapes.data() + place * modes;
    return std::vector<double>(first, first + modes);
  };
  for (std::size_t i = 0; i < modes; ++i)
    string.modes.push_back({Data::angular_frequencies[i], Data::decays[i], Data::masses[i]});
  for (const InstrumentConnection& c : Data::connections) {
    if (c.kind == ConnectionKind::kContact) {
      string.contacts.push_back(shapes_at(c.first));
      string.gaps_m.push_back(c.gap_m);
      string.weight = c.weight;
    } else {
      string.spring = shapes_at(c.first);
      string.spring_n_per_m = c.stiffness_n_per_m;
      string.resistance_n_s_per_m = c.resistance_n_s_per_m;
    }
  }
  string.push = shapes_at(Data::targets[0]);
  return plucked;
}

/// A guitar string D3 over 20 steel frets. A finger holds it down on fret 5.
inline PluckedString plucked_over_frets() {
  using String = resonators::guitar_d3;
  constexpr double kLength = 0.648;
  PluckedString plucked{"D3 over frets", {}, -2, 0.01};
  StringOverContacts& string = plucked.string;
  string.table = detail::kSteel;
  const auto shapes_at = [](double place_m) {
    std::vector<double> shapes;
    for (const double k : String::wavenumbers) shapes.push_back(std::sin(k * place_m));
    return shapes;
  };
  string.modes.assign(modes_in<String>.begin(), modes_in<String>.end());
  const auto place_of = [](double fret) { return kLength * (1 - std::exp2(-fret / 12)); };
  for (int fret = 1; fret <= 20; ++fret) {
    const double place = place_of(fret);
    string.contacts.push_back(shapes_at(place));
    string.gaps_m.push_back(3e-4 + 1.5e-3 * place / kLength);
  }
  string.spring = shapes_at(place_of(4.8));
  string.spring_n_per_m = 5e3;
  string.resistance_n_s_per_m = 1;
  string.spring_gap_m = 1.5e-3;
  string.push = shapes_at(kLength - 0.13);
  return plucked;
}

/// A ContactNetwork that plays such a string.
class NetworkOfString {
 public:
  NetworkOfString(const StringOverContacts& string, double sample_rate_hz)
      : contacts_(string.contacts.size()), network_(plan_of(string), sample_rate_hz) {}

  void tick(double push_n) {
    network_.push(0, push_n);
    network_.tick();
  }
  [[nodiscard]] std::size_t contacts() const { return contacts_; }
  [[nodiscard]] double force(std::size_t k) const { return network_.force(k); }
  [[nodiscard]] double compression(std::size_t k) const { return network_.compression(k); }
  [[nodiscard]] std::size_t sleeping() const { return network_.sleeping(); }
  [[nodiscard]] const ContactNetwork<double>& network() const { return network_; }

 private:
  static NetworkPlan<double> plan_of(const StringOverContacts& string) {
    NetworkPlan<double> plan;
    const std::size_t body = plan.add_body(string.modes);
    plan.add_place(body, string.push);
    std::vector<std::size_t> places;
    for (const auto& shapes : string.contacts) places.push_back(plan.add_place(body, shapes));
    const std::vector<double> weights(places.size(), string.weight);
    plan.add_profile(places, kGround, string.table, string.gaps_m, weights);
    plan.add_spring(plan.add_place(body, string.spring), kGround, string.spring_n_per_m, string.resistance_n_s_per_m,
                    string.spring_gap_m);
    return plan;
  }

  std::size_t contacts_;
  ContactNetwork<double> network_;
};

/// Energy of a NetworkOfString as its network keeps it.
class NetworkEnergy {
 public:
  NetworkEnergy(const NetworkOfString& string, const StringOverContacts&, double)
      : network_(string.network()), books_(network_.energy()), energy_(network_.energy()) {}

  /// Call it after each sample.
  void follow(double) {
    books_ += network_.work() - network_.dissipated();
    energy_ = network_.energy();
  }
  [[nodiscard]] double energy() const { return energy_; }  ///< [J]
  [[nodiscard]] double error() const {
    return static_cast<double>(energy_ - books_);
  }  ///< energy that came from nowhere [J]

 private:
  const ContactNetwork<double>& network_;
  long double books_;
  double energy_;
};

/// Energy of a QuadratisedNetwork, from the displacements of its modes. With u(n+1) = A u(n) - B u(n-1) + C f of a
/// mode, multiplied by (u(n+1) - u(n-1))/(2 C): the work of f is the change of
/// ((1 + B) (u(n+1) - u(n))^2 + 2 (1 + B - A) u(n+1) u(n))/(4 C), and (1 - B) (u(n+1) - u(n-1))^2/(4 C) is
/// dissipated.
template <typename Scheme>
class QuadratisedEnergy {
 public:
  QuadratisedEnergy(const Scheme& scheme, const StringOverContacts& string, double sample_rate_hz)
      : scheme_(scheme), string_(string), damper_(string.resistance_n_s_per_m * sample_rate_hz / 2) {
    for (const Mode& mode : string.modes) {
      const auto c = contactspline::detail::mode_constants(mode, sample_rate_hz);
      const double eight = 8 * c.receptance, b = 1 - c.loss;  // 4 C
      modes_.push_back({(1 + b) / eight, 2 * c.stiffness / eight, c.loss / eight});
    }
    energy_ = begin_ = stored();
  }

  /// Call it after each sample.
  void follow(double push_n) {
    double pushed = 0, spring = 0, energy = 0;
    for (std::size_t i = 0; i < modes_.size(); ++i) {
      const auto& [inertia, stiffness, resistance] = modes_[i].constants;
      auto& [now, before, last] = modes_[i].displacements;
      last = before;
      before = now;
      now = scheme_.displacement(i);
      pushed += string_.push[i] * (now - last);
      spring += string_.spring[i] * (now - last);
      energy += inertia * (now - before) * (now - before) + stiffness * now * before;
      dissipated_ += resistance * (now - last) * (now - last);
    }
    work_ += push_n * pushed / 2;
    dissipated_ += damper_ * spring * spring / 2;
    energy_ = energy + stored();
  }
  [[nodiscard]] double energy() const { return energy_; }  ///< [J]
  /// Energy that came from nowhere since the beginning [J].
  [[nodiscard]] double error() const { return static_cast<double>(energy_ - begin_ - work_ + dissipated_); }

 private:
  struct ModeEnergy {
    ModeEnergy(double inertia, double stiffness, double resistance) : constants{inertia, stiffness, resistance} {}
    std::array<double, 3> constants;
    std::array<double, 3> displacements = {};
  };

  // In psi and in the spring.
  [[nodiscard]] double stored() const {
    double energy = scheme_.spring_energy();
    for (std::size_t k = 0; k < scheme_.contacts(); ++k) energy += scheme_.stored(k);
    return energy;
  }

  const Scheme& scheme_;
  const StringOverContacts& string_;
  double damper_;
  std::vector<ModeEnergy> modes_;
  double energy_ = 0, begin_ = 0;
  long double work_ = 0, dissipated_ = 0;
};

template <typename Scheme>
using EnergyOf = std::conditional_t<std::same_as<Scheme, NetworkOfString>, NetworkEnergy, QuadratisedEnergy<Scheme>>;

}  // namespace contactspline::bench
