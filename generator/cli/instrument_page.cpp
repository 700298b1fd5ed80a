// SPDX-License-Identifier: MIT
#include "generator/cli/instrument_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

std::string_view kind_of(const InstrumentBody& body) {
  return body.is_mass ? "mass" : name_of(body.resonator.body);
}

std::string_view place_name(const InstrumentModel& model, std::size_t place) {
  return place == kGround ? std::string_view("ground") : model.places[place].name;
}

// One number, or the range of several.
std::string range_text(std::vector<double> numbers) {
  const auto [min, max] = std::ranges::minmax(numbers);
  return min == max ? fmt::format("{:.6g}", min) : fmt::format("{:.6g} to {:.6g}", min, max);
}

std::string body_row(const InstrumentBody& body, double sample_rate_hz) {
  if (body.is_mass)
    return fmt::format("{:.6g} kg", std::get<ModeTable>(body.resonator.body).rows.front().mode.mass_kg);
  const auto modes = modes_of(body.resonator, sample_rate_hz / 2).modes;
  if (modes.empty()) return "no mode";
  const auto hz = [](const ResonatorMode& mode) {
    return mode.mode.angular_frequency_rad_per_s / (2 * std::numbers::pi);
  };
  return fmt::format("{} modes from {:.6g} to {:.6g} Hz", modes.size(), hz(modes.front()), hz(modes.back()));
}

// Distance from the middle of a membrane, negative on its other side, or from an end of another body [m].
double position_of(const Place& point) {
  return std::cos(point.angle_rad) < 0 ? -point.position_m : point.position_m;
}

// Of the diameter or radius on which a point lies, as position_of counts it [rad].
double angle_of(const Place& point) {
  return std::cos(point.angle_rad) < 0 ? point.angle_rad - std::numbers::pi : point.angle_rad;
}

// All points of a place lie on a line: across_m and the angle are the same for all of them.
std::string place_row(const decltype(Resonator::body)& body, const InstrumentPlace& place) {
  if (!place.shapes.empty()) return "given by shapes";
  if (const double radius = place.points.front().mean_radius_m; radius > 0)
    return fmt::format("mean over the disc of {:.6g} m about the middle", radius);
  std::vector<double> positions;
  for (const Place& point : place.points) positions.push_back(position_of(point));
  std::string row = fmt::format("{} m", range_text(positions));
  if (std::holds_alternative<Plate>(body)) row += fmt::format(", {:.6g} m across", place.points.front().across_m);
  if (std::holds_alternative<Membrane>(body)) row += fmt::format(", {:.6g} rad", angle_of(place.points.front()));
  return positions.size() == 1 ? row : fmt::format("{}, {} points", row, positions.size());
}

std::string connection_row(const InstrumentModel& model, const ConnectionGroup& group) {
  std::string row =
      fmt::format("{} and {}", place_name(model, group.each.first), place_name(model, group.each.second));
  if (group.gaps_m.size() > 1) row += fmt::format(", {} points", group.gaps_m.size());
  row += fmt::format(", gap {} m", range_text(group.gaps_m));
  if (group.each.kind == ConnectionKind::kContact)
    row += fmt::format(", {} times {}", model.tables[group.each.table].material, range_text(group.weights));
  if (group.each.kind == ConnectionKind::kSpring)
    row += fmt::format(", {:.6g} N/m, {:.6g} N s/m", group.each.stiffness_n_per_m, group.each.resistance_n_s_per_m);
  return row;
}

/// Draws an instrument: a row for each body from the top. What is held by the ground ends at a bar below its body.
class Diagram {
 public:
  explicit Diagram(const InstrumentModel& model) : model_(model) {
    for (const InstrumentPlace& place : model.places) xs_.push_back(xs_on_body(place));
    for (std::size_t p = 0; p < model.places.size(); ++p)
      if (model.bodies[model.places[p].body].is_mass) xs_[p] = {x_of_mass(p)};
  }

