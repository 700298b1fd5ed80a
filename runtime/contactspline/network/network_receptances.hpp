// SPDX-License-Identifier: MIT
// By how much a force at one place or connection of a network moves another.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/network_parts.hpp"

namespace contactspline::detail {

/// The receptances of a network's connections and places [m/N]: in a sample, one newton moves them so far. The
/// receptance of two connections is the sum over the modes of both bodies' shapes times xi_n
/// (docs/how-it-works/several-contacts.md). Where forces act on two samples, it is twice as large.
template <std::floating_point T>
class NetworkReceptances {
 public:
  explicit NetworkReceptances(NetworkParts<T>& parts)
      : of_connections_(parts.connections.size() * parts.connections.size()),
        of_places_(parts.places.size() * parts.places.size()) {
    for (std::size_t b = 0; b < parts.bodies.size(); ++b) {
      NetworkBody<T>& body = parts.bodies[b];
      body.shapes.assign(body.connections.size(), ModeShapes<double>(body.bank.size()));
      body.pushed = ModeShapes<double>(body.bank.size());
      body.pushed_by_place = ModeShapes<T>(body.bank.size());
      body.receptances.resize(body.connections.size() * (body.connections.size() + 1) / 2);
      measure(parts, b);
    }
  }

  /// Measures a body anew whose modes have changed.
  void measure(NetworkParts<T>& parts, std::size_t b) {
    measure_where(parts, b, [](std::size_t) { return true; });
    measure_bounds(parts, b);
  }

  /// Measures what concerns the places that have moved.
  void measure_moved(NetworkParts<T>& parts) {
    const auto is_new = [&](std::size_t p) {
      return p != kGround && parts.places[p].mover && parts.movers[*parts.places[p].mover].is_new;
    };
    for (const NetworkMover<T>& mover : parts.movers) {
      if (!mover.is_new) continue;
      const std::size_t b = parts.places[mover.place].body;
      measure_where(parts, b, is_new);
      for (const std::size_t p : parts.bodies[b].places)
        if (const auto& other = parts.places[p].mover) parts.movers[*other].is_new = false;
    }
  }

  /// Measures a body anew whose frequencies have changed: shapes stay, and what is largest of them.
  void measure_frequencies(NetworkParts<T>& parts, std::size_t b) {
    NetworkBody<T>& body = parts.bodies[b];
    const auto all = [](std::size_t) { return true; };
    measure_pairs(body, all);
    measure_places(parts, b, all);
    body.total_receptance =
        detail::sum_of<double>(body.bank.size(), [&](std::size_t n) { return double(body.bank.receptance(n)); });
  }

  /// Measures the connections' own receptances without damping, the largest ones where a place moves.
  void measure_own(NetworkParts<T>& parts) {
    for (NetworkConnection<T>& c : parts.connections) c.own_receptance = 0;
    for (std::size_t b = 0; b < parts.bodies.size(); ++b) {
      const NetworkBody<T>& body = parts.bodies[b];
      std::size_t own = 0;  // on the diagonal of its triangle
      for (std::size_t k = 0; k < body.connections.size(); ++k) {
        NetworkConnection<T>& c = parts.connections[body.connections[k]];
        const double max = double(parts.is_on(c.first, b) ? c.first_max : c.second_max);
        c.own_receptance += parts.samples_of_step *
                            (moves_on(parts, c, b) ? body.total_receptance * max * max : body.receptances[own]);
        own += k + 2;
      }
    }
  }

  /// Gives the solver the receptances of all pairs of connections that share a body, with the damping of the bodies.
  /// Those of other pairs are 0.
  void couple(NetworkParts<T>& parts, CoupledContacts<T>& solver) {
    const std::size_t n = parts.connections.size();
    const auto each_pair = [&](const NetworkBody<T>& body, auto visit) {
      for (const std::size_t k : body.connections)
        for (const std::size_t l : body.connections) {
          if (l > k) break;
          visit(k, l, of_connections_[k * n + l]);
        }
    };
    for (const NetworkBody<T>& body : parts.bodies)
      each_pair(body, [](std::size_t, std::size_t, double& sum) { sum = 0; });
    for (NetworkBody<T>& body : parts.bodies) {
      body.damping_gain = 1 / (1 + body.damping);
      const double* receptance = body.receptances.data();
      each_pair(body, [&](std::size_t, std::size_t, double& sum) {
        sum += parts.samples_of_step * double(body.damping_gain) * *receptance++;
      });
    }
    for (const NetworkBody<T>& body : parts.bodies)
      each_pair(body, [&](std::size_t k, std::size_t l, double sum) {
        solver.set_receptance(k, l, k == l ? (std::max)(sum, kMinReceptance) : sum);
      });
  }

  /// Receptance between two places of one body, with its damping.
  [[nodiscard]] T mutual(const NetworkParts<T>& parts, std::size_t p, std::size_t q) const {
    return parts.body_of(p).damping_gain * of_places_[p * parts.places.size() + q];
  }

 private:
  // Where nothing moves the receptance is 0; a contact needs one > 0.
  static constexpr double kMinReceptance = 1e-18;

