// SPDX-License-Identifier: MIT
#include "generator/instrument/diagram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "generator/instrument/label_places.hpp"
#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

// Rising numbers from 0 to 1 with at least a gap between neighbours: those with the least sum of squared moves, by
// pooling neighbours that are too close (the isotonic regression of the numbers less their gaps).
std::vector<double> moved_apart(const std::vector<double>& numbers, double gap) {
  const auto count = static_cast<double>(numbers.size());
  gap = std::min(gap, 1 / std::max(1.0, count - 1));
  struct Pool {
    double sum;
    int count;
    [[nodiscard]] double mean() const { return sum / count; }
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    pools.push_back({numbers[i] - static_cast<double>(i) * gap, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back() = {pools.back().sum + last.sum, pools.back().count + last.count};
    }
  }
  std::vector<double> moved;
  for (const Pool& pool : pools)
    for (int i = 0; i < pool.count; ++i)
      moved.push_back(std::clamp(pool.mean(), 0.0, std::max(0.0, 1 - (count - 1) * gap)) +
                      static_cast<double>(moved.size()) * gap);
  return moved;
}

/// Lays out the parts of an instrument, one after the other.
class Layout {
 public:
  Layout(const InstrumentModel& model, DiagramSize size) : model_(model), size_(size) {
    for (const InstrumentBody& body : model.bodies)
      left_ = std::max(left_, (box_of(label_of(body), {0, 0}).right * 2 + kAfterName) / size.width);
    diagram_.bottom = kBottom;
    const auto rows = static_cast<double>(model.bodies.size());
    diagram_.top = rows + std::max(0.6, rows / 20);  // labels have room above the first row
    for (const InstrumentPlace& place : model.places) xs_.push_back(xs_on_body(place));
    for (std::size_t p = 0; p < model.places.size(); ++p)
      if (model.bodies[model.places[p].body].is_mass) xs_[p] = {x_of_mass(p)};
  }

  Diagram draw() {
    for (const ConnectionGroup& group : model_.connections) draw_connection(group);
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) draw_body(b);
    for (std::size_t p = 0; p < model_.places.size(); ++p) draw_points(p);
    for (std::size_t p = 0; p < model_.places.size(); ++p) name_place(p);
    for (const ConnectionGroup& group : model_.connections) name_connection(group);
    return std::move(diagram_);
  }

 private:
  static constexpr double kRight = 0.985;
  static constexpr double kShift = 0.09;       // of the last row to the right
  static constexpr double kGroundDepth = 0.4;  // below a body
  static constexpr double kBottom = 0.2;
  static constexpr double kLeastGap = 7;    // points of the screen between two points of a body
  static constexpr double kAfterName = 12;  // points of the screen between the name of a body and the body

  [[nodiscard]] ScreenPoint on_screen(DiagramPoint at) const {
    return {size_.width * at.x, size_.height * (at.y - kBottom) / (diagram_.top - kBottom)};
  }
  [[nodiscard]] DiagramPoint in_frame(ScreenPoint at) const {
    return {at.x / size_.width, kBottom + at.y / size_.height * (diagram_.top - kBottom)};
  }

  static std::string label_of(const InstrumentBody& body) { return fmt::format("{}, {}", body.name, kind_of(body)); }

  [[nodiscard]] double row_of(std::size_t body) const { return static_cast<double>(model_.bodies.size() - body); }

  // Each row lies further to the right than the one above it, by more and more: so a line that passes a body does not
  // meet its points.
  [[nodiscard]] double left_of(std::size_t body) const {
    const double part =
        static_cast<double>(body) / static_cast<double>(std::max<std::size_t>(model_.bodies.size(), 2));
    return left_ + kShift * part * part;
  }

  // From the left end of a body to its right one, to scale; see part_on(). The places of a table of modes lie side by
  // side.
  [[nodiscard]] std::vector<double> xs_on_body(const InstrumentPlace& place) const {
    const bool is_table = std::holds_alternative<ModeTable>(model_.bodies[place.body].resonator.body);
    std::vector<double> xs;
    for (const Place& point : place.points)
      xs.push_back(left_of(place.body) +
                   (kRight - kShift - left_) * (is_table ? part_on_table(place) : part_on(place.body, point)));
    return xs;
  }

  // Where a point lies between the left and the right end of its body, 0 to 1.
  [[nodiscard]] double part_of(std::size_t body, const Place& point) const {
    const Resonator& resonator = model_.bodies[body].resonator;
    const double part = position_of(point) / extent_of(resonator.body);
    return is_round(resonator.body) ? (1 + part) / 2 : part;
  }

  // Where a point is drawn: to scale, but points that would lie on each other are moved apart, as little as possible.
  [[nodiscard]] double part_on(std::size_t body, const Place& point) const {
    std::vector<double> parts;
    for (const InstrumentPlace& place : model_.places)
      for (const Place& other : place.points)
        if (place.body == body) parts.push_back(part_of(body, other));
    std::ranges::sort(parts);
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    const auto index = std::ranges::find(parts, part_of(body, point)) - parts.begin();
    return moved_apart(parts, kLeastGap / (size_.width * (kRight - kShift - left_)))[static_cast<std::size_t>(index)];
  }

  [[nodiscard]] double part_on_table(const InstrumentPlace& place) const {
    int count = 0, index = 0;
    for (const InstrumentPlace& other : model_.places)
      if (other.body == place.body) {
        if (&other == &place) index = count;
        ++count;
      }
    return (index + 1.0) / (count + 1.0);
  }

  // Beside the middle of what it meets, so that lines from several rows do not lie on each other.
  [[nodiscard]] double x_of_mass(std::size_t place) const {
    double sum = 0;
    int count = 0;
    for (const ConnectionGroup& group : model_.connections)
      for (const auto& [mine, other] :
           {std::pair(group.each.first, group.each.second), std::pair(group.each.second, group.each.first)}) {
        if (mine != place || other == kGround || model_.bodies[model_.places[other].body].is_mass) continue;
        for (const double x : xs_[other]) sum += x;
        count += static_cast<int>(xs_[other].size());
      }
    return count == 0 ? 0.55 : std::min(sum / count + 0.09, kRight);
  }

  void draw_line(DiagramPoint from, DiagramPoint to, DiagramPart part) {
    places_.add_line(on_screen(from), on_screen(to));
    diagram_.lines.push_back({from, to, part});
  }

  // Point i of a place, or its only point; the ground is below the other end.
  [[nodiscard]] DiagramPoint point(std::size_t place, std::size_t other, std::size_t i) const {
    if (place == kGround) {
      const DiagramPoint above = point(other, place, i);
      return {above.x, above.y - kGroundDepth};
    }
    const auto& xs = xs_[place];
    return {xs[xs.size() == 1 ? 0 : i], row_of(model_.places[place].body)};
  }

  static DiagramPart part_of(const ConnectionGroup& group) {
    switch (group.each.kind) {
      case ConnectionKind::kContact:
        return DiagramPart::kContact;
      case ConnectionKind::kSpring:
        return DiagramPart::kSpring;
      case ConnectionKind::kLink:
        return DiagramPart::kLink;
      case ConnectionKind::kFriction:
        break;
    }
    return DiagramPart::kFriction;
  }

  void draw_connection(const ConnectionGroup& group) {
    const auto [first, second] = std::pair(group.each.first, group.each.second);
    for (std::size_t i = 0; i < group.gaps_m.size(); ++i) {
      draw_line(point(first, second, i), point(second, first, i), part_of(group));
      for (const auto& [place, other] : {std::pair(first, second), std::pair(second, first)})
        if (place == kGround) draw_ground(point(place, other, i));
    }
  }

  void draw_ground(DiagramPoint at) { draw_line({at.x - 0.008, at.y}, {at.x + 0.008, at.y}, DiagramPart::kSupport); }

  void draw_body(std::size_t b) {
    const InstrumentBody& body = model_.bodies[b];
    const double y = row_of(b);
    const std::string name = label_of(body);
    diagram_.labels.push_back({{0.005, y}, name, DiagramPart::kBody});
    const ScreenBox box = box_of(name, on_screen({0.005, y}));
    places_.add_box({0, box.bottom, box.right - box.left, box.top});
    if (!body.is_mass)
      draw_line({left_of(b), y}, {left_of(b) + kRight - kShift - left_, y},
                std::holds_alternative<ModeTable>(body.resonator.body) ? DiagramPart::kTable : DiagramPart::kBody);
  }

  void draw_points(std::size_t p) {
    const double y = row_of(model_.places[p].body);
    const bool is_mass = model_.bodies[model_.places[p].body].is_mass;
    const double size = is_mass ? 11 : 5;
    for (const double x : xs_[p]) {
      diagram_.dots.push_back({{x, y}, is_mass});
      const auto [at_x, at_y] = on_screen({x, y});
      places_.add_box({at_x - size, at_y - size, at_x + size, at_y + size});
    }
  }

  void name(const std::string& text, const std::vector<ScreenPoint>& middles, DiagramPart part) {
    diagram_.labels.push_back({in_frame(places_.choose(text, middles)), text, part});
  }

  // Above or below one of the points, the middle one first, or to one side of it.
  void name_place(std::size_t p) {
    const InstrumentPlace& place = model_.places[p];
    if (model_.bodies[place.body].is_mass) return;
    std::vector<double> xs = xs_[p];
    std::rotate(xs.begin(), xs.begin() + static_cast<std::ptrdiff_t>(xs.size() / 2), xs.end());
    std::vector<ScreenPoint> middles;
    const double half = box_of(place.name, {0, 0}).right;
    for (const double height : {16.0, 32.0, 48.0})
      for (const double x : xs) {
        const auto [at_x, at_y] = on_screen({x, row_of(place.body)});
        for (const double side : {0.0, 1.0, -1.0, 0.5, -0.5})
          for (const double up : {1, -1}) middles.push_back({at_x + side * (half + 3), at_y + up * height});
      }
    name(place.name, middles, DiagramPart::kPlace);
  }

  [[nodiscard]] std::ptrdiff_t connections_at(std::size_t place) const {
    return std::ranges::count_if(model_.connections, [&](const ConnectionGroup& group) {
      return group.each.first == place || group.each.second == place;
    });
  }

  // Beside one of the lines, first near the end at which fewer other connections end, or below what holds it.
  void name_connection(const ConnectionGroup& group) {
    auto [first, second] = std::pair(group.each.first, group.each.second);
    if (connections_at(second) < connections_at(first)) std::swap(first, second);
    const double half = box_of(group.name, {0, 0}).right;
    std::vector<ScreenPoint> middles;
    for (const double part : {0.3, 0.4, 0.2, 0.5, 0.6, 0.7, 0.8, 0.13, 0.87})
      for (std::size_t i = 0; i < group.gaps_m.size(); ++i) {
        const ScreenPoint a = on_screen(point(first, second, i)), b = on_screen(point(second, first, i));
        const ScreenPoint at{a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)};
        // a slanting line needs more room for the height of the label
        const double slant = 8 * std::abs(b.x - a.x) / std::max(1.0, std::abs(b.y - a.y));
        for (const double side : {1, -1}) middles.push_back({at.x + side * (half + slant + 3), at.y});
      }
    if (first == kGround || second == kGround)
      for (std::size_t i = 0; i < group.gaps_m.size(); ++i) {
        const ScreenPoint at = on_screen(first == kGround ? point(first, second, i) : point(second, first, i));
        for (const double depth : {13.0, 29.0}) middles.push_back({at.x, at.y - depth});
      }
    name(group.name, middles, part_of(group));
  }

  const InstrumentModel& model_;
  std::vector<std::vector<double>> xs_;  // of the points of each place
  DiagramSize size_;
  double left_ = 0.17;  // of the first row
  Diagram diagram_;
  LabelPlaces places_{{0, 0, size_.width, size_.height}};
};

}  // namespace

std::string_view name_of(DiagramPart part) {
  constexpr std::array kNames = {"contact", "spring", "link", "support", "body", "table", "place"};  // in its order
  return kNames[static_cast<std::size_t>(part)];
}

Diagram diagram_of(const InstrumentModel& model, DiagramSize size) {
  return Layout(model, size).draw();
}

}  // namespace contactspline
