// SPDX-License-Identifier: MIT
// Slow motion of the instruments that files describe, and of strings with a slide or a fret: their strings, what is
// thrown at them and what they touch.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "web/wasm/membrane.hpp"
#include "web/wasm/study.hpp"

namespace contactspline::web {

/// The geometry of a network's places, as far as their shapes tell it.
class NetworkGeometry {
 public:
  explicit NetworkGeometry(const InstrumentData& data) : data_(data), strings_(data.body_ends.size()) {
    for (std::size_t b = 0; b < data.body_ends.size(); ++b) membranes_.push_back(MembraneShapes::of(data, b));
    const std::size_t moving = data.place_bodies.size() - data.keyed.far_ends;
    for (std::size_t p = 0; p < data.place_bodies.size(); ++p) {
      const auto shapes = data.shapes_of(p);
      places_.push_back(p < moving ? along_string(shapes) : std::nullopt);
      if (places_.back()) strings_[data.place_bodies[p]] = true;
      if (const auto& membrane = membranes_[data.place_bodies[p]])
        places_.back() = (1 + membrane->along_diameter(shapes)) / 2;
    }
  }

  [[nodiscard]] bool is_string(std::size_t body) const { return strings_[body]; }
  [[nodiscard]] bool is_mass(std::size_t body) const {
    return std::ranges::find(data_.strikes, body) != data_.strikes.end();
  }
  [[nodiscard]] const std::optional<MembraneShapes>& membrane(std::size_t body) const { return membranes_[body]; }
  /// Part of the length, of a membrane's diameter through the strike; nothing where the body is neither.
  [[nodiscard]] std::optional<double> place(std::size_t place) const {
    return place == kGround ? std::nullopt : places_[place];
  }
  [[nodiscard]] std::size_t body(std::size_t place) const {
    return place == kGround ? kGround : data_.place_bodies[place];
  }

 private:
  // Mode n of a hinged string has the shape sin(n angle) at one angle.
  static std::optional<double> along_string(std::span<const double> shapes) {
    if (shapes.size() < 10 || shapes[0] == 0) return {};
    const double angle = std::acos(std::clamp(shapes[1] / (2 * shapes[0]), -1.0, 1.0));
    for (std::size_t n = 0; n < 10; ++n)
      if (std::abs(shapes[n] - std::sin(static_cast<double>(n + 1) * angle)) > 1e-6) return {};
    return angle / std::numbers::pi;
  }

  InstrumentData data_;
  std::vector<bool> strings_;
  std::vector<std::optional<MembraneShapes>> membranes_;  // of the bodies
  std::vector<std::optional<double>> places_;
};

namespace detail {

inline ModeShapes<double> sines(std::size_t modes, double angle) {
  ModeShapes<double> shapes(modes);
  for (std::size_t n = 0; n < modes; ++n) shapes[n] = std::sin(static_cast<double>(n + 1) * angle);
  return shapes;
}

/// Energies of a network of so many bodies from a note on [J].
struct NetworkBooks {
  std::size_t count;  ///< of the bodies
  double bodies = 0, contacts = 0, lost = 0,
         work = 0;  ///< contacts: with springs; work: put in, also before the note

  void open(const NetworkInstrument<double>& instrument) {
    store(instrument);
    work = bodies + contacts;
  }
  void follow(const NetworkInstrument<double>& instrument) {
    store(instrument);
    lost += instrument.dissipated();
    work += instrument.work();
  }

 private:
  void store(const NetworkInstrument<double>& instrument) {
    bodies = 0;
    for (std::size_t b = 0; b < count; ++b) bodies += instrument.network().body(b).energy();
    contacts = instrument.energy() - bodies;
  }
};

inline constexpr std::size_t kNetworkHead = 5;  // numbers before those of the items

/// What is read from a network in each frame: the sum of the forces of its contacts, its books, and what is drawn.
class NetworkFrames {
 public:
  explicit NetworkFrames(const InstrumentData& data) : data_(data), geometry_(data) {
    for (std::size_t b = 0; b < data.body_ends.size(); ++b) {
      if (geometry_.is_string(b))
        add_string(b);
      else if (!geometry_.is_mass(b))
        add_body(b);
    }
    for (std::size_t k = 0; k < data.connections.size(); ++k) add_connection(k);
  }

