// SPDX-License-Identifier: MIT
// The keyboard that the page plays by the C++ runtime: the strings of the piano that ships, under hammers with the
// felt of the page's material. And the study of one strike, sample by sample, for the slow motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "contactspline/modal/stiff_string.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "generated/piano.hpp"
#include "web/wasm/door.hpp"
#include "web/wasm/energy_books.hpp"

namespace contactspline::web {
namespace {

using Piano = keyboards::piano;

constexpr std::size_t kMaxSegments = 128;
constexpr std::size_t kBlock = 128;
constexpr std::size_t kMaxSounding = 32;  // keys at a time
constexpr int kMiddleC = 60;
constexpr float kGain = 0.012f;  // output per newton on the bridge

template <typename T>
using Table = std::array<Segment<T>, kMaxSegments + 1>;

// The page's material, and its controls. Each key takes them at its next strike.
struct Material {
  std::array<double, kMaxSegments * 4> rows{};  // knot, energy, force, half curvature of each segment
  std::size_t segments = 0;
  double mass_kg = 0.00297, loss_s_per_m = 0, stiffness_ratio = 1, mass_ratio = 1;
  double strike_position = 0.12;  // part of the string's length

  // All entries of a table: the segments beyond the last one continue its parabola, far out.
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
};
Material material;

std::size_t index_of(int key) {
  return static_cast<std::size_t>(key - Piano::first_key);
}

bool is_key(int key) {
  return key >= Piano::first_key && index_of(key) < Piano::keys;
}

// The mass of a key's whole hammer in the piano that ships, relative to middle C.
double relative_mass(int key) {
  const auto whole = [](std::size_t k) { return Piano::hammer_masses[k] * Piano::strings[k]; };
  return whole(index_of(key)) / whole(index_of(kMiddleC));
}

// The force of a key's whole felt in the piano that ships, at 0.3 mm, relative to middle C: harder towards the
// treble.
double relative_stiffness(int key) {
  const auto whole = [](std::size_t k) {
    return force(SegmentTable<double>(felts_of<Piano, double>[k]), 3e-4) * Piano::strings[k];
  };
  return whole(index_of(key)) / whole(index_of(kMiddleC));
}

template <typename T>
HammerStringControls<T> controls_of(int key) {
  return {.hammer_mass_kg = T(material.mass_kg * material.mass_ratio * relative_mass(key)),
          .felt = {.stiffness_ratio = T(material.stiffness_ratio * relative_stiffness(key)),
                   .loss_s_per_m = T(material.loss_s_per_m)}};
}

// A string with its modes.
struct Resonator {
  StiffString string;
  std::vector<StringMode> modes;

  Resonator(int key, double sample_rate_hz)
      : string(string_of<Piano>(key)), modes(modes_below(string, sample_rate_hz / 2)) {}

  template <typename T>
  [[nodiscard]] ModeShapes<T> shapes_at(double position) const {
    ModeShapes<T> shapes(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i)
      shapes[i] = T(std::sin(modes[i].wavenumber_per_m * position * string.length_m));
    return shapes;
  }
};

/// One key: string, hammer, and a table of its own, so that a new material waits for its next strike.
class Key {
 public:
  Key(int key, double sample_rate_hz)
      : key_(key),
        resonator_(key, sample_rate_hz),
        table_(material.table<float>()),
        voice_({.felt = SegmentTable<float>(table_),
                .modes = bare(resonator_.modes),
                .strike = resonator_.shapes_at<float>(0.12),
                .output = bridge_shapes<float>(resonator_.string, resonator_.modes, 1),
                .controls = controls_of<float>(key),
                .damper = damper_of(key)},
               sample_rate_hz),
        side_(0.2f + 0.6f * static_cast<float>(index_of(key)) / (Piano::keys - 1)) {}
  Key(const Key&) = delete;
  Key& operator=(const Key&) = delete;

  void strike(float speed_m_per_s) {
    table_ = material.table<float>();
    voice_.controls() = controls_of<float>(key_);
    voice_.strike_at(resonator_.shapes_at<float>(material.strike_position));
    voice_.strike(speed_m_per_s);
    sounds_ = true;
  }

  // Adds a block to left and right. With books, sample by sample.
  void process(std::size_t samples, float* left, float* right, float* force, StrikeBooks<float>* books,
               double sample_rate_hz) {
    std::array<float, kBlock> out{};
    if (books != nullptr)
      process_with_books(std::span(out).first(samples), force, *books, sample_rate_hz);
    else
      voice_.process(std::span(out).first(samples));
    const float gain_left = kGain * std::sqrt(1 - side_), gain_right = kGain * std::sqrt(side_);
    for (std::size_t i = 0; i < samples; ++i) {
      left[i] += gain_left * out[i];
      right[i] += gain_right * out[i];
    }
    if (voice_.is_silent()) sounds_ = false;
  }

  void open(StrikeBooks<float>& books) const { books.open(voice_.model(), table_, controls_of<float>(key_)); }