  std::string draw() {
    script_ = fmt::format(
        "unset border\nunset tics\nunset grid\nunset key\nset style textbox opaque noborder margins 0.2,0.2\n"
        "set xrange [0:1]\nset yrange [0.2:{}]\n",
        static_cast<double>(model_.bodies.size()) + 0.6);
    for (std::size_t k = 0; k < model_.connections.size(); ++k) draw_connection(k);
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) draw_body(b);
    for (std::size_t p = 0; p < model_.places.size(); ++p) draw_place(p);
    return script_ + "plot NaN\nunset multiplot\n";
  }

 private:
  struct Point {
    double x, y;
  };

  static constexpr double kLeft = 0.17, kRight = 0.985;
  static constexpr double kShift = 0.09;       // of the last row to the right
  static constexpr double kGroundDepth = 0.4;  // below a body

  [[nodiscard]] double row_of(std::size_t body) const { return static_cast<double>(model_.bodies.size() - body); }

  // Each row lies further to the right than the one above it, by more and more: so a line that passes a body does not
  // meet its points.
  [[nodiscard]] double left_of(std::size_t body) const {
    const double part =
        static_cast<double>(body) / static_cast<double>(std::max<std::size_t>(model_.bodies.size(), 2));
    return kLeft + kShift * part * part;
  }

  // From the left end of a body to its right one. Half of it is the position, half the rank among the points of the
  // body: neighbours would lie on each other. The places of a table of modes lie side by side.
  [[nodiscard]] std::vector<double> xs_on_body(const InstrumentPlace& place) const {
    const Resonator& resonator = model_.bodies[place.body].resonator;
    const double extent = extent_of(resonator.body);
    std::vector<double> xs;
    for (const Place& point : place.points) {
      double part = position_of(point) / extent;
      if (std::holds_alternative<Membrane>(resonator.body)) part = (1 + part) / 2;
      part = std::holds_alternative<ModeTable>(resonator.body) ? part_on_table(place)
                                                               : (part + rank_of(place.body, point)) / 2;
      xs.push_back(left_of(place.body) + (kRight - kShift - kLeft) * part);
    }
    return xs;
  }

  // Of a point among those of its body, from 0 to 1.
  [[nodiscard]] double rank_of(std::size_t body, const Place& point) const {
    int count = 0, before = 0;
    for (const InstrumentPlace& place : model_.places)
      for (const Place& other : place.points) {
        if (place.body != body) continue;
        ++count;
        before += position_of(other) < position_of(point);
      }
    return (before + 0.5) / count;
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

  void draw_line(Point from, Point to, std::string_view style) {
    script_ +=
        fmt::format("set arrow from {:.4f},{:.4f} to {:.4f},{:.4f} nohead {}\n", from.x, from.y, to.x, to.y, style);
  }

  void draw_label(Point at, std::string_view text, std::string_view alignment, std::string_view colour = "#222222",
                  std::string_view style = "") {
    script_ += fmt::format("set label '{}' at {:.4f},{:.4f} {} noenhanced front textcolor rgb '{}' font ',12' {}\n",
                           text, at.x, at.y, alignment, colour, style);
  }

  // Point i of a place, or its only point; the ground is below the other end.
  [[nodiscard]] Point point(std::size_t place, std::size_t other, std::size_t i) const {
    if (place == kGround) {
      const Point above = point(other, place, i);
      return {above.x, above.y - kGroundDepth};
    }
    const auto& xs = xs_[place];
    return {xs[xs.size() == 1 ? 0 : i], row_of(model_.places[place].body)};
  }

  [[nodiscard]] std::ptrdiff_t connections_at(std::size_t place) const {
    return std::ranges::count_if(model_.connections, [&](const ConnectionGroup& group) {
      return group.each.first == place || group.each.second == place;
    });
  }

  // The name stands near the end at which fewer other connections end.
  void draw_connection(std::size_t k) {
    const ConnectionGroup& group = model_.connections[k];
    const auto [first, second] = std::pair(group.each.first, group.each.second);
    const bool is_contact = group.each.kind == ConnectionKind::kContact;
    const bool is_spring = group.each.kind == ConnectionKind::kSpring;
    const std::string_view colour = is_contact ? "#d55e00" : is_spring ? "#0072b2" : "#009e73";
    const std::string style =
        fmt::format("lc rgb '{}' lw {} dt {}", colour, is_contact ? 1.6 : 2.4, is_spring ? 2 : 1);
    const std::size_t size = group.gaps_m.size();
    for (std::size_t i = 0; i < size; ++i) {
      draw_line(point(first, second, i), point(second, first, i), style);
      for (const auto& [place, other] : {std::pair(first, second), std::pair(second, first)})
        if (place == kGround) draw_ground(point(place, other, i));
    }
    Point near = point(first, second, size / 2), far = point(second, first, size / 2);
    if (connections_at(second) < connections_at(first)) std::swap(near, far);
    const double part = std::min(0.45, 0.3 / std::max(std::abs(far.y - near.y), 0.1));
    draw_label({near.x + part * (far.x - near.x) + 0.006, near.y + part * (far.y - near.y)}, group.name, "left",
               colour, "boxed");
  }

  void draw_ground(Point at) { draw_line({at.x - 0.008, at.y}, {at.x + 0.008, at.y}, "lc rgb '#888888' lw 5"); }

  void draw_body(std::size_t b) {
    const InstrumentBody& body = model_.bodies[b];
    const double y = row_of(b);
    draw_label({0.005, y}, fmt::format("{}, {}", body.name, kind_of(body)), "left");
    if (!body.is_mass)
      draw_line(
          {left_of(b), y}, {left_of(b) + kRight - kShift - kLeft, y},
          std::holds_alternative<ModeTable>(body.resonator.body) ? "lc rgb '#b8b8b8' lw 8" : "lc rgb '#555555' lw 3");
  }

  void draw_place(std::size_t p) {
    const InstrumentPlace& place = model_.places[p];
    const double y = row_of(place.body);
    const bool is_mass = model_.bodies[place.body].is_mass;
    const std::string_view style =
        is_mass ? "point pt 5 ps 2.2 lc rgb '#555555'" : "point pt 7 ps 0.7 lc rgb '#222222'";
    for (const double x : xs_[p]) draw_label({x, y}, "", "left", "#222222", style);
    if (!is_mass)
      draw_label({xs_[p][xs_[p].size() / 2], y + label_height(p)}, place.name, "center", "#666666", "boxed");
  }

  // Names of places that would overlap stand above and below their body in turn.
  [[nodiscard]] double label_height(std::size_t p) const {
    const double step = 0.032 * static_cast<double>(model_.bodies.size() + 1);
    const auto rank = std::ranges::count_if(model_.places, [&](const InstrumentPlace& other) {
      const auto q = static_cast<std::size_t>(&other - model_.places.data());
      return q < p && other.body == model_.places[p].body &&
             std::abs(xs_[q][xs_[q].size() / 2] - xs_[p][xs_[p].size() / 2]) < 0.1;
    });
    return rank % 2 == 0 ? step : -step;
  }

  const InstrumentModel& model_;
  std::vector<std::vector<double>> xs_;  // of the points of each place
  std::string script_;
};

}  // namespace

