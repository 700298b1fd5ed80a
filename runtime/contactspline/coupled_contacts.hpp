// SPDX-License-Identifier: MIT
// The coupled step: one sample of several contacts and springs that move each other.
#pragma once

#include "contactspline/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "contactspline/contact.hpp"
#include "contactspline/kernels.hpp"
#include "contactspline/modal.hpp"

namespace contactspline {

/// A contact or a spring over one sample. It is a contact if it has a table. A spring has none, pulls as well as it
/// pushes, and stores spring_n_per_m compression^2/2.
template <std::floating_point T>
struct CoupledConnection {
  SegmentTable<T> table = {};
  ContactControls<T> contact = {};
  T spring_n_per_m = 0;     ///< >= 0
  T resistance = 0;         ///< viscous force per metre of increment [N/m], R/dt, >= 0; of springs only
  T compression = 0;        ///< at the beginning of the sample [m]; advance() moves it to the end
  T free_increment = 0;     ///< change of the compression over the sample if no connection acted [m]
  std::size_t segment = 0;  ///< of a contact: the one that holds the compression; advance() moves it too
  T force = 0;              ///< over the last sample [N]; the search for the next one begins here
};

namespace detail {

/// Force of a connection over a sample and its slope, as functions of the increment.
template <std::floating_point T>
struct ForceAndSlope {
  T force, slope;
};

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

  SampleLaw(const CoupledConnection<T>& c, T time_step) : table_(c.table), start_(c.segment), y0_(c.compression) {
    const Segment<T>& here = table_[start_];
    ratio_ = c.contact.stiffness_ratio;
    slope_at_knot_ = here.force_at(y0_);
    force_ = ratio_ * slope_at_knot_;
    half_curvature_ = ratio_ * here.half_curvature;
    resistance_ = c.contact.loss_s_per_m > 0 ? c.contact.loss_s_per_m * ratio_ / time_step * slope_at_knot_ : T(0);
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
    const T elastic = step.force - resistance_ * x, at_end = ratio_ * table_[step.segment].force_at(step.compression);
    return std::max(T(0), (at_end - elastic) / x) + resistance_;
  }

  /// A slope C [N/m] with force_at_rest() + C x >= force(x) for x > 0 and <= force(x) for x < 0, whatever x: half the
  /// largest curvature, and the resistance.
  [[nodiscard]] T steepest_slope() const {
    T half_curvature = half_curvature_;
    for (const Segment<T>& segment : table_)
      half_curvature = std::max(half_curvature, ratio_ * segment.half_curvature);
    return half_curvature + resistance_;
  }

  [[nodiscard]] T force_at_rest() const { return force_; }      ///< for x = 0 [N]
  [[nodiscard]] std::size_t segment() const { return start_; }  ///< in which the sample begins

  /// Where a step with the increment x ends. segment: as in at().
  [[nodiscard]] EndOfSample<T> end_of(T x, std::size_t segment) const {
    if (x >= lower_ && x < upper_) return {y0_ + x, relocate_segment(table_, start_, y0_ + x)};
    const Crossed crossed = cross(x, segment);
    const T y = table_[crossed.entry].knot + crossed.beyond;
    return {y, relocate_segment(table_, crossed.last, y)};
  }

 private:
  // A step that ends in segment `last`, `beyond` the knot `entry` by which it enters this segment.
  struct Crossed {
    std::size_t last, entry;
    T beyond;
  };

  [[nodiscard]] T distance_to(std::size_t knot) const { return whole(table_[knot].knot - y0_); }

  [[nodiscard]] Crossed cross(T x, std::size_t expected) const {
    std::size_t last = expected;
    if (x >= upper_) {
      last = std::max(last, start_);
      while (last > start_ && x < distance_to(last)) --last;
      while (last + 1 < table_.size() && x >= distance_to(last + 1)) ++last;
      return {last, last, x - distance_to(last)};
    }
    last = std::min(last, start_);
    while (last < start_ && x >= distance_to(last + 1)) ++last;
    while (last > 0 && x < distance_to(last)) --last;
    return {last, last + 1, x - distance_to(last + 1)};
  }

  [[nodiscard]] ForceAndSlope<T> crossing(T x, std::size_t& segment) const {
    const Crossed crossed = cross(x, segment);
    segment = crossed.last;
    const bool up = x >= upper_;
    const Segment<T>& first = table_[start_ + up];
    const Segment<T>& entry = table_[crossed.entry];
    const T c = table_[crossed.last].half_curvature, s = crossed.beyond;
    const T gain_to_first = distance_to(start_ + up) * (slope_at_knot_ + first.force) / 2;
    const T gain = gain_to_first + whole(entry.energy - first.energy) + s * (entry.force + c * s);
    const T force = x != 0 ? gain / x : slope_at_knot_;
    const T slope = x != 0 ? (entry.force + 2 * c * s - force) / x : c;
    return {ratio_ * std::max(T(0), force), ratio_ * std::max(T(0), slope)};
  }