  void release() { voice_.release(); }
  void silence() {
    voice_.reset();
    sounds_ = false;
  }
  [[nodiscard]] bool sounds() const { return sounds_; }
  [[nodiscard]] double energy() const { return voice_.model().string().energy(); }

  bool is_down = false;

 private:
  void process_with_books(std::span<float> out, float* force, StrikeBooks<float>& books, double sample_rate_hz) {
    const auto& controls = voice_.controls();
    for (float& sample : out) {
      const float y0 = voice_.model().compression();
      sample = voice_.tick();
      *force++ = voice_.model().force();
      books.add_loss(voice_.model(), table_, controls, sample_rate_hz, y0);
    }
    books.close(voice_.model(), table_, controls);
  }

  static Damper damper_of(int key) {
    return {key <= Piano::last_damped_key ? Piano::damper_per_s : 0.0, Piano::damper_time_s};
  }

  int key_;
  Resonator resonator_;
  Table<float> table_;
  HammerVoice<float> voice_;
  float side_;
  bool sounds_ = false;
};

/// All keys. No call but the constructor allocates.
class Keyboard {
 public:
  explicit Keyboard(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {
    for (std::size_t k = 0; k < Piano::keys; ++k)
      keys_[k] = std::make_unique<Key>(Piano::first_key + static_cast<int>(k), sample_rate_hz);
  }

  void strike(int key, float speed_m_per_s) {
    Key& struck = *keys_[index_of(key)];
    struck.is_down = true;
    if (!struck.sounds()) make_room();
    struck.strike(speed_m_per_s);
    watched_ = &struck;
    struck.open(books_);
  }

  void release(int key) {
    Key& released = *keys_[index_of(key)];
    released.is_down = false;
    if (!pedal_) released.release();
  }

  void pedal(bool down) {
    pedal_ = down;
    if (down) return;
    for (auto& key : keys_)
      if (!key->is_down) key->release();
  }

  void silence() {
    for (auto& key : keys_) key->silence();
  }

  // Writes left, right and the contact force of the last key that was struck.
  void process(std::size_t samples, float* left, float* right, float* force) {
    std::fill_n(left, samples, 0.0f);
    std::fill_n(right, samples, 0.0f);
    std::fill_n(force, samples, 0.0f);
    for (auto& key : keys_)
      if (key->sounds())
        key->process(samples, left, right, force, key.get() == watched_ ? &books_ : nullptr, sample_rate_hz_);
  }

  // Without books all keys are played by the kernels.
  void watch_none() { watched_ = nullptr; }

  [[nodiscard]] const Books& books() const { return books_.books(); }

 private:
  // The weakest string gives way to a new one.
  void make_room() {
    std::size_t sounding = 0;
    Key* weakest = nullptr;
    for (auto& key : keys_) {
      if (!key->sounds()) continue;
      ++sounding;
      if (weakest == nullptr || key->energy() < weakest->energy()) weakest = key.get();
    }
    if (sounding >= kMaxSounding) weakest->silence();
  }

  double sample_rate_hz_;
  std::array<std::unique_ptr<Key>, Piano::keys> keys_;
  Key* watched_ = nullptr;
  StrikeBooks<float> books_;
  bool pedal_ = false;
};

std::optional<Keyboard> keyboard;
std::array<float, 3 * kBlock> outputs;
std::array<double, 5> shown_books;

// One frame of a study: hammer [m], compression [m], force [N], hammer, felt and string energy, dissipated energy,
// total less work [J], then the string at kPoints places [m].
constexpr std::size_t kPoints = 97, kFrame = 8 + kPoints;
std::vector<double> study;

void add_frame(double place, double compression, double force, const Books& books) {
  for (const double value : {place, compression, force, books.hammer, books.felt, books.string, books.dissipated,
                             books.total() - books.work})
    study.push_back(value);
}

}  // namespace

/// Makes the keyboard, which the functions from engine_strike to engine_books play. Studies need none.
CONTACTSPLINE_WEB(void, engine_start, double sample_rate_hz) {
  keyboard.emplace(sample_rate_hz);
}

/// Where the page writes the rows of a table: knot, energy, force, half curvature of each segment.
CONTACTSPLINE_WEB(double*, engine_rows) {
  return material.rows.data();
}

/// Takes the rows as the material of all later strikes. 0 if there are too many.
CONTACTSPLINE_WEB(int, engine_use_material, int segments, double mass_kg, double loss_s_per_m) {
  if (segments < 1 || segments > static_cast<int>(kMaxSegments)) return 0;
  material.segments = static_cast<std::size_t>(segments);
  material.mass_kg = mass_kg;
  material.loss_s_per_m = loss_s_per_m;
  return 1;
}

/// The controls of all later strikes.
CONTACTSPLINE_WEB(void, engine_control, double stiffness_ratio, double mass_ratio, double loss_s_per_m,
                  double strike_position) {
  material.stiffness_ratio = stiffness_ratio;
  material.mass_ratio = mass_ratio;
  material.loss_s_per_m = loss_s_per_m;
  material.strike_position = strike_position;
}

CONTACTSPLINE_WEB(void, engine_strike, int key, float speed_m_per_s) {
  if (is_key(key)) keyboard->strike(key, speed_m_per_s);
}

CONTACTSPLINE_WEB(void, engine_release, int key) {
  if (is_key(key)) keyboard->release(key);
}

CONTACTSPLINE_WEB(void, engine_pedal, int down) {
  keyboard->pedal(down != 0);
}

CONTACTSPLINE_WEB(void, engine_silence) {
  keyboard->silence();
}

CONTACTSPLINE_WEB(void, engine_watch_none) {
  keyboard->watch_none();
}

/// Plays up to 128 samples. Returns left, right and the contact force, 128 samples each.
CONTACTSPLINE_WEB(const float*, engine_process, int samples) {
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(samples, 0)), 0, kBlock);
  keyboard->process(count, outputs.data(), outputs.data() + kBlock, outputs.data() + 2 * kBlock);
  return outputs.data();
}