  // Measures what concerns places of a body.
  template <typename Concerns>
  void measure_where(NetworkParts<T>& parts, std::size_t b, Concerns concerns_place) {
    NetworkBody<T>& body = parts.bodies[b];
    const auto concerns = [&](std::size_t i) {
      const NetworkConnection<T>& c = parts.connections[body.connections[i]];
      return (parts.is_on(c.first, b) && concerns_place(c.first)) ||
             (parts.is_on(c.second, b) && concerns_place(c.second));
    };
    for (std::size_t i = 0; i < body.connections.size(); ++i)
      if (concerns(i)) write_shapes(parts, parts.connections[body.connections[i]], b, body.shapes[i]);
    measure_pairs(body, concerns);
    measure_places(parts, b, concerns_place);
  }

  // The receptances of the pairs of a body's connections that one of `concerns` is part of. A pair is computed in one
  // order only, so that it has the same digits whichever of the two has moved.
  template <typename Concerns>
  static void measure_pairs(NetworkBody<T>& body, Concerns concerns) {
    const std::size_t modes = body.bank.size();
    bool is_concerned = false;
    for (std::size_t i = 0; i < body.connections.size(); ++i) {
      is_concerned = is_concerned || concerns(i);
      if (!is_concerned) continue;
      for (std::size_t n = 0; n < modes; ++n) body.pushed[n] = double(body.bank.receptance(n)) * body.shapes[i][n];
      double* row = body.receptances.data() + i * (i + 1) / 2;  // of the triangle
      for (std::size_t j = 0; j <= i; ++j)
        if (concerns(i) || concerns(j))
          row[j] = inner_product<double>(modes, body.pushed.data(), body.shapes[j].data());
    }
  }

  // The same of the pairs of its places.
  template <typename Concerns>
  void measure_places(NetworkParts<T>& parts, std::size_t b, Concerns concerns) {
    NetworkBody<T>& body = parts.bodies[b];
    const std::size_t modes = body.bank.size();
    ModeShapes<T>& pushed = body.pushed_by_place;
    bool is_concerned = false;
    for (const std::size_t p : body.places) {
      is_concerned = is_concerned || concerns(p);
      if (!is_concerned) continue;
      for (std::size_t n = 0; n < modes; ++n) pushed[n] = body.bank.receptance(n) * parts.places[p].shapes[n];
      parts.places[p].travel_per_force = sum_of<T>(modes, [&](std::size_t n) { return std::abs(pushed[n]); });
      for (const std::size_t q : body.places) {
        if (q > p) break;
        if (concerns(p) || concerns(q))
          of_places_[p * parts.places.size() + q] = of_places_[q * parts.places.size() + p] =
              inner_product<T>(modes, pushed.data(), parts.places[q].shapes.data());
      }
    }
  }

  // By how much the modes of a body move its connections at most, wherever their places are.
  static void measure_bounds(NetworkParts<T>& parts, std::size_t b) {
    NetworkBody<T>& body = parts.bodies[b];
    body.total_receptance = 0;
    for (std::size_t n = 0; n < body.bank.size(); ++n) body.total_receptance += double(body.bank.receptance(n));
    for (std::size_t i = 0; i < body.connections.size(); ++i) {
      NetworkConnection<T>& c = parts.connections[body.connections[i]];
      T& max = parts.is_on(c.first, b) ? c.first_max : c.second_max;
      max = moves_on(parts, c, b) ? max_shape(parts, c.first, b) + max_shape(parts, c.second, b) : T(0);
      for (std::size_t n = 0; n < body.bank.size(); ++n)
        max = (std::max)(max, static_cast<T>(std::abs(body.shapes[i][n])));
    }
  }

  // Shapes of a connection on a body: those of its first place minus those of its second. The receptance of two
  // places that move almost together needs the difference before the sum over the modes, or it loses its digits.
  static void write_shapes(const NetworkParts<T>& parts, const NetworkConnection<T>& c, std::size_t body,
                           ModeShapes<double>& shapes) {
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] = 0;
    const auto add = [&](std::size_t place, double sign) {
      if (!parts.is_on(place, body)) return;
      const ModeShapes<T>& at = parts.places[place].shapes;
      for (std::size_t i = 0; i < at.size(); ++i) shapes[i] += sign * double(at[i]);
    };
    add(c.first, 1);
    add(c.second, -1);
  }

  [[nodiscard]] static bool moves_on(const NetworkParts<T>& parts, const NetworkConnection<T>& c, std::size_t body) {
    return (parts.is_on(c.first, body) && parts.places[c.first].mover) ||
           (parts.is_on(c.second, body) && parts.places[c.second].mover);
  }
  [[nodiscard]] static T max_shape(const NetworkParts<T>& parts, std::size_t place, std::size_t body) {
    return parts.is_on(place, body) ? parts.places[place].max_shape() : T(0);
  }

  std::vector<double> of_connections_;  // of each with those up to itself
  std::vector<T> of_places_;            // of all pairs, without damping
};

}  // namespace contactspline::detail
