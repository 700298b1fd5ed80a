// SPDX-License-Identifier: MIT
// A connection over one sample, and the law that its force follows over it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>

#include "contactspline/step/contact.hpp"
#include "contactspline/step/friction.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// A contact, a spring or friction over one sample. It is a contact if it has a table. A spring has none, pulls as
/// well as it pushes, and stores spring_n_per_m compression^2/2. The compression of friction is the strain of its
/// bristles.
template <std::floating_point T>
struct CoupledConnection {
  SegmentTable<T> table = {};
  ContactControls<T> contact = {};
  ContactMemory<T> memory = {};  ///< where the compression has jumped, its last increment is to be set to 0
  T spring_n_per_m = 0;          ///< >= 0
  T resistance = 0;              ///< viscous force per metre of increment [N/m], R/dt, >= 0; of springs only
  T compression = 0;             ///< at the beginning of the sample [m]; advance() moves it to the end
  T free_increment = 0;          ///< change of the compression over the sample if no connection acted [m]
  std::size_t segment = 0;       ///< of a contact: the one that holds the compression; advance() moves it too
  T force = 0;                   ///< over the last sample [N]; the search for the next one begins here
  bool is_friction = false;
  Friction<T> friction = {};           ///< press() it before each sample
  FrictionStep<T> friction_step = {};  ///< of this sample; advance() ends it

  /// Energy that it stores at a compression [J].
  [[nodiscard]] double energy_at(T y) const {
    if (is_friction) return friction.energy();
    if (table.empty()) return double(spring_n_per_m) / 2 * double(y) * double(y);
    return double(contact.stiffness_ratio) * double(memory.energy(table, y));
  }
  /// Energy that it dissipated over the last sample, which began at compression y0 [J].
  [[nodiscard]] double dissipated_since(T y0, T time_step) const {
    if (is_friction) return friction.heat();
    const double x = double(compression) - double(y0);
    if (table.empty()) return double(resistance) * x * x;
    if (!(contact.loss_s_per_m > 0)) return 0;
    if (!(force > 0))  // all that it held beyond
      return double(contact.stiffness_ratio) *
             (double(memory.energy_before(table, y0)) - double(memory.energy_before(table, compression)));
    return double(contact.loss_s_per_m) * double(contact.stiffness_ratio) / double(time_step) *
           double(memory.midway_force_before(table, y0)) * x * x;
  }
  /// Energy that its memory dissipated when it relaxed last [J].
  [[nodiscard]] double dissipated_by_memory() const {
    if (memory.empty()) return 0;
    return double(contact.stiffness_ratio) *
           (double(memory.energy_before(table, compression)) - double(memory.energy(table, compression)));
  }
};

namespace detail {

/// Compression [m] at the end of a sample, and the segment that holds it.
template <std::floating_point T>
struct EndOfSample {
  T compression;
  std::size_t segment;
};

/// The law of one contact over one sample: force(x) never falls with the increment x.
template <std::floating_point T>
class SampleLaw {
 public:
  SampleLaw() = default;

  SampleLaw(const CoupledConnection<T>& c, T time_step)
      : table_(c.memory.spring(c.table)), start_(table_.segment_here(c.segment, c.compression)), y0_(c.compression) {
    const Segment<T> here = table_[start_];
    ratio_ = c.memory.designed(c.contact).stiffness_ratio;
    slope_at_knot_ = here.force_at(y0_);
    force_ = ratio_ * slope_at_knot_;
    half_curvature_ = ratio_ * here.half_curvature;
    if (c.contact.loss_s_per_m > 0)
      resistance_ =
          c.contact.loss_s_per_m * ratio_ / time_step * force_midway(table_, start_, y0_, c.memory.last_increment());
    if (start_ > 0) lower_ = distance_to(start_);
    if (start_ + 1 < table_.size()) upper_ = distance_to(start_ + 1);
  }

  /// Force over the sample [N] and its slope [N/m] for an increment x. segment: where it is expected to end, becomes
  /// where it ends.
  [[nodiscard]] ForceAndSlope<T> at(T x, std::size_t& segment) const {
    ForceAndSlope<T> elastic{force_ + half_curvature_ * x, half_curvature_};
    if (x < lower_ || x >= upper_)
      elastic = crossing(x, segment);
    else
      segment = start_;
    const ForceAndSlope<T> total{elastic.force + resistance_ * x, elastic.slope + resistance_};
    if (total.force < 0) return {0, 0};  // it would pull
    return total;
  }

  /// Slope of the force [N/m] where a contact step ends.
  [[nodiscard]] T slope_at(const ContactStep<T>& step) const {
    if (step.force == 0) return 0;
    const T x = step.compression - y0_;
    if ((x >= lower_ && x < upper_) || x == 0) return half_curvature_ + resistance_;
    const T elastic = step.force - resistance_ * x,
            at_end = ratio_ * table_[table_.segment_here(step.segment, step.compression)].force_at(step.compression);
    return (std::max)(T(0), (at_end - elastic) / x) + resistance_;
  }

  /// A slope C [N/m] with force_at_rest() + C x >= force(x) for x > 0 and <= force(x) for x < 0, whatever x: half the
  /// largest curvature, and the resistance.
  [[nodiscard]] T steepest_slope() const {
    T half_curvature = half_curvature_;
    for (std::size_t k = 0; k < table_.size(); ++k)
      half_curvature = (std::max)(half_curvature, ratio_ * table_.half_curvature(k));
    return half_curvature + resistance_;
  }

