// SPDX-License-Identifier: MIT
// Opcodes of Csound: contact_create, contact_set, contact_note, contact_play, contact_out, contact_list.
#include <csound/csdl.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "hosts/wired_instrument.hpp"

namespace {

using Player = contactspline::WiredInstrument<MYFLT>;
using Tap = contactspline::Tap<MYFLT>;

// The instruments of a Csound, by handles from 1 on. With --realtime, handles are made on a thread of their own. An
// instrument whose note has ended is deleted when the next one is made, not while sound is computed. That one has
// another handle in the same slot, so that who kept the old handle plays nothing.
struct Players {
  struct Slot {
    std::atomic<Player*> player = nullptr;
    std::atomic<std::size_t> handle = 0;
    std::atomic<bool> is_free = true, has_output = false;
    std::array<int, 128> holders{};  ///< notes that hold each key
  };
  Players() = default;
  Players(const Players&) = delete;
  Players& operator=(const Players&) = delete;
  ~Players() {
    for (Slot& slot : slots) delete slot.player.load();
  }

  // The handle of a new instrument; nothing where there are too many.
  std::optional<std::size_t> keep(std::unique_ptr<Player> player) {
    for (Slot& slot : slots)
      if (slot.is_free) delete slot.player.exchange(nullptr);
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (!slots[i].is_free) continue;
      slots[i].player = player.release();
      slots[i].has_output = false;
      slots[i].holders = {};
      slots[i].handle = next_handle(i);
      slots[i].is_free = false;
      return slots[i].handle;
    }
    return {};
  }

  [[nodiscard]] Slot* of(MYFLT handle) {
    if (!(handle >= 1 && handle <= kMaxHandle)) return nullptr;
    const auto number = static_cast<std::size_t>(handle);
    Slot& slot = slots[(number - 1) % slots.size()];
    return slot.is_free || slot.handle != number ? nullptr : &slot;
  }

  // Handles of a slot are a number of slots apart; after the last one that a number of Csound holds, the first again.
  [[nodiscard]] std::size_t next_handle(std::size_t slot) const {
    const std::size_t last = slots[slot].handle, next = last + slots.size();
    return last == 0 || static_cast<MYFLT>(next) > kMaxHandle ? slot + 1 : next;
  }

  static constexpr MYFLT kMaxHandle = MYFLT(1) / std::numeric_limits<MYFLT>::epsilon();
  std::array<Slot, 1024> slots;
};

constexpr const char* kVariable = "contactspline players";

Players* players_of(CSOUND* csound) {
  auto* const kept = static_cast<Players**>(csound->QueryGlobalVariable(csound, kVariable));
  return kept != nullptr ? *kept : nullptr;
}

Players::Slot* slot_of(CSOUND* csound, MYFLT handle) {
  Players* const players = players_of(csound);
  return players != nullptr ? players->of(handle) : nullptr;
}

Player* player_of(CSOUND* csound, MYFLT handle) {
  Players::Slot* const slot = slot_of(csound, handle);
  return slot != nullptr ? slot->player.load() : nullptr;
}

int forget_players(CSOUND* csound, void*) {
  delete players_of(csound);
  csound->DestroyGlobalVariable(csound, kVariable);
  return OK;
}

Players* players_made_for(CSOUND* csound) {
  if (Players* const players = players_of(csound)) return players;
  if (csound->CreateGlobalVariable(csound, kVariable, sizeof(Players*)) != CSOUND_SUCCESS) return nullptr;
  auto* const kept = static_cast<Players**>(csound->QueryGlobalVariable(csound, kVariable));
  *kept = new Players;
  csound->RegisterResetCallback(csound, nullptr, forget_players);
  return *kept;
}

std::string names_of(const Player& player) {
  std::string names;
  for (const std::string& line : player.lines()) names += "\n  " + line;
  return names;
}

// Ends an opcode with its note. reinit begins it again before that: it must let go what it holds by itself. Csound
// makes opcodes of zeros, which hold nothing.
template <typename Opcode, void (*kEnd)(CSOUND*, Opcode*)>
void end_with_note(CSOUND* csound, Opcode* p) {
  const auto callback = [](CSOUND* of, void* opcode) {
    kEnd(of, static_cast<Opcode*>(opcode));
    static_cast<Opcode*>(opcode)->is_registered = false;
    return OK;
  };
  if (!p->is_registered) csound->RegisterDeinitCallback(csound, p, callback);
  p->is_registered = true;
}

// What an opcode needs of a handle; says so where there is none.
Player* required_player(CSOUND* csound, MYFLT handle) {
  Player* const player = player_of(csound, handle);
  if (player == nullptr)
    csound->InitError(csound, "contactspline: ihandle: %g is no instrument; allowed: what contact_create gives",
                      static_cast<double>(handle));
  return player;
}