std::string instrument_table(const InstrumentModel& model, double sample_rate_hz) {
  std::string table = fmt::format("{}{}{}\n", model.name, model.description.empty() ? "" : ": ", model.description);
  const auto heading = [&](std::string_view text) { table += fmt::format("\n{}\n", text); };
  const auto row = [&](std::string_view name, std::string_view kind, const std::string& text) {
    table += fmt::format("  {:<24} {:<9} {}\n", name, kind, text);
  };
  heading(fmt::format("bodies, at {:g} Hz", sample_rate_hz));
  for (const InstrumentBody& body : model.bodies) row(body.name, kind_of(body), body_row(body, sample_rate_hz));
  heading("places");
  for (const InstrumentPlace& place : model.places)
    if (!model.bodies[place.body].is_mass)
      row(place.name, "",
          fmt::format("{}: {}", model.bodies[place.body].name,
                      place_row(model.bodies[place.body].resonator.body, place)));
  heading("connections");
  for (const ConnectionGroup& group : model.connections)
    row(group.name, name_of(group.each.kind), connection_row(model, group));
  heading("controls");
  for (const ModelControl& control : model.controls) {
    const auto [min, max] = control.range;
    row(control.name, "", fmt::format("{:g} to {:g}, at the beginning {:g}", min, max, control.initial));
  }
  for (std::size_t i = 0; i < model.strikes.size(); ++i) row(strike_name(model, i), "strike", "");
  heading("outputs");
  for (const ModelOutput& output : model.outputs) row(output.name, "", std::string(unit_of(output)));
  return table;
}

std::string instrument_diagram(const InstrumentModel& model) {
  return Diagram(model).draw();
}

}  // namespace contactspline
