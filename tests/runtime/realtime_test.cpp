// SPDX-License-Identifier: MIT
// Every model as an audio thread plays it: nothing is allocated by new, and no system call is made, so no lock waits.
// scripts/sanitize realtime compiles the same with RealtimeSanitizer, which knows malloc, locks and calls that may
// block.
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <memory>
#include <utility>

#include "band.hpp"
#include "contactspline/host/engine.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_live.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/ensemble.hpp"
#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "contactspline/models/slide_string.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/step/live_exponent.hpp"
#include "support/precisions.hpp"
#include "support/real_time.hpp"

namespace contactspline::testing {
namespace {

constexpr int kSamples = 3000;

/// How a process of its own ends that may only return from here: by SIGKILL at any system call.
int end_without_system_calls(const Play& play) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) ::_exit(1);
    play_in_real_time(play);
    ::syscall(SYS_exit, 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

template <typename T>
struct StringParts {
  std::vector<ResonatorMode> modes = audible_modes(c4());
  std::vector<Segment<T>> table = table_in<T>(felt_table(c4(), 40));
  ModeShapes<T> strike = shapes<T>(modes, &ResonatorMode::strike_shape);
  ModeShapes<T> pickup = shapes<T>(modes, &ResonatorMode::pickup_shape);
  StringShapes<T> places{wavenumbers_of(modes)};
};

template <typename T>
Play mass_barrier() {
  struct Parts : StringParts<T> {
    MassBarrier<T> model{this->table, T(kRate)};
  };
  return [parts = std::make_shared<Parts>()] {
    parts->model.throw_from(T(-1e-3), 2);
    for (int n = 0; n < kSamples; ++n) parts->model.tick({T(0.003 + 1e-7 * n), 9, {T(1 + 1e-3 * n), T(0.1)}});
    parts->model.reset();
  };
}

template <typename T>
Play hammer_string() {
  struct Parts : StringParts<T> {
    HammerString<T> model{this->table, bare(this->modes), this->strike, kRate};
    std::vector<T> sound = std::vector<T>(512), forces = std::vector<T>(512);
  };
  return [parts = std::make_shared<Parts>()] {
    auto& model = parts->model;
    auto &sound = parts->sound, &forces = parts->forces;
    for (int block = 0; block < 8; ++block) {
      if (block % 4 == 0) model.strike_at(block == 0 ? parts->pickup : parts->strike), model.strike(2, T(1e-4));
      model.process({.hammer_mass_kg = T(0.003), .damping_per_s = T(block)}, parts->pickup, sound, forces.data());
      model.process({.hammer_mass_kg = T(0.003)}, parts->pickup, std::span(sound).first(7));
      model.tick({.hammer_mass_kg = T(0.003)});
    }
    model.reset();
  };
}

template <typename T>
Play hammer_voice() {
  struct Parts : StringParts<T> {
    HammerVoice<T> voice{{this->table, bare(this->modes), this->strike, this->pickup, {.hammer_mass_kg = T(0.003)}},
                         kRate};
    KeyboardVoice<keyboards::piano, T> key{60, kRate};
    std::vector<Mode> other = [this] {
      auto sharper = bare(this->modes);
      for (Mode& mode : sharper) mode.angular_frequency_rad_per_s *= 1.01;
      return sharper;
    }();
    std::vector<T> sound = std::vector<T>(512);
  };
  return [parts = std::make_shared<Parts>()] {
    const auto play = [&](HammerVoice<T>& voice) {
      voice.strike(static_cast<T>(strike_speed<keyboards::piano>(0.7)));
      voice.process(parts->sound);
      if (voice.model().string().size() == parts->other.size()) voice.retune(parts->other);
      voice.release();
      voice.process(parts->sound);
      voice.strike_at(voice.output_shapes());
      (void)voice.tick();
      (void)voice.is_silent();
      voice.reset();
    };
    play(parts->voice), play(parts->key);
  };
}

template <typename T>
Play keyboard_instrument() {
  struct Parts {
    KeyboardInstrument<keyboards::piano, T> piano{kRate, 20};
    std::vector<T> left = std::vector<T>(700), right = std::vector<T>(700);
  };
  return [parts = std::make_shared<Parts>()] {
    auto& piano = parts->piano;
    for (int block = 0; block < 6; ++block) {
      piano.sustain(block % 3 / 2.0);
      piano.una_corda(block % 2);
      piano.bend(39, 10 * block), piano.damp(39, T(block)), piano.strike_at(39, 0.01 * block);
      piano.sostenuto(block == 3);
      for (int key = 40; key < 90; key += 7) piano.note_on(key + block, 0.7);
      piano.press(3);
      piano.set_hammers(T(1 + block), {T(1), T(0.1)});
      piano.process(parts->left, parts->right);
      for (int key = 0; key < 128; ++key) piano.note_off(key);
      piano.process(parts->left);
    }
    piano.reset();
  };
}

template <typename T>
Play ensemble() {
  struct Parts {
    std::vector<Player<T>> players = band<T>(20);
    Ensemble<T> model = ensemble_of(players, 1);
    std::vector<T> left = std::vector<T>(700), right = std::vector<T>(700);
  };
  return [parts = std::make_shared<Parts>()] {
    for (std::size_t block = 0; block < 6; ++block) {
      for (std::size_t i = 0; i < 10; ++i) parts->model.strike((block * 7 + i * 11) % 20, 2, T(1e-4));
      parts->model.process(parts->left, parts->right);
      parts->model.process(parts->left);
      parts->model.reset(block);
    }
    parts->model.reset();
  };
}

/// controls(n): of a sample.
template <typename T, typename Model, typename Controls>
Play contact_on_string(Controls controls) {
  struct Parts : StringParts<T> {
    Model model{this->table, bare(this->modes), this->places, T(0.1), kRate};
  };
  return [parts = std::make_shared<Parts>(), controls] {
    parts->model.place(T(0.3), T(1e-4));
    for (int n = 0; n < kSamples; ++n) parts->model.tick(controls(n));
    parts->model.reset();
  };
}

template <typename T>
Play slide_string() {
  return contact_on_string<T, SlideString<T>>([](int n) {
    return SlideStringControls<T>{T(0.3 + 1e-5 * n), T(0.02), 5, 100, 1, 1, T(n < 100), {1, T(0.1)}};
  });
}

template <typename T>
Play fret_string() {
  return contact_on_string<T, FretString<T>>([](int n) {
    return FretStringControls<T>{T(0.3 + 1e-5 * n), T(1e-4 - 1e-7 * n), T(n < 100), 2, {1, T(0.1)}};
  });
}

template <typename T>
Play live_exponent() {
  return [live = std::make_shared<LiveExponent<materials::felt_live, T>>(T(2))] {
    MassBarrier<T, LiveExponent<materials::felt_live, T>::size> model(live->table(), T(kRate));
    model.throw_from(0, 2);
    for (int n = 0; n < kSamples; ++n) live->set(T(1 + 1e-3 * n)), model.tick({T(0.003)});
  };
}

template <typename T>
Play contact_network() {
  struct Parts : StringParts<T> {
    NetworkPlan<T> plan() {
      NetworkPlan<T> plan;
      const std::size_t mass = plan.add_mass_place(plan.add_mass(0.003)),
                        second = plan.add_mass_place(plan.add_mass(0.01));
      std::vector<double> strikes;
      for (const auto& mode : this->modes) strikes.push_back(mode.strike_shape);
      const std::size_t string = plan.add_place(plan.add_body(bare(this->modes)), strikes);
      plan.add_contact(mass, string, this->table, T(1e-5), {1, T(0.1)});
      plan.add_contact(second, string, this->table, T(2e-5));
      spring = plan.add_spring(mass, second, 100, 1);
      return plan;
    }
    std::size_t spring = 0;
    ContactNetwork<T> network{plan(), kRate};
  };
  return [parts = std::make_shared<Parts>()] {
    auto& network = parts->network;
    network.set_motion(0, T(-1e-4), 2);
    for (int n = 0; n < kSamples; ++n) {
      network.push(0, T(n % 7));
      if (n % 500 == 0) network.set_damping(2, T(n)), network.set_contact(0, {T(1 + n), T(0.2)});
      network.set_gap(1, T(2e-5 + 1e-8 * n));
      network.set_spring(parts->spring, T(100 + n), 1);
      network.tick();
    }
    network.reset();
  };
}

// An instrument of a file, with contacts, rigid links and every call that an audio thread makes.
template <typename T>
Play network_instrument() {
  struct Parts {
    Parts() { model->prepare(kRate); }
    Handle<T> model = compiled<instruments::trichord_c4<T>>();
    std::vector<T> sound = std::vector<T>(513), force = sound;
    std::array<std::span<T>, 3> outputs = {sound, sound, sound};
  };
  return [parts = std::make_shared<Parts>()] {
    auto& model = *parts->model;
    for (std::size_t block = 0; block < 6; ++block) {
      model.strike(0, T(block));
      model.set(0, double(1 + block)), model.set(1, 0.1), model.set(2, double(block));
      model.note_on(60, 0.5), model.note_off(60);
      model.process(parts->outputs, parts->force);
      (void)(model.value(0) + model.books().stored_j);
      (void)(model.is_silent(1e-14) || model.is_at_rest(1e-14));
    }
    model.reset();
  };
}

// A string on a body.
template <typename T>
Play body() {
  struct Parts : StringParts<T> {
    HammerString<T> model{this->table, bare(this->modes), this->strike, kRate};
    std::vector<double> shape = std::vector<double>(this->modes.size(), 1000);
    BridgeShapes<T> bridge = model.bridge(ModeShapes<T>(shape));
    std::vector<Mode> board = {{600, 10, 1}, {1500, 20, 1}};
    std::vector<double> at = {1, -0.5};
    Body<T> body{board, ModeShapes<T>(at), {1e3, 1e5}, kRate};
  };
  return [parts = std::make_shared<Parts>()] {
    parts->model.strike(2, T(1e-4));
    for (int n = 0; n < kSamples; ++n) {
      const T change = parts->body.change();
      parts->body.tick(parts->model.tick({.hammer_mass_kg = T(0.003)}, parts->bridge, change));
    }
    (void)parts->body.energy();
    parts->body.reset();
  };
}

template <typename T>
std::vector<std::pair<const char*, Play>> all_models() {
  return {{"mass-barrier", mass_barrier<T>()},
          {"hammer-string", hammer_string<T>()},
          {"hammer-voice", hammer_voice<T>()},
          {"ensemble", ensemble<T>()},
          {"keyboard-instrument", keyboard_instrument<T>()},
          {"slide-string", slide_string<T>()},
          {"fret-string", fret_string<T>()},
          {"live-exponent", live_exponent<T>()},
          {"contact-network", contact_network<T>()},
          {"network-instrument", network_instrument<T>()},
          {"body", body<T>()}};
}

CONTACTSPLINE_EACH_PRECISION(RealTime);

TYPED_TEST(RealTime, AllocatesNothing) {
  for (const auto& [name, play] : all_models<TypeParam>()) {
    SCOPED_TRACE(name);
    expect_real_time(play);
  }
}

#ifndef CONTACTSPLINE_REALTIME_SANITIZER
TYPED_TEST(RealTime, CallsNoSystem) {
  for (const auto& [name, play] : all_models<TypeParam>())
    EXPECT_EQ(end_without_system_calls(play), 0) << name << " made a system call";
}

TEST(RealTimeTrap, SpringsAtASystemCall) {
  EXPECT_EQ(end_without_system_calls([] { ::syscall(SYS_getppid); }), SIGKILL);
  EXPECT_EQ(end_without_system_calls([] {}), 0);
}
#else
TEST(RealTimeTrapDeathTest, SpringsAtMalloc) {
  const Play allocate = [] {
    void* volatile memory = std::malloc(100);
    std::free(memory);
  };
  EXPECT_DEATH(play_in_real_time(allocate), "malloc");
}
#endif

}  // namespace
}  // namespace contactspline::testing
