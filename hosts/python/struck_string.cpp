// SPDX-License-Identifier: MIT
#include "hosts/python/struck_string.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/tangent/strike_gradient.hpp"
#include "contactspline/tangent/strike_tangent.hpp"
#include "generator/support/error.hpp"

namespace contactspline::python {
namespace {

// The parameters, before two for each memory. The first ones are those of the instrument of that name.
enum StrikeParameter : std::size_t {
  kMass,
  kStiffness,
  kLoss,
  kStrike,
  kSpeed,
  kExponent,
  kPickup,
  kLength,
  kStringMass,
  kTension,
  kBending,
  kConstantLoss,
  kQuadraticLoss,
  kParameters
};

constexpr double kThrowDistance_m = 1e-4;
constexpr double kMaxLoss = 1e6;
constexpr std::size_t kWatched = 4096;  // samples between two calls of watch()

StruckString::Row row_of(std::size_t parameter, double initial) {
  const Parameter& p = HammerStringParameter::kList[parameter];
  return {std::string(p.name), std::string(p.unit), initial, p.allowed.min, p.allowed.max};
}

std::vector<double StiffString::*> string_members() {
  return {&StiffString::length_m, &StiffString::mass_kg, &StiffString::tension_n,
          &StiffString::bending_stiffness_n_m2};
}

ModeShapes<double> shapes_of(const std::vector<ResonatorMode>& rows, double ResonatorMode::*shape) {
  ModeShapes<double> shapes(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) shapes[i] = rows[i].*shape;
  return shapes;
}

// The table of forces times (y/end)^change at the knots.
std::vector<Segment<double>> with_exponent(SegmentTable<double> table, double end, double change) {
  return table_through(table, end,
                       [&](double y) { return y > 0 ? force(table, y) * std::pow(y / end, change) : 0.0; });
}

}  // namespace

/// The strike of some values, with what it points to, and the direction of each parameter.
struct StruckString::Made {
  std::vector<Segment<double>> table;
  std::vector<Memory> memories;
  StiffString string;
  std::vector<ResonatorMode> rows;
  std::vector<Mode> modes;
  HammerStrike<double> strike;
  double end_m, strike_m, pickup_m;

  [[nodiscard]] StrikeNumbers<double> direction(std::size_t parameter) const {
    StrikeNumbers<double> direction;
    switch (parameter) {
      case kMass:
        direction.hammer_mass_kg = 1;
        break;
      case kStiffness:
        direction.felt.stiffness_ratio = 1;
        break;
      case kLoss:
        direction.felt.loss_s_per_m = 1;
        break;
      case kStrike:
        direction.strike = shapes_tangent<double>(string, rows, strike_m, 1, 0);
        break;
      case kSpeed:
        direction.velocity_m_per_s = 1;
        break;
      case kExponent:
        direction.felt.table = exponent_direction<double>(std::span(table), end_m, end_m);
        break;
      case kPickup:
        direction.output = shapes_tangent<double>(string, rows, pickup_m, 1, 0);
        break;
      default:
        parameter < kParameters ? of_string(parameter, direction) : of_memory(parameter - kParameters, direction);
    }
    return direction;
  }

