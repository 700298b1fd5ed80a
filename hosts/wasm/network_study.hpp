// SPDX-License-Identifier: MIT
// Slow motion of the instruments that files describe: their strings, what is thrown at them and what they touch.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "hosts/wasm/drawn_instrument.hpp"
#include "hosts/wasm/study.hpp"

namespace contactspline::web {

/// Where the places of a network are on its bodies, and how these are drawn.
class NetworkGeometry {
 public:
  NetworkGeometry(const InstrumentData& data, const DrawnInstrument& drawn) : data_(data), drawn_(drawn) {}

  [[nodiscard]] DrawnKind kind(std::size_t body) const { return drawn_.bodies[body].kind; }
  [[nodiscard]] bool is_string(std::size_t body) const { return kind(body) == DrawnKind::kString; }
  [[nodiscard]] bool is_mass(std::size_t body) const { return kind(body) == DrawnKind::kMass; }
  /// The shapes of all modes at each point that is drawn.
  [[nodiscard]] std::vector<ModeShapes<double>> points(std::size_t body) const {
    const double* next = drawn_.shapes.data();
    for (std::size_t b = 0; b < body; ++b) next += drawn_.bodies[b].points * data_.modes_of(b);
    std::vector<ModeShapes<double>> points;
    for (std::size_t p = 0; p < drawn_.bodies[body].points; ++p, next += data_.modes_of(body))
      points.emplace_back(std::span(next, data_.modes_of(body)));
    return points;
  }
  /// Part of the length, of a disc's diameter; the middle where the body has neither.
  [[nodiscard]] double at(std::size_t place) const {
    const bool is_known = place < drawn_.places.size() && !std::isnan(drawn_.places[place]);
    return is_known ? drawn_.places[place] : 0.5;
  }
  [[nodiscard]] std::size_t body(std::size_t place) const {
    return place == kGround ? kGround : data_.place_bodies[place];
  }

 private:
  InstrumentData data_;
  DrawnInstrument drawn_;
};

namespace detail {

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

/// What is read from a network in each frame: the sum of the forces of its contacts, its books, and what is drawn:
/// the bodies that an event reaches by connections. Where a bow plays, the force is that of its friction.
class NetworkFrames {
 public:
  NetworkFrames(const InstrumentData& data, const DrawnInstrument& drawn, const Event& event)
      : data_(data), event_(event), geometry_(data, drawn) {
    const std::vector<bool> reached = reached_bodies();
    for (std::size_t b = 0; b < data.body_ends.size(); ++b)
      if (reached[b]) add_body(b);
    for (std::size_t k = 0; k < data.connections.size(); ++k)
      if (const std::size_t b = moving_body(k); b != kGround && reached[b]) add_connection(k);
  }

  void append_to(std::vector<double>& numbers, const NetworkInstrument<double>& instrument,
                 const NetworkBooks& books) const {
    const ContactNetwork<double>& network = instrument.network();
    const double imbalance = books.bodies + books.contacts + books.lost - books.work;
    double rubbed = 0, slip = 0;  // of all points of a bow: force, mean slip
    for (const std::size_t k : rubbing_) {
      rubbed += network.force(k);
      slip += network.slip(k) / static_cast<double>(rubbing_.size());
    }
    const double force = event_.kind == EventKind::kBow ? std::abs(rubbed) : instrument.contact_force();
    numbers.insert(numbers.end(), {force, books.bodies, books.contacts, books.lost, imbalance});
    for (const Curve& curve : curves_)
      for (const auto& shapes : curve.points) numbers.push_back(network.body(curve.body).displacement(shapes));
    for (const std::size_t k : contacts_) {
      numbers.push_back(network.compression(k));
      numbers.push_back(network.force(k));
    }
    if (!rubbing_.empty()) numbers.insert(numbers.end(), {rubbed, slip});
  }

