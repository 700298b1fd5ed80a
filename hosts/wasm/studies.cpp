// SPDX-License-Identifier: MIT
// The slow motion of every instrument of the page, and the strike of the comparison. In double precision, without
// kernels: not for the audio thread.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "generated/felt_c4.hpp"
#include "hosts/wasm/door.hpp"
#include "hosts/wasm/hammer_keys.hpp"
#include "hosts/wasm/network_study.hpp"
#include "hosts/wasm/packed_instrument.hpp"
#include "hosts/wasm/study.hpp"

namespace contactspline::web {
namespace {

Material material;
Study study;
std::size_t frames = 1;
std::vector<double> values;  // of the parameters of the instrument that is studied
Bytes of_file;               // packed instrument of a file that ships or is the user's

constexpr double kBlow_s = 0.012, kPluck_s = 0.03;

struct Studied {
  std::string name;
  double seconds;
  std::function<Study(const StudyPlan&, std::size_t event)> play;
};

std::vector<Studied> all_studied() {
  return {{HammerKeys::name(), kBlow_s,
           [](const StudyPlan& plan, std::size_t) { return study_of_key(material, values, plan); }},
          {Piano::name, kBlow_s, [](const StudyPlan& plan, std::size_t) { return study_of_piano(values, plan); }},
          {"mass_barrier", kBlow_s,
           [](const StudyPlan& plan, std::size_t) {
             return study_of_mass(segments_of<materials::felt_c4, double>, {}, values, plan);
           }},
          {"mass_at_material", kBlow_s,  // of the page, for its story
           [](const StudyPlan& plan, std::size_t) {
             return study_of_mass(material.table<double>(), material.memories, values, plan);
           }},
          {"of_file", kPluck_s, [](const StudyPlan& plan, std::size_t event) {
             if (of_file.empty()) return Study{};
             const UnpackedInstrument file(of_file);
             if (file.rest().empty()) return Study{};
             return study_of_network(file.data(), unpacked_drawn(file.rest().data()), values, event, plan);
           }}};
}

}  // namespace

/// Where the page writes the rows of a table: knot, energy, force, half curvature of each segment; then weight and
/// relaxation time of each memory.
CONTACTSPLINE_WEB(double*, studies_rows) {
  return material.rows.data();
}

/// Takes the rows as the material. 0 if there are too many.
CONTACTSPLINE_WEB(int, studies_use_material, int segments, int memories, double mass_kg, double loss_s_per_m) {
  return material.use(segments, memories, mass_kg, loss_s_per_m) ? 1 : 0;
}

/// Where the page writes so many bytes of the instrument of a file, which is called "of_file": packed by the
/// generator's module, with what is drawn behind it.
CONTACTSPLINE_WEB(std::byte*, studies_file_instrument, int bytes) {
  of_file.resize(static_cast<std::size_t>(std::max(bytes, 1)));
  return of_file.data();
}

/// Where the page writes the values of so many parameters.
CONTACTSPLINE_WEB(double*, studies_values, int count) {
  values.assign(static_cast<std::size_t>(std::max(count, 0)), 0);
  return values.data();
}

/// Plays a note from rest: a key, or an event of an instrument that has no keys. Returns frames of equal size, or
/// null where there is no such note.
CONTACTSPLINE_WEB(const double*, studies_play, const char* instrument, int key, double velocity, int event,
                  double sample_rate_hz) {
  study = {};
  static const std::vector<Studied> all = all_studied();
  const auto studied = std::ranges::find(all, std::string_view(instrument), &Studied::name);
  if (studied == all.end()) return nullptr;
  frames = static_cast<std::size_t>(studied->seconds * sample_rate_hz) + 1;
  study = studied->play({sample_rate_hz, frames, key, velocity}, static_cast<std::size_t>(std::max(event, 0)));
  return study.numbers.empty() ? nullptr : study.numbers.data();
}

/// Follows the first event of the instrument of a file from rest for so many samples: its first output, or by how
/// much its first bow slips in each [m]. Null where there is none.
CONTACTSPLINE_WEB(const double*, studies_follow, int samples, double sample_rate_hz, int is_slip) {
  study = {};
  if (of_file.empty()) return nullptr;
  const UnpackedInstrument file(of_file);
  const InstrumentData& data = file.data();
  NetworkInstrument<double> instrument(data);
  if (instrument.events().empty() || (is_slip != 0 && data.bows.empty())) return nullptr;
  instrument.prepare(sample_rate_hz);
  for (std::size_t p = 0; p < values.size(); ++p) instrument.set(p, values[p]);
  const Event& played = instrument.events()[0];
  play_event(instrument, played, instrument.value(played.parameter));
  for (int i = 0; i < samples; ++i) {
    instrument.tick();
    study.numbers.push_back(is_slip != 0 ? instrument.network().slip(data.bows[0].first) : instrument.output(0));
  }
  return study.numbers.data();
}

/// Frames of the last study, and the numbers of each.
CONTACTSPLINE_WEB(int, studies_frames) {
  return static_cast<int>(frames);
}
CONTACTSPLINE_WEB(int, studies_frame_size) {
  return static_cast<int>(study.numbers.size() / frames);
}

/// The scene of the last study, as JSON.
CONTACTSPLINE_WEB(const char*, studies_scene) {
  return study.scene.c_str();
}

/// The strike of bench/baselines/fd_hammer_c4.dsp by the contact step: displacement of the string at the place of the
/// strike [m], in single precision as there. The material gives the felt.
CONTACTSPLINE_WEB(const double*, studies_strike_c4, double stiffness_ratio, int samples, double sample_rate_hz) {
  const StiffString string{0.62, 0.00393, 670.0, 0.00983833, {0.5, 0.0001}};
  const auto modes = modes_below(string, sample_rate_hz / 2);
  ModeShapes<float> strike(modes.size());
  for (std::size_t i = 0; i < modes.size(); ++i)
    strike[i] = float(std::sin(modes[i].wavenumber_per_m * 0.12 * string.length_m));
  const auto table = material.table<float>();
  HammerString<float> model(SegmentTable<float>(table), bare(modes), strike, sample_rate_hz, material.memories);
  model.strike(2.5f, 1e-4f);
  study = {};
  for (int i = 0; i < samples; ++i) {
    model.tick({.hammer_mass_kg = 0.00297f, .felt = {.stiffness_ratio = float(stiffness_ratio)}});
    study.numbers.push_back(model.string().displacement(strike));
  }
  return study.numbers.data();
}

/// Memory for texts that the page passes.
CONTACTSPLINE_WEB(void*, contactspline_allocate, std::size_t bytes) {
  return std::malloc(bytes);
}

CONTACTSPLINE_WEB(void, contactspline_free, void* memory) {
  std::free(memory);
}

}  // namespace contactspline::web
