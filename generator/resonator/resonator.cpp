// SPDX-License-Identifier: MIT
#include "generator/resonator/resonator.hpp"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <type_traits>
#include <utility>
#include <variant>

#include "generator/resonator/ribbed_plate.hpp"
#include "generator/resonator/undercut_bar.hpp"

namespace contactspline {
namespace {

using std::numbers::pi;

// The i-th positive root of J_order, and J_order+1 there.
struct BesselRoot {
  double root, next_order;
};

// Each is found once: the modes of a membrane are asked for again for each place on it.
const BesselRoot& bessel_root(int order, int i) {
  thread_local std::map<std::pair<int, int>, BesselRoot> roots;
  const auto [found, is_new] = roots.try_emplace({order, i});
  if (is_new) {
    const double root = boost::math::cyl_bessel_j_zero(static_cast<double>(order), i);
    found->second = {root, boost::math::cyl_bessel_j(order + 1, root)};
  }
  return found->second;
}

UndampedMode undamped_mode(const Membrane& membrane, int order, int i) {
  const auto [root, ring] = bessel_root(order, i);
  const double beta = root / membrane.radius_m;
  const double area = area_of(membrane) * (order == 0 ? 1.0 : 0.5);
  return {beta * std::sqrt(membrane.tension_n_per_m / membrane.mass_per_area_kg_m2), beta,
          membrane.mass_per_area_kg_m2 * area * ring * ring};
}

UndampedMode undamped_mode(const Plate& plate, int m, int n) {
  const double kx = m * pi / plate.length_m, ky = n * pi / plate.width_m, x = kx * kx, y = ky * ky;
  const auto [along, across, mixed] = bending_stiffness(plate);
  const double mass_per_area = plate.density_kg_m3 * plate.thickness_m;
  return {std::sqrt((along * x * x + 2 * mixed * x * y + across * y * y) / mass_per_area), std::sqrt(x + y),
          mass_per_area * plate.length_m * plate.width_m / 4};
}

// At a node sin() and Bessel functions return a rounding error, which differs between machines, instead of 0.
double without_rounding(double shape) {
  return std::abs(shape) < 1e-12 ? 0.0 : shape;
}

double natural_frequency(const NumberedMode& mode) {
  return std::hypot(mode.mode.angular_frequency_rad_per_s, mode.mode.decay_per_s);
}

// Sorts by rising frequency and keeps at most max + 1 modes. Returns the limit above which no further mode is needed.
double keep_lowest(std::vector<NumberedMode>& modes, std::size_t max, double limit) {
  std::ranges::stable_sort(modes, {}, natural_frequency);
  if (modes.size() <= max) return limit;
  modes.resize(max + 1);
  return natural_frequency(modes.back());
}

// Adds the modes i = 1, 2, ... of a row with undamped frequencies below the limit, at most max + 1 of them.
template <typename UndampedAt>
void add_row(std::vector<NumberedMode>& modes, int row, double limit, std::size_t max, const Losses& losses,
             UndampedAt undamped_at) {
  detail::for_sounding_modes(limit, max + 1, losses, undamped_at, [&](const Mode& mode, double beta, int i) {
    modes.push_back({mode, beta, row, i});
  });
}

// All rows from the first. The lowest mode of a row rises with it, so the search ends at one without a mode below the
// limit.
template <typename UndampedAt>
std::vector<NumberedMode> rows_below(int first, double limit, std::size_t max, const Losses& losses,
                                     UndampedAt undamped_at) {
  std::vector<NumberedMode> modes;
  for (int row = first;; ++row) {
    const std::size_t before = modes.size();
    add_row(modes, row, limit, max, losses, [&](int i) { return undamped_at(row, i); });
    if (modes.size() == before) return modes;
    limit = keep_lowest(modes, max, limit);
  }
}

std::vector<NumberedMode> numbered_below(const StiffString& string, double limit, std::size_t max) {
  std::vector<NumberedMode> modes;
  for (const auto& [mode, beta] : modes_below(string, limit / (2 * pi), max + 1))
    modes.push_back({mode, beta, 0, static_cast<int>(modes.size()) + 1});
  return modes;
}

// Modes that were computed together, which are counted from 0.
std::vector<NumberedMode> numbered_below(const std::vector<UndampedMode>& computed, double limit,
                                         const Losses& losses) {
  std::vector<NumberedMode> modes;
  for (std::size_t i = 0; i < computed.size(); ++i) {
    if (computed[i].angular_frequency_rad_per_s >= limit) break;
    if (const auto mode = computed[i].with(losses))
      modes.push_back({*mode, computed[i].wavenumber_per_m, 0, static_cast<int>(i)});
  }
  return modes;
}

std::vector<NumberedMode> numbered_below(const Bar& bar, double limit, std::size_t max) {
  if (bar.undercut) return numbered_below(bar.undercut->modes(), limit, bar.losses);
  std::vector<NumberedMode> modes;
  add_row(modes, 0, limit, max, bar.losses, [&](int i) { return undamped_mode(bar, i); });
  return modes;
}

std::vector<NumberedMode> numbered_below(const Membrane& membrane, double limit, std::size_t max) {
  return rows_below(0, limit, max, membrane.losses,
                    [&](int order, int i) { return undamped_mode(membrane, order, i); });
}

std::vector<NumberedMode> numbered_below(const Plate& plate, double limit, std::size_t max) {
  if (plate.ribbed) return numbered_below(plate.ribbed->modes().modes, limit, plate.losses);
  return rows_below(1, limit, max, plate.losses, [&](int m, int n) { return undamped_mode(plate, m, n); });
}

// Each mode with nodal diameters twice, the second time between them.
std::vector<NumberedMode> with_sines(const std::vector<NumberedMode>& cosines) {
  std::vector<NumberedMode> modes;
  for (const NumberedMode& mode : cosines) {
    modes.push_back(mode);
    if (mode.row == 0) continue;
    modes.push_back(mode);
    modes.back().is_sine = true;
  }
  return modes;
}

// The lowest mode of the orders 0 and 1 with a free rim is above that of order 2. Where the losses take all modes
// below a root, as many more are sought. Bessel's functions have numbers up to 700.
std::vector<NumberedMode> numbered_below(const RoundPlate& plate, double limit, std::size_t max) {
  const double rises = frequency_at(plate, 1);  // w0 and the quadratic loss with root^2
  const double damped = plate.losses.quadratic_m2_per_s / (plate.radius_m * plate.radius_m);
  const double silent = rises > damped ? std::sqrt(plate.losses.constant_per_s / (rises - damped)) : 0;
  const double end = std::min(600.0, root_above(max + 1) + silent);
  limit = std::min(limit, frequency_at(plate, end));
  const auto undamped_at = [&](int order, int i) { return undamped_mode(plate, order, i); };
  std::vector<NumberedMode> modes = rows_below(2, limit, max, plate.losses, undamped_at);
  for (const int order : {0, 1})
    add_row(modes, order, limit, max, plate.losses, [&](int i) { return undamped_at(order, i); });
  return plate.has_both_symmetries ? with_sines(modes) : modes;
}

std::vector<NumberedMode> numbered_below(const ModeTable& table, double limit, std::size_t) {
  std::vector<NumberedMode> modes;
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (table.rows[i].mode.angular_frequency_rad_per_s < limit)
      modes.push_back({table.rows[i].mode, 0, 0, static_cast<int>(i)});
  return modes;
}

// The shape of a mode at a place, whose angle counts from `zero_rad`.
double shape_at(const StiffString&, const NumberedMode& mode, const Place& at, double) {
  return std::sin(mode.wavenumber_per_m * at.position_m);
}

double shape_at(const Bar& bar, const NumberedMode& mode, const Place& at, double) {
  if (bar.undercut) return bar.undercut->shape_at(static_cast<std::size_t>(mode.number), at.position_m);
  return contactspline::shape_at(bar, mode.number, mode.wavenumber_per_m, at.position_m);
}

double radial_shape(const Membrane&, int order, double wavenumber_per_m, double radius_m) {
  return boost::math::cyl_bessel_j(order, wavenumber_per_m * radius_m);
}

// The shape of what is round at a place, the radial part times cos(m angle) or sin(m angle).
template <typename RoundBody>
double round_shape_at(const RoundBody& body, const NumberedMode& mode, const Place& at, double zero_rad) {
  return radial_shape(body, mode.row, mode.wavenumber_per_m, at.position_m) *
         angular_shape(mode, at.angle_rad - zero_rad);
}

// Or the mean over a disc of radius a: 2 J_1(beta a)/(beta a) for m = 0, otherwise 0.
double shape_at(const Membrane& membrane, const NumberedMode& mode, const Place& at, double zero_rad) {
  if (at.mean_radius_m == 0) return round_shape_at(membrane, mode, at, zero_rad);
  const double x = mode.wavenumber_per_m * at.mean_radius_m;
  return mode.row == 0 ? 2 * boost::math::cyl_bessel_j(1, x) / x : 0;
}

double shape_at(const Plate& plate, const NumberedMode& mode, const Place& at, double) {
  if (plate.ribbed) return plate.ribbed->shape_at(static_cast<std::size_t>(mode.number), at.position_m, at.across_m);
  const double kx = mode.row * pi / plate.length_m, ky = mode.number * pi / plate.width_m;
  return std::sin(kx * at.position_m) * std::sin(ky * at.across_m);
}

double shape_at(const RoundPlate& plate, const NumberedMode& mode, const Place& at, double zero_rad) {
  return round_shape_at(plate, mode, at, zero_rad);
}

// Are there modes below the limit that nobody has computed?
bool ends_below(const decltype(Resonator::body)& body, double limit) {
  const auto* plate = std::get_if<Plate>(&body);
  const auto* bar = std::get_if<Bar>(&body);
  const std::vector<UndampedMode>* computed = nullptr;
  if (plate != nullptr && plate->ribbed) computed = &plate->ribbed->modes().modes;
  if (bar != nullptr && bar->undercut) computed = &bar->undercut->modes();
  return computed != nullptr && computed->back().angular_frequency_rad_per_s < limit;
}

const ModeTable::Row& row_of(const ModeTable& table, const NumberedMode& mode) {
  return table.rows[static_cast<std::size_t>(mode.number)];
}

// The shape at a place of a body that is no table. Angles count from that of the strike.
double shape_of(const Resonator& resonator, const NumberedMode& mode, const Place& at) {
  const double zero_rad = resonator.strike.angle_rad;
  return std::visit(
      [&](const auto& body) {
        if constexpr (std::is_same_v<decltype(body), const ModeTable&>)
          return 0.0;
        else
          return without_rounding(shape_at(body, mode, at, zero_rad));
      },
      resonator.body);
}

}  // namespace

double angular_shape(const NumberedMode& mode, double angle_rad) {
  return mode.is_sine ? std::sin(mode.row * angle_rad) : std::cos(mode.row * angle_rad);
}

double radius_of(const decltype(Resonator::body)& round_body) {
  const auto* membrane = std::get_if<Membrane>(&round_body);
  return membrane != nullptr ? membrane->radius_m : std::get<RoundPlate>(round_body).radius_m;
}

double radial_shape(const decltype(Resonator::body)& round_body, int order, double wavenumber_per_m,
                    double radius_m) {
  const auto* membrane = std::get_if<Membrane>(&round_body);
  return membrane != nullptr ? radial_shape(*membrane, order, wavenumber_per_m, radius_m)
                             : radial_shape(std::get<RoundPlate>(round_body), order, wavenumber_per_m, radius_m);
}

std::string_view name_of(const decltype(Resonator::body)& body) {
  constexpr std::array<std::string_view, std::variant_size_v<decltype(Resonator::body)>> kNames = {
      "string", "bar", "membrane", "plate", "round_plate", "modes"};  // in the order of the variant
  return kNames[body.index()];
}

NumberedModeSet numbered_modes_of(const Resonator& resonator, double max_frequency_hz) {
  const double limit = 2 * pi * max_frequency_hz;
  const auto max = static_cast<std::size_t>(resonator.max_modes);
  auto modes = std::visit([&](const auto& body) { return numbered_below(body, limit, max); }, resonator.body);
  keep_lowest(modes, max, limit);
  const bool cut = modes.size() > max || ends_below(resonator.body, limit);
  const bool splits_a_pair = modes.size() > max && modes[max].is_sine;
  if (modes.size() > max) modes.resize(splits_a_pair ? max - 1 : max);
  return {std::move(modes), cut};
}

// A strike is shared by the strings of a choir.
double strike_shape(const Resonator& resonator, const NumberedMode& mode) {
  if (const auto* table = std::get_if<ModeTable>(&resonator.body)) return row_of(*table, mode).strike_shape;
  const auto* string = std::get_if<StiffString>(&resonator.body);
  const double shape = shape_of(resonator, mode, resonator.strike);
  return string == nullptr ? shape : shape / static_cast<double>(string->detuning_cents.size());
}

double pickup_shape(const Resonator& resonator, const NumberedMode& mode) {
  if (const auto* table = std::get_if<ModeTable>(&resonator.body)) return row_of(*table, mode).pickup_shape;
  return shape_of(resonator, mode, resonator.pickup);
}

ModeSet modes_of(const Resonator& resonator, double max_frequency_hz) {
  const auto [found, cut] = numbered_modes_of(resonator, max_frequency_hz);
  ModeSet set{{}, cut};
  for (const NumberedMode& mode : found)
    set.modes.push_back(
        {mode.mode, mode.wavenumber_per_m, strike_shape(resonator, mode), pickup_shape(resonator, mode)});
  return set;
}

}  // namespace contactspline
