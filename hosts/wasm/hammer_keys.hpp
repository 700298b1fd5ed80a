// SPDX-License-Identifier: MIT
// The keyboard of the page: the strings of the piano that ships, under hammers with the felt of the page's material.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instrument/parameter_values.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/keyboard.hpp"
#include "generated/felt_c4.hpp"
#include "generated/piano.hpp"
#include "hosts/wasm/energy_books.hpp"

namespace contactspline::web {

using Piano = keyboards::piano;

constexpr std::size_t kMaxSegments = 128;

template <typename T>
using Table = std::array<Segment<T>, kMaxSegments + 1>;

/// The material of the page's editor, at first the felt of C4 that ships. Each key takes it at its next strike.
struct Material {
  using Rows = std::array<double, kMaxSegments * 4 + kMaxMemories * 2>;
  Rows rows =
      felt_rows();  ///< knot, energy, force, half curvature of each segment, then weight and time of each memory
  std::size_t segments = materials::felt_c4::segments;
  std::vector<Memory> memories;
  double mass_kg = 0.00297, loss_s_per_m = 0;

  /// Takes the rows, which are written before. Returns whether there are no more than fit.
  bool use(int count, int memory_count, double hammer_mass_kg, double loss) {
    if (count < 1 || count > static_cast<int>(kMaxSegments)) return false;
    if (memory_count < 0 || memory_count > static_cast<int>(kMaxMemories)) return false;
    segments = static_cast<std::size_t>(count);
    memories.clear();
    for (std::size_t i = 4 * segments; i < 4 * segments + 2 * static_cast<std::size_t>(memory_count); i += 2)
      memories.push_back({rows[i], rows[i + 1]});
    mass_kg = hammer_mass_kg;
    loss_s_per_m = loss;
    return true;
  }

  /// All entries of a table: the segments beyond the last one continue its parabola, far out.
  template <typename T>
  [[nodiscard]] Table<T> table() const {
    Table<T> table{};
    Segment<double> last{};
    for (std::size_t j = 0; j < kMaxSegments; ++j) {
      if (j < segments) {
        last = {rows[4 * j], rows[4 * j + 1], rows[4 * j + 2], rows[4 * j + 3]};
      } else {
        const double knot = 1 + static_cast<double>(j);  // [m]
        last = {knot, last.energy_at(knot), last.force_at(knot), last.half_curvature};
      }
      table[j + 1] = {T(last.knot), T(last.energy), T(last.force), T(last.half_curvature)};
    }
    return table;
  }

 private:
  static constexpr Rows felt_rows() {
    constexpr const auto& table = segments_of<materials::felt_c4, double>;
    Rows rows{};
    for (std::size_t j = 0; j + 1 < table.size(); ++j) {
      const Segment<double>& s = table[j + 1];
      rows[4 * j] = s.knot, rows[4 * j + 1] = s.energy, rows[4 * j + 2] = s.force, rows[4 * j + 3] = s.half_curvature;
    }
    return rows;
  }
};

inline constexpr int kMiddleC = 60;

[[nodiscard]] inline std::size_t index_of(int key) {
  return static_cast<std::size_t>(key - Piano::first_key);
}
[[nodiscard]] inline bool is_key(int key) {
  return key >= Piano::first_key && index_of(key) < Piano::keys;
}

/// A string with its modes.
struct Resonator {
  StiffString string;
  std::vector<StringMode> modes;

  Resonator(int key, double sample_rate_hz)
      : string(string_of<Piano>(key)), modes(modes_below(string, sample_rate_hz / 2)) {}

