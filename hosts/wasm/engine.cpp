// SPDX-License-Identifier: MIT
// The instruments that the page plays on its audio thread, in single precision with kernels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/host/oversampled.hpp"
#include "contactspline/midi/key_tuning.hpp"
#include "contactspline/midi/midi_interpreter.hpp"
#include "hosts/wasm/door.hpp"
#include "hosts/wasm/hammer_keys.hpp"
#include "hosts/wasm/instruments.hpp"
#include "hosts/wasm/packed_instrument.hpp"
#include "hosts/wasm/playable.hpp"

namespace contactspline::web {
namespace {

constexpr std::size_t kBlock = 128;

/// One of the instruments that play together, and how loud it is on both sides.
struct Voice {
  std::unique_ptr<Playable> instrument;
  float left, right;
  bool is_played;        ///< the instrument itself rests beside voices until it is struck
  bool is_part = false;  ///< another instrument, with messages of its own
};

Material material;
std::vector<Voice> voices;  // of the instrument that was chosen
int chosen = 0;
double chosen_rate_hz = 0;
int oversampling = 1;  // of the instrument that was chosen, its voices and parts
Bytes own_bytes;       // packed instrument of the page's user
Bytes voice_bytes;     // of the next voice
Bytes packed_bytes;    // for the studies
std::array<float, 3 * kBlock> outputs, part;
std::array<double, 5> shown_energies;
std::array<std::uint8_t, 128> midi_bytes;
KeyCents key_cents;

/// A key that has begun to play, or, at velocity 0, was let go: for those who draw it.
struct HeardKey {
  double key, velocity;
};
std::array<HeardKey, 1024> heard_keys;  // more of them are not told
std::size_t heard_count = 0;
MidiInterpreter heard_midi;

void hear(int key, double velocity) {
  if (heard_count < heard_keys.size()) heard_keys[heard_count++] = {double(key), velocity};
}

void hear(const MidiEvent& event) {
  if (event.kind == MidiEvent::Kind::kNoteOn) hear(event.key, event.value);
  if (event.kind == MidiEvent::Kind::kNoteOff && event.is_last) hear(event.key, 0);
}

// Of all voices, and of other instruments if it is for them, too.
void take_midi(std::span<const std::uint8_t> bytes, bool is_for_parts = false) {
  for (const Voice& each : voices)
    if (is_for_parts || !each.is_part) each.instrument->hosted().midi(bytes);
  heard_midi.take(bytes, [](const MidiEvent& event) { hear(event); });
}

// Those of the list: models, files, and the user's own where there is one.
std::size_t instrument_count() {
  return kModels + kFiles.size() + (own_bytes.empty() ? 0 : 1);
}

// The number of a file among kFiles; none of them: kFiles.size().
std::size_t file_of(std::size_t number) {
  return number < kModels ? kFiles.size() : std::min(number - kModels, kFiles.size());
}

PageInstrument made(std::size_t number) {
  if (number < kModels) return model_of(number, material);
  const std::size_t file = file_of(number);
  return file < kFiles.size() ? instrument_of(kFiles[file]()) : instrument_of(own_bytes);
}

// Null where there is none of this number. Runs so many times finer.
std::unique_ptr<Playable> instrument(int number, int factor) {
  const auto known = static_cast<std::size_t>(number);
  if (number < 0 || known >= instrument_count()) return nullptr;
  return std::make_unique<Playable>(made(known), factor);
}

bool is_rate(double sample_rate_hz) {
  return sample_rate_hz >= 1000 && sample_rate_hz <= 768000;
}

// Calls use() with the voice of this number, or with the first; not where none was chosen.
template <typename Use>
void with_voice(int number, const Use& use) {
  const auto v = static_cast<std::size_t>(std::max(number, 0));
  if (!voices.empty()) use(voices[v < voices.size() ? v : 0]);
}

void process(Playable& played, std::span<float> out, std::size_t count) {
  played.process(out.first(count), out.subspan(kBlock, count), out.subspan(2 * kBlock, count));
}

}  // namespace

/// The instruments, as a JSON list (playable.hpp). Their numbers are their places in it.
CONTACTSPLINE_WEB(const char*, engine_instruments) {
  std::vector<std::string> all;
  for (int number = 0; const auto one = instrument(number, 1); ++number) all.push_back(one->described());
  return keep(fmt::format("[{}]", fmt::join(all, ", ")));
}

/// Where the page writes so many bytes of an instrument of its user's: packed by the generator's module, the last of
/// the instruments from now on. What plays already stays.
CONTACTSPLINE_WEB(std::byte*, engine_own_instrument, int bytes) {
  own_bytes.resize(static_cast<std::size_t>(std::max(bytes, 1)));
  return own_bytes.data();
}

/// Packs the instrument of a file that ships, as the studies take it; then engine_packed() says where. Returns the
/// number of bytes, 0 of another instrument.
CONTACTSPLINE_WEB(int, engine_pack, int number) {
  const std::size_t file = file_of(static_cast<std::size_t>(std::max(number, 0)));
  packed_bytes = file < kFiles.size() ? packed(kFiles[file]()) : Bytes();
  return static_cast<int>(packed_bytes.size());
}
CONTACTSPLINE_WEB(const std::byte*, engine_packed) {
  return packed_bytes.data();
}

/// How late an instrument is that runs so many times finer [samples].
CONTACTSPLINE_WEB(int, engine_latency, int factor) {
  return static_cast<int>(Decimator<float>(factor).delay());
}

/// Makes an instrument, at rest, which the functions below play, and runs it 1, 2, 4 or 8 times finer, at 1 to 768
/// kHz all in all. 0 if there is none of this number, and at another factor or rate. Allocates.
CONTACTSPLINE_WEB(int, engine_choose, int number, double sample_rate_hz, int factor) {
  if (std::ranges::count(kOversamplings, factor) == 0 || !is_rate(factor * sample_rate_hz)) return 0;
  auto next = instrument(number, factor);
  if (!next) return 0;
  next->hosted().prepare(sample_rate_hz);
  voices.clear();
  voices.push_back({std::move(next), 1, 1, true});
  chosen = number;
  chosen_rate_hz = sample_rate_hz;
  oversampling = factor;
  voice_bytes.clear();
  heard_midi = MidiInterpreter();
  heard_count = 0;
  return 1;
}

/// Lets the user's own instrument take the place of the one that plays, while it sounds, in all voices but those of
/// other instruments. 0 if there is none. Allocates.
CONTACTSPLINE_WEB(int, engine_replace) {
  if (own_bytes.empty() || voices.empty()) return 0;
  for (const Voice& each : voices)
    if (!each.is_part) each.instrument->replace(instrument_of(own_bytes).handle, chosen_rate_hz);
  return 1;
}

/// Where the page writes so many bytes of a packed instrument, which the next voice plays.
CONTACTSPLINE_WEB(std::byte*, engine_voice_instrument, int bytes) {
  voice_bytes.resize(static_cast<std::size_t>(std::max(bytes, 1)));
  return voice_bytes.data();
}

/// Adds a voice: the packed instrument, or where none was written the chosen one once more. 0 if none was chosen.
/// Allocates.
CONTACTSPLINE_WEB(int, engine_add_voice) {
  const Bytes bytes = std::exchange(voice_bytes, {});
  if (voices.empty()) return 0;
  auto next = bytes.empty() ? instrument(chosen, oversampling)
                            : std::make_unique<Playable>(instrument_of(bytes), oversampling);
  next->hosted().prepare(chosen_rate_hz);
  if (voices.size() == 1) voices[0].is_played = false;
  voices.push_back({std::move(next), 1, 1, true});
  return 1;
}

/// Adds another instrument, `level` times as loud as its file says, as a voice that plays beside the first one. 0 if
/// there is none of this number. Allocates.
CONTACTSPLINE_WEB(int, engine_add_part, int number, double level) {
  auto next = instrument(number, oversampling);
  if (!next || voices.empty()) return 0;
  next->hosted().prepare(chosen_rate_hz);
  const auto side = static_cast<float>(level);
  voices.push_back({std::move(next), side, side, true, true});
  return 1;
}

/// Moves a voice between left, -1, and right, 1, with equal power; 0 is as loud as one voice alone.
CONTACTSPLINE_WEB(void, engine_pan, int number, double pan) {
  if (number < 0 || number >= static_cast<int>(voices.size())) return;
  Voice& moved = voices[static_cast<std::size_t>(number)];
  const double angle = (std::clamp(pan, -1.0, 1.0) + 1) * std::numbers::pi / 4;
  moved.left = static_cast<float>(std::numbers::sqrt2 * std::cos(angle));
  moved.right = static_cast<float>(std::numbers::sqrt2 * std::sin(angle));
}

/// Forgets what plays, the material and the user's own instrument, as if it had just been started.
CONTACTSPLINE_WEB(void, engine_restart) {
  voices.clear();
  oversampling = 1;
  material = Material{};
  own_bytes.clear();
  voice_bytes.clear();
}

/// Where the page writes the rows of a table: knot, energy, force, half curvature of each segment; then weight and
/// relaxation time of each memory.
CONTACTSPLINE_WEB(double*, engine_rows) {
  return material.rows.data();
}

/// Takes the rows as the material of all later strikes of the first instrument. 0 if there are too many.
CONTACTSPLINE_WEB(int, engine_use_material, int segments, int memories, double mass_kg, double loss_s_per_m) {
  return material.use(segments, memories, mass_kg, loss_s_per_m) ? 1 : 0;
}

/// Below, a voice is called by its number: 0 is the instrument itself, then those that were added.
CONTACTSPLINE_WEB(void, engine_set, int number, int parameter, double value) {
  with_voice(number,
             [&](Voice& voice) { voice.instrument->hosted().set(static_cast<std::size_t>(parameter), value); });
}

CONTACTSPLINE_WEB(void, engine_note_on, int number, int key, double velocity) {
  with_voice(number, [&](Voice& voice) {
    voice.is_played = true;
    voice.instrument->note_on(key, velocity);
    hear(key, velocity);
  });
}

CONTACTSPLINE_WEB(void, engine_note_off, int number, int key) {
  with_voice(number, [&](Voice& voice) {
    voice.instrument->note_off(key);
    hear(key, 0);
  });
}

/// Where the page writes up to 128 bytes of MIDI.
CONTACTSPLINE_WEB(std::uint8_t*, engine_midi_bytes) {
  return midi_bytes.data();
}

/// Takes so many of them: messages or pieces of a stream, for the voice of this number, or below 1 for all voices of
/// the instrument.
CONTACTSPLINE_WEB(void, engine_midi, int number, int count) {
  const auto bytes =
      std::span(midi_bytes).first(std::min<std::size_t>(static_cast<std::size_t>(count), midi_bytes.size()));
  if (number < 1) return take_midi(bytes);
  with_voice(number, [&](Voice& voice) { voice.instrument->hosted().midi(bytes); });
}

/// Where the page writes the cents of the 128 keys of MIDI.
CONTACTSPLINE_WEB(double*, engine_key_cents) {
  return key_cents.data();
}

/// Tunes the keys of all voices by them, from the next notes on.
CONTACTSPLINE_WEB(void, engine_tune) {
  for (const Voice& each : voices) each.instrument->hosted().tune(key_cents);
}

/// Lets all keys and pedals of MIDI go, and brings wheels to their centre.
CONTACTSPLINE_WEB(void, engine_let_go) {
  for (int channel = 0; channel < 16; ++channel)
    for (const int controller : {123, 121})  // all notes off, reset all controllers
      take_midi(std::array{static_cast<std::uint8_t>(0xb0 | channel), static_cast<std::uint8_t>(controller),
                           std::uint8_t{0}},
                true);
}

/// How many keys have begun to play or were let go since the last call.
CONTACTSPLINE_WEB(int, engine_heard) {
  return static_cast<int>(std::exchange(heard_count, 0));
}

/// These keys: the number of each, and its velocity, 0 where it was let go.
CONTACTSPLINE_WEB(const double*, engine_heard_keys) {
  return &heard_keys.front().key;
}

/// Where a parameter of the instrument itself is or goes to; not a number behind the last one.
CONTACTSPLINE_WEB(double, engine_target, int parameter) {
  return voices.empty() ? NAN : voices.front().instrument->target(static_cast<std::size_t>(parameter));
}

/// Plays an event by a speed [m/s] or a force [N]; by its parameter if that is not a number.
CONTACTSPLINE_WEB(void, engine_strike, int number, int event, double value) {
  with_voice(number, [&](Voice& voice) {
    voice.is_played = true;
    voice.instrument->play(static_cast<std::size_t>(event), value);
    if (value == 0) return;  // which lifts a bow
    for (const double velocity : {1.0, 0.0})
      hear(voice.instrument->key_of(static_cast<std::size_t>(event)), velocity);
  });
}

CONTACTSPLINE_WEB(void, engine_watch_none) {
  with_voice(0, [](Voice& voice) { voice.instrument->watch_none(); });
}

/// Plays up to 128 samples. Returns left, right and the contact force, 128 samples each.
CONTACTSPLINE_WEB(const float*, engine_process, int samples) {
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(samples, 0)), 0, kBlock);
  if (voices.size() == 1) {
    process(*voices[0].instrument, outputs, count);
    return outputs.data();
  }
  outputs.fill(0);
  for (const Voice& each : voices) {
    if (!each.is_played) continue;
    process(*each.instrument, part, count);
    for (std::size_t i = 0; i < count; ++i) {
      outputs[i] += each.left * part[i];
      outputs[kBlock + i] += each.right * part[kBlock + i];
      outputs[2 * kBlock + i] += part[2 * kBlock + i];
    }
  }
  return outputs.data();
}

/// Energy that all voices store [J].
CONTACTSPLINE_WEB(double, engine_energy) {
  double energy = 0;
  for (const Voice& each : voices) energy += each.instrument->energy();
  return energy;
}

/// Energies of the last strike: hammer, felt, string, dissipated, work [J]. Null where none are kept.
CONTACTSPLINE_WEB(const double*, engine_books) {
  const StrikeEnergies* const last = voices.empty() ? nullptr : voices.front().instrument->strike_energies();
  if (last == nullptr) return nullptr;
  shown_energies = {last->hammer, last->felt, last->string, last->dissipated, last->work};
  return shown_energies.data();
}

}  // namespace contactspline::web
