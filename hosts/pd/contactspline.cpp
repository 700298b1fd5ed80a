// SPDX-License-Identifier: MIT
// The object contactspline~ of Pd: [contactspline~ INSTRUMENT NAME...]. Each name of a parameter is an inlet of a
// signal, each name of an output an outlet; without one of these, left and right.
#include <m_pd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hosts/wired_instrument.hpp"

namespace {

static_assert(sizeof(t_sample) == sizeof(float));
using Player = contactspline::WiredInstrument<t_sample>;

// What stands behind the object.
struct Wired {
  std::string name;
  std::vector<std::string> outputs;
  double rate_hz = 0;
  std::unique_ptr<Player> player;
  std::vector<contactspline::Wire<t_sample>> wires;
  std::vector<contactspline::Tap<t_sample>> taps;
  std::vector<const t_sample*> inlets;  // of this block
  std::vector<t_sample*> outlets, parts;
};

struct Object {
  t_object object;  // Pd's part stands first
  Wired* wired;
};

t_class* object_class = nullptr;

std::string_view text_of(const t_atom& atom) {
  return atom.a_type == A_SYMBOL ? atom.a_w.w_symbol->s_name : std::string_view();
}

void post_lines(const Player& player) {
  for (const std::string& line : player.lines()) post("%s", line.c_str());
}

// Sorts the names of the object's arguments. False, with a line, where one is unknown.
bool take_names(Wired& wired, int count, const t_atom* names) {
  for (int i = 0; i < count; ++i) {
    const std::string name(text_of(names[i]));
    if (const auto parameter = wired.player->parameter(name)) {
      wired.wires.push_back({.parameter = *parameter});
    } else if (wired.player->tap(name)) {
      wired.outputs.push_back(name);
    } else {
      pd_error(nullptr,
               "contactspline~: %s: no parameter or output of %s has the name %s; allowed are:", wired.name.c_str(),
               wired.name.c_str(), name.c_str());
      post_lines(*wired.player);
      return false;
    }
  }
  if (wired.outputs.empty()) wired.outputs = {"left", "right"};
  for (const std::string& output : wired.outputs) wired.taps.push_back(*wired.player->tap(output));
  wired.inlets.resize(wired.wires.size());
  wired.outlets.resize(wired.outputs.size());
  wired.parts.resize(wired.outputs.size());
  return true;
}

// An instrument that ships, or a file beside the patch.
std::string path_of(std::string_view name) {
  const t_canvas* const canvas = canvas_getcurrent();
  if (!name.ends_with(".json") || name.starts_with("/") || canvas == nullptr) return std::string(name);
  return std::string(canvas_getdir(canvas)->s_name) + "/" + std::string(name);
}

void* create(t_symbol*, int count, t_atom* arguments) {
  if (count == 0 || text_of(arguments[0]).empty()) {
    pd_error(nullptr, "contactspline~: instrument: is missing; allowed: a name, such as piano, or a .json file");
    return nullptr;
  }
  auto wired = std::make_unique<Wired>();
  wired->name = path_of(text_of(arguments[0]));
  wired->rate_hz = static_cast<double>(sys_getsr());
  wired->player = Player::create(wired->name.c_str(), wired->rate_hz);
  if (wired->player == nullptr) {
    pd_error(nullptr, "contactspline~: %s", contactspline_last_error());
    return nullptr;
  }
  if (!take_names(*wired, count - 1, arguments + 1)) return nullptr;
  auto* const object = reinterpret_cast<Object*>(pd_new(object_class));
  for (const auto& wire : wired->wires)
    signalinlet_new(&object->object, static_cast<t_float>(wired->player->value(wire.parameter)));
  for (std::size_t o = 0; o < wired->outputs.size(); ++o) outlet_new(&object->object, &s_signal);
  object->wired = wired.release();
  return object;
}

void destroy(Object* object) {
  delete object->wired;
}

// Does a signal move its parameter at this sample?
bool moves_at(const Wired& wired, std::size_t sample) {
  for (std::size_t w = 0; w < wired.wires.size(); ++w)
    if (wired.wires[w].moves(wired.inlets[w][sample])) return true;
  return false;
}

// Inlets and outlets may share memory: a sample is read before it is written.
t_int* perform(t_int* arguments) {
  Wired& wired = *reinterpret_cast<Wired*>(arguments[1]);
  const auto samples = static_cast<std::size_t>(arguments[2]);
  const auto play = [&](std::size_t begin, std::size_t end) {
    for (std::size_t o = 0; o < wired.parts.size(); ++o) wired.parts[o] = wired.outlets[o] + begin;
    wired.player->process(wired.taps, wired.parts, end - begin);
  };
  std::size_t begin = 0;
  for (std::size_t n = 0; n < samples; ++n) {
    if (!moves_at(wired, n)) continue;
    std::size_t w = 0;
    play(begin, n);
    for (auto& wire : wired.wires) wire.move(*wired.player, wired.inlets[w++][n]);
    begin = n;
  }
  play(begin, samples);
  return arguments + 3;
}

// Where Pd's rate has changed, the instrument is made anew, with the parameters of the old one.
void prepare(Wired& wired, double rate_hz) {
  if (wired.rate_hz == rate_hz) return;
  auto player = Player::create(wired.name.c_str(), rate_hz);
  if (player == nullptr) return pd_error(nullptr, "contactspline~: %s", contactspline_last_error());
  wired.rate_hz = rate_hz;
  for (std::size_t p = 0; !std::isnan(player->value(p)); ++p) player->set(p, wired.player->value(p));
  wired.player = std::move(player);
}

void begin_dsp(Object* object, t_signal** signals) {
  Wired& wired = *object->wired;
  prepare(wired, static_cast<double>(signals[0]->s_sr));
  for (auto& inlet : wired.inlets) inlet = (*signals++)->s_vec;
  for (auto& outlet : wired.outlets) outlet = (*signals++)->s_vec;
  dsp_add(perform, 2, reinterpret_cast<t_int>(&wired), static_cast<t_int>(signals[-1]->s_n));
}

// Messages: note KEY VELOCITY or the two numbers alone, NAME VALUE for a parameter, NAME [VALUE] for an event, reset,
// print. One with other values does nothing.
void take(Object* object, t_symbol* selector, int count, t_atom* values) {
  Player& player = *object->wired->player;
  const std::string_view name = selector->s_name;
  const bool are_numbers = std::all_of(values, values + count, [](const t_atom& a) { return a.a_type == A_FLOAT; });
  const auto has = [&](int min, int max, const char* allowed) {
    const bool is_right = are_numbers && count >= min && count <= max;
    if (!is_right)
      pd_error(object, "contactspline~: %s: %s; allowed: %s", selector->s_name,
               are_numbers ? "too few or too many values" : "a value is no number", allowed);
    return is_right;
  };
  const auto value = [&](int i) { return static_cast<double>(atom_getfloatarg(i, count, values)); };
  if (name == "note" || name == "list") {
    if (has(2, 2, "two numbers, KEY VELOCITY, such as 60 0.7")) player.note(value(0), value(1));
  } else if (name == "reset") {
    if (has(0, 0, "no value")) player.reset();
  } else if (name == "print") {
    if (has(0, 0, "no value")) post_lines(player);
  } else if (const auto parameter = player.parameter(name)) {
    if (has(1, 1, "one number, in the parameter's unit")) player.set(*parameter, value(0));
  } else if (const auto event = player.event(name)) {
    if (has(0, 1, "one number, in m/s or N, or none"))
      count > 0 ? player.play(*event, value(0)) : player.play(*event);
  } else {
    pd_error(object,
             "contactspline~: %s: no message of %s; allowed: note KEY VELOCITY, reset, print, a parameter with "
             "its value, an event",
             selector->s_name, object->wired->name.c_str());
  }
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void contactspline_tilde_setup() {
  // Pd takes functions of any kind as one type, and calls them by the types named behind.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wcast-function-type"
  object_class = class_new(gensym("contactspline~"), reinterpret_cast<t_newmethod>(create),
                           reinterpret_cast<t_method>(destroy), sizeof(Object), CLASS_DEFAULT, A_GIMME, 0);
  class_addmethod(object_class, reinterpret_cast<t_method>(begin_dsp), gensym("dsp"), A_CANT, 0);
  class_addanything(object_class, reinterpret_cast<t_method>(take));
#pragma GCC diagnostic pop
}