  /// position: part of the length.
  template <typename T>
  [[nodiscard]] ModeShapes<T> shapes_at(double position) const {
    ModeShapes<T> shapes(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i)
      shapes[i] = T(std::sin(modes[i].wavenumber_per_m * position * string.length_m));
    return shapes;
  }
};

/// What all keys have.
struct HammerKeysParameter {
  enum : std::size_t { kSpeed, kStiffness, kMass, kPosition, kSustain, kParameters };
  static constexpr std::array<Parameter, kParameters> kList = {
      {HammerStringParameter::kList[HammerStringParameter::kSpeed],
       HammerStringParameter::kList[HammerStringParameter::kStiffnessRatio],
       KeyboardParameter::kList[KeyboardParameter::kMassRatio],
       {"strike_position", "of the length", {0.01, 0.99}, {0.02, 0.5}, 0.12, Scale::kLinear, Acts::kAtNextNote},
       HammerStringParameter::kList[HammerStringParameter::kSustain]}};
  static constexpr std::array<Output, 2> kOutputs = {{{"left_force_n", "N", 80}, {"right_force_n", "N", 80}}};
};

/// Hammer, felt and loss of a key under the page's material: in the treble they are lighter and harder, as in the
/// piano that ships. values: of HammerKeysParameter.
template <typename T>
[[nodiscard]] HammerStringControls<T> controls_of(int key, const Material& material, std::span<const double> values) {
  const auto mass = [](std::size_t k) { return Piano::hammer_masses[k] * Piano::strings[k]; };
  const auto stiffness = [](std::size_t k) {
    return force(SegmentTable<double>(felts_of<Piano, double>[k]), 3e-4) * Piano::strings[k];
  };
  const std::size_t k = index_of(key), c = index_of(kMiddleC);
  return {.hammer_mass_kg = T(material.mass_kg * values[HammerKeysParameter::kMass] * mass(k) / mass(c)),
          .felt = {.stiffness_ratio = T(values[HammerKeysParameter::kStiffness] * stiffness(k) / stiffness(c)),
                   .loss_s_per_m = T(material.loss_s_per_m)}};
}

/// One key: string, hammer, and a table of its own, so that a new material waits for its next strike.
class HammerKey {
 public:
  HammerKey(int key, const Material& material, std::span<const double> values, double sample_rate_hz)
      : key_(key),
        resonator_(key, sample_rate_hz),
        table_(material.table<float>()),
        voice_({.felt = SegmentTable<float>(table_),
                .modes = bare(resonator_.modes),
                .strike = resonator_.shapes_at<float>(values[HammerKeysParameter::kPosition]),
                .output = bridge_shapes<float>(resonator_.string, resonator_.modes, 1),
                .controls = controls_of<float>(key, material, values),
                .damper = {key <= Piano::last_damped_key ? Piano::damper_per_s : 0.0, Piano::damper_time_s},
                .memories = material.memories},
               sample_rate_hz),
        sample_rate_hz_(sample_rate_hz),
        side_(0.2f + 0.6f * static_cast<float>(index_of(key)) / (Piano::keys - 1)) {}
  HammerKey(const HammerKey&) = delete;
  HammerKey& operator=(const HammerKey&) = delete;

  void strike(float speed_m_per_s, const Material& material, std::span<const double> values) {
    table_ = material.table<float>();
    voice_.set_memories(material.memories, sample_rate_hz_);
    voice_.controls() = controls_of<float>(key_, material, values);
    voice_.strike_at(resonator_.shapes_at<float>(values[HammerKeysParameter::kPosition]));
    voice_.strike(speed_m_per_s);
    sounds_ = true;
    fade_ = 0;
  }

  /// Fades out, and rests: another key takes its place.
  void fade_out() { fade_ = fade_ > 0 ? fade_ : kFade; }

  /// Adds a block to left and right, and where books are kept to force.
  void process(std::span<float> out, std::span<float> left, std::span<float> right, std::span<float> force,
               StrikeBooks<float>* books, double sample_rate_hz) {
    if (books != nullptr)
      process_with_books(out, force, *books, sample_rate_hz);
    else
      voice_.process(out);
    if (fade_ > 0) fade(out);
    const float gain_left = std::sqrt(1 - side_), gain_right = std::sqrt(side_);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] += gain_left * out[i];
    for (std::size_t i = 0; i < right.size(); ++i) right[i] += gain_right * out[i];
    if (voice_.is_silent()) sounds_ = false;
  }

  void open(StrikeBooks<float>& books) { books.open(voice_.model(), table_, voice_.controls()); }
  void release() { voice_.release(); }
  void silence() {
    voice_.reset();
    sounds_ = false;
    fade_ = 0;
  }
  [[nodiscard]] bool sounds() const { return sounds_; }
  [[nodiscard]] bool is_fading() const { return fade_ > 0; }
  [[nodiscard]] bool is_silent(double limit_j) const { return !sounds_ || voice_.is_silent(limit_j); }
  [[nodiscard]] double energy() const { return voice_.model().string().energy(); }

  bool is_down = false;

 private:
  static constexpr std::size_t kFade = 441;  // samples

  void fade(std::span<float> out) {
    for (float& sample : out) {
      sample *= static_cast<float>(fade_) / kFade;
      if (fade_ > 0) --fade_;
    }
    if (fade_ == 0) silence();
  }

  void process_with_books(std::span<float> out, std::span<float> force, StrikeBooks<float>& books,
                          double sample_rate_hz) {
    const auto& controls = voice_.controls();
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float y0 = voice_.model().compression();
      out[i] = voice_.tick();
      if (i < force.size()) force[i] = voice_.model().force();
      books.add_loss(voice_.model(), table_, controls, sample_rate_hz, y0);
    }
    books.close(voice_.model(), table_, controls);
  }

  int key_;
  Resonator resonator_;
  Table<float> table_;
  HammerVoice<float> voice_;
  double sample_rate_hz_;
  float side_;
  std::size_t fade_ = 0;  // samples that remain; 0: it does not fade
  bool sounds_ = false;
};

