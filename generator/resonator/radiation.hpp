// SPDX-License-Identifier: MIT
// The sound pressure of a plate or a membrane at a place in the room (docs/how-it-works/listening.md).
#pragma once

#include <span>
#include <vector>

#include "generator/resonator/resonator.hpp"

namespace contactspline {

/// A microphone or an ear in front of a body that lies in an endless rigid wall.
struct ListeningPlace {
  double distance_m;      ///< from the middle of the body
  double angle_rad = 0;   ///< from the normal of the body
  double around_rad = 0;  ///< where it leans to: from the direction of a plate's length or of a membrane's angle 0
  double side_m = 0;      ///< then moved to the right, as seen by a listener who looks at the middle
};

/// Distances from the nearest and from the farthest point of a body to a listening place [m].
struct Reach {
  double nearest_m, farthest_m;
};

/// Can it be listened to? A plate or a membrane.
[[nodiscard]] bool radiates(const decltype(Resonator::body)& body);

/// Precondition: radiates(body).
[[nodiscard]] Reach reach_of(const decltype(Resonator::body)& body, const ListeningPlace& place);

inline constexpr double kSpeedOfSound_m_per_s = 343;
inline constexpr double kAirDensity_kg_m3 = 1.2;

/// When a listening place begins: so many seconds of the distances are left out, the same for all places of an
/// instrument. What forces add is filtered at this sample rate.
struct RadiationTiming {
  double left_out_s;
  double sample_rate_hz;
};

/// The time to leave out for places whose nearest point of a body is at this distance.
[[nodiscard]] RadiationTiming radiation_timing(double nearest_m, double sample_rate_hz);

/// The pressure is the sum over the modes of of_velocity [Pa s/m] times the modal velocity and of_displacement [Pa/m]
/// times the modal displacement, as `sound_pickup` reads them, and over the driven places of the last forces
/// there, filtered by `taps` [Pa/N]: tap 0 is for the force of the last sample.
struct Radiation {
  std::vector<double> of_velocity, of_displacement;
  std::vector<std::vector<double>> taps;  ///< for each driven place
};

/// The same in digits on which all machines agree: as those of sin() and sqrt(), and of solutions of linear
/// equations.
[[nodiscard]] Radiation rounded(Radiation radiation);

/// `driven`: for each place where forces act the shapes of these modes there. Precondition: radiates(body).
[[nodiscard]] Radiation radiation_of(const Resonator& resonator, std::span<const NumberedMode> modes,
                                     const ListeningPlace& place, const RadiationTiming& timing,
                                     std::span<const std::vector<double>> driven);

}  // namespace contactspline
