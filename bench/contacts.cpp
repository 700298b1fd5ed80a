// SPDX-License-Identifier: MIT
// contacts [ROUNDS [PLUCKS]]: strings over several contacts by ContactNetwork and by linearly implicit schemes: time,
// penetration and drift; strings that stretch beside others. As sections of docs/measurements/speed.md on standard
// output (scripts/bench).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bench/contact_problems.hpp"
#include "bench/paired_timer.hpp"
#include "contactspline/modal/stretching_bank.hpp"

namespace contactspline::bench {
namespace {

constexpr int kRate = 44100, kBetween = kRate / 20;  // samples from pluck to pluck

using Ours = NetworkOfString;
using Zero = QuadratisedNetwork<OpenGradient::zero>;
using FreeMotion = QuadratisedNetwork<OpenGradient::free_motion>;
using Limited = QuadratisedNetwork<OpenGradient::limited>;

template <typename Scheme>
constexpr const char* kName = "spline";
template <>
constexpr const char* kName<Zero> = "linearly implicit";
template <>
constexpr const char* kName<FreeMotion> = "with release";
template <>
constexpr const char* kName<Limited> = "with limit";

/// A scheme at a multiple of 44.1 kHz. Its finger plucks every 50 ms.
template <typename Scheme>
class Performer {
 public:
  Performer(const PluckedString& plucked, int oversampling)
      : plucked_(plucked),
        rate_(static_cast<double>(kRate) * oversampling),
        between_(static_cast<std::size_t>(kBetween * oversampling)),
        scheme_(plucked.string, rate_) {}

  /// Plays a sample. Returns the force of the finger. It acts over a whole sample of ours, and at the beginning of
  /// one of the others.
  double tick() {
    constexpr double kActs = std::same_as<Scheme, Ours> ? 0.5 : 0;
    const double force = plucked_.force_at((static_cast<double>(sample_++ % between_) + kActs) / rate_);
    scheme_.tick(force);
    return force;
  }
  [[nodiscard]] const Scheme& scheme() const { return scheme_; }