  SegmentTable<T> table_{};
  std::size_t start_ = 0;
  T y0_ = 0, ratio_ = 1, slope_at_knot_ = 0;
  T force_ = 0, half_curvature_ = 0, resistance_ = 0;  // within the segment of y0
  T lower_ = -std::numeric_limits<T>::infinity(), upper_ = std::numeric_limits<T>::infinity();  // its ends
};

/// A list of no more elements than were reserved: to add one is to store it.
template <typename Element>
class ReservedList {
 public:
  void reserve(std::size_t size) { elements_.resize(size); }
  void clear() { size_ = 0; }
  void push_back(const Element& element) { elements_[size_++] = element; }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const Element* begin() const { return elements_.data(); }
  [[nodiscard]] const Element* end() const { return elements_.data() + size_; }
  [[nodiscard]] const Element& operator[](std::size_t i) const { return elements_[i]; }
  friend bool operator==(const ReservedList& a, const ReservedList& b) { return std::ranges::equal(a, b); }

 private:
  std::vector<Element> elements_;
  std::size_t size_ = 0;
};

using IndexList = ReservedList<std::size_t>;

/// A symmetric matrix, or the lower triangle of one. Its columns begin on cache lines.
template <std::floating_point T>
class ColumnMatrix {
 public:
  ColumnMatrix() = default;
  explicit ColumnMatrix(std::size_t size) : stride_(padded(size)), values_(stride_ * size) {}

  /// n rounded up to whole cache lines.
  [[nodiscard]] static std::size_t padded(std::size_t n) {
    return (n + ModalArray<T>::kLine - 1) / ModalArray<T>::kLine * ModalArray<T>::kLine;
  }
  /// From the beginning of a column to that of the next one.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] T* column(std::size_t j) { return values_.data() + j * stride_; }
  [[nodiscard]] const T* column(std::size_t j) const { return values_.data() + j * stride_; }
  [[nodiscard]] T operator()(std::size_t i, std::size_t j) const { return column(j)[i]; }
  [[nodiscard]] T& operator()(std::size_t i, std::size_t j) { return column(j)[i]; }

 private:
  std::size_t stride_ = 0;
  ModalArray<T> values_;
};

/// to[from..n) += factor * column[from..n)
template <std::floating_point T>
void add_scaled(std::size_t from, std::size_t n, T factor, const T* __restrict column, T* __restrict to) {
  for (std::size_t i = from; i < n; ++i) to[i] += factor * column[i];
}

}  // namespace detail

/// Solves the connections of a model together, sample by sample. Over one sample
///
///     x = free increment - Xi force(x)
///
/// Xi is the matrix of admittances: by how much a newton in connection j reduces the increment of connection i. Each
/// force is the discrete gradient of its contact, so the stored energy changes by force x, exactly. A contact that
/// does not touch costs a comparison and a dot product with the forces that act. Groups without admittance between
/// them are solved apart. Springs are linear: they are eliminated, and each contact meets bodies and springs
/// together. A contact that is alone in its group is contact_step. No allocation after construction.
/// (docs/several-contacts.md)
template <std::floating_point T>
class CoupledContacts {
 public:
  /// Newton steps that a group may take in a sample. After these, the bounding law computes its forces.
  static constexpr int kMaxSteps = 64;

  /// Steps in a row that need not halve the residual. After these, each step must lower the convex merit.
  static constexpr int kPatience = 8;

  /// max_steps: in place of kMaxSteps, 0 or more. patience: in place of kPatience; -1: all steps lower the merit.
  CoupledContacts(std::size_t connections, double sample_rate_hz, int max_steps = kMaxSteps, int patience = kPatience)
      : time_step_(T(1 / sample_rate_hz)),
        max_steps_(max_steps),
        patience_(patience),
        connections_(connections),
        laws_(connections),
        ends_(connections),
        is_active_(connections),
        is_grouped_(connections),
        spring_range_(connections),
        admittance_(connections),
        beside_springs_(connections),
        spring_rows_(connections),
        spring_factor_(connections),
        coupling_(connections),
        factor_(connections),
        root_admittance_(connections),
        free_(connections),
        spring_slope_(connections),
        spring_root_(connections),
        spring_push_(connections),
        ahead_(connections),
        root_(connections),
        right_(connections),
        step_(connections),
        increments_(connections),
        force_displacements_(connections),
        now_(connections),
        next_(connections) {
    for (auto* list : {&contacts_, &active_, &touching_, &springs_, &eliminated_, &members_, &group_, &rows_})
      list->reserve(connections);
    for (auto* ends : {&spring_ends_, &row_ends_}) ends->reserve(connections);
  }