  [[nodiscard]] std::string scene(double work_j) const {
    std::vector<std::string> items;
    std::size_t column = kNetworkHead;
    for (const Curve& curve : curves_) {
      if (!curve.kind.empty())
        items.push_back(fmt::format(R"({{"kind": "{}", "column": {}, "points": {}, {}}})", curve.kind, column,
                                    curve.points.size(), curve.more));
      column += curve.points.size();
    }
    for (const std::size_t k : contacts_) {
      items.push_back(contact_item(k, column));
      column += 2;
    }
    if (!rubbing_.empty()) items.push_back(bow_item(column));
    return fmt::format(
        R"({{"throws": {}, "moves": null, "plucks": {}, "force": 0, "energies": [], "isFlipped": {}, "items": [{}], )"
        R"("books": [["bodies", 1], ["contacts", 2], ["lost", 3]], "imbalance": 4, "work": {:.17g}}})",
        event_.parameter, pluck(), is_from_above(), fmt::join(items, ", "), work_j);
  }

 private:
  struct Curve {
    std::string kind;  // empty: it is drawn with something else
    std::size_t body;
    std::vector<ModeShapes<double>> points;
    std::string more;  // of its item
  };

  // What the event acts on, and what that reaches.
  [[nodiscard]] std::vector<bool> reached_bodies() const {
    std::vector<bool> reached(data_.body_ends.size());
    if (event_.kind == EventKind::kStrike) reached[data_.strikes[event_.number]] = true;
    if (event_.kind == EventKind::kPluck) reached[geometry_.body(plucked_place())] = true;
    if (event_.kind == EventKind::kBow)
      reached[geometry_.body(data_.connections[data_.bows[event_.number].first].second)] = true;
    for (bool grows = true; grows;) {
      grows = false;
      for (const InstrumentConnection& c : data_.connections) {
        if (c.first == kGround || c.second == kGround) continue;
        const std::size_t a = geometry_.body(c.first), b = geometry_.body(c.second);
        if (reached[a] == reached[b]) continue;
        reached[a] = reached[b] = grows = true;
      }
    }
    return reached;
  }
  [[nodiscard]] std::size_t moving_body(std::size_t k) const {
    const InstrumentConnection& c = data_.connections[k];
    return geometry_.body(c.first == kGround ? c.second : c.first);
  }
  [[nodiscard]] std::size_t plucked_place() const {
    return data_.targets_of(data_.controls[data_.plucks[event_.number]]).front();
  }

  [[nodiscard]] std::size_t column_of(std::size_t body) const {
    std::size_t column = kNetworkHead;
    for (const Curve& curve : curves_) {
      if (curve.body == body) break;
      column += curve.points.size();
    }
    return column;
  }

  // Where an event plucks a string, and the first number of the string in a frame; null where it plucks none.
  [[nodiscard]] std::string pluck() const {
    if (event_.kind != EventKind::kPluck) return "null";
    const std::size_t place = plucked_place(), body = geometry_.body(place);
    if (!geometry_.is_string(body)) return "null";
    return fmt::format(R"({{"at": {:.17g}, "column": {}}})", at(place), column_of(body));
  }

  void add_body(std::size_t b) {
    const bool is_thrown = std::ranges::find(data_.strikes, b) != data_.strikes.end();
    if (is_thrown && !is_struck_mass(b)) return;  // by another event
    switch (const DrawnKind kind = geometry_.kind(b)) {
      case DrawnKind::kNothing:
        return add_held(b);
      case DrawnKind::kMass:
        return add_mass(b);
      case DrawnKind::kString: {
        const double hz = data_.part_of(data_.angular_frequencies, b)[0] / (2 * std::numbers::pi);
        curves_.push_back({"string", b, geometry_.points(b), fmt::format(R"("hz": {:.6g})", hz)});
        return;
      }
      case DrawnKind::kBar:
        curves_.push_back({"bar", b, geometry_.points(b), R"("isBar": true)"});
        return;
      case DrawnKind::kTine:  // the others stand behind it
        if (is_played_tine(b)) curves_.push_back({"tine", b, geometry_.points(b), R"("isBar": true)"});
        return;
      default:
        curves_.push_back({"surface", b, geometry_.points(b),
                           fmt::format(R"("rings": {}, "isPlate": {}, "isFree": {})", kRings,
                                       kind != DrawnKind::kMembrane, kind == DrawnKind::kFreePlate)});
    }
  }