int unknown_name(CSOUND* csound, const char* kind, const char* name, const Player& player) {
  return csound->InitError(csound, "contactspline: %s: there is none of the name %s; allowed are:%s", kind, name,
                           names_of(player).c_str());
}

struct Create {
  OPDS h;
  MYFLT* handle;
  STRINGDAT* name;
  MYFLT made;  ///< the handle, whatever becomes of the variable
  bool is_registered;
};

void release_handle(CSOUND* csound, Create* p) {
  if (Players::Slot* const slot = slot_of(csound, p->made)) slot->is_free = true;
  p->made = 0;
}

int create(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Create*>(opcode);
  *p->handle = 0;
  Players* const players = players_made_for(csound);
  auto player = Player::create(p->name->data, static_cast<double>(csound->GetSr(csound)));
  if (player == nullptr || players == nullptr) return csound->InitError(csound, "%s", contactspline_last_error());
  const auto handle = players->keep(std::move(player));
  if (!handle) return csound->InitError(csound, "contactspline: %s", "more than 1024 instruments at a time");
  release_handle(csound, p);  // what was made before a reinit: the next create deletes it
  *p->handle = p->made = static_cast<MYFLT>(*handle);
  end_with_note<Create, release_handle>(csound, p);
  return OK;
}

struct Set {
  OPDS h;
  MYFLT* handle;
  STRINGDAT* name;
  MYFLT* value;
  contactspline::Wire<MYFLT> wire;
  MYFLT kept;  ///< the handle that begin_set read
};

int begin_set(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Set*>(opcode);
  const Player* const player = required_player(csound, *p->handle);
  if (player == nullptr) return NOTOK;
  const auto parameter = player->parameter(p->name->data);
  if (!parameter) return unknown_name(csound, "Sparameter", p->name->data, *player);
  p->wire = {.parameter = *parameter};
  p->kept = *p->handle;
  return OK;
}

int set(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Set*>(opcode);
  if (Player* const player = player_of(csound, p->kept)) p->wire.move(*player, *p->value);
  return OK;
}

struct Note {
  OPDS h;
  MYFLT *handle, *key, *velocity;
  MYFLT kept, kept_key;         ///< what begin_note read
  MYFLT held_handle, held_key;  ///< the key that is down; handle 0: none
  bool has_begun, is_registered;
};

// The count of notes that hold a key; nothing where no instrument has it.
int* holders_of(CSOUND* csound, MYFLT handle, MYFLT key) {
  Players::Slot* const slot = slot_of(csound, handle);
  return slot != nullptr && key >= 0 && key < 127.5 ? &slot->holders[static_cast<std::size_t>(std::lround(key))]
                                                    : nullptr;
}

// A key goes up with the last note that holds it: with the pedal of MIDI, Csound prolongs notes beyond the next one.
void end_note(CSOUND* csound, Note* p) {
  int* const holders = holders_of(csound, p->held_handle, p->held_key);
  if (holders != nullptr && *holders > 0 && --*holders == 0) player_of(csound, p->held_handle)->note(p->held_key, 0);
  p->held_handle = 0;
}

int begin_note(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Note*>(opcode);
  if (required_player(csound, *p->handle) == nullptr) return NOTOK;
  p->kept = *p->handle;
  p->kept_key = *p->key;
  p->has_begun = false;
  end_with_note<Note, end_note>(csound, p);
  return OK;
}

// Begins where sound is computed: with --realtime, begin_note runs beside it.
int note(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Note*>(opcode);
  if (p->has_begun) return OK;
  p->has_begun = true;
  end_note(csound, p);  // the key from before a reinit
  Player* const player = player_of(csound, p->kept);
  if (player == nullptr) return OK;
  player->note(p->kept_key, *p->velocity);
  int* const holders = holders_of(csound, p->kept, p->kept_key);
  if (holders == nullptr || !(*p->velocity > 0)) return OK;
  ++*holders;
  p->held_handle = p->kept;
  p->held_key = p->kept_key;
  return OK;
}

struct Play {
  OPDS h;
  MYFLT* handle;
  STRINGDAT* name;
  MYFLT *trigger, *value;
  MYFLT kept;
  std::size_t event;
  bool has_value;
};

int begin_play(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Play*>(opcode);
  const Player* const player = required_player(csound, *p->handle);
  if (player == nullptr) return NOTOK;
  const auto event = player->event(p->name->data);
  if (!event) return unknown_name(csound, "Sevent", p->name->data, *player);
  p->kept = *p->handle;
  p->event = *event;
  p->has_value = csound->GetInputArgCnt(p) > 3;
  return OK;
}