  [[nodiscard]] T force_at_rest() const { return force_; }  ///< for x = 0 [N]

  /// Where a step with the increment x ends. segment: as in at().
  [[nodiscard]] EndOfSample<T> end_of(T x, std::size_t segment) const {
    if (x >= lower_ && x < upper_) return {y0_ + x, relocate_segment(table_.table(), start_, y0_ + x)};
    const Crossed crossed = cross(x, segment);
    const T y = table_.knot(crossed.entry) + crossed.beyond;
    return {y, relocate_segment(table_.table(), crossed.last, y)};
  }

 private:
  // A step that ends in segment `last`, `beyond` the knot `entry` by which it enters this segment.
  struct Crossed {
    std::size_t last, entry;
    T beyond;
  };

  [[nodiscard]] T distance_to(std::size_t knot) const { return whole(table_.knot(knot) - y0_); }

  [[nodiscard]] Crossed cross(T x, std::size_t expected) const {
    std::size_t last = expected;
    if (x >= upper_) {
      last = (std::max)(last, start_);
      while (last > start_ && x < distance_to(last)) --last;
      while (last + 1 < table_.size() && x >= distance_to(last + 1)) ++last;
      return {last, last, x - distance_to(last)};
    }
    last = (std::min)(last, start_);
    while (last < start_ && x >= distance_to(last + 1)) ++last;
    while (last > 0 && x < distance_to(last)) --last;
    return {last, last + 1, x - distance_to(last + 1)};
  }

  [[nodiscard]] ForceAndSlope<T> crossing(T x, std::size_t& segment) const {
    if (table_.is_whole()) return crossing(table_.table(), x, segment);  // faster
    return crossing(table_, x, segment);
  }
  template <typename Table>
  [[nodiscard, gnu::always_inline]] ForceAndSlope<T> crossing(const Table& table, T x, std::size_t& segment) const {
    const Crossed crossed = cross(x, segment);
    segment = crossed.last;
    const PotentialWalk<T, Table> walk(table, start_, y0_, x >= upper_);
    const T c = table[crossed.last].half_curvature, s = crossed.beyond;
    const Segment<T> entry = table[crossed.entry];
    const T gain = walk.gain_to(crossed.entry) + s * (entry.force + c * s);
    const T force = x != 0 ? gain / x : slope_at_knot_;
    const T slope = x != 0 ? (entry.force + 2 * c * s - force) / x : c;
    return {ratio_ * (std::max)(T(0), force), ratio_ * (std::max)(T(0), slope)};
  }

  TableLessLine<T> table_;
  std::size_t start_ = 0;
  T y0_ = 0, ratio_ = 1, slope_at_knot_ = 0;
  T force_ = 0, half_curvature_ = 0, resistance_ = 0;  // within the segment of y0
  T lower_ = -std::numeric_limits<T>::infinity(), upper_ = std::numeric_limits<T>::infinity();  // its ends
};

/// The step of a connection if the forces of all others hold: its force, the slope of its law there and the segment
/// in which it ends.
template <std::floating_point T>
struct StepAlone {
  T force, slope;
  std::size_t segment;
};

/// The law of a contact or of friction over one sample: its force never falls with the increment x.
template <std::floating_point T>
class ConnectionLaw {
 public:
  ConnectionLaw() = default;
  ConnectionLaw(const CoupledConnection<T>& connection, T time_step) : is_friction_(connection.is_friction) {
    if (is_friction_)
      bristles_ = connection.friction.law();
    else
      contact_ = SampleLaw<T>(connection, time_step);
  }

  /// As SampleLaw::at.
  [[nodiscard, gnu::always_inline]] ForceAndSlope<T> at(T x, std::size_t& segment) const {
    if (is_friction_) return bristles_.at(x);
    return contact_.at(x, segment);
  }
  /// As SampleLaw::steepest_slope.
  [[nodiscard]] T steepest_slope() const { return is_friction_ ? bristles_.slope() : contact_.steepest_slope(); }
  [[nodiscard]] T force_at_rest() const {  ///< for x = 0 [N]
    return is_friction_ ? bristles_.force_at_rest() : contact_.force_at_rest();
  }

  /// The step of the connection `c` of this law, if the forces of all others hold.
  [[nodiscard]] StepAlone<T> alone(const CoupledConnection<T>& c, const Approach<T>& approach, T time_step) const {
    if (is_friction_) {
      const FrictionStep<T> step = bristles_.step(approach.free_increment, approach.receptance);
      return {step.force, bristles_.at(step.increment).slope, c.segment};
    }
    const ContactStep<T> step = c.memory.step(c.table, c.contact, time_step, approach, c.segment);
    return {step.force, contact_.slope_at(step), step.segment};
  }

  /// Where a step of a contact ends, as SampleLaw::end_of.
  [[nodiscard]] EndOfSample<T> end_of(T x, std::size_t segment) const { return contact_.end_of(x, segment); }
  /// The same of friction under a force [N].
  [[nodiscard]] FrictionStep<T> friction_step(T x, T force) const { return bristles_.end_of(x, force); }

 private:
  bool is_friction_ = false;
  SampleLaw<T> contact_;
  BristleLaw<T> bristles_;
};

}  // namespace detail

}  // namespace contactspline
