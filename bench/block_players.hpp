// SPDX-License-Identifier: MIT
// One hammer-string in several implementations. Each computes blocks, as in a plug-in host.
#pragma once

#include <faust/gui/MapUI.h>
#include <faust/gui/UI.h>
#include <faust/gui/meta.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "bench/faust_strings/programs.hpp"
#include "bench/models.hpp"
#include "contactspline/host/faust_dsp.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/models/hammer_string.hpp"

namespace contactspline::bench {

template <std::size_t Some, std::size_t All>
constexpr std::array<double, Some> lowest(const std::array<double, All>& all) {
  std::array<double, Some> some{};
  std::copy_n(all.begin(), Some, some.begin());
  return some;
}

/// C2 with the lowest 80 of its modes.
struct string_c2_80 {
  using All = resonators::string_c2;
  static constexpr std::size_t modes = 80;
  static constexpr std::size_t strings = All::strings;
  static constexpr double strike_position_m = All::strike_position_m;
  static constexpr auto angular_frequencies = lowest<modes>(All::angular_frequencies);
  static constexpr auto decays = lowest<modes>(All::decays);
  static constexpr auto masses = lowest<modes>(All::masses);
  static constexpr auto wavenumbers = lowest<modes>(All::wavenumbers);
  static constexpr auto strike_shapes = lowest<modes>(All::strike_shapes);
  static constexpr auto pickup_shapes = lowest<modes>(All::pickup_shapes);
};

class BlockPlayer {
 public:
  static constexpr std::size_t kMax = 256;  // samples in a block

  virtual ~BlockPlayer() = default;
  /// Throws the hammer at 2.5 m/s from 0.1 mm at the start of the next block. Call it at most every second block.
  virtual void strike() = 0;
  virtual void process(std::size_t samples) = 0;
  /// Outputs of the last block. The force is 0 if the player does not compute it.
  [[nodiscard]] virtual double displacement_mm(std::size_t sample) const = 0;
  [[nodiscard]] virtual double force_n(std::size_t sample) const = 0;
};

/// HammerString::process, without a wrapper.
template <typename Felt, typename String, std::floating_point T>
class BarePlayer final : public BlockPlayer {
 public:
  BarePlayer(double hammer_kg, bool with_forces)
      : model_(segments_of<Felt, T>, modes_in<String>, ModeShapes<T>(String::strike_shapes), kSampleRate),
        controls_{.hammer_mass_kg = static_cast<T>(hammer_kg)},
        with_forces_(with_forces) {}
  void strike() override { model_.strike(T(2.5), T(1e-4)); }
  void process(std::size_t samples) override {
    model_.process(controls_, pickup_, std::span(displacement_m_).first(samples),
                   with_forces_ ? force_n_.data() : nullptr);
  }
  [[nodiscard]] double displacement_mm(std::size_t sample) const override { return 1000 * displacement_m_[sample]; }
  [[nodiscard]] double force_n(std::size_t sample) const override { return force_n_[sample]; }

 private:
  HammerString<T, segments_of<Felt, T>.size()> model_;
  ModeShapes<T> pickup_ = model_.string().sound_pickup(String::pickup_shapes);
  HammerStringControls<T> controls_;
  bool with_forces_;
  std::array<T, kMax> displacement_m_{}, force_n_{};
};

/// A class with Faust's `dsp` interface: the controls of `hammer_string_ui`, or those of HammerStringInstrument.
class DspPlayer final : public BlockPlayer {
 public:
  /// values: of sliders. full_scale_n: what the output of the force is divided by.
  explicit DspPlayer(std::unique_ptr<dsp> program, const std::map<std::string, double>& values = {},
                     double full_scale_n = 1)
      : program_(std::move(program)), full_scale_n_(full_scale_n) {
    program_->init(kSampleRate);
    MapUI controls;
    program_->buildUserInterface(&controls);
    for (const auto& [label, value] : values) controls.setParamValue(label, static_cast<FAUSTFLOAT>(value));
    strike_ = controls.getParamZone("strike");
  }
  void strike() override { *strike_ = 1; }
  void process(std::size_t samples) override {
    std::array<FAUSTFLOAT*, 2> outputs = {displacement_mm_.data(), force_n_.data()};
    program_->compute(static_cast<int>(samples), nullptr, outputs.data());
    *strike_ = 0;
  }
  [[nodiscard]] double displacement_mm(std::size_t sample) const override {
    return static_cast<double>(displacement_mm_[sample]);
  }
  [[nodiscard]] double force_n(std::size_t sample) const override {
    return full_scale_n_ * static_cast<double>(force_n_[sample]);
  }

 private:
  std::unique_ptr<dsp> program_;
  double full_scale_n_;
  FAUSTFLOAT* strike_;
  std::array<FAUSTFLOAT, kMax> displacement_mm_{}, force_n_{};
};

struct NamedBlockPlayer {
  std::string name;
  std::unique_ptr<BlockPlayer> player;
};

/// All implementations of one string, HammerString first. program: name of the Faust program, c4, c2 or eighty_modes.
template <typename Felt, typename String, std::floating_point T>
std::vector<NamedBlockPlayer> block_players(const std::string& program, double hammer_kg) {
  std::vector<NamedBlockPlayer> all;
  all.push_back({"HammerString", std::make_unique<BarePlayer<Felt, String, T>>(hammer_kg, false)});
  all.push_back({"with forces", std::make_unique<BarePlayer<Felt, String, T>>(hammer_kg, true)});
  const double length_m = std::numbers::pi / String::wavenumbers[0];
  all.push_back(
      {"InstrumentDsp",
       std::make_unique<DspPlayer>(
           std::make_unique<InstrumentDsp<HammerStringOf<Felt, String, T>>>(),
           std::map<std::string, double>{{"hammer_mass_kg", hammer_kg}, {"strike_m", 0.12 * length_m}}, 50)});
  for (const FaustString& faust : faust_strings())
    if (faust.string == program && faust.precision == (std::same_as<T, double> ? "double" : "single"))
      all.push_back({faust.name, std::make_unique<DspPlayer>(faust.make())});
  return all;
}

/// Calls visit(name, make) for each string of the comparison; make.template operator()<T>() returns its players.
template <typename Visit>
void for_each_faust_string(Visit visit) {
  visit("C4, 56 modes",
        []<typename T>() { return block_players<materials::felt_c4, resonators::string_c4, T>("c4", 0.00297); });
  visit("C2, 80 of its modes",
        []<typename T>() { return block_players<materials::felt_c2, string_c2_80, T>("eighty_modes", 0.0049); });
  visit("C2, 204 modes",
        []<typename T>() { return block_players<materials::felt_c2, resonators::string_c2, T>("c2", 0.0049); });
}

}  // namespace contactspline::bench