  void append_to(std::vector<double>& numbers, const NetworkInstrument<double>& instrument,
                 const NetworkBooks& books) const {
    const ContactNetwork<double>& network = instrument.network();
    const double imbalance = books.bodies + books.contacts + books.lost - books.work;
    numbers.insert(numbers.end(), {instrument.contact_force(), books.bodies, books.contacts, books.lost, imbalance});
    for (const Curve& curve : curves_)
      for (const auto& shapes : curve.points) numbers.push_back(network.body(curve.body).displacement(shapes));
    for (const auto& [body, shapes] : masses_) numbers.push_back(network.body(body).displacement(shapes));
    for (const std::size_t k : contacts_) {
      numbers.push_back(network.compression(k));
      numbers.push_back(network.force(k));
    }
  }

  [[nodiscard]] std::string scene(const Event& event, double work_j) const {
    std::vector<std::string> items;
    std::size_t column = kNetworkHead;
    for (const Curve& curve : curves_) {
      items.push_back(fmt::format(R"({{"kind": "{}", "column": {}, "points": {}, "rings": {}}})", curve.kind, column,
                                  curve.points.size(), curve.kind == std::string_view("surface") ? kRings : 0));
      column += curve.points.size();
    }
    const std::size_t first_contact = column + masses_.size();
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      items.push_back(contact_item(contacts_[i], column, first_contact + 2 * i));
    return fmt::format(
        R"({{"throws": {}, "moves": null, "plucks": {}, "force": 0, "energies": [], "isFlipped": {}, "items": [{}], )"
        R"("books": [["bodies", 1], ["contacts", 2], ["lost", 3]], "imbalance": 4, "work": {:.17g}}})",
        event.parameter, pluck(event), has_stops() || has_membranes(), fmt::join(items, ", "), work_j);
  }

 private:
  // Where an event plucks a string, and the first number of the string in a frame; null where it plucks none.
  [[nodiscard]] std::string pluck(const Event& event) const {
    if (event.kind != EventKind::kPluck) return "null";
    const std::size_t place = data_.targets_of(data_.controls[data_.plucks[event.number]]).front();
    std::size_t column = kNetworkHead;
    for (const Curve& curve : curves_) {
      if (curve.body == geometry_.body(place) && geometry_.is_string(curve.body))
        return fmt::format(R"({{"at": {:.17g}, "column": {}}})", at(place), column);
      column += curve.points.size();
    }
    return "null";
  }

  struct Curve {
    const char* kind;
    std::size_t body;
    std::vector<ModeShapes<double>> points;
  };

  void add_string(std::size_t b) {
    Curve& curve = curves_.emplace_back(Curve{"string", b, {}});
    for (std::size_t p = 0; p < kPoints; ++p)
      curve.points.push_back(sines(data_.modes_of(b), std::numbers::pi * static_cast<double>(p) / (kPoints - 1)));
  }

  // A membrane, or the places of a plate or a bar, side by side.
  void add_body(std::size_t b) {
    if (const auto& membrane = geometry_.membrane(b)) {
      curves_.push_back({"surface", b, membrane_points(*membrane)});
      return;
    }
    Curve curve{"body", b, {}};
    for (std::size_t p = 0; p < data_.place_bodies.size(); ++p)
      if (data_.place_bodies[p] == b) curve.points.emplace_back(data_.shapes_of(p));
    if (!curve.points.empty()) curves_.push_back(std::move(curve));
  }

  void add_connection(std::size_t k) {
    const InstrumentConnection& c = data_.connections[k];
    if (c.kind != ConnectionKind::kContact) return;
    contacts_.push_back(k);
    for (const std::size_t place : {c.first, c.second})
      if (const std::size_t body = geometry_.body(place); body != kGround && geometry_.is_mass(body))
        masses_.push_back({body, ModeShapes<double>(std::vector<double>{1})});
  }

  // A mass that meets something, a stop in the way of a string, or two bodies that meet.
  [[nodiscard]] std::string contact_item(std::size_t k, std::size_t first_mass, std::size_t column) const {
    const InstrumentConnection& c = data_.connections[k];
    std::size_t masses = 0;
    for (const std::size_t other : contacts_)
      for (const std::size_t place : {data_.connections[other].first, data_.connections[other].second}) {
        const std::size_t body = geometry_.body(place);
        if (body == kGround || !geometry_.is_mass(body)) continue;
        if (other == k)
          return fmt::format(R"({{"kind": "hammer", "at": {}, "column": {}, "compression": {}, "surface": {:.17g}}})",
                             at(place == c.first ? c.second : c.first), first_mass + masses, column,
                             place == c.first ? -c.gap_m : c.gap_m);
        ++masses;
      }
    if (c.first != kGround && c.second != kGround)
      return fmt::format(R"({{"kind": "touch", "at": {}, "force": {}}})", at(c.first), column + 1);
    const bool is_above = c.second == kGround;
    return fmt::format(R"({{"kind": "stop", "at": {}, "height": {:.17g}, "side": {}, "force": {}}})",
                       at(is_above ? c.first : c.second), is_above ? c.gap_m : -c.gap_m, is_above ? 1 : -1,
                       column + 1);
  }