  [[nodiscard]] std::size_t size() const { return connections_.size(); }

  /// Connection i. Set its compression and free increment before each sample; read its force after it.
  [[nodiscard]] CoupledConnection<T>& operator[](std::size_t i) { return connections_[i]; }
  [[nodiscard]] const CoupledConnection<T>& operator[](std::size_t i) const { return connections_[i]; }

  /// Sets the admittance between connections i and j [m/N]. The matrix must be positive semidefinite, and the
  /// admittance of a connection with itself above 0.
  void set_admittance(std::size_t i, std::size_t j, T admittance) {
    admittance_(i, j) = admittance_(j, i) = admittance;
    members_.clear();
    eliminated_.clear();
  }
  [[nodiscard]] T admittance(std::size_t i, std::size_t j) const { return admittance_(i, j); }

  /// Begins a sample without connections.
  void begin() {
    for (auto* list : {&active_, &contacts_, &touching_, &springs_}) list->clear();
    steps_ = 0;
    is_first_pass_ = true;
  }

  /// Adds connection i to this sample.
  void add(std::size_t i) {
    if (connections_[i].table.empty()) {
      active_.push_back(i);
      springs_.push_back(i);
    } else {
      is_active_[i] = false;
      contacts_.push_back(i);
    }
  }

  /// Computes the forces. May be called again after further calls of add().
  void solve() {
    if (!springs_.empty()) predict_springs();
    for (const std::size_t i : contacts_) {
      if (is_active_[i]) continue;
      CoupledConnection<T>& c = connections_[i];
      increments_[i] = increment_beside_springs(i);
      if (c.compression > 0 || c.compression + increments_[i] > 0)
        activate(i);
      else
        c.force = 0;
    }
    do {
      for (const std::size_t i : touching_) is_grouped_[i] = false;
      for (const std::size_t i : touching_)
        if (!is_grouped_[i]) solve_group_of(i);
      displace_by_contacts();
      if (!springs_.empty()) solve_springs();
      is_first_pass_ = false;
    } while (activate_touching());
  }

  /// Ends the sample: moves the compressions of the connections that were added.
  void advance() {
    for (const std::size_t i : active_) {
      connections_[i].compression = ends_[i].compression;
      connections_[i].segment = ends_[i].segment;
    }
    for (const std::size_t i : contacts_) {
      if (is_active_[i]) continue;
      CoupledConnection<T>& c = connections_[i];
      c.compression += increments_[i] - force_displacements_[i];
      c.segment = c.compression < 0 ? 0 : detail::relocate_segment(c.table, 0, c.compression);
    }
  }

  /// Connections whose force solve() computed.
  [[nodiscard]] std::span<const std::size_t> active() const { return active_; }
  /// Newton steps of the last sample, of all groups of contacts.
  [[nodiscard]] int steps() const { return steps_; }
  /// In how many samples a group took the bounding law, since construction.
  [[nodiscard]] std::size_t bounded() const { return bounded_; }

 private:
  struct Range {
    std::size_t begin, end;
  };

  // Forces of a group of contacts with what follows from them. Index: position in the group.
  struct State {
    explicit State(std::size_t size) : force(size), increment(size), residual(size), slope(size), segment(size) {}

    detail::ModalArray<T> force, increment;
    detail::ModalArray<T> residual;    // force that the law wants less force
    detail::ModalArray<T> slope;       // of the law
    std::vector<std::size_t> segment;  // where the contacts end
    T norm = 0;                        // of the residual, in roots of joules
    bool is_found = false;             // are all residuals rounding?
  };

  static constexpr T kRounding = std::numeric_limits<T>::epsilon();
  // Motions whose energies round to 0 [m]: errors of less do not count.
  static constexpr T kTiny = std::numeric_limits<T>::min_exponent < -1000 ? T(1e-150) : T(1e-18);
  static constexpr int kRefinements = 2;  // of the forces of springs

  // By how much the forces of the contacts reduce the increments of all, with the springs.
  void displace_by_contacts() {
    const std::size_t padded = admittance_.padded(size());
    std::fill_n(force_displacements_.data(), padded, T(0));
    for (const std::size_t j : touching_)
      if (const T force = connections_[j].force; force != 0)
        detail::add_scaled(0, padded, force, acting_admittance().column(j), force_displacements_.data());
  }

  void activate(std::size_t i) {
    is_active_[i] = true;
    active_.push_back(i);
    touching_.push_back(i);
  }

