// SPDX-License-Identifier: MIT
// The piano of piano.hpp as a plug-in: 88 keys, a sustain pedal, stereo.
#include "../piano.hpp"
#include "instrument_plugin.hpp"

namespace {

class PianoInstrument : public Piano {
 public:
  static constexpr const char* name = "piano";
  static constexpr const char* description = "88 hammer-strings from physical parameters, contact without iteration";
  static constexpr auto unique_id = d_cconst('C', 's', 'P', 'n');
  static constexpr std::array<PluginControl, 3> controls{
      {{"hammer hardness", "", 1, 0.05f, 20, true, 74},
       {"hammer mass", "", 1, 0.25f, 4, true},
       {"felt loss", "s/m", static_cast<float>(Keys::felt_loss_s_per_m), 0, 2}}};
  static constexpr std::array<PluginProgram<3>, 4> programs{{{"piano", {1, 1, 0.1f}},
                                                             {"soft felt", {0.2f, 1, 0.3f}},
                                                             {"hard felt", {6, 1, 0.05f}},
                                                             {"heavy hammers", {1, 2.5f, 0.1f}}}};

  using Piano::Piano;

  void set(std::span<const float, 3> values) {
    set_hammers(values[1], {.stiffness_ratio = values[0], .loss_s_per_m = values[2]});
  }
};

}  // namespace

DISTRHO_NAMESPACE::Plugin* DISTRHO_NAMESPACE::createPlugin() {
  return new InstrumentPlugin<PianoInstrument>;
}