  // A drum is struck from above.
  [[nodiscard]] bool has_membranes() const {
    return std::ranges::any_of(curves_,
                               [&](const Curve& curve) { return geometry_.membrane(curve.body).has_value(); });
  }

  // What a string meets on the ground is drawn below it.
  [[nodiscard]] bool has_stops() const {
    return std::ranges::any_of(contacts_, [&](std::size_t k) {
      return data_.connections[k].first == kGround || data_.connections[k].second == kGround;
    });
  }

  [[nodiscard]] double at(std::size_t place) const { return geometry_.place(place).value_or(0.5); }

  InstrumentData data_;
  NetworkGeometry geometry_;
  std::vector<Curve> curves_;
  std::vector<std::pair<std::size_t, ModeShapes<double>>> masses_;
  std::vector<std::size_t> contacts_;
};

}  // namespace detail

/// A key or an event of an instrument of a file. values: of its parameters.
inline Study study_of_network(const InstrumentData& data, std::span<const double> values, std::size_t event,
                              const StudyPlan& plan) {
  NetworkInstrument<double> instrument(data);
  instrument.prepare(plan.sample_rate_hz);
  for (const KeyRange& range : data.keyed.ranges) {
    if (plan.key < range.first || plan.key > range.last) continue;
    event = range.event;
    if (range.tuned_key >= 0) instrument.tune(100.0 * (plan.key - range.tuned_key), range.string);
  }
  for (std::size_t p = 0; p < values.size(); ++p) instrument.set(p, values[p]);
  Study study;
  if (event >= instrument.events().size()) return study;
  const Event& played = instrument.events()[event];
  detail::NetworkBooks books{data.body_ends.size()};
  books.open(instrument);
  play_event(instrument, played, values[played.parameter]);
  const detail::NetworkFrames frames(data);
  for (std::size_t i = 0; i < plan.frames; ++i) {
    frames.append_to(study.numbers, instrument, books);
    instrument.tick();
    books.follow(instrument);
  }
  study.scene = frames.scene(played, books.work);
  return study;
}

/// A plucked string with a slide or a fret. I: of PluckedStringInstrument<double>. pluck: part of the length. values:
/// of its parameters.
template <typename I>
Study study_of_plucked(I& instrument, double length_m, double pluck, std::span<const double> values,
                       const StudyPlan& plan) {
  for (std::size_t p = 0; p < values.size(); ++p) instrument.set(p, values[p]);
  instrument.prepare(plan.sample_rate_hz);
  const auto& model = instrument.model();
  constexpr bool kSlides = requires {
    model.slide();
  };
  const std::size_t modes = model.string().size();
  std::vector<ModeShapes<double>> points;
  for (std::size_t p = 0; p < kPoints; ++p)
    points.push_back(detail::sines(modes, std::numbers::pi * static_cast<double>(p) / (kPoints - 1)));
  instrument.pluck(0, values[I::kPluck]);
  Study study;
  std::vector<double> force(1);
  for (std::size_t i = 0; i < plan.frames; ++i) {
    const double place = model.place();
    const double at_contact = model.string().displacement(detail::sines(modes, std::numbers::pi * place / length_m));
    const double height = kSlides ? at_contact + model.compression() : at_contact - model.compression();
    study.numbers.insert(study.numbers.end(), {model.force(), place / length_m, height});
    for (const auto& point : points) study.numbers.push_back(model.string().displacement(point));
    instrument.process({}, force);
  }
  study.scene = fmt::format(
      R"({{"throws": {}, "moves": null, "plucks": {{"at": {:.17g}, "column": 3}}, "force": 0, "energies": [], "isFlipped": true, )"
      R"("items": [{}{{"kind": "stop", "name": "{}", "atColumn": 1, "column": 2, "side": {}, "force": 0}}]}})",
      std::size_t{I::kPluck}, pluck, detail::string_item(3), kSlides ? "slide" : "fret", kSlides ? -1 : 1);
  return study;
}

}  // namespace contactspline::web
