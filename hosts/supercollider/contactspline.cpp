// SPDX-License-Identifier: MIT
// The unit generator ContactInstrument of SuperCollider's server. Its inputs, in order; a text is its length and its
// characters, all constant:
//   name of the instrument, or path of its file
//   number of outputs; the name of each
//   number of notes; gate, key and velocity of each
//   number of events; of each its name, trigger, 1 if a value follows, or 0, and the value
//   number of parameters; name and signal of each
#include <SC_PlugIn.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string_view>

#include "hosts/wired_instrument.hpp"

static InterfaceTable* ft;

namespace {

using Player = contactspline::WiredInstrument<float>;

/// What is made beside the audio thread: outlives its unit.
struct Request {
  struct ContactInstrument* unit;  ///< null: has ended
  Player* player;
  double sample_rate_hz;
  char name[1024];
};

struct Note {
  std::uint32_t input;  ///< of the gate; key and velocity follow
  bool is_down, waits;
  float key;  ///< that is down
};

struct Trigger {
  std::uint32_t name, input;  ///< of its text; of the trigger; the value follows
  bool is_up, waits;
  std::optional<std::size_t> event;
};

struct Control {
  std::uint32_t name, input;
  bool is_known;
  contactspline::Wire<float> wire;
};

constexpr double kMaxWait_s = 30;  // a piano takes a few seconds
constexpr std::size_t kMaxOutputs = 16, kMaxNotes = 128, kMaxTriggers = 64, kMaxControls = 128, kMaxText = 1000;

struct ContactInstrument : public Unit {
  Request* request;  ///< while the instrument is made
  double waited_s;   ///< for it; negative once that was told
  Player* player;
  std::size_t outputs, notes, triggers, controls;
  bool is_audio_rate;  ///< has an input at audio rate
  std::uint32_t output_names[kMaxOutputs];
  contactspline::Tap<float> taps[kMaxOutputs];
  Note note[kMaxNotes];
  Trigger trigger[kMaxTriggers];
  Control control[kMaxControls];
};

/// Reads the inputs in order. What is not there or not allowed makes it wrong.
class Reader {
 public:
  explicit Reader(const Unit* unit) : unit_(unit) {}

  [[nodiscard]] bool is_wrong() const { return is_wrong_; }
  std::uint32_t next() {
    if (at_ < unit_->mNumInputs) return at_++;
    is_wrong_ = true;
    return 0;
  }
  std::size_t count(std::size_t max) {
    const std::uint32_t input = constant();
    const float value = is_wrong_ ? -1 : unit_->mInBuf[input][0];
    is_wrong_ |= !(value >= 0 && value <= static_cast<float>(max));
    return is_wrong_ ? 0 : static_cast<std::size_t>(value);
  }
  /// The input of the length of a text.
  std::uint32_t text() {
    const std::uint32_t begin = at_;
    for (std::size_t left = count(kMaxText); left > 0 && !is_wrong_; --left) constant();
    return begin;
  }

 private:
  // An input that never moves: texts are read again when the instrument is ready.
  std::uint32_t constant() {
    const std::uint32_t input = next();
    is_wrong_ |= is_wrong_ || unit_->mInput[input]->mCalcRate != calc_ScalarRate;
    return input;
  }

