// SPDX-License-Identifier: MIT
// The piano of piano.hpp as a plug-in: 88 keys on their soundboard, three pedals, stereo.
#include "../piano.hpp"
#include "instrument_plugin.hpp"

namespace {

class PianoInstrument : public Piano {
 public:
  static constexpr const char* name = "piano";
  static constexpr const char* description = "88 keys of strings on a soundboard, contact without iteration";
  static constexpr auto unique_id = d_cconst('C', 's', 'P', 'n');
  static constexpr std::array<PluginControl, 5> controls{
      {{"hammer hardness", "", 1, 0.05f, 20, true, 74},
       {"hammer mass", "", 1, 0.25f, 4, true},
       {"felt loss", "s/m", static_cast<float>(Keys::felt_loss_s_per_m), 0, 2},
       {"sustain", "", 0, 0, 1},
       {"una corda", "", 0, 0, 1}}};
  static constexpr std::array<PluginProgram<5>, 6> programs{{{"concert", {1, 1, 0.1f, 0, 0}},
                                                             {"una corda", {1, 1, 0.1f, 0, 1}},
                                                             {"soft felt", {0.2f, 1, 0.3f, 0, 0}},
                                                             {"hard felt", {6, 1, 0.05f, 0, 0}},
                                                             {"heavy hammers", {1, 2.5f, 0.1f, 0, 0}},
                                                             {"long sustain", {1, 1, 0.1f, 1, 0}}}};

  using Piano::Piano;

  void set(std::span<const float, 5> values) {
    set_hammers(values[1], {.stiffness_ratio = values[0], .loss_s_per_m = values[2]});
    if (values[3] == set_sustain_ && values[4] == set_soft_) return;
    set_sustain_ = values[3];
    set_soft_ = values[4];
    move_pedals();
  }

  // The pedals of the keyboard: sustain, sostenuto, soft. A parameter holds a pedal down from the host.
  void move_pedal(int controller, float position) {
    if (controller == 64) pedal_sustain_ = position;
    if (controller == 66) sostenuto(position >= 0.5f);
    if (controller == 67) pedal_soft_ = position;
    move_pedals();
  }

 private:
  void move_pedals() {
    sustain(static_cast<double>(std::max(set_sustain_, pedal_sustain_)));
    una_corda(static_cast<double>(std::max(set_soft_, pedal_soft_)));
  }

  float set_sustain_ = 0, set_soft_ = 0, pedal_sustain_ = 0, pedal_soft_ = 0;
};

}  // namespace

DISTRHO_NAMESPACE::Plugin* DISTRHO_NAMESPACE::createPlugin() {
  return new InstrumentPlugin<PianoInstrument>;
}
