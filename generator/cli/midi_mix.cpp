// SPDX-License-Identifier: MIT
#include "generator/cli/midi_mix.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contactspline/midi/midi_interpreter.hpp"

namespace contactspline {
namespace {

constexpr int kVolume = 7, kPan = 10, kExpression = 11;
constexpr double kGlide_s = 0.005;

struct Mixer {
  double volume = 100, expression = 127, pan = 64;

  // Is the controller one of these?
  bool take(int controller, double value) {
    double* const taken = controller == kVolume       ? &volume
                          : controller == kExpression ? &expression
                          : controller == kPan        ? &pan
                                                      : nullptr;
    if (taken != nullptr) *taken = value;
    return taken != nullptr;
  }

  // 0 and 1 are both the left end, so that 64 is the middle.
  [[nodiscard]] MixGains at(double time_s) const {
    const double level = std::numbers::sqrt2 * std::pow(volume / 100 * (expression / 127), 2);
    const double angle = std::numbers::pi / 2 * (std::max(pan, 1.0) - 1) / 126;
    return {time_s, pan == 64 ? level / std::numbers::sqrt2 : level * std::cos(angle),
            pan == 64 ? level / std::numbers::sqrt2 : level * std::sin(angle)};
  }
};

}  // namespace

std::vector<MixGains> mix_of(std::span<const MidiFileMessage> messages, std::span<const int> channels,
                             const std::function<bool(int controller)>& free) {
  Mixer mixer;
  MidiInterpreter midi;
  std::vector<MixGains> gains;
  for (const auto& [time_s, message] : messages)
    midi.take(message, [&, time_s = time_s](const MidiEvent& event) {
      const bool resets = event.kind == MidiEvent::Kind::kReset;
      if (resets) mixer = {};
      const bool is_control =
          event.kind == MidiEvent::Kind::kController && std::ranges::count(channels, event.channel + 1) > 0;
      if (resets || (is_control && free(event.number) && mixer.take(event.number, std::round(127 * event.value))))
        gains.push_back(mixer.at(time_s));
    });
  const bool differs =
      std::ranges::any_of(gains, [](const MixGains& gain) { return gain.left != 1 || gain.right != 1; });
  return differs ? gains : std::vector<MixGains>{};
}

MixGlide::MixGlide(std::span<const MixGains> gains, double sample_rate_hz)
    : gains_(gains), sample_rate_hz_(sample_rate_hz), part_(-std::expm1(-1 / (kGlide_s * sample_rate_hz))) {}

MixGlide::Sides MixGlide::next() {
  const double time_s = static_cast<double>(sample_) / sample_rate_hz_;
  for (; !gains_.empty() && gains_.front().time_s <= time_s; gains_ = gains_.subspan(1))
    wanted_ = {gains_.front().left, gains_.front().right};
  if (sample_++ == 0) now_ = wanted_;
  now_.left += part_ * (wanted_.left - now_.left);
  now_.right += part_ * (wanted_.right - now_.right);
  return now_;
}

}  // namespace contactspline