  // Lets the contacts act that the forces of others close. Are there any?
  bool activate_touching() {
    const std::size_t before = active_.size();
    if (before == 0) return false;
    for (const std::size_t i : contacts_) {
      const CoupledConnection<T>& c = connections_[i];
      if (!is_active_[i] && c.compression + (increments_[i] - force_displacements_[i]) > 0) activate(i);
    }
    return active_.size() > before;
  }

  // Slope of a spring's force [N/m]: force = K compression + slope increment.
  [[nodiscard]] T slope_of_spring(std::size_t i) const {
    return connections_[i].spring_n_per_m / 2 + connections_[i].resistance;
  }

  // The forces of springs are root z with (I + root Xi root) z = root (K compression/slope + free increment - Xi of
  // contacts), root the roots of their slopes. The Cholesky factor L of the matrix eliminates z as it does rows of
  // any system: with W = L^-1 root Xi, contacts meet the admittances Xi - W' W and have the increments free - W'
  // ahead without forces of contacts, ahead = L^-1 root (K compression/slope + free increment).
  void predict_springs() {
    if (is_elimination_old()) eliminate_springs();
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      const CoupledConnection<T>& c = connections_[springs_[s]];
      ahead_[s] = spring_root_[s] * c.free_increment + spring_push_[s] * c.compression;
    }
    solve_forwards(spring_factor_, spring_ends_, ahead_.data());
  }

  // The increment of a contact without forces of contacts.
  [[nodiscard]] T increment_beside_springs(std::size_t i) const {
    T increment = connections_[i].free_increment;
    if (springs_.empty()) return increment;
    const T* w = spring_rows_.column(i);
    for (std::size_t s = spring_range_[i].begin; s < spring_range_[i].end; ++s) increment -= w[s] * ahead_[s];
    return increment;
  }

  // The forces of the springs beside those of the contacts, and where they end.
  void solve_springs() {
    const std::size_t m = springs_.size();
    for (std::size_t s = 0; s < m; ++s) {
      right_[s] = ahead_[s];
      step_[s] = 0;
      free_[s] = connections_[springs_[s]].free_increment;
    }
    for (const std::size_t i : touching_) {
      const T force = connections_[i].force;
      if (force == 0) continue;
      for (std::size_t s = spring_range_[i].begin; s < spring_range_[i].end; ++s) {
        right_[s] -= spring_rows_(s, i) * force;
        free_[s] -= admittance_(springs_[s], i) * force;
      }
    }
    for (int pass = 0;; ++pass) {
      solve_backwards(spring_factor_, spring_ends_, right_.data());
      for (std::size_t s = 0; s < m; ++s) step_[s] += spring_root_[s] * right_[s];
      if (!have_springs_errors() || pass == kRefinements) return;
      solve_forwards(spring_factor_, spring_ends_, right_.data());
    }
  }

  // Moves the springs by the forces step_. Does the law of one of them want a force that differs by more than
  // rounding? right_ becomes what corrects the forces. free_: their increments under the forces of contacts.
  bool have_springs_errors() {
    bool have_errors = false;
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      const std::size_t i = springs_[s];
      CoupledConnection<T>& c = connections_[i];
      T x = free_[s];
      for (std::size_t t = spring_range_[i].begin; t < spring_range_[i].end; ++t)
        x -= admittance_(springs_[t], i) * step_[t];
      const T slope = spring_slope_[s], at_rest = c.spring_n_per_m * c.compression;
      const T error = at_rest + slope * x - step_[s];
      const T displacements = std::abs(c.free_increment) + std::abs(x) + admittance_(i, i) * std::abs(step_[s]);
      const T forces = std::abs(step_[s]) + std::abs(at_rest);
      have_errors |= std::abs(error) > kRounding * (2 * forces + slope * displacements) + slope * kTiny;
      c.force = step_[s];
      ends_[i] = {c.compression + x, 0};
      right_[s] = slope > 0 ? error / spring_root_[s] : T(0);
    }
    return have_errors;
  }

  [[nodiscard]] bool is_elimination_old() const {
    if (eliminated_ != springs_) return true;
    for (std::size_t s = 0; s < springs_.size(); ++s)
      if (spring_slope_[s] != slope_of_spring(springs_[s])) return true;
    return false;
  }

  void eliminate_springs() {
    eliminated_ = springs_;
    members_.clear();
    const std::size_t m = springs_.size(), padded = spring_factor_.padded(m);
    for (std::size_t s = 0; s < m; ++s) {
      spring_slope_[s] = slope_of_spring(springs_[s]);
      spring_root_[s] = std::sqrt(spring_slope_[s]);
      spring_push_[s] =
          spring_slope_[s] > 0 ? connections_[springs_[s]].spring_n_per_m / spring_slope_[s] * spring_root_[s] : T(0);
    }
    for (std::size_t s = 0; s < m; ++s) {
      T* to = spring_factor_.column(s);
      for (std::size_t t = 0; t < m; ++t)
        to[t] = spring_root_[s] * spring_root_[t] * admittance_(springs_[t], springs_[s]);
      std::fill(to + m, to + padded, T(0));
      to[s] += 1;
    }
    factorise(spring_factor_, m);
    spring_ends_.assign(m, 0);
    for (std::size_t s = 0; s < m; ++s)
      for (std::size_t t = s; t < m; ++t)
        if (spring_factor_(t, s) != 0) spring_ends_[s] = t + 1;
    for (std::size_t i = 0; i < size(); ++i) {
      T* w = spring_rows_.column(i);
      for (std::size_t s = 0; s < m; ++s) w[s] = spring_root_[s] * admittance_(springs_[s], i);
      solve_forwards(spring_factor_, spring_ends_, w);
      Range& range = spring_range_[i] = {0, m};
      const auto is_apart = [&](std::size_t s) { return w[s] == 0 && admittance_(springs_[s], i) == 0; };
      while (range.end > 0 && is_apart(range.end - 1)) --range.end;
      while (range.begin < range.end && is_apart(range.begin)) ++range.begin;
      std::copy_n(admittance_.column(i), admittance_.stride(), beside_springs_.column(i));
      if (range.begin == range.end) continue;
      for (std::size_t j = 0; j <= i; ++j) {
        const T* v = spring_rows_.column(j);
        const std::size_t begin = std::max(range.begin, spring_range_[j].begin);
        const std::size_t end = std::min(range.end, spring_range_[j].end);
        for (std::size_t s = begin; s < end; ++s) beside_springs_(j, i) -= v[s] * w[s];
        beside_springs_(i, j) = beside_springs_(j, i);
      }
      beside_springs_(i, i) = std::max(beside_springs_(i, i), kRounding * admittance_(i, i));
    }
  }

  // The admittances that contacts meet.
  [[nodiscard]] const detail::ColumnMatrix<T>& acting_admittance() const {
    return springs_.empty() ? admittance_ : beside_springs_;
  }

  void solve_group_of(std::size_t seed) {
    collect_group(seed);
    if (group_.size() == 1) return solve_alone(seed);
    gather();
    if (!iterate()) apply_bounding_law();
    for (std::size_t a = 0; a < group_.size(); ++a) {
      const std::size_t i = group_[a];
      connections_[i].force = now_.force[a];
      ends_[i] = laws_[a].end_of(now_.increment[a], now_.segment[a]);
    }
  }

  void solve_alone(std::size_t i) {
    CoupledConnection<T>& c = connections_[i];
    const Approach<T> approach{c.compression, increments_[i], acting_admittance()(i, i)};
    const auto step = contact_step(c.table, c.contact, time_step_, approach, c.segment);
    c.force = step.force;
    ends_[i] = {step.compression, step.segment};
  }

  // The contacts that touch and are coupled with this one, directly or through others.
  void collect_group(std::size_t seed) {
    group_.clear();
    group_.push_back(seed);
    is_grouped_[seed] = true;
    for (std::size_t a = 0; a < group_.size() && group_.size() < touching_.size(); ++a) {
      const T* column = acting_admittance().column(group_[a]);
      for (const std::size_t j : touching_) {
        if (is_grouped_[j] || column[j] == 0) continue;
        is_grouped_[j] = true;
        group_.push_back(j);
      }
    }
  }

  void gather() {
    const std::size_t n = group_.size();
    if (group_ != members_) {
      members_ = group_;
      for (std::size_t b = 0; b < n; ++b) {
        const T* from = acting_admittance().column(group_[b]);
        T* to = coupling_.column(b);
        for (std::size_t a = 0; a < n; ++a) to[a] = from[group_[a]];
        std::fill(to + n, to + coupling_.padded(n), T(0));
        root_admittance_[b] = std::sqrt(to[b]);
      }
    }
    for (std::size_t a = 0; a < n; ++a) {
      const CoupledConnection<T>& c = connections_[group_[a]];
      laws_[a] = detail::SampleLaw<T>(c, time_step_);
      free_[a] = increments_[group_[a]];
      now_.force[a] = c.force;
      now_.segment[a] = next_.segment[a] = c.segment;
    }
    std::fill(free_.data() + n, free_.data() + coupling_.padded(n), T(0));
  }

  // The increments under the forces of a state.
  void displace(State& state) const {
    const std::size_t n = group_.size(), padded = coupling_.padded(n);
    std::copy_n(free_.data(), padded, state.increment.data());
    for (std::size_t b = 0; b < n; ++b)
      if (state.force[b] != 0)
        detail::add_scaled(0, padded, -state.force[b], coupling_.column(b), state.increment.data());
  }

  // Fills in a state from its forces.
  void evaluate(State& state) const {
    displace(state);
    const std::size_t n = group_.size();
    const T* x = state.increment.data();
    state.norm = 0;
    state.is_found = true;
    for (std::size_t a = 0; a < n; ++a) {
      const auto law = laws_[a].at(x[a], state.segment[a]);
      const T residual = law.force - state.force[a];
      state.residual[a] = residual;
      state.slope[a] = law.slope;
      if (residual == 0) continue;
      // Where forces cancel each other, rounding is larger: then the search ends without progress.
      const T xi = coupling_(a, a),
              displacements = std::abs(free_[a]) + std::abs(x[a]) + xi * std::abs(state.force[a]);
      const T forces = std::abs(law.force) + std::abs(laws_[a].force_at_rest());
      // Beside a law that is 0 here and not there: what moves the contact by less than rounding.
      const T slope = law.force == 0 ? std::max(law.slope, 1 / xi) : law.slope;
      const T rounding = kRounding * (2 * forces + slope * displacements) + slope * kTiny;
      state.norm = std::max(state.norm, root_admittance_[a] * std::abs(residual));
      state.is_found &= std::abs(residual) <= rounding;
    }
  }

  // Finds the solution, or returns false. Each step is Newton's, about the point that linearise_nearby() chooses. If
  // patience_ of them in a row do not halve the smallest residual, Newton's method on the convex merit goes on, which
  // cannot fail.
  bool iterate() {
    if (is_first_pass_) {
      displace(now_);
    } else {
      evaluate(now_);  // this group may be solved already
      if (now_.is_found) return true;
    }
    if (max_steps_ == 0) return false;
    T best = std::numeric_limits<T>::max();
    for (int step = 0, refused = 0; step < max_steps_; ++step) {
      linearise_nearby();
      compute_direction();
      move(1);
      ++steps_;
      refused = next_.norm <= best / 2 ? 0 : refused + 1;
      if (refused > patience_ && !next_.is_found && !descend()) break;
      std::swap(now_, next_);
      best = std::min(best, now_.norm);
      if (now_.is_found || (refused > 1 && is_rounding(now_))) return true;
    }
    return is_rounding(now_);
  }

  // May the residual be rounding of forces that cancel each other?
  [[nodiscard]] bool is_rounding(const State& state) const {
    T reach = 0;
    for (std::size_t a = 0; a < group_.size(); ++a) reach += root_admittance_[a] * std::abs(state.force[a]);
    for (std::size_t a = 0; a < group_.size(); ++a) {
      const T root = root_admittance_[a], forces = std::abs(state.force[a]) + std::abs(laws_[a].force_at_rest());
      const T slope = state.slope[a] + 1 / (root * root);
      const T rounding = kRounding * (forces + slope * (std::abs(free_[a]) + root * reach)) + slope * kTiny;
      if (!(std::abs(state.residual[a]) <= 16 * rounding)) return false;
    }
    return true;
  }

  // Linearises each contact where its own contact step ends if the other forces hold: better than where the
  // increments of now_ lie, which overshoot. The residual is scaled so that compute_direction() still applies.
  void linearise_nearby() {
    for (std::size_t a = 0; a < group_.size(); ++a) {
      const CoupledConnection<T>& c = connections_[group_[a]];
      now_.slope[a] = now_.residual[a] = 0;
      if (now_.force[a] == 0 && c.compression <= 0 && c.compression + now_.increment[a] <= 0)
        continue;  // stays apart
      const T xi = coupling_(a, a);
      const Approach<T> alone{c.compression, now_.increment[a] + xi * now_.force[a], xi};
      const auto step = contact_step(c.table, c.contact, time_step_, alone, c.segment);
      now_.slope[a] = laws_[a].slope_at(step);
      next_.segment[a] = step.segment;
      now_.residual[a] = (1 + xi * now_.slope[a]) * (step.force - now_.force[a]);
    }
  }

  // One step of Newton's method on the merit from now_ to next_, which lowers it. False if rounding hides its slope.
  bool descend() {
    evaluate(now_);
    compute_direction();
    move(1);
    const T length = search_along_direction();
    if (!(length > 0)) return false;
    if (length < 1) move(length);
    return true;
  }

  void move(T length) {
    for (std::size_t a = 0; a < group_.size(); ++a) next_.force[a] = now_.force[a] + length * step_[a];
    evaluate(next_);
  }

  // Slope of the merit at this part of the distance from now_ to next_, which lie a whole direction apart.
  [[nodiscard]] T merit_slope(T length) const {
    T sum = 0;
    for (std::size_t a = 0; a < group_.size(); ++a) {
      const T change = next_.increment[a] - now_.increment[a];
      std::size_t segment = now_.segment[a];
      const T force = laws_[a].at(now_.increment[a] + length * change, segment).force;
      sum += change * (force - (now_.force[a] + length * step_[a]));
    }
    return sum;
  }

  // A length, 0 to 1, up to which the merit falls and at which it falls at most half as steeply as at 0, or 1. 0 if
  // rounding hides the slope.
  [[nodiscard]] T search_along_direction() const {
    const T slope_at_0 = merit_slope(0);
    if (!(slope_at_0 < 0)) return 0;
    T low = 0, high = 1, slope_low = slope_at_0, slope_high = merit_slope(1);
    if (slope_high <= 0) return 1;
    for (int i = 0; i < 60 && slope_low < slope_at_0 / 2; ++i) {
      const T secant = low + (high - low) * (slope_low / (slope_low - slope_high));
      const T length = i % 2 == 0 ? std::max(secant * T(0.999), low) : low + (high - low) / 2;
      const T slope = merit_slope(length);
      (slope <= 0 ? low : high) = length;
      (slope <= 0 ? slope_low : slope_high) = slope;
    }
    return low;
  }

  // Solves (I + D Xi) step = residual, D the slopes, by a Cholesky factor of I + sqrt(D) Xi sqrt(D).
  void compute_direction() {
    const std::size_t n = group_.size();
    rows_.clear();
    bool others_move = false;
    for (std::size_t a = 0; a < n; ++a) {
      step_[a] = now_.residual[a];
      if (now_.slope[a] * coupling_(a, a) > kRounding)
        rows_.push_back(a);
      else
        others_move |= now_.residual[a] != 0;
    }
    const std::size_t m = rows_.size(), padded = factor_.padded(m);
    for (std::size_t r = 0; r < m; ++r) root_[r] = std::sqrt(now_.slope[rows_[r]]);
    for (std::size_t r = 0; r < m; ++r) {
      const T* from = coupling_.column(rows_[r]);
      T* to = factor_.column(r);
      for (std::size_t q = 0; q < m; ++q) to[q] = root_[r] * root_[q] * from[rows_[q]];
      std::fill(to + m, to + padded, T(0));
      to[r] += 1;
      T residual = now_.residual[rows_[r]] / root_[r];
      if (others_move) residual -= root_[r] * moved_by_others(rows_[r]);
      right_[r] = residual;
    }
    solve_factor(m);
    for (std::size_t r = 0; r < m; ++r) step_[rows_[r]] = root_[r] * right_[r];
  }

  // Displacement of position a by the residuals of the positions that are not in rows_.
  [[nodiscard]] T moved_by_others(std::size_t a) const {
    T sum = 0;
    for (std::size_t b = 0, r = 0; b < group_.size(); ++b) {
      if (r < rows_.size() && rows_[r] == b)
        ++r;
      else
        sum += coupling_(a, b) * now_.residual[b];
    }
    return sum;
  }

  // Solves factor_ x = right_; right_ becomes x.
  void solve_factor(std::size_t m) {
    if (m == 1) return solve_few<1>();
    if (m == 2) return solve_few<2>();
    if (m == 3) return solve_few<3>();
#ifdef CONTACTSPLINE_SIMD
    std::fill(right_.data() + m, right_.data() + factor_.padded(m), T(0));
    return detail::solve_positive_definite(m, factor_.column(0), factor_.stride(), right_.data());
#endif
    factorise(factor_, m);
    row_ends_.assign(m, m);
    solve_forwards(factor_, row_ends_, right_.data());
    solve_backwards(factor_, row_ends_, right_.data());
  }

  // The same for so few rows that they fit into registers.
  template <std::size_t kRows>
  void solve_few() {
    T l[kRows][kRows], x[kRows];
    for (std::size_t j = 0; j < kRows; ++j) {
      T diagonal = factor_(j, j);
      x[j] = right_[j];
      for (std::size_t k = 0; k < j; ++k) {
        l[j][k] = factor_(j, k);
        for (std::size_t q = 0; q < k; ++q) l[j][k] -= l[j][q] * l[k][q];
        l[j][k] *= l[k][k];
        diagonal -= l[j][k] * l[j][k];
        x[j] -= l[j][k] * x[k];
      }
      l[j][j] = 1 / std::sqrt(std::max(diagonal, T(1)));
      x[j] *= l[j][j];
    }
    for (std::size_t j = kRows; j-- > 0;) {
      for (std::size_t k = j + 1; k < kRows; ++k) x[j] -= l[k][j] * x[k];
      right_[j] = x[j] *= l[j][j];
    }
  }

  // The matrix becomes its Cholesky factor, with the inverse of its diagonal. Above its diagonal it is scratch, so
  // that all loops run on whole vectors.
  static void factorise(detail::ColumnMatrix<T>& factor, std::size_t m) {
    constexpr std::size_t kLine = detail::ModalArray<T>::kLine;
    const std::size_t padded = factor.padded(m);
    for (std::size_t j = 0; j < m; ++j) {
      T* column = factor.column(j);
      const T inverse = 1 / std::sqrt(std::max(column[j], T(1)));  // no diagonal of I + ... is below 1
      for (std::size_t i = j / kLine * kLine; i < padded; ++i) column[i] *= inverse;
      for (std::size_t k = j + 1; k < m; ++k)
        detail::add_scaled(k / kLine * kLine, padded, -column[k], column, factor.column(k));
      column[j] = inverse;
    }
  }

  // right becomes factor^-1 right. Below row ends[j] - 1, column j is 0.
  static void solve_forwards(const detail::ColumnMatrix<T>& factor, const std::vector<std::size_t>& ends, T* right) {
    for (std::size_t j = 0; j < ends.size(); ++j) {
      const T* column = factor.column(j);
      right[j] *= column[j];
      for (std::size_t i = j + 1; i < ends[j]; ++i) right[i] -= right[j] * column[i];
    }
  }

  // right becomes factor^-T right.
  static void solve_backwards(const detail::ColumnMatrix<T>& factor, const std::vector<std::size_t>& ends, T* right) {
    for (std::size_t j = ends.size(); j-- > 0;) {
      const T* column = factor.column(j);
      T sum = right[j];
      for (std::size_t i = j + 1; i < ends[j]; ++i) sum -= column[i] * right[i];
      right[j] = sum * column[j];
    }
  }

  // One linear step with a law that is nowhere less stiff than the real one: passive, whatever the increments.
  // Contacts that do not touch at the end join until none is left out that should touch: at most one step for each.
  void apply_bounding_law() {
    ++bounded_;
    const std::size_t n = group_.size();
    for (std::size_t a = 0; a < n; ++a) {
      const auto& law = laws_[a];
      next_.force[a] = law.at(now_.increment[a], now_.segment[a]).force > 0;  // does it act?
    }
    for (bool changed = true; changed;) {
      for (std::size_t a = 0; a < n; ++a) {
        const auto& law = laws_[a];
        const bool acts = next_.force[a] != 0;
        now_.slope[a] = acts ? law.steepest_slope() : T(0);
        now_.residual[a] = acts ? law.force_at_rest() + now_.slope[a] * free_[a] : T(0);
      }
      compute_direction();
      std::copy_n(step_.data(), n, now_.force.data());
      displace(now_);
      changed = false;
      for (std::size_t a = 0; a < n; ++a) {
        const CoupledConnection<T>& c = connections_[group_[a]];
        if (next_.force[a] != 0 || c.compression + now_.increment[a] <= std::max(c.compression, T(0))) continue;
        next_.force[a] = 1;
        changed = true;
      }
    }
  }

  T time_step_;
  int max_steps_, patience_;
  std::vector<CoupledConnection<T>> connections_;
  std::vector<detail::SampleLaw<T>> laws_;  // of the positions in the group
  std::vector<detail::EndOfSample<T>> ends_;
  std::vector<char> is_active_, is_grouped_;
  std::vector<Range> spring_range_;                // springs that move a connection
  detail::IndexList contacts_;                     // that were added
  detail::IndexList active_, touching_, springs_;  // all that act, and these by kind
  detail::IndexList eliminated_;                   // springs that are eliminated from beside_springs_
  std::vector<std::size_t> spring_ends_;           // rows of spring_factor_ from which on each column is 0
  std::vector<std::size_t> row_ends_;              // the same of factor_
  detail::IndexList members_;                      // whose admittances coupling_ holds
  detail::IndexList group_;                        // that is being solved
  detail::IndexList rows_;                         // positions in the group with a slope
  detail::ColumnMatrix<T> admittance_, beside_springs_, spring_rows_, spring_factor_, coupling_, factor_;
  detail::ModalArray<T> root_admittance_, free_, spring_slope_, spring_root_, spring_push_, ahead_, root_, right_,
      step_;
  detail::ModalArray<T> increments_;  // of the contacts that were added, with springs, without forces of contacts
  detail::ModalArray<T> force_displacements_;
  State now_, next_;
  int steps_ = 0;
  bool is_first_pass_ = true;  // of solve() in this sample
  std::size_t bounded_ = 0;
};

}  // namespace contactspline
