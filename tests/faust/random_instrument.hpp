// SPDX-License-Identifier: MIT
// Random instrument files: bodies of all kinds, connections, controls, strikes and outputs, with constants over their
// ranges and at the ends of them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace contactspline::testing {

/// Writes one file after the other. What an instrument file may not say is refused by its reader: draw again.
class RandomInstruments {
 public:
  using Materials = std::array<const char*, 4>;

  /// materials: of the contacts. stretch: strings and membranes do. rub: there are frictions.
  explicit RandomInstruments(unsigned seed,
                             const Materials& materials = {"felt_c4", "mb1", "rubber_on_wood", "steel_on_steel"},
                             bool stretch = false, bool rub = false)
      : random_(seed), materials_(materials), stretch_(stretch), rub_(rub) {}

  [[nodiscard]] std::string next() {
    places_.clear();
    connections_.clear();
    std::ostringstream text;
    text.precision(17);
    const int bodies = integer(1, 3), masses = integer(1, 2);
    text << "{\n\"name\": \"random\",\n\"bodies\": [\n";
    for (int b = 0; b < bodies; ++b) text << "{ \"name\": \"b" << b << "\", " << body(b) << " },\n";
    for (int m = 0; m < masses; ++m) {
      text << "{ \"name\": \"m" << m << "\", \"mass_kg\": " << number(1e-5, 1, 1e-7, 1e4) << " }"
           << (m + 1 < masses ? "," : "") << '\n';
      places_.push_back({"m" + std::to_string(m), bodies + m});
    }
    text << "],\n\"places\": [" << joined(place_texts_) << "],\n";
    place_texts_.clear();
    text << list("contacts", contacts()) << list("springs", springs()) << list("links", links());
    if (rub_) text << list("frictions", frictions());
    text << "\"strikes\": [\"m0\"" << (masses == 2 ? ", \"m1\"" : "") << "],\n";
    text << list("controls", controls(bodies)) << "\"outputs\": [" << joined(outputs()) << "]\n}\n";
    return text.str();
  }

  /// Log-uniform from min to max; at times one of the two ends.
  [[nodiscard]] double number(double min, double max, double low_end, double high_end) {
    const int end = integer(0, 15);
    if (end < 2) return end == 0 ? low_end : high_end;
    return std::exp(uniform(std::log(min), std::log(max)));
  }
  [[nodiscard]] double uniform(double min, double max) {
    return min + (max - min) * std::generate_canonical<double, 53>(random_);
  }
  [[nodiscard]] int integer(int min, int max) {
    return min + static_cast<int>(random_() % static_cast<unsigned>(max - min + 1));
  }

 private:
  struct PlaceOf {
    std::string name;
    int body;
  };

  static std::string text_of(double value) {
    std::ostringstream text;
    text.precision(17);
    text << value;
    return text.str();
  }

  static std::string joined(const std::vector<std::string>& texts) {
    std::string all;
    for (const std::string& text : texts) all += (all.empty() ? "\n" : ",\n") + text;
    return all;
  }

  static std::string list(const std::string& key, const std::vector<std::string>& texts) {
    return texts.empty() ? "" : "\"" + key + "\": [" + joined(texts) + "],\n";
  }

  std::string losses() {
    return ", \"constant_loss_per_s\": " + text_of(number(0.1, 1e6, 0, 1e6)) +
           ", \"quadratic_loss_m2_per_s\": " + text_of(number(1e-6, 1, 0, 10)) +
           " }, \"max_modes\": " + text_of(integer(1, 12));
  }

  std::string stretch(const std::string& size, const std::string& more) {
    if (!stretch_) return "";
    return ", \"stretch\": { \"youngs_modulus_pa\": " + text_of(number(1e8, 2e11, 1e6, 1e12)) + ", \"" + size +
           "\": " + text_of(number(1e-4, 1e-3, 1e-5, 1e-2)) + more + " }";
  }

