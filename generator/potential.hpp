// SPDX-License-Identifier: MIT
// One-sided contact potentials: power law, sum of power laws, smoothed measurement. Closed forms and quadratures for
// a mass on a rigid barrier.
#pragma once

#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace contactspline {

/// V(y) = stiffness/(exponent + 1) y^(exponent + 1) and F(y) = stiffness y^exponent for y > 0, else 0.
/// stiffness > 0 [N/m^exponent], exponent > 0.
struct PowerLaw {
  double stiffness;
  double exponent;

  [[nodiscard]] double energy(double compression_m) const;  ///< V(y) [J]
  [[nodiscard]] double force(double compression_m) const;   ///< dV/dy [N]

  /// ym = ((a + 1) m v^2 / (2 k))^(1/(a + 1)) [m]: all of m v^2/2 stored. mass > 0, speed >= 0.
  [[nodiscard]] double max_compression(double mass_kg, double speed_m_per_s) const;

  /// T = 2 zeta ym / v [s], zeta = sqrt(pi) Gamma(1 + 1/(a + 1)) / Gamma(1/2 + 1/(a + 1)). speed > 0.
  [[nodiscard]] double contact_duration(double mass_kg, double speed_m_per_s) const;
};

/// A power law that begins to act at a compression `offset_m` >= 0: F(y) = k (y - offset)^a beyond it.
struct PowerTerm {
  PowerLaw law;
  double offset_m = 0;
};

/// Layers that are compressed alike, their forces added (in parallel): F(y) = sum of k_i (y - d_i)^a_i.
struct PowerSum {
  std::vector<PowerTerm> terms;  ///< one at least begins at 0

  [[nodiscard]] double energy(double compression_m) const;
  [[nodiscard]] double force(double compression_m) const;
};

/// A force whose slope runs straight from knot to knot, from F(0) = 0 on: F is C1 and rises, V is convex. Beyond the
/// last knot the slope stays.
struct ForceCurve {
  std::vector<double> knot_m;         ///< from 0, rising
  std::vector<double> slope_n_per_m;  ///< >= 0, dF/dy at the knots
  std::vector<double> force_n;        ///< at the knots
  std::vector<double> energy_j;       ///< at the knots

  /// Force and energy follow from knots and slopes.
  ForceCurve(std::vector<double> knots, std::vector<double> slopes);

  [[nodiscard]] double energy(double compression_m) const;
  [[nodiscard]] double force(double compression_m) const;
};

/// Any of these laws. Energy [J] and force [N] are 0 for y <= 0; the force never falls.
class Potential {
 public:
  using Law = std::variant<PowerLaw, PowerSum, ForceCurve>;

  Potential(double stiffness, double exponent) : law_(PowerLaw{stiffness, exponent}) {}
  template <typename Kind>
  requires std::is_constructible_v<Law, Kind> Potential(Kind law) : law_(std::move(law)) {}

  [[nodiscard]] double energy(double compression_m) const;  ///< V(y) [J]
  [[nodiscard]] double force(double compression_m) const;   ///< dV/dy [N]

  /// Compression at which all of m v^2/2 is stored [m]: closed form for a power law, else a root to double precision.
  [[nodiscard]] double max_compression(double mass_kg, double speed_m_per_s) const;

  /// Time in contact [s]: closed form for a power law, else by quadrature to about 1e-10. speed > 0.
  [[nodiscard]] double contact_duration(double mass_kg, double speed_m_per_s) const;

  /// The power law, or null where it is none.
  [[nodiscard]] const PowerLaw* power_law() const { return std::get_if<PowerLaw>(&law_); }
  [[nodiscard]] const Law& law() const { return law_; }

  /// Compressions at which the law is not smooth, beyond 0, each once [m].
  [[nodiscard]] std::vector<double> breaks() const;

 private:
  Law law_;
};

}  // namespace contactspline
