// SPDX-License-Identifier: MIT
// All schemes that are timed, behind one interface. To add a scheme, add a line to schemes().
#pragma once

#include <concepts>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/baselines/newton.hpp"
#include "bench/baselines/quadratised.hpp"
#include "bench/linear_string.hpp"
#include "bench/models.hpp"
#include "bench/roofline.hpp"
#include "contactspline/models/hammer_string.hpp"

namespace contactspline::bench {

template <std::floating_point T>
class Player {
 public:
  virtual ~Player() = default;
  virtual void strike(T speed_m_per_s, T distance_m) = 0;
  virtual void process(std::span<T> out) = 0;
};

/// HammerString behind the interface of the baselines.
template <std::floating_point T>
class SplineHammerString {
 public:
  SplineHammerString(const Model& model, double hammer_kg)
      : felt_(felt_in_precision(model.felt)),
        pickup_(std::span<const double>(model.pickup_shapes)),
        string_(SegmentTable<T>(felt_), model.modes, ModeShapes<T>(model.strike_shapes), kSampleRate),
        controls_{.hammer_mass_kg = static_cast<T>(hammer_kg)} {}

  void strike(T speed_m_per_s, T distance_m) { string_.strike(speed_m_per_s, distance_m); }
  void process(std::span<T> out) { process(string_, out); }
  [[nodiscard]] T force() const { return string_.force(); }

 private:
  static std::vector<Segment<T>> felt_in_precision(const std::vector<Segment<double>>& felt) {
    std::vector<Segment<T>> cast;
    for (const auto& [knot, energy, force, half_curvature] : felt)
      cast.push_back(
          {static_cast<T>(knot), static_cast<T>(energy), static_cast<T>(force), static_cast<T>(half_curvature)});
    return cast;
  }

  // Uses process() of the model if it has one, else tick().
  void process(auto& string, std::span<T> out) {
    if constexpr (requires { string.process(controls_, pickup_, out); }) {
      string.process(controls_, pickup_, out);
    } else {
      for (T& sample : out) {
        string.tick(controls_);
        sample = string.string().displacement(pickup_);
      }
    }
  }

  std::vector<Segment<T>> felt_;
  ModeShapes<T> pickup_;
  HammerString<T> string_;
  HammerStringControls<T> controls_;
};

namespace detail {

template <std::floating_point T, typename Scheme>
class PlayerOf final : public Player<T> {
 public:
  explicit PlayerOf(Scheme scheme) : scheme_(std::move(scheme)) {}
  void strike(T speed_m_per_s, T distance_m) override {
    if constexpr (requires { scheme_.strike(); })
      scheme_.strike();
    else if constexpr (requires { scheme_.strike(speed_m_per_s, distance_m); })
      scheme_.strike(speed_m_per_s, distance_m);
  }
  void process(std::span<T> out) override { scheme_.process(out); }

 private:
  Scheme scheme_;
};

template <std::floating_point T>
using MakePlayer = std::unique_ptr<Player<T>> (*)(const Model& model, const PowerLawHammer& hammer);

template <std::floating_point T, typename Scheme>
std::unique_ptr<Player<T>> baseline(const Model& model, const PowerLawHammer& hammer) {
  return std::make_unique<PlayerOf<T, Scheme>>(
      Scheme(hammer, model.modes, model.strike_shapes, model.pickup_shapes, kSampleRate));
}

template <std::floating_point T>
std::unique_ptr<Player<T>> spline(const Model& model, const PowerLawHammer& hammer) {
  return std::make_unique<PlayerOf<T, SplineHammerString<T>>>(SplineHammerString<T>(model, hammer.mass_kg));
}

/// The string without a hammer.
template <std::floating_point T, typename String>
std::unique_ptr<Player<T>> string_alone(const Model& model, const PowerLawHammer&) {
  if (model.modes.empty()) return nullptr;
  return std::make_unique<PlayerOf<T, String>>(String(model.modes, model.pickup_shapes, kSampleRate));
}

/// HammerString before its first throw.
template <std::floating_point T>
class RestingHammerString {
 public:
  explicit RestingHammerString(const Model& model) : string_(model, model.hammer.mass_kg) {}
  void process(std::span<T> out) { string_.process(out); }

 private:
  SplineHammerString<T> string_;
};

template <std::floating_point T>
std::unique_ptr<Player<T>> string_in_blocks(const Model& model, const PowerLawHammer&) {
  if (model.modes.empty()) return nullptr;
  return std::make_unique<PlayerOf<T, RestingHammerString<T>>>(RestingHammerString<T>(model));
}

template <std::floating_point T>
std::unique_ptr<Player<T>> fd_hammer(const Model& model, const PowerLawHammer&) {
  if (!model.fd) return nullptr;
  return std::make_unique<PlayerOf<T, FdHammerString<T>>>(FdHammerString<T>(*model.fd, kSampleRate));
}

}  // namespace detail

template <std::floating_point T>
struct Scheme {
  std::string name;
  detail::MakePlayer<T> make;  ///< returns null if the scheme does not support the model
};

/// All schemes. The others are compared with the first one, HammerString.
template <std::floating_point T>
std::vector<Scheme<T>> schemes() {
  return {{"spline", detail::spline<T>},
          {"EXP-3", detail::baseline<T, Exp3HammerString<T>>},
          {"EXP-3, caught", detail::baseline<T, CatchingExp3HammerString<T>>},
          {"linearly implicit", detail::baseline<T, LinearlyImplicitHammerString<T>>},
          {"Newton", detail::baseline<T, NewtonHammerString<T>>},
          {"fd.hammer", detail::fd_hammer<T>},
          {"string alone", detail::string_alone<T, LinearString<T>>},
          {"in blocks", detail::string_in_blocks<T>},
          {"roofline", detail::string_alone<T, Roofline<T>>}};
}

template <std::floating_point T>
struct NamedPlayer {
  std::string name;
  std::unique_ptr<Player<T>> player;
};
/// The players of a model for a workload, in the order of schemes(), without the schemes that do not support the
/// model.
template <std::floating_point T>
std::vector<NamedPlayer<T>> players_of(const Model& model, const Workload& workload) {
  PowerLawHammer hammer = model.hammer;
  hammer.mass_kg *= workload.mass_ratio;
  std::vector<NamedPlayer<T>> players;
  for (const Scheme<T>& scheme : schemes<T>())
    if (auto player = scheme.make(model, hammer)) players.push_back({scheme.name, std::move(player)});
  return players;
}

}  // namespace contactspline::bench