/// The books of the last strike: hammer, felt, string, dissipated, work [J].
CONTACTSPLINE_WEB(const double*, engine_books) {
  const Books& books = keyboard->books();
  shown_books = {books.hammer, books.felt, books.string, books.dissipated, books.work};
  return shown_books.data();
}

/// Numbers of a frame of a study.
CONTACTSPLINE_WEB(int, engine_frame_size) {
  return static_cast<int>(kFrame);
}

/// One strike of a key at rest in double precision, one frame for each sample.
CONTACTSPLINE_WEB(const double*, engine_study_string, int key, double speed_m_per_s, int frames,
                  double sample_rate_hz) {
  study.clear();
  if (!is_key(key)) return study.data();
  const Resonator resonator(key, sample_rate_hz);
  const auto table = material.table<double>();
  const auto controls = controls_of<double>(key);
  const auto strike = resonator.shapes_at<double>(material.strike_position);
  std::vector<ModeShapes<double>> points;
  for (std::size_t p = 0; p < kPoints; ++p)
    points.push_back(resonator.shapes_at<double>(static_cast<double>(p) / (kPoints - 1)));
  HammerString<double> model(SegmentTable<double>(table), bare(resonator.modes), strike, sample_rate_hz);
  model.strike(speed_m_per_s, 1e-4);
  StrikeBooks<double> books;
  books.open(model, table, controls);
  for (int i = 0; i < frames; ++i) {
    const double compression = model.compression();
    add_frame(model.string().displacement(strike) + compression, compression, model.force(), books.books());
    for (const auto& point : points) study.push_back(model.string().displacement(point));
    model.tick(controls);
    books.add_loss(model, table, controls, sample_rate_hz, compression);
    books.close(model, table, controls);
  }
  return study.data();
}

/// The strike of bench/baselines/fd_hammer_c4.dsp by the contact step: displacement of the string at the place of the
/// strike [m], in single precision as there. The material gives the felt.
CONTACTSPLINE_WEB(const double*, engine_strike_c4, double stiffness_ratio, int samples, double sample_rate_hz) {
  const StiffString string{0.62, 0.00393, 670.0, 0.00983833, {0.5, 0.0001}};
  const auto modes = modes_below(string, sample_rate_hz / 2);
  ModeShapes<float> strike(modes.size());
  for (std::size_t i = 0; i < modes.size(); ++i)
    strike[i] = float(std::sin(modes[i].wavenumber_per_m * 0.12 * string.length_m));
  const auto table = material.table<float>();
  HammerString<float> model(SegmentTable<float>(table), bare(modes), strike, sample_rate_hz);
  model.strike(2.5f, 1e-4f);
  study.clear();
  for (int i = 0; i < samples; ++i) {
    model.tick({.hammer_mass_kg = 0.00297f, .felt = {.stiffness_ratio = float(stiffness_ratio)}});
    study.push_back(model.string().displacement(strike));
  }
  return study.data();
}

/// The same for a mass at a rigid barrier: the string stands at 0.
CONTACTSPLINE_WEB(const double*, engine_study_barrier, double mass_kg, double speed_m_per_s, int frames,
                  double sample_rate_hz) {
  study.clear();
  const auto table = material.table<double>();
  const ContactControls<double> contact{material.stiffness_ratio, material.loss_s_per_m};
  MassBarrier<double> model(SegmentTable<double>(table), sample_rate_hz);
  model.throw_from(-1e-4, speed_m_per_s);
  Books books;
  books.work = mass_kg * speed_m_per_s * speed_m_per_s / 2;
  for (int i = 0; i < frames; ++i) {
    books.hammer = mass_kg * model.velocity() * model.velocity() / 2;
    books.felt = contact.stiffness_ratio * potential(SegmentTable<double>(table), model.displacement());
    add_frame(model.displacement(), model.displacement(), model.force(), books);
    study.insert(study.end(), kPoints, 0.0);
    const double y0 = model.displacement();
    model.tick({.mass_kg = mass_kg, .contact = contact});
    books.dissipated +=
        contact_loss(SegmentTable<double>(table), contact, sample_rate_hz, y0, model.displacement(), model.force());
  }
  return study.data();
}

}  // namespace contactspline::web
