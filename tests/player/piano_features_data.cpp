// SPDX-License-Identifier: MIT
// piano_features_data: prints what docs/measurements/piano.md says of middle C. piano_features_data FOLDER: writes
// its waveform and its spectrum at three speeds there, for scripts/figures.
#include <fmt/os.h>

#include "piano_features.hpp"

namespace {

using namespace contactspline;
using namespace contactspline::testing;

struct Dynamic {
  const char* name;
  double speed_m_per_s;
};
constexpr Dynamic kDynamics[] = {{"pp", 0.5}, {"mf", 1.5}, {"ff", 4}};

void print_table() {
  const StiffString string = note_of(testing::shipped_piano(), 60).string;
  fmt::print("| | pp, 0.5 m/s | mf, 1.5 m/s | ff, 4 m/s |\n|---|---|---|---|\n");
  std::vector<std::vector<double>> sounds;
  for (const Dynamic& dynamic : kDynamics) sounds.push_back(sound_of(one_note(60, dynamic.speed_m_per_s, 100, 8)));
  const auto row = [&](const char* what, auto value, const char* unit) {
    fmt::print("| {} |", what);
    for (std::size_t i = 0; i < 3; ++i) fmt::print(" {:.3g}{} |", value(i), unit);
    fmt::print("\n");
  };
  row(
      "contact time", [](std::size_t i) { return 1000 * contact_time_s(60, kDynamics[i].speed_m_per_s); }, " ms");
  row(
      "attack time", [&](std::size_t i) { return 1000 * attack_time_s(sounds[i]); }, " ms");
  row(
      "spectral centroid", [&](std::size_t i) { return spectral_centroid_hz(sounds[i]); }, " Hz");
  row(
      "inharmonicity B", [&](std::size_t i) { return 1e4 * inharmonicity(partials_hz(sounds[i], string, 20)); },
      "e-4");
  fmt::print("\n| partial | frequency | level | decay 0.1 to 1 s | decay 3 to 7 s |\n|---|---|---|---|---|\n");
  const auto& sound = sounds[1];
  const auto partials = partials_hz(sound, string, 10);
  const double first = partial_level_db(sound, partials[0], 0.1);
  for (std::size_t i = 0; i < partials.size(); ++i)
    fmt::print("| {} | {:.1f} Hz | {:.0f} dB | {:.1f} dB/s | {:.1f} dB/s |\n", i + 1, partials[i],
               partial_level_db(sound, partials[i], 0.1) - first, decay_db_per_s(sound, partials[i], 0.1, 1),
               decay_db_per_s(sound, partials[i], 3, 7));
}

void write_figure(const std::string& folder) {
  for (const Dynamic& dynamic : kDynamics) {
    const auto sound = sound_of(one_note(60, dynamic.speed_m_per_s, 100, 3));
    auto waveform = fmt::output_file(fmt::format("{}/waveform_{}", folder, dynamic.name));
    for (std::size_t n = 0; n < 4410; ++n)
      waveform.print("{:.6g} {:.6g}\n", 1000.0 * static_cast<double>(n) / kFeatureRate, 1000 * sound[n]);
    auto spectrum = fmt::output_file(fmt::format("{}/spectrum_{}", folder, dynamic.name));
    const auto power = power_spectrum(std::span(sound).first(44100));
    for (std::size_t k = 30; k < 10000; ++k) spectrum.print("{} {:.5g}\n", k, 10 * std::log10(power[k]) + 60);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1)
    write_figure(argv[1]);
  else
    print_table();
}