int play(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Play*>(opcode);
  Player* const player = player_of(csound, p->kept);
  if (player == nullptr || !(*p->trigger > 0)) return OK;
  p->has_value ? player->play(p->event, *p->value) : player->play(p->event);
  return OK;
}

// As many letters in the table of opcodes: Csound puts the inputs behind so many outputs.
#define CONTACTSPLINE_OUTPUTS "mmmmmmmmmmmmmmmm"
constexpr std::size_t kMaxOutputs = sizeof CONTACTSPLINE_OUTPUTS - 1;

struct Out {
  OPDS h;
  MYFLT* sounds[kMaxOutputs];
  MYFLT* handle;
  STRINGDAT* names[kMaxOutputs];
  Tap taps[kMaxOutputs];
  std::size_t count;
  MYFLT kept;  ///< the handle that it plays; 0: none
  bool is_registered;
};

void end_out(CSOUND* csound, Out* p) {
  if (Players::Slot* const slot = slot_of(csound, p->kept)) slot->has_output = false;
  p->kept = 0;
}

int begin_out(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Out*>(opcode);
  end_out(csound, p);
  const Player* const player = required_player(csound, *p->handle);
  if (player == nullptr) return NOTOK;
  p->count = static_cast<std::size_t>(csound->GetOutputArgCnt(p));
  const auto names = static_cast<std::size_t>(csound->GetInputArgCnt(p)) - 1;
  if (p->count > kMaxOutputs || (names == 0 ? p->count > 2 : names != p->count))
    return csound->InitError(csound,
                             "contactspline: contact_out: %d results for %d names; allowed: as many names, or "
                             "one or two results without a name",
                             static_cast<int>(p->count), static_cast<int>(names));
  for (std::size_t o = 0; o < p->count; ++o) {
    const char* const name = names == 0 ? (o == 0 ? "left" : "right") : p->names[o]->data;
    const auto tap = player->tap(name);
    if (!tap) return unknown_name(csound, "Soutput", name, *player);
    p->taps[o] = *tap;
  }
  if (players_of(csound)->of(*p->handle)->has_output.exchange(true))
    return csound->InitError(csound, "contactspline: contact_out: %s",
                             "plays this instrument already; allowed: one contact_out for each instrument");
  p->kept = *p->handle;
  end_with_note<Out, end_out>(csound, p);
  return OK;
}

// Only the part of a block in which the note sounds is played, with --sample-accurate.
int out(CSOUND* csound, void* opcode) {
  auto* const p = static_cast<Out*>(opcode);
  const std::size_t samples = p->h.insdshead->ksmps;
  const std::size_t begin = p->h.insdshead->ksmps_offset;
  const std::size_t end = samples - p->h.insdshead->ksmps_no_end;
  std::array<MYFLT*, kMaxOutputs> sounds{};
  for (std::size_t o = 0; o < p->count; ++o) {
    std::fill_n(p->sounds[o], samples, MYFLT(0));
    sounds[o] = p->sounds[o] + begin;
  }
  if (Player* const player = player_of(csound, p->kept))
    player->process(std::span(p->taps).first(p->count), std::span(sounds).first(p->count), end - begin);
  return OK;
}

struct List {
  OPDS h;
  MYFLT* handle;
};

int list(CSOUND* csound, void* opcode) {
  const Player* const player = required_player(csound, *static_cast<List*>(opcode)->handle);
  if (player == nullptr) return NOTOK;
  for (const std::string& line : player->lines()) csound->Message(csound, "%s\n", line.c_str());
  return OK;
}

// As for a channel that one opcode writes and another reads: with -j Csound then keeps their order.
constexpr int kOrdered = _CR | _CW;

}  // namespace

extern "C" {
// Csound's table holds pointers to text that nobody writes to.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wwrite-strings"
#pragma GCC diagnostic ignored "-Wpedantic"
static OENTRY localops[] = {
    {"contact_create", sizeof(Create), kOrdered, 1, "i", "S", create, nullptr, nullptr, nullptr},
    {"contact_set", sizeof(Set), kOrdered, 3, "", "iSk", begin_set, set, nullptr, nullptr},
    {"contact_note", sizeof(Note), kOrdered, 3, "", "iii", begin_note, note, nullptr, nullptr},
    {"contact_play", sizeof(Play), kOrdered, 3, "", "iSkO", begin_play, play, nullptr, nullptr},
    {"contact_out", sizeof(Out), kOrdered, 3, CONTACTSPLINE_OUTPUTS, "iW", begin_out, out, nullptr, nullptr},
    {"contact_list", sizeof(List), kOrdered, 1, "", "i", list, nullptr, nullptr, nullptr},
};
LINKAGE
#pragma GCC diagnostic pop
}