  // What the event throws, which its contact draws, or a weight at a string.
  void add_mass(std::size_t b) {
    Curve mass{"", b, geometry_.points(b), {}};
    for (const InstrumentConnection& c : data_.connections) {
      if (c.kind != ConnectionKind::kContact && c.kind != ConnectionKind::kSpring) continue;
      const std::size_t other = geometry_.body(c.first) == b    ? c.second
                                : geometry_.body(c.second) == b ? c.first
                                                                : kGround;
      if (is_struck_mass(b) || other == kGround || !geometry_.is_string(geometry_.body(other))) continue;
      const bool is_held = c.kind == ConnectionKind::kSpring;  // by both sides
      const bool is_around = is_held || std::ranges::count_if(data_.connections, [&](const InstrumentConnection& x) {
                                          return x.kind == ConnectionKind::kContact &&
                                                 (geometry_.body(x.first) == b || geometry_.body(x.second) == b);
                                        }) > 1;
      mass.kind = "weight";
      mass.more = fmt::format(R"("at": {:.17g}, "isAround": {})", at(other), is_around);
      break;
    }
    curves_.push_back(std::move(mass));
  }

  [[nodiscard]] bool is_played_tine(std::size_t b) const {
    return geometry_.kind(b) == DrawnKind::kTine &&
           (event_.kind != EventKind::kPluck || geometry_.body(plucked_place()) == b);
  }

  // A body at a string or a tine is its board, one at a bar its tube: each by the place that it is held at. Others
  // are not seen.
  void add_held(std::size_t b) {
    for (const InstrumentConnection& c : data_.connections) {
      if (c.kind != ConnectionKind::kLink && c.kind != ConnectionKind::kSpring) continue;
      if (c.first == kGround || c.second == kGround) continue;
      for (const auto& [own, other] : {std::pair(c.first, c.second), std::pair(c.second, c.first)}) {
        if (geometry_.body(own) != b) continue;
        const std::size_t held_by = geometry_.body(other);
        const bool is_board = geometry_.is_string(held_by) || is_played_tine(held_by);
        if (!is_board && geometry_.kind(held_by) != DrawnKind::kBar) continue;
        curves_.push_back({is_board ? "board" : "tube",
                           b,
                           {ModeShapes<double>(data_.shapes_of(own))},
                           fmt::format(R"("at": {:.17g})", at(other))});
        return;
      }
    }
  }

  void add_connection(std::size_t k) {
    const InstrumentConnection& c = data_.connections[k];
    if (c.kind == ConnectionKind::kFriction && event_.kind == EventKind::kBow) {
      const InstrumentBow& bow = data_.bows[event_.number];
      if (k >= bow.first && k < bow.first + bow.count) rubbing_.push_back(k);
    }
    if (c.kind == ConnectionKind::kContact && !is_of_other_mass(c)) contacts_.push_back(k);
  }

  [[nodiscard]] bool is_struck_mass(std::size_t body) const {
    return event_.kind == EventKind::kStrike && data_.strikes[event_.number] == body;
  }
  // A weight, which its place draws, or what another event throws.
  [[nodiscard]] bool is_of_other_mass(const InstrumentConnection& c) const {
    return std::ranges::any_of(std::array{c.first, c.second}, [&](std::size_t place) {
      const std::size_t body = geometry_.body(place);
      return body != kGround && geometry_.is_mass(body) && !is_struck_mass(body);
    });
  }

