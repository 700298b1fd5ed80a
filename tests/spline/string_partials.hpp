// SPDX-License-Identifier: MIT
// The partials of a shipped string after one blow with a shipped felt.
#pragma once

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/models/hammer_string.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"

namespace contactspline::testing {

constexpr double kRate_hz = 44100;
constexpr int kOversampling = 64;  // for the exact motion: what is left falls with its square

/// A shipped felt and a shipped string of the same note, "c2", "c4" or "c7".
class StruckNote {
 public:
  explicit StruckNote(const std::string& note)
      : felt_(parse_material(shipped(Shipped::kMaterials, "felt_" + note), note, shipped_file)) {
    const Resonator string = parse_resonator(shipped(Shipped::kResonators, "string_" + note), note);
    for (const ResonatorMode& mode : modes_of(string, kRate_hz / 2).modes) {
      modes_.push_back(mode.mode);
      shapes_.push_back(mode.strike_shape);
    }
  }

  [[nodiscard]] const Material& felt() const { return felt_; }
  [[nodiscard]] const std::vector<Mode>& modes() const { return modes_; }
  [[nodiscard]] const std::vector<double>& strike_shapes() const { return shapes_; }
  [[nodiscard]] double frequency_hz(std::size_t k) const {
    return modes_[k].angular_frequency_rad_per_s / (2 * std::numbers::pi);
  }

  [[nodiscard]] Spline spline_of(Knots knots, ErrorOf minimise, int segments) const {
    Material material = felt_;
    material.spline = {segments, felt_.spline.max_compression_m, knots, minimise};
    return design_spline(material, "felt.json");
  }

  /// Amplitudes of the velocity of each mode [m/s] 60 ms after the hammer was thrown from the string, when it has
  /// left it. NaN if it has not.
  [[nodiscard]] std::vector<double> velocities(const Spline& spline, double speed_m_per_s,
                                               double rate_hz = kRate_hz) const {
    return velocities(modes_, spline, speed_m_per_s, rate_hz);
  }
  [[nodiscard]] std::vector<double> velocities(std::span<const Mode> modes, const Spline& spline,
                                               double speed_m_per_s, double rate_hz) const {
    const auto table = segment_table(spline);
    HammerString<double> model(std::span<const Segment<double>>(table), modes, ModeShapes<double>(shapes_), rate_hz);
    model.strike(speed_m_per_s, 0);
    const HammerStringControls<double> controls{felt_.impact->mass_kg};
    for (int n = 0; n < 0.06 * rate_hz; ++n) model.tick(controls);
    const bool has_left = model.compression() < 0;
    const std::vector<double> before = displacements(model);
    model.tick(controls);
    const std::vector<double> after = displacements(model);
    std::vector<double> found;
    for (std::size_t k = 0; k < modes.size(); ++k) {
      const std::complex<double> pole(-modes[k].decay_per_s, modes[k].angular_frequency_rad_per_s);
      const std::complex<double> z = std::exp(pole / rate_hz);
      const double imaginary = (before[k] * z.real() - after[k]) / z.imag();  // q[n] = Re(a z^n)
      const double velocity = std::abs(pole) * std::hypot(before[k], imaginary);
      found.push_back(has_left ? velocity : std::numeric_limits<double>::quiet_NaN());
    }
    return found;
  }

  /// The same as heard: divided by what averaging over a sample takes away (ModalBank::sound_pickup).
  [[nodiscard]] std::vector<double> heard_velocities(const Spline& spline, double speed_m_per_s) const {
    std::vector<double> found = velocities(spline, speed_m_per_s);
    for (std::size_t k = 0; k < found.size(); ++k)
      found[k] /= detail::mode_constants(modes_[k], kRate_hz).averaging_factor;
    return found;
  }

  /// The same of the exact law in continuous time: 1,024 graded segments at kOversampling times the rate.
  [[nodiscard]] std::vector<double> exact_velocities(double speed_m_per_s) const {
    return velocities(spline_of(Knots::graded, ErrorOf::contact_duration, 1024), speed_m_per_s,
                      kOversampling * kRate_hz);
  }

 private:
  static std::string_view shipped(Shipped folder, const std::string& name) {
    return find_embedded(folder, name + ".json")->content;
  }

  [[nodiscard]] static std::vector<double> displacements(const HammerString<double>& model) {
    const std::size_t modes = model.string().size();
    std::vector<double> found;
    for (std::size_t k = 0; k < modes; ++k) {
      ModeShapes<double> only(modes);
      only[k] = 1;
      found.push_back(model.string().displacement(only));
    }
    return found;
  }

  Material felt_;
  std::vector<Mode> modes_;
  std::vector<double> shapes_;
};

}  // namespace contactspline::testing