  const Unit* unit_;
  std::uint32_t at_ = 0;
  bool is_wrong_ = false;
};

using Text = std::array<char, kMaxText + 1>;

/// Characters of a text; Reader has checked that they are there.
std::string_view text_at(const Unit* unit, std::uint32_t input, Text& space) {
  const auto length = static_cast<std::size_t>(unit->mInBuf[input][0]);
  for (std::size_t i = 0; i < length; ++i) {
    const float character = unit->mInBuf[input + 1 + i][0];
    space[i] = character >= 1 && character < 256 ? static_cast<char>(static_cast<unsigned char>(character)) : '?';
  }
  space[length] = '\0';
  return {space.data(), length};
}

bool read_inputs(ContactInstrument* unit, Reader& inputs) {
  unit->outputs = inputs.count(kMaxOutputs);
  for (std::size_t i = 0; i < unit->outputs; ++i) unit->output_names[i] = inputs.text();
  unit->notes = inputs.count(kMaxNotes);
  for (std::size_t i = 0; i < unit->notes; ++i) {
    unit->note[i] = {.input = inputs.next(), .is_down = false, .waits = false, .key = 0};
    inputs.next();
    inputs.next();
  }
  unit->triggers = inputs.count(kMaxTriggers);
  for (std::size_t i = 0; i < unit->triggers; ++i) {
    const std::uint32_t name = inputs.text();
    unit->trigger[i] = {.name = name, .input = inputs.next(), .is_up = false, .waits = false, .event = {}};
    inputs.next();
    inputs.next();
  }
  unit->controls = inputs.count(kMaxControls);
  for (std::size_t i = 0; i < unit->controls; ++i) {
    const std::uint32_t name = inputs.text();
    unit->control[i] = {.name = name, .input = inputs.next(), .is_known = false, .wire = {}};
  }
  return !inputs.is_wrong() && unit->outputs == unit->mNumOutputs;
}

/// The value of an input at a sample of the block; what a demand rate gave last.
float value_at(const Unit* unit, std::uint32_t input, int sample) {
  return unit->mInBuf[input][unit->mInput[input]->mCalcRate == calc_FullRate ? sample : 0];
}

/// The next value of an input at demand rate; that of another one.
float demanded(ContactInstrument* unit, std::uint32_t input, int sample) {
  return IsDemandInput(unit, static_cast<int>(input)) ? DemandInputA(unit, static_cast<int>(input), sample + 1)
                                                      : value_at(unit, input, sample);
}

/// Notes and triggers take the next values of parameters at demand rate, too.
void demand_controls(ContactInstrument* unit, int sample) {
  for (std::size_t i = 0; i < unit->controls; ++i) {
    Control& control = unit->control[i];
    if (control.is_known && IsDemandInput(unit, static_cast<int>(control.input)))
      control.wire.move(*unit->player, demanded(unit, control.input, sample));
  }
}

/// Remembers what begins while the instrument is being made.
void wait(ContactInstrument* unit, int sample) {
  for (std::size_t i = 0; i < unit->notes; ++i)
    unit->note[i].waits |= value_at(unit, unit->note[i].input, sample) > 0;
  for (std::size_t i = 0; i < unit->triggers; ++i)
    unit->trigger[i].waits |= value_at(unit, unit->trigger[i].input, sample) > 0;
}

/// Does anything begin, end or move at a sample?
bool acts_at(ContactInstrument* unit, int sample) {
  for (std::size_t i = 0; i < unit->notes; ++i) {
    const Note& note = unit->note[i];
    if (note.waits || (value_at(unit, note.input, sample) > 0) != note.is_down) return true;
  }
  for (std::size_t i = 0; i < unit->triggers; ++i) {
    const Trigger& trigger = unit->trigger[i];
    if (trigger.waits || (value_at(unit, trigger.input, sample) > 0) != trigger.is_up) return true;
  }
  for (std::size_t i = 0; i < unit->controls; ++i) {
    const Control& control = unit->control[i];
    if (control.is_known && !IsDemandInput(unit, static_cast<int>(control.input)) &&
        control.wire.moves(value_at(unit, control.input, sample)))
      return true;
  }
  return false;
}

void play_note(ContactInstrument* unit, Note& note, int sample) {
  const bool is_down = value_at(unit, note.input, sample) > 0;
  if (is_down == note.is_down && !note.waits) return;
  if (note.is_down) unit->player->note(note.key, 0);
  if (is_down || note.waits) {
    demand_controls(unit, sample);
    note.key = demanded(unit, note.input + 1, sample);
    unit->player->note(note.key, demanded(unit, note.input + 2, sample));
    if (!is_down) unit->player->note(note.key, 0);
  }
  note.is_down = is_down;
  note.waits = false;
}

void play_trigger(ContactInstrument* unit, Trigger& trigger, int sample) {
  const bool is_up = value_at(unit, trigger.input, sample) > 0;
  if (((is_up && !trigger.is_up) || trigger.waits) && trigger.event) {
    demand_controls(unit, sample);
    if (value_at(unit, trigger.input + 1, 0) > 0)
      unit->player->play(*trigger.event, demanded(unit, trigger.input + 2, sample));
    else
      unit->player->play(*trigger.event);
  }
  trigger.is_up = is_up;
  trigger.waits = false;
}

void act_at(ContactInstrument* unit, int sample) {
  for (std::size_t i = 0; i < unit->controls; ++i) {
    Control& control = unit->control[i];
    if (control.is_known && !IsDemandInput(unit, static_cast<int>(control.input)))
      control.wire.move(*unit->player, value_at(unit, control.input, sample));
  }
  for (std::size_t i = 0; i < unit->notes; ++i) play_note(unit, unit->note[i], sample);
  for (std::size_t i = 0; i < unit->triggers; ++i) play_trigger(unit, unit->trigger[i], sample);
}

/// Tells once that an instrument takes too long. The server says nothing where its queue is full.
void tell_of_wait(ContactInstrument* unit, int samples) {
  if (unit->request == nullptr || unit->waited_s < 0) return;
  unit->waited_s += samples / unit->mRate->mSampleRate;
  if (unit->waited_s < kMaxWait_s) return;
  unit->waited_s = -1;
  Print(
      "contactspline: %s: is not made after %g s, maybe as the server's queue of commands was full; allowed: to end "
      "this synth and start it again\n",
      unit->request->name, kMaxWait_s);
}

/// An input may share memory with an output: the server is told not to do that.
void play_block(ContactInstrument* unit, int samples) {
  if (unit->player == nullptr) {
    tell_of_wait(unit, samples);
    for (int n = 0; n < (unit->is_audio_rate ? samples : 1); ++n) wait(unit, n);
    return ClearUnitOutputs(unit, samples);
  }
  const auto play = [&](int begin, int end) {
    float* sounds[kMaxOutputs];
    for (std::size_t o = 0; o < unit->outputs; ++o) sounds[o] = unit->mOutBuf[o] + begin;
    unit->player->process({unit->taps, unit->outputs}, {sounds, unit->outputs},
                          static_cast<std::size_t>(end - begin));
  };
  int begin = 0;
  for (int n = 0; n < (unit->is_audio_rate ? samples : 1); ++n) {
    if (!acts_at(unit, n)) continue;
    play(begin, n);
    act_at(unit, n);
    begin = n;
  }
  play(begin, samples);
}

void say_unknown(const char* kind, std::string_view name) {
  Print("contactspline: %s: there is none of the name %s; allowed: see the help of ContactInstrument\n", kind,
        name.data());
}

/// Finds the names in the lists of the instrument. False where an output is unknown.
bool resolve(ContactInstrument* unit) {
  Text space;
  const Player& player = *unit->player;
  for (std::size_t o = 0; o < unit->outputs; ++o) {
    const std::string_view name = text_at(unit, unit->output_names[o], space);
    const auto tap = player.tap(name);
    if (!tap) return say_unknown("output", name), false;
    unit->taps[o] = *tap;
  }
  for (std::size_t i = 0; i < unit->triggers; ++i) {
    const std::string_view name = text_at(unit, unit->trigger[i].name, space);
    unit->trigger[i].event = player.event(name);
    if (!unit->trigger[i].event) say_unknown("event", name);
  }
  for (std::size_t i = 0; i < unit->controls; ++i) {
    Control& control = unit->control[i];
    const std::string_view name = text_at(unit, control.name, space);
    const auto parameter = player.parameter(name);
    control.is_known = parameter.has_value();
    if (parameter)
      control.wire = {.parameter = *parameter};
    else
      say_unknown("parameter", name);
  }
  return true;
}

// Stages of a command: beside the audio thread, on it, beside it, on it.
bool make_player(World*, void* data) {
  auto* const request = static_cast<Request*>(data);
  request->player = Player::create(request->name, request->sample_rate_hz).release();
  if (request->player == nullptr) Print("%s\n", contactspline_last_error());
  return true;
}

bool hand_over(World*, void* data) {
  auto* const request = static_cast<Request*>(data);
  ContactInstrument* const unit = request->unit;
  if (unit == nullptr) return true;
  unit->request = nullptr;
  unit->player = request->player;
  if (unit->player == nullptr || resolve(unit)) {
    request->player = nullptr;
  } else {
    unit->player = nullptr;
  }
  return true;
}

bool delete_player(World*, void* data) {
  delete static_cast<Request*>(data)->player;
  return false;
}

void free_request(World* world, void* data) {
  RTFree(world, data);
}

bool nothing(World*, void*) {
  return true;
}

Request* request_of(ContactInstrument* unit) {
  void* const memory = RTAlloc(unit->mWorld, sizeof(Request));
  return memory == nullptr
             ? nullptr
             : new (memory)
                   Request{.unit = unit, .player = nullptr, .sample_rate_hz = unit->mRate->mSampleRate, .name = {}};
}

bool is_begun(ContactInstrument* unit, Request* request, AsyncStageFn second, AsyncStageFn third,
              AsyncStageFn fourth) {
  return DoAsynchronousCommand(unit->mWorld, nullptr, "", request, second, third, fourth, free_request, 0, nullptr) ==
         0;
}

void begin(ContactInstrument* unit) {
  Reader inputs(unit);
  const std::uint32_t name = inputs.text();
  unit->request = nullptr;
  unit->waited_s = 0;
  unit->player = nullptr;
  unit->outputs = unit->notes = unit->triggers = unit->controls = 0;
  unit->is_audio_rate = false;
  for (std::uint32_t i = 0; i < unit->mNumInputs; ++i)
    unit->is_audio_rate |= unit->mInput[i]->mCalcRate == calc_FullRate;
  unit->mCalcFunc = reinterpret_cast<UnitCalcFunc>(play_block);
  ClearUnitOutputs(unit, 1);
  Request* const request = read_inputs(unit, inputs) ? request_of(unit) : nullptr;
  if (request == nullptr) {
    unit->outputs = unit->notes = unit->triggers = unit->controls = 0;
    Print("contactspline: ContactInstrument: its inputs are damaged, or the server has no memory\n");
    return;
  }
  Text space;
  const std::string_view text = text_at(unit, name, space);
  std::copy_n(text.data(), text.size() + 1, request->name);
  unit->request = request;
  if (is_begun(unit, request, make_player, hand_over, delete_player)) return;
  unit->request = nullptr;
  Print(
      "contactspline: %s: cannot be made, as the server takes no command; allowed: to end this synth and start it "
      "again\n",
      request->name);
  free_request(unit->mWorld, request);
}

// Where the server cannot delete the instrument beside the audio thread, it is deleted here.
void end(ContactInstrument* unit) {
  if (unit->request != nullptr) unit->request->unit = nullptr;
  if (unit->player == nullptr) return;
  Request* const request = request_of(unit);
  if (request == nullptr) return delete unit->player;
  request->player = unit->player;
  if (is_begun(unit, request, delete_player, nothing, nothing)) return;
  delete unit->player;
  free_request(unit->mWorld, request);
}

}  // namespace

PluginLoad(ContactSpline) {
  ft = inTable;
  (*ft->fDefineUnit)("ContactInstrument", sizeof(ContactInstrument), reinterpret_cast<UnitCtorFunc>(begin),
                     reinterpret_cast<UnitDtorFunc>(end), kUnitDef_CantAliasInputsToOutputs);
}