  // A bow in the middle of the points that it touches.
  [[nodiscard]] std::string bow_item(std::size_t column) const {
    double middle = 0;
    for (const std::size_t k : rubbing_)
      middle += at(data_.connections[k].second) / static_cast<double>(rubbing_.size());
    return fmt::format(R"({{"kind": "bow", "at": {:.17g}, "string": {}, "force": {}, "slip": {}}})", middle,
                       column_of(geometry_.body(data_.connections[rubbing_.front()].second)), column, column + 1);
  }

  // A mass that meets something, a stop in the way of a string, or two bodies that meet.
  [[nodiscard]] std::string contact_item(std::size_t k, std::size_t column) const {
    const InstrumentConnection& c = data_.connections[k];
    for (const std::size_t place : {c.first, c.second}) {
      const std::size_t body = geometry_.body(place);
      if (body == kGround || !geometry_.is_mass(body)) continue;
      return fmt::format(
          R"({{"kind": "hammer", "name": "{}", "at": {}, "column": {}, "compression": {}, "surface": {:.17g}}})",
          event_.name, at(place == c.first ? c.second : c.first), column_of(body), column,
          place == c.first ? -c.gap_m : c.gap_m);
    }
    if (c.first != kGround && c.second != kGround)
      return fmt::format(R"({{"kind": "touch", "at": {}, "force": {}}})", at(c.first), column + 1);
    const bool is_above = c.second == kGround;
    return fmt::format(R"({{"kind": "stop", "at": {}, "height": {:.17g}, "side": {}, "force": {}}})",
                       at(is_above ? c.first : c.second), is_above ? c.gap_m : -c.gap_m, is_above ? 1 : -1,
                       column + 1);
  }

  // Discs and bars are struck from above, and what a string meets on the ground is drawn below it.
  [[nodiscard]] bool is_from_above() const {
    return std::ranges::any_of(curves_,
                               [](const Curve& curve) { return curve.kind == "surface" || curve.kind == "bar"; }) ||
           std::ranges::any_of(contacts_, [&](std::size_t k) {
             return data_.connections[k].first == kGround || data_.connections[k].second == kGround;
           });
  }

  [[nodiscard]] double at(std::size_t place) const { return geometry_.at(place); }

  InstrumentData data_;
  Event event_;
  NetworkGeometry geometry_;
  std::vector<Curve> curves_;
  std::vector<std::size_t> contacts_, rubbing_;
};

}  // namespace detail

/// Seconds that a bow plays before it is shown: by then the string has its motion.
inline constexpr double kBowed_s = 0.5;

/// A key or an event of an instrument of a file. values: of its parameters.
inline Study study_of_network(const InstrumentData& data, const DrawnInstrument& drawn,
                              std::span<const double> values, std::size_t event, const StudyPlan& plan) {
  NetworkInstrument<double> instrument(data);
  instrument.prepare(plan.sample_rate_hz);
  double strength = 1;
  for (const KeyRange& range : data.keyed.ranges) {
    if (plan.key < range.first || plan.key > range.last) continue;
    event = range.event;
    strength = range.strength(plan.key);
    if (range.tuned_key >= 0) instrument.tune(100.0 * (plan.key - range.tuned_key), range.string);
  }
  for (std::size_t p = 0; p < values.size(); ++p) instrument.set(p, values[p]);
  Study study;
  if (event >= instrument.events().size()) return study;
  const Event& played = instrument.events()[event];
  detail::NetworkBooks books{data.body_ends.size()};
  books.open(instrument);
  play_event(instrument, played, strength * values[played.parameter]);
  const double before_s = played.kind == EventKind::kBow ? kBowed_s : 0;
  for (double left = before_s * plan.sample_rate_hz; left > 0; --left) {
    instrument.tick();
    books.follow(instrument);
  }
  const detail::NetworkFrames frames(data, drawn, played);
  for (std::size_t i = 0; i < plan.frames; ++i) {
    frames.append_to(study.numbers, instrument, books);
    instrument.tick();
    books.follow(instrument);
  }
  study.scene = frames.scene(books.work);
  return study;
}

}  // namespace contactspline::web