  std::string body(int b) {
    const std::string name = "b" + std::to_string(b);
    const int kind = integer(0, 3), places = integer(1, 3);
    std::string text;
    std::vector<std::string> where(static_cast<std::size_t>(places));
    if (kind == 0) {
      const int modes = integer(1, 12);
      text = "\"modes\": [";
      for (int i = 0; i < modes; ++i)
        text += std::string(i == 0 ? "" : ", ") + "{ \"frequency_hz\": " + text_of(number(20, 2e4, 0.1, 21999)) +
                ", \"decay_per_s\": " + text_of(number(0.1, 1e6, 0, 1e6)) +
                ", \"mass_kg\": " + text_of(number(1e-5, 1, 1e-6, 1e4)) + " }";
      text += "]";
      for (std::string& place : where) {
        place = "\"shapes\": [";
        for (int i = 0; i < modes; ++i) place += (i == 0 ? "" : ", ") + text_of(uniform(-2, 2));
        place += "]";
      }
    } else {
      const double length = std::exp(uniform(std::log(0.05), std::log(1.0)));
      const std::string size = "\"length_m\": " + text_of(length) + ", \"mass_kg\": ";
      if (kind == 1)
        text = "\"string\": { " + size + text_of(number(1e-4, 0.1, 1e-5, 10)) +
               ", \"tension_n\": " + text_of(number(10, 1e3, 0.1, 1e5)) +
               ", \"bending_stiffness_n_m2\": " + text_of(number(1e-6, 0.1, 0, 1)) + losses() +
               stretch("core_diameter_m", "");
      if (kind == 2)
        text = "\"bar\": { " + size + text_of(number(1e-3, 1, 1e-4, 10)) +
               ", \"bending_stiffness_n_m2\": " + text_of(number(1e-3, 100, 1e-6, 1e4)) + losses();
      if (kind == 3)
        text = "\"membrane\": { \"radius_m\": " + text_of(length) +
               ", \"mass_per_area_kg_m2\": " + text_of(number(0.01, 10, 1e-3, 100)) +
               ", \"tension_n_per_m\": " + text_of(number(10, 1e4, 1, 1e6)) + losses() +
               stretch("thickness_m", ", \"poisson_ratio\": 0.3");
      for (std::string& place : where) place = "\"position_m\": " + text_of(length * uniform(0.05, 0.95));
    }
    for (int p = 0; p < places; ++p) {
      places_.push_back({name + "p" + std::to_string(p), b});
      place_texts_.push_back("{ \"name\": \"" + places_.back().name + "\", \"body\": \"" + name + "\", " +
                             where[static_cast<std::size_t>(p)] + " }");
    }
    has_string_[static_cast<std::size_t>(b)] = kind == 1;
    return text;
  }

  // Two places of different bodies, or a place and the ground.
  std::string between() {
    const PlaceOf& first = any_place();
    std::string second = "ground";
    if (integer(0, 4) != 0)
      if (const PlaceOf& other = any_place(); other.body != first.body) second = other.name;
    return "\"between\": [\"" + first.name + "\", \"" + second + "\"]";
  }
  const PlaceOf& any_place() { return places_[random_() % places_.size()]; }

  std::string named(const std::string& kind, std::size_t index, const std::string& rest) {
    connections_.push_back({kind + std::to_string(index), kind});
    return "{ \"name\": \"" + connections_.back().name + "\", " + between() + ", " + rest + " }";
  }

  std::vector<std::string> contacts() {
    std::vector<std::string> texts(static_cast<std::size_t>(integer(0, 3)));
    for (std::size_t i = 0; i < texts.size(); ++i)
      texts[i] = named("contact", i,
                       "\"material\": \"" + std::string(materials_[static_cast<std::size_t>(integer(0, 3))]) +
                           "\", \"gap_m\": " + text_of(uniform(0, 2e-3)) +
                           ", \"weight\": " + text_of(number(0.1, 10, 1, 1)));
    return texts;
  }

