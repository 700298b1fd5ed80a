// SPDX-License-Identifier: MIT
// One hammer on one piano string, C4, as a plug-in. Every note throws the hammer, whatever its key.
#include <bitset>
#include <numbers>

#include "contactspline/hammer_voice.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "instrument_plugin.hpp"

namespace {

class HammerStringInstrument {
  using Felt = contactspline::materials::felt_c4;
  using String = contactspline::resonators::string_c4;

  enum : std::size_t { kSpeed, kMass, kStiffnessRatio, kLoss, kDamping, kPosition, kControls };

 public:
  static constexpr const char* name = "hammer_string";
  static constexpr const char* description = "Hammer on a string: contact without iteration, modes with exact poles";
  static constexpr auto unique_id = d_cconst('C', 's', 'H', 's');
  // As in ci.hammer_string_ui, but the mass in grams: hosts show six decimals.
  static constexpr std::array<PluginControl, kControls> controls{
      {{"speed", "m/s", 2.5f, 0.05f, 10},
       {"hammer mass", "g", 2.97f, 0.5f, 50, true},
       {"stiffness ratio", "", 1, 0.001f, 1000, true},
       {"felt loss", "s/m", static_cast<float>(Felt::loss_s_per_m), 0, 2},
       {"damping", "1/s", 0, 0, 1000},
       {"strike position", "", 0.12f, 0.01f, 0.99f}}};
  static constexpr std::array<PluginProgram<kControls>, 4> programs{
      {{"felt hammer", {2.5f, 2.97f, 1, 0, 0, 0.12f}},
       {"soft mallet", {1.5f, 12, 0.05f, 0.2f, 0, 0.2f}},
       {"hard hammer", {4, 2.97f, 50, 0, 0, 0.12f}},
       {"muted", {3, 2.97f, 1, 0, 20, 0.3f}}}};

  explicit HammerStringInstrument(double sample_rate_hz)
      : voice_(contactspline::SegmentTable<float>(contactspline::segments_of<Felt, float>),
               contactspline::modes_in<String>, shapes_, Shapes(std::span<const double>(String::pickup_shapes)),
               {.hammer_mass_kg = 0.00297f}, {}, sample_rate_hz) {}

  void set(std::span<const float, kControls> values) {
    speed_m_per_s_ = values[kSpeed];
    voice_.controls() = {values[kMass] / 1000, {values[kStiffnessRatio], values[kLoss]}, values[kDamping]};
    if (values[kPosition] == position_) return;
    position_ = values[kPosition];
    const double place_m = static_cast<double>(position_) * std::numbers::pi / String::wavenumbers[0];
    for (std::size_t i = 0; i < String::modes; ++i)
      shapes_[i] = static_cast<float>(std::sin(String::wavenumbers[i] * place_m) / String::strings);
    voice_.strike_at(shapes_);
  }

  void note_on(int note, float velocity) {
    down_.set(static_cast<std::size_t>(note));
    voice_.strike(velocity * speed_m_per_s_);
  }

  void note_off(int note) {
    down_.reset(static_cast<std::size_t>(note));
    release_if_free();
  }

  void move_pedal(int controller, float position) {
    if (controller != 64) return;
    const bool is_down = position >= 0.5f;
    is_pedal_down_ = is_down;
    release_if_free();
  }

  void reset() {
    voice_.reset();
    down_.reset();
  }

  /// Displacement at the pickup [mm] on both sides.
  void process(std::span<float> left, std::span<float> right) {
    voice_.process(left);
    for (float& sample : left) sample *= 1000;
    std::ranges::copy(left, right.begin());
  }

 private:
  using Shapes = contactspline::ModeShapes<float>;

  // The damper comes down when neither a key nor the pedal holds it.
  void release_if_free() {
    if (down_.none() && !is_pedal_down_) voice_.release();
  }

  Shapes shapes_{std::span<const double>(String::strike_shapes)};
  contactspline::HammerVoice<float> voice_;
  float speed_m_per_s_ = 0;
  float position_ = -1;  // none yet
  std::bitset<128> down_;
  bool is_pedal_down_ = false;
};

}  // namespace

DISTRHO_NAMESPACE::Plugin* DISTRHO_NAMESPACE::createPlugin() {
  return new InstrumentPlugin<HammerStringInstrument>;
}