/// Up to kMaxSounding keys at a time: the weakest one stops for another. Meets Instrument. material: of all later
/// strikes.
class HammerKeys : public HammerKeysParameter, public ParameterValues<float, HammerKeysParameter::kParameters> {
  using Values = ParameterValues<float, kParameters>;

 public:
  using value_type = float;
  static constexpr std::size_t kMaxSounding = 32;

  explicit HammerKeys(const Material& material) : Values(kList), material_(material) {}

  static const char* name() { return "hammer_on_string"; }
  static const char* description() { return "Hammers with your material on the strings of the piano that ships"; }
  static std::span<const Event> events() { return {}; }
  static std::span<const Output> outputs() { return kOutputs; }
  static std::span<const Preset> presets() { return {}; }
  static bool has_key(int key) { return is_key(key); }

  void prepare(double sample_rate_hz) {
    sample_rate_hz_ = sample_rate_hz;
    for (std::size_t k = 0; k < Piano::keys; ++k)
      keys_[k] =
          std::make_unique<HammerKey>(Piano::first_key + static_cast<int>(k), material_, values(), sample_rate_hz);
  }

  void set(std::size_t parameter, double to) {
    Values::set(parameter, to);
    if (parameter != kSustain || is_sustained() || !keys_[0]) return;
    for (auto& key : keys_)
      if (!key->is_down) key->release();
  }

  /// velocity: multiplies the speed of all keys.
  void note_on(int key, double velocity) {
    if (is_key(key)) strike(index_of(key), static_cast<float>(value(kSpeed) * velocity));
  }
  void note_off(int key) {
    if (is_key(key)) release(index_of(key));
  }
  /// A key, 0 to 87, at a speed [m/s].
  void strike(std::size_t key, float speed_m_per_s) {
    if (key >= keys_.size() || !is_number(speed_m_per_s)) return;
    HammerKey& struck = *keys_[key];
    struck.is_down = true;
    if (!struck.sounds()) make_room();
    struck.strike(speed_m_per_s, material_, values());
    watched_ = &struck;
    struck.open(books_);
  }
  void release(std::size_t key) {
    if (key >= keys_.size()) return;
    keys_[key]->is_down = false;
    if (!is_sustained()) keys_[key]->release();
  }
  void pluck(std::size_t, float, double = 0) {}

  /// force: of the key that was struck last [N].
  void process(Outputs<float> outputs, std::span<float> force = {}) {
    std::array<float, kBlock> scratch;
    for (const std::span<float> output : outputs) std::ranges::fill(output, 0.0f);
    std::ranges::fill(force, 0.0f);
    const std::size_t length = detail::block_length<float>(outputs, force);
    for (std::size_t done = 0; done < length; done += kBlock) {
      const std::size_t samples = std::min(kBlock, length - done);
      const auto part = [&](std::size_t o) {
        return o < outputs.size() ? detail::part_of(outputs[o], done, samples) : std::span<float>();
      };
      for (auto& key : keys_)
        if (key->sounds())
          key->process(std::span(scratch).first(samples), part(0), part(1), detail::part_of(force, done, samples),
                       key.get() == watched_ ? &books_ : nullptr, sample_rate_hz_);
    }
  }

  void reset() {
    for (auto& key : keys_) {
      key->silence();
      key->is_down = false;
    }
  }
  [[nodiscard]] bool is_silent(double limit_j) const {
    return std::ranges::all_of(keys_, [&](const auto& key) { return key->is_silent(limit_j); });
  }
  [[nodiscard]] double energy() const {
    double sum = 0;
    for (const auto& key : keys_)
      if (key->sounds()) sum += key->energy();
    return sum;
  }

  /// Of the key that was struck last.
  [[nodiscard]] const StrikeEnergies& books() const { return books_.books(); }
  /// From now on all keys are played by the kernels.
  void watch_none() { watched_ = nullptr; }
  [[nodiscard]] std::array<double, kParameters> values() const {
    std::array<double, kParameters> values{};
    for (std::size_t p = 0; p < kParameters; ++p) values[p] = value(p);
    return values;
  }

 private:
  static constexpr std::size_t kBlock = 256;

  [[nodiscard]] bool is_sustained() const { return value(kSustain) >= 0.5; }

  void make_room() {
    std::size_t sounding = 0;
    HammerKey* weakest = nullptr;
    for (auto& key : keys_) {
      if (!key->sounds() || key->is_fading()) continue;
      ++sounding;
      if (weakest == nullptr || key->energy() < weakest->energy()) weakest = key.get();
    }
    if (sounding >= kMaxSounding) weakest->fade_out();
  }

  const Material& material_;
  double sample_rate_hz_ = 0;
  std::array<std::unique_ptr<HammerKey>, Piano::keys> keys_;
  HammerKey* watched_ = nullptr;
  StrikeBooks<float> books_;
};

}  // namespace contactspline::web