  std::vector<std::string> springs() {
    std::vector<std::string> texts(static_cast<std::size_t>(integer(0, 3)));
    for (std::size_t i = 0; i < texts.size(); ++i)
      texts[i] = named("spring", i,
                       "\"stiffness_n_per_m\": " + text_of(number(1, 1e6, 0, 1e9)) +
                           ", \"resistance_n_s_per_m\": " + text_of(number(1e-3, 100, 0, 1e6)));
    return texts;
  }

  std::vector<std::string> links() {
    std::vector<std::string> texts(static_cast<std::size_t>(integer(0, 1)));
    for (std::size_t i = 0; i < texts.size(); ++i) texts[i] = named("link", i, "\"gap_m\": 0");
    return texts;
  }

  // Half of them of rosin; pressed and moved by a number or by controls.
  std::vector<std::string> frictions() {
    std::vector<std::string> texts(static_cast<std::size_t>(integer(1, 2)));
    for (std::size_t i = 0; i < texts.size(); ++i)
      texts[i] =
          named("friction", i,
                (integer(0, 1) == 0 ? "\"material\": \"rosin\", \"width_m\": " + text_of(number(1e-3, 0.1, 1e-4, 1))
                                    : "\"coefficient\": " + text_of(number(0.1, 2, 0, 10)) +
                                          ", \"stiffness_per_m\": " + text_of(number(1e4, 1e7, 1e3, 1e9))) +
                    ", \"normal_force_n\": " + text_of(number(0.01, 10, 0, 1000)) +
                    ", \"surface_speed_m_per_s\": " + text_of(uniform(-1, 1)));
    return texts;
  }

  static std::string control(const std::string& key, const std::string& target) {
    return "{ \"name\": \"" + target + "\", \"" + key + "\": \"" + target + "\" }";
  }

  std::vector<std::string> controls(int bodies) {
    std::vector<std::string> texts = {control("force_n", places_.front().name)};
    for (int b = 0; b < bodies; ++b)
      if (integer(0, 1) == 0) texts.push_back(control("damping_per_s", "b" + std::to_string(b)));
    for (const Connection& connection : connections_) {
      if (connection.kind == "contact" && integer(0, 1) == 0)
        texts.push_back(control("stiffness_ratio", connection.name));
      if (connection.kind == "contact" && integer(0, 1) == 0)
        texts.push_back(control("loss_s_per_m", connection.name));
      if (connection.kind == "spring" && integer(0, 1) == 0)
        texts.push_back(control("stiffness_n_per_m", connection.name));
      if (connection.kind == "spring" && integer(0, 1) == 0)
        texts.push_back(control("resistance_n_s_per_m", connection.name));
      if (connection.kind == "friction") {
        if (integer(0, 3) != 0) texts.push_back(control("normal_force_n", connection.name));
        if (integer(0, 3) != 0) texts.push_back(control("surface_speed_m_per_s", connection.name));
        continue;
      }
      if (integer(0, 2) == 0) texts.push_back(control("gap_shift_m", connection.name));
    }
    return texts;
  }

  // Displacement and velocity of each place, the forces of all connections, the end force of each string.
  std::vector<std::string> outputs() {
    std::vector<std::string> texts;
    for (const PlaceOf& place : places_) {
      texts.push_back(control("displacement_m", place.name));
      texts.push_back(control("velocity_m_per_s", place.name));
    }
    for (const Connection& connection : connections_) texts.push_back(control("force_n", connection.name));
    for (std::size_t b = 0; b < places_.size(); ++b)
      if (b < 3 && has_string_[b]) texts.push_back(control("end_force_n", "b" + std::to_string(b)));
    has_string_[0] = has_string_[1] = has_string_[2] = false;
    return texts;
  }

  struct Connection {
    std::string name, kind;
  };

  std::mt19937_64 random_;
  Materials materials_;
  bool stretch_, rub_;
  std::vector<PlaceOf> places_;
  std::vector<std::string> place_texts_;
  std::vector<Connection> connections_;
  bool has_string_[3] = {};
};

}  // namespace contactspline::testing