 private:
  void of_string(std::size_t parameter, StrikeNumbers<double>& direction) const {
    StiffString change{};
    if (parameter < kConstantLoss) change.*string_members()[parameter - kLength] = 1;
    if (parameter == kConstantLoss) change.losses.constant_per_s = 1;
    if (parameter == kQuadraticLoss) change.losses.quadratic_m2_per_s = 1;
    direction.modes = modes_tangent(string, rows, change);
    if (parameter != kLength) return;
    direction.strike = shapes_tangent<double>(string, rows, strike_m, 0, 1);
    direction.output = shapes_tangent<double>(string, rows, pickup_m, 0, 1);
  }
  void of_memory(std::size_t index, StrikeNumbers<double>& direction) const {
    direction.felt.memories.resize(memories.size());
    Memory& memory = direction.felt.memories[index / 2];
    (index % 2 == 0 ? memory.weight : memory.time_s) = 1;
  }
};

StruckString::StruckString(Design felt, Resonator resonator, double sample_rate_hz)
    : felt_(std::move(felt)), resonator_(std::move(resonator)), rate_(sample_rate_hz) {
  using Of = HammerStringParameter;
  const auto* const string = std::get_if<StiffString>(&resonator_.body);
  if (string == nullptr)
    refuse(resonator_.name, "string", "is no string", "a resonator of the kind string, such as string_c4");
  if (string->detuning_cents.size() != 1)
    refuse(resonator_.name, "string", "has several strings", "one string, such as string_c4");
  if (!(rate_ >= 1e3 && rate_ <= 1e6))
    refuse(resonator_.name, "sample_rate_hz", fmt::format("{} is refused", rate_), "1000 to 1000000, such as 44100");
  const Material& material = felt_.material;
  constexpr double kMin = 1e-9, kMax = 1e9;
  rows_ = {row_of(Of::kHammerMass, material.impact ? material.impact->mass_kg : 0.003),
           row_of(Of::kStiffnessRatio, 1),
           row_of(Of::kLoss, material.loss_s_per_m),
           row_of(Of::kPlace, resonator_.strike.position_m),
           row_of(Of::kSpeed, Of::kList[Of::kSpeed].initial),
           {"exponent_change", "", 0, -1, 2},
           {"pickup_m", "m", resonator_.pickup.position_m, 0, 100},
           {"string_length_m", "m", string->length_m, kMin, kMax},
           {"string_mass_kg", "kg", string->mass_kg, kMin, kMax},
           {"string_tension_n", "N", string->tension_n, kMin, kMax},
           {"string_bending_stiffness_n_m2", "N m^2", string->bending_stiffness_n_m2, 0, kMax},
           {"string_constant_loss_per_s", "1/s", string->losses.constant_per_s, 0, kMaxLoss},
           {"string_quadratic_loss_m2_per_s", "m^2/s", string->losses.quadratic_m2_per_s, 0, kMaxLoss}};
  for (std::size_t i = 0; i < material.memories.size(); ++i) {
    const auto& [weight, time_s] = material.memories[i];
    rows_.push_back({fmt::format("memory_weight_{}", i + 1), "", weight, 1e-6, 0.999});
    rows_.push_back({fmt::format("memory_time_{}_s", i + 1), "s", time_s, 1e-9, 10});
  }
}

StruckString::Made StruckString::make(std::span<const double> values) const {
  for (std::size_t p = 0; p < rows_.size(); ++p)
    if (!(values[p] >= rows_[p].min && values[p] <= rows_[p].max))
      refuse("strike", rows_[p].name, fmt::format("{} is refused", values[p]),
             fmt::format("{} to {}, such as {}", rows_[p].min, rows_[p].max, rows_[p].initial));
  Made made;
  made.end_m = felt_.spline.end_m;
  made.strike_m = values[kStrike];
  made.pickup_m = values[kPickup];
  made.table = with_exponent(segment_table(felt_.spline), made.end_m, values[kExponent]);
  if (std::ranges::any_of(made.table, [](const Segment<double>& s) { return s.half_curvature < 0; }))
    refuse("strike", "exponent_change", fmt::format("with {} the force would fall somewhere", values[kExponent]),
           "a change after which the force rises, such as 0");
  for (const std::size_t place : {kStrike, kPickup})
    if (const double length = values[kLength]; values[place] > length)
      refuse("strike", rows_[place].name, fmt::format("{} is beyond the string", values[place]),
             fmt::format("0 to {}, its length, such as {}", length, std::min(rows_[place].initial, length)));
  double sum = 0;
  for (std::size_t k = kParameters; k < values.size(); k += 2) {
    made.memories.push_back({values[k], values[k + 1]});
    sum += values[k];
  }
  if (!(sum < 1)) refuse("strike", "memory_weight_1", "the weights add up to 1 or more", "a sum below 1");
  made.string = std::get<StiffString>(resonator_.body);
  for (std::size_t k = kLength; k <= kBending; ++k) made.string.*string_members()[k - kLength] = values[k];
  made.string.losses = {values[kConstantLoss], values[kQuadraticLoss]};
  Resonator changed = resonator_;
  changed.body = made.string;
  changed.strike.position_m = made.strike_m;
  changed.pickup.position_m = made.pickup_m;
  made.rows = modes_of(changed, rate_ / 2).modes;
  if (made.rows.empty()) refuse("strike", "string", "has no mode below half the sample rate", "a longer string");
  made.modes = bare(made.rows);
  made.strike = {std::span<const Segment<double>>(made.table),
                 made.modes,
                 shapes_of(made.rows, &ResonatorMode::strike_shape),
                 shapes_of(made.rows, &ResonatorMode::pickup_shape),
                 {values[kMass], {values[kStiffness], values[kLoss]}},
                 values[kSpeed],
                 kThrowDistance_m,
                 made.memories};
  return made;
}

void StruckString::play(std::span<const double> values, std::span<double> displacement, std::span<double> force,
                        const std::function<void()>& watch) const {
  const Made made = make(values);
  auto model = detail::struck(made.strike, rate_);
  for (std::size_t n = 0; n < displacement.size(); ++n) {
    if (n % kWatched == 0) watch();
    model.tick(made.strike.controls);
    displacement[n] = model.string().displacement(made.strike.output);
    force[n] = model.force();
  }
}

void StruckString::tangents(std::span<const double> values, std::span<const std::size_t> parameters,
                            std::span<double> displacements, std::span<double> forces,
                            const std::function<void()>& watch) const {
  constexpr std::size_t kTogether = 4;
  const Made made = make(values);
  const std::size_t samples = parameters.empty() ? 0 : displacements.size() / parameters.size();
  for (std::size_t first = 0; first < parameters.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, parameters.size() - first);
    std::array<StrikeNumbers<double>, kTogether> directions;
    for (std::size_t p = 0; p < count; ++p) directions[p] = made.direction(parameters[first + p]);
    StrikeTangent<double, kTogether> tangent(made.strike, rate_, directions);
    std::array<Dual<double, kTogether>, 64> block;
    for (std::size_t n = 0, told = 0; n < samples;) {
      for (; told <= n; told += kWatched) watch();
      const bool flies = tangent.is_hammer_flying();
      const std::size_t length = flies ? 1 : std::min(block.size(), samples - n);
      tangent.process(std::span(block).first(length));
      for (std::size_t p = 0; p < count; ++p)
        for (std::size_t k = 0; k < length; ++k) {
          displacements[(first + p) * samples + n + k] = block[k].slopes[p];
          forces[(first + p) * samples + n + k] = flies ? tangent.force().slopes[p] : 0;
        }
      n += length;
    }
  }
}

std::vector<double> StruckString::gradient(std::span<const double> values,
                                           std::span<const double> displacement_weights,
                                           std::span<const double> force_weights) const {
  const Made made = make(values);
  const auto gradient = strike_gradient(made.strike, rate_, displacement_weights, force_weights);
  std::vector<double> derivatives;
  for (std::size_t p = 0; p < rows_.size(); ++p) derivatives.push_back(derivative(gradient, made.direction(p)));
  return derivatives;
}

}  // namespace contactspline::python
