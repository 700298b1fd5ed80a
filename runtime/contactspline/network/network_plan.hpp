// SPDX-License-Identifier: MIT
// What a network of bodies and connections is made of.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/friction_materials.hpp"
#include "contactspline/data/instrument_data.hpp"
#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/string_place.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/memory.hpp"
#include "contactspline/step/roughness.hpp"

namespace contactspline {

/// Consecutive connections of a network.
struct ConnectionRange {
  std::size_t first, count;
};

/// What a ContactNetwork is made of. Each add function returns the index of what it adds. A connection joins two
/// places of earlier calls, one of which may be kGround. Its compression is
///
///     displacement(first) - displacement(second) - gap
template <std::floating_point T>
class NetworkPlan {
 public:
  struct Place {
    std::size_t body;
    ModeShapes<T> shapes;                        ///< where it begins, if it moves
    std::vector<double> wavenumbers_per_m = {};  ///< of the modes of its string; empty: it does not move
    T place_m = 0;                               ///< where it begins on its string
  };
  struct Connection {
    std::size_t first, second;
    SegmentTable<T> table = {};  // of a contact
    ContactControls<T> contact = {};
    T weight = 1;  // multiplies the stiffness of a contact
    T gap_m = 0;
    std::span<const Memory> memories = {};  // of a contact
    Roughness roughness = {};               // of a contact
    T spring_n_per_m = 0, resistance_n_s_per_m = 0;
    bool is_rigid = false;
    std::optional<FrictionMaterial> friction = {};
    double friction_width_m = 1;
    std::size_t pressed_by = kNoConnection;  // of friction
  };

  /// forms: those of a body that stretches. With one such body in the network all forces act over two samples
  /// (detail::TwoStepMotion), no contact sleeps, a place that moves stays where put_place() puts it, and there is no
  /// friction.
  std::size_t add_body(std::span<const Mode> modes, std::span<const StretchForm> forms = {}) {
    forms_.emplace_back(forms.begin(), forms.end());
    return add(bodies_, {modes.begin(), modes.end()});
  }

  /// A free mass [kg], which moves along one line. Returns its body; mass_place() has its place.
  std::size_t add_mass(double mass_kg) {
    const Mode mode{0, 0, mass_kg};
    return add_body({&mode, 1});
  }
  std::size_t add_place(std::size_t body, std::span<const double> shapes) {
    return add(places_, {body, ModeShapes<T>(shapes)});
  }
  /// A place that moves along a string, where the shapes of the modes are sin(wavenumber x). place_m: where it
  /// begins, 0 to the length of the string.
  std::size_t add_moving_place(std::size_t string, std::span<const double> wavenumbers_per_m, T place_m) {
    ModeShapes<T> shapes(wavenumbers_per_m.size());
    StringShapes<T>(wavenumbers_per_m).at(place_m, shapes);
    return add(places_, {string, shapes, {wavenumbers_per_m.begin(), wavenumbers_per_m.end()}, place_m});
  }
  std::size_t add_mass_place(std::size_t mass) {
    const double shape = 1;
    return add_place(mass, {&shape, 1});
  }

  /// The table must outlive the network. weight: multiplies the stiffness, > 0. memories: of the material, as
  /// memories_of tells them.
  std::size_t add_contact(std::size_t first, std::size_t second, SegmentTable<T> table, T gap_m = 0,
                          const ContactControls<T>& contact = {}, T weight = 1,
                          std::span<const Memory> memories = {}) {
    return add(connections_, {.first = first,
                              .second = second,
                              .table = table,
                              .contact = contact,
                              .weight = weight,
                              .gap_m = gap_m,
                              .memories = memories});
  }

  /// A distributed contact between places of one body and one place or the ground. gaps_m: distance from each place
  /// to the profile. weights: part of the profile that each point stands for. If the material's force is per metre,
  /// they are lengths [m].
  ConnectionRange add_profile(std::span<const std::size_t> places, std::size_t second, SegmentTable<T> table,
                              std::span<const double> gaps_m, std::span<const double> weights,
                              const ContactControls<T>& contact = {}, std::span<const Memory> memories = {}) {
    const std::size_t first = connections_.size();
    for (std::size_t k = 0; k < places.size(); ++k)
      add_contact(places[k], second, table, static_cast<T>(gaps_m[k]), contact, static_cast<T>(weights[k]), memories);
    return {first, places.size()};
  }

  /// Makes a contact rough: its gap shrinks by the height of a surface that slides between its places
  /// (ContactNetwork::set_surface_speed, move_place).
  void roughen(std::size_t contact, const Roughness& roughness) { connections_[contact].roughness = roughness; }

  /// A spring [N/m] with a damper [N s/m] beside it; one of them may be 0. gap_m: displacement(first) -
  /// displacement(second) where the spring is relaxed.
  std::size_t add_spring(std::size_t first, std::size_t second, T spring_n_per_m, T resistance_n_s_per_m = 0,
                         T gap_m = 0) {
    return add(connections_, {.first = first,
                              .second = second,
                              .gap_m = gap_m,
                              .spring_n_per_m = spring_n_per_m,
                              .resistance_n_s_per_m = resistance_n_s_per_m});
  }

  /// Friction between two places that move along each other; ContactNetwork::set_normal_force presses them together,
  /// and so does the force over the last sample of a connection, such as a contact across this motion. width_m: of
  /// the surfaces across the motion, > 0, where heat weakens the material.
  std::size_t add_friction(std::size_t first, std::size_t second, const FrictionMaterial& material,
                           double width_m = 1, std::size_t pressed_by = kNoConnection) {
    return add(connections_, {.first = first,
                              .second = second,
                              .friction = material,
                              .friction_width_m = width_m,
                              .pressed_by = pressed_by});
  }

  /// A link so stiff that its length changes by 1e-3 of what the places would move apart in a sample.
  std::size_t add_rigid_link(std::size_t first, std::size_t second, T gap_m = 0) {
    return add(connections_, {.first = first, .second = second, .gap_m = gap_m, .is_rigid = true});
  }

  [[nodiscard]] const std::vector<std::vector<Mode>>& bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<StretchForm>& forms(std::size_t body) const { return forms_[body]; }
  /// Number of forms of all bodies.
  [[nodiscard]] std::size_t forms() const {
    std::size_t sum = 0;
    for (const auto& forms : forms_) sum += forms.size();
    return sum;
  }
  /// On how many samples a force acts: two where a body stretches.
  [[nodiscard]] int samples_of_step() const { return forms() > 0 ? 2 : 1; }
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }
  [[nodiscard]] const std::vector<Connection>& connections() const { return connections_; }

 private:
  template <typename Element>
  static std::size_t add(std::vector<Element>& elements, Element element) {
    elements.push_back(std::move(element));
    return elements.size() - 1;
  }

  std::vector<std::vector<Mode>> bodies_;
  std::vector<std::vector<StretchForm>> forms_;  // of each body
  std::vector<Place> places_;
  std::vector<Connection> connections_;
};

}  // namespace contactspline