 private:
  const PluckedString& plucked_;
  double rate_;
  std::size_t between_, sample_ = 0;
  Scheme scheme_;
};

// --- Time ---

/// A task that plays the 50 ms of a pluck.
template <typename Scheme>
TimedTask<std::function<void()>> task_of(const PluckedString& plucked, int oversampling) {
  const auto performer = std::make_shared<Performer<Scheme>>(plucked, oversampling);
  const int samples = kBetween * oversampling;
  return {kName<Scheme>, [performer, samples] {
            for (int n = 0; n < samples; ++n) performer->tick();
          }};
}

void print_times(const PluckedString& plucked, int ours, int others, int rounds) {
  std::vector tasks = {task_of<Ours>(plucked, ours), task_of<Zero>(plucked, others),
                       task_of<FreeMotion>(plucked, others), task_of<Limited>(plucked, others)};
  PairedTimer<std::function<void()>, ThreadClock> timer(tasks, kBetween * ours);
  for (int i = 0; i < rounds; ++i) timer.round();
  fmt::print("| {} | {} | {} | {:.0f} |", plucked.name, ours, others, timer.nanoseconds(0));
  for (std::size_t i = 1; i < tasks.size(); ++i) fmt::print(" {:.2f} |", timer.ratio(i));
  fmt::print("\n");
}

// --- Penetration ---

/// Over 20 plucks.
struct Penetration {
  double largest = 0, rms = 0, mean_force = 0;  // compression [m], force of all contacts [N]
};

template <typename Scheme>
Penetration penetration(const PluckedString& plucked, int oversampling) {
  Performer<Scheme> performer(plucked, oversampling);
  const Scheme& scheme = performer.scheme();
  Penetration found;
  const int samples = 20 * kBetween * oversampling;
  for (int n = 0; n < samples; ++n) {
    performer.tick();
    for (std::size_t k = 0; k < scheme.contacts(); ++k) {
      const double y = std::max(scheme.compression(k), 0.0);
      found.largest = std::max(found.largest, y);
      found.rms += y * y;
      found.mean_force += scheme.force(k);
    }
  }
  found.rms = std::sqrt(found.rms / samples);
  found.mean_force /= samples;
  return found;
}

template <typename Scheme>
void print_penetration(const PluckedString& plucked, const Penetration& reference, int oversampling) {
  const Penetration found = penetration<Scheme>(plucked, oversampling);
  fmt::print("| {} | {} | {} | {:.3g} | {:.3g} | {:.3g} |\n", plucked.name, kName<Scheme>, oversampling,
             found.largest / reference.largest, found.rms / reference.rms, found.mean_force / reference.mean_force);
}

void print_penetrations(const PluckedString& plucked) {
  const Penetration reference = penetration<Ours>(plucked, 16);
  for (const int oversampling : {1, 4}) {
    print_penetration<Ours>(plucked, reference, oversampling);
    print_penetration<Zero>(plucked, reference, oversampling);
    print_penetration<FreeMotion>(plucked, reference, oversampling);
    print_penetration<Limited>(plucked, reference, oversampling);
  }
}

// --- Drift ---

struct Drift {
  double of_psi = 0;               // mean of the sum of |psi^2/2 - V| over the last pluck [J]
  double of_energy = 0, peak = 0;  // largest error of the energy balance, largest energy [J]
};

template <typename Scheme>
Drift drift(const PluckedString& plucked, int plucks) {
  Performer<Scheme> performer(plucked, 1);
  const Scheme& scheme = performer.scheme();
  EnergyOf<Scheme> books(scheme, plucked.string, kRate);
  Drift drift;
  for (int pluck = 1; pluck <= plucks; ++pluck) {
    drift.of_psi = 0;
    for (int n = 0; n < kBetween; ++n) {
      books.follow(performer.tick());
      drift.peak = std::max(drift.peak, books.energy());
      drift.of_energy = std::max(drift.of_energy, std::isfinite(books.error()) ? std::abs(books.error()) : INFINITY);
      if constexpr (!std::same_as<Scheme, Ours>)
        for (std::size_t k = 0; k < scheme.contacts(); ++k)
          drift.of_psi += std::abs(scheme.stored(k) - scheme.potential(k)) / kBetween;
    }
  }
  return drift;
}

template <typename Scheme>
void print_drift(const PluckedString& plucked, const Drift& d, double peak) {
  const std::string of_psi = std::same_as<Scheme, Ours> ? "" : fmt::format("{:.1e}", d.of_psi / peak);
  fmt::print("| {} | {} | {} | {:.1e} |\n", plucked.name, kName<Scheme>, of_psi, d.of_energy / peak);
}

void print_drifts(const PluckedString& plucked, int plucks) {
  const Drift ours = drift<Ours>(plucked, plucks);
  print_drift<Ours>(plucked, ours, ours.peak);
  print_drift<Zero>(plucked, drift<Zero>(plucked, plucks), ours.peak);
  print_drift<FreeMotion>(plucked, drift<FreeMotion>(plucked, plucks), ours.peak);
  print_drift<Limited>(plucked, drift<Limited>(plucked, plucks), ours.peak);
}

// --- Bodies that stretch ---

constexpr std::size_t kModes = 80;

std::vector<Mode> modes_of_steel_string() {
  std::vector<Mode> modes;
  for (std::size_t n = 1; n <= kModes; ++n)
    modes.push_back({2 * std::numbers::pi * 110 * static_cast<double>(n), 1, 1.8e-4});
  return modes;
}

/// The string of 0.65 m and 0.3 mm stretches by one form; so many in place of it are each as stiff.
std::vector<StretchForm> forms_of_steel_string(std::size_t count) {
  StretchForm form{2e11 * 7.07e-8 * 0.65 / 8, {}};
  for (std::size_t n = 1; n <= kModes; ++n)
    form.squares_per_m2.push_back(std::pow(std::numbers::pi * static_cast<double>(n) / 0.65, 2));
  return std::vector(count, form);
}

template <typename Bank>
TimedTask<std::function<void()>> ringing(const char* name, Bank made, auto advance) {
  const auto bank = std::make_shared<Bank>(std::move(made));
  for (std::size_t i = 0; i < kModes; ++i) bank->set_motion(i, 1e-3F / static_cast<float>((i + 1) * (i + 1)), 0);
  return {name, [bank, advance] {
            for (int n = 0; n < kBetween; ++n) advance(*bank);
          }};
}

/// The string in a network, plucked 1 mm, over a stop of steel that it meets in each period.
template <std::floating_point T>
TimedTask<std::function<void()>> at_a_stop(const char* name, const std::vector<Mode>& modes, std::size_t forms) {
  NetworkPlan<T> plan;
  const std::size_t body = plan.add_body(modes, forms_of_steel_string(forms));
  std::vector<double> shapes;
  for (std::size_t n = 1; n <= modes.size(); ++n)
    shapes.push_back(-std::sin(std::numbers::pi * 0.6 * static_cast<double>(n)));
  plan.add_contact(plan.add_place(body, shapes), kGround, segments_of<materials::steel_on_steel, T>, T(1e-4));
  const auto network = std::make_shared<ContactNetwork<T>>(plan, kRate);
  for (std::size_t i = 0; i < kModes; ++i)
    network->set_motion(body, static_cast<T>(1e-3 / static_cast<double>((i + 1) * (i + 1))), 0, i);
  return {name, [network] {
            for (int n = 0; n < kBetween; ++n) network->tick();
          }};
}

void print_times(const char* precision, std::vector<TimedTask<std::function<void()>>> tasks, int rounds) {
  PairedTimer<std::function<void()>, ThreadClock> timer(tasks, kBetween);
  for (int i = 0; i < rounds; ++i) timer.round();
  for (std::size_t i = 0; i < tasks.size(); ++i)
    fmt::print("| {} | {} | {:.0f} | {:.2f} |\n", precision, tasks[i].name, timer.nanoseconds(i), 1 / timer.ratio(i));
}

template <std::floating_point T>
void print_stretching(const char* precision, int rounds) {
  const auto modes = modes_of_steel_string();
  const auto advance = [](StretchingBank<T>& bank) {
    bank.predict();
    bank.commit();
  };
  const auto stretching = [&](const char* name, std::size_t forms) {
    return ringing(name, StretchingBank<T>(modes, forms_of_steel_string(forms), kRate), advance);
  };
  print_times(precision,
              {ringing("linear", ModalBank<T>(modes, kRate),
                       [](ModalBank<T>& bank) { bank.advance(0, {}, nullptr, {}, nullptr); }),
               stretching("one form", 1), stretching("four forms", 4)},
              rounds);
  print_times(precision, {at_a_stop<T>("linear, at a stop", modes, 0), at_a_stop<T>("one form, at a stop", modes, 1)},
              rounds);
}

constexpr const char* kStretchingText =
    "\n## Bodies that stretch\n\n"
    "A string of 80 modes that rings, alone, by `ModalBank::advance` and by `StretchingBank` "
    "([stretching.md](../how-it-works/stretching.md)), and by `ContactNetwork` at a stop.\n\n"
    "| precision | string | ns per sample | of the linear one |\n"
    "|---|---|---:|---:|\n";

constexpr const char* kText =
    "\n## Several contacts\n\n"
    "A string over several contacts, plucked every 50 ms: by `ContactNetwork`, and by linearly implicit schemes "
    "(`bench/baselines/quadratised_network.hpp`), which store the energy of each contact as psi^2/2 and solve one "
    "linear "
    "system per sample. The tanpura that ships has 120 modes and 24 points of the bridge; the guitar string D3 has "
    "118 "
    "modes, and a finger holds it down on the fifth of 20 frets.\n\n"
    "| scheme | what it is |\n"
    "|---|---|\n"
    "| spline | `ContactNetwork`, 64 segments |\n"
    "| linearly implicit | Ducceschi and Bilbao (DAFx 2019): a contact that opens keeps its psi |\n"
    "| with release | Ducceschi et al. (JSV 2021): a contact that opens returns its psi to the motion |\n"
    "| with limit | psi of a contact that opens becomes 0, as in EXP-3; exact only if no other contact has a force "
    "|\n\n"
    "Time of the spline per sample of 44.1 kHz, and this time divided by that of the other schemes. Above 1 the "
    "spline "
    "is slower.\n\n";
constexpr const char* kPenetrationText =
    "\nCompression of all contacts over the first 20 plucks, and their mean force, divided by those of the spline at "
    "16 "
    "times 44.1 kHz.\n\n"
    "| string | scheme | rate, 44.1 kHz | largest compression | rms compression | mean force |\n"
    "|---|---|---:|---:|---:|---:|\n";
constexpr const char* kDriftText =
    "\nDrift at 44.1 kHz over 1,000 plucks, divided by the largest energy of the string: the mean of the sum over "
    "the contacts "
    "of "
    "|psi^2/2 - V| in the last one, and the largest error of each scheme's own energy balance.\n\n"
    "| string | scheme | psi^2/2 - V | energy balance |\n"
    "|---|---|---:|---:|\n";

void report(int rounds, int plucks) {
  flush_denormals();
  const std::vector<PluckedString> strings = {plucked_tanpura(), plucked_over_frets()};
  fmt::print("{}", kText);
  fmt::print(
      "| string | rate of the spline, 44.1 kHz | of the others | spline, ns | {} | {} | {} |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n",
      kName<Zero>, kName<FreeMotion>, kName<Limited>);
  for (const PluckedString& plucked : strings)
    for (const auto& [ours, others] : {std::pair{1, 1}, {4, 4}, {1, 4}}) print_times(plucked, ours, others, rounds);
  fmt::print("{}", kPenetrationText);
  for (const PluckedString& plucked : strings) print_penetrations(plucked);
  fmt::print("{}", kDriftText);
  for (const PluckedString& plucked : strings) print_drifts(plucked, plucks);
  fmt::print("{}", kStretchingText);
  print_stretching<double>("double", rounds);
  print_stretching<float>("single", rounds);
}

}  // namespace
}  // namespace contactspline::bench

int main(int argc, char** argv) {
  contactspline::bench::report(argc > 1 ? std::max(1, std::atoi(argv[1])) : 51,
                               argc > 2 ? std::max(1, std::atoi(argv[2])) : 1000);
}
