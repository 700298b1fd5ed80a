// SPDX-License-Identifier: MIT
// soak SECONDS [NAME...]: every model played at random, in turn, in both precisions. `played`: controls, strikes and
// places change every tenth of a second, to anything. `jumping`: they change in each sample. A fault is a number that
// is not finite, energy beyond the work put in, or, in double precision, a sample of coupled contacts whose solver
// did not converge (docs/how-it-works/several-contacts.md). Prints how many samples each model played; exits with 1
// after a fault. NAME: models that contain it only. CONTACTSPLINE_SOAK_SEED is a number that chooses what is drawn.
// soak --own-time SECONDS [NAME...]: each model for so many seconds of its own time, and never brought to rest.
// scripts/soak runs it for long.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/ensemble.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "random_controls.hpp"
#include "shipped_instruments.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

constexpr double kHz = 44100;
constexpr std::size_t kHeld = 4410, kSlice = 20000;  // samples
std::size_t samples_of_take = 1'000'000;             // after which a model is brought to rest

/// The seed of everything that is drawn: CONTACTSPLINE_SOAK_SEED, or 3.
std::uint64_t seed() {
  const char* chosen = std::getenv("CONTACTSPLINE_SOAK_SEED");
  return chosen == nullptr ? 3 : std::strtoull(chosen, nullptr, 10);
}

/// What became of a model.
struct Record {
  std::string model;
  std::size_t samples = 0, faults = 0, bounded = 0;
  double peak_j = 0, excess_j = 0;

  void fault(std::string_view what) {
    if (++faults <= 3)
      std::printf("  %s, fault at sample %zu: %.*s\n", model.c_str(), samples, static_cast<int>(what.size()),
                  what.data());
  }
  template <typename T>
  void demand_finite(T value) {
    if (!is_finite(value)) fault("a number that is not finite");
  }
};

/// One model: plays a slice of samples.
struct Soaked {
  Soaked(std::string name, std::function<void(Record&)> play_slice)
      : play(std::move(play_slice)), record{.model = std::move(name)} {}

  std::function<void(Record&)> play;
  Record record;
};

template <typename T>
const Parts<T>& parts() {
  static const Parts<T> parts(kHz);
  return parts;
}

/// Books of the work put into a model until it is brought to rest.
template <typename T>
class Take {
 public:
  explicit Take(Record& record) : record_(&record) {}
  void close(double work_j, double energy_j) {
    books_.close(work_j, energy_j);
    record_->peak_j = std::max(record_->peak_j, books_.peak());
    record_->excess_j = std::max(record_->excess_j, books_.excess());
    if (books_.is_within()) return;
    record_->fault("energy beyond the work put in");
    books_ = WorkBooks<T>(kHz);
    books_.close(energy_j, energy_j);
  }
  void restart() { books_ = WorkBooks<T>(kHz); }

 private:
  Record* record_;
  WorkBooks<T> books_{kHz};
};

/// The kinetic energy that a strike brings: a speed that is not a number throws nothing.
template <typename T>
double thrown_j(T mass_kg, T speed) {
  if (!is_number(speed)) return 0;
  const auto v = static_cast<double>(held(T(0), speed, ControlRanges<T>::speed_m_per_s));
  return static_cast<double>(mass_kg) * v * v / 2;
}

template <typename T>
std::function<void(Record&)> mass_barrier(std::size_t held_for) {
  struct State {
    MassBarrier<T> model{parts<T>().table, T(kHz)};
    RandomControls<T> random;
    T mass = 1, gravity = 0;  // the values that act

    [[nodiscard]] double energy() const {
      return static_cast<double>(mass) * model.velocity() * model.velocity() / 2 +
             static_cast<double>(model.stiffness_ratio()) *
                 potential(SegmentTable<T>(parts<T>().table), model.displacement());
    }
  };
  auto s = std::make_shared<State>();
  s->random = RandomControls<T>(held_for, seed());
  return [s, take = std::shared_ptr<Take<T>>()](Record& record) mutable {
    using Ranges = ControlRanges<T>;
    if (!take) take = std::make_shared<Take<T>>(record);
    bool is_thrown = false;
    for (std::size_t n = 0; n < kSlice; ++n, ++record.samples) {
      s->random.next();
      if (n % 2500 == 0) {
        s->model.throw_from(s->random.any(Ranges::displacement_m), s->random.any(Ranges::speed_m_per_s));
        is_thrown = true;
      }
      const T mass = s->random.any(Ranges::mass_kg), gravity = s->random.any(Ranges::gravity_m_per_s2);
      const double before = s->model.displacement();
      s->model.tick({mass, gravity, any_contact(s->random)});
      s->mass = held(s->mass, mass, Ranges::mass_kg);
      s->gravity = held(s->gravity, gravity, Ranges::gravity_m_per_s2);
      record.demand_finite(s->model.displacement());
      record.demand_finite(s->model.velocity());
      record.demand_finite(s->model.force());
      if (std::exchange(is_thrown, false)) {  // to anywhere: the books begin
        take->restart();
        take->close(s->energy(), s->energy());
      } else {
        // Each displacement is rounded; gravity and contact act over that distance.
        const double weight = static_cast<double>(s->mass) * s->gravity, after = s->model.displacement();
        const double rounding = std::numeric_limits<T>::epsilon() * std::max(std::abs(before), std::abs(after));
        take->close(weight * (after - before) + rounding * (std::abs(weight) + s->model.force()), s->energy());
      }
    }
  };
}

/// The work put into a model and its energy afterwards [J].
struct Flow {
  double work, energy;
};

/// Plays a model in blocks, a tenth of a second each and, where controls jump, one sample. play(n, block, record)
/// draws anew and plays the block that begins with sample n of the slice.
template <typename T, typename State, typename Play>
std::function<void(Record&)> in_blocks(std::shared_ptr<State> s, std::size_t held_for, Play play) {
  return [s, held_for, play, take = std::shared_ptr<Take<T>>()](Record& record) mutable {
    if (!take) take = std::make_shared<Take<T>>(record);
    if (record.samples % samples_of_take < kSlice) s->model.reset(), take->restart();
    for (std::size_t n = 0, block = 0; n < kSlice; n += block, record.samples += block) {
      s->random.next();
      block = std::min(held_for, kSlice - n);
      const Flow flow = play(n, block, record);
      take->close(flow.work, flow.energy);
    }
  };
}

template <typename T>
std::function<void(Record&)> hammer_string(std::size_t held_for) {
  struct State {
    HammerString<T> model{parts<T>().table, bare(parts<T>().modes), parts<T>().strike, kHz};
    RandomControls<T> random{1, seed()};
    std::vector<T> out = std::vector<T>(kHeld);
  };
  auto s = std::make_shared<State>();
  return in_blocks<T>(s, held_for, [s, held_for](std::size_t n, std::size_t block, Record& record) {
    using Ranges = ControlRanges<T>;
    const T mass = T(0.003);
    double work = 0;
    if (held_for > 1 || n % 50 == 0) {
      const T speed = s->random.any(Ranges::speed_m_per_s);
      s->model.strike(speed, s->random.any(Ranges::throw_distance_m));
      work = thrown_j(mass, speed);
    }
    s->model.process({mass, any_contact(s->random), s->random.any(Ranges::damping_per_s)}, parts<T>().pickup,
                     std::span(s->out).first(block));
    for (std::size_t i = 0; i < block; ++i) record.demand_finite(s->out[i]);
    return Flow{work, s->model.string().energy()};
  });
}

template <typename T>
std::function<void(Record&)> keyboard_voice(std::size_t held_for) {
  struct State {
    std::vector<KeyboardVoice<keyboards::piano, T>> keys;
    RandomControls<T> random{1, seed()};
    std::vector<T> out = std::vector<T>(kHeld);
    std::size_t at = 0;
  };
  auto s = std::make_shared<State>();
  for (const int key : {21, 45, 60, 76, 96, 108}) s->keys.emplace_back(key, kHz);
  return [s, held_for, take = std::shared_ptr<Take<T>>()](Record& record) mutable {
    if (!take) take = std::make_shared<Take<T>>(record);
    take->restart();
    auto& voice = s->keys[s->at++ % s->keys.size()];
    for (std::size_t n = 0, block = 0; n < kSlice; n += block, record.samples += block) {
      s->random.next();
      double work = 0;
      if (held_for > 1 || n % 50 == 0) {
        const T speed = s->random.any(ControlRanges<T>::speed_m_per_s);
        voice.strike(speed);
        work = thrown_j(voice.controls().hammer_mass_kg, speed);
      }
      if (s->random.once_in(2)) voice.release();
      voice.controls().felt = any_contact(s->random);
      voice.controls().damping_per_s = s->random.any(ControlRanges<T>::damping_per_s);
      block = std::min(held_for, kSlice - n);
      voice.process(std::span(s->out).first(block));
      for (std::size_t i = 0; i < block; ++i) record.demand_finite(s->out[i]);
      take->close(work, voice.model().string().energy());
    }
    voice.reset();
  };
}

template <typename T>
std::function<void(Record&)> ensemble(std::size_t held_for) {
  struct State {
    Ensemble<T> model{kHz};
    RandomControls<T> random{1, seed()};
    std::vector<T> left = std::vector<T>(kHeld), right = std::vector<T>(kHeld);
  };
  constexpr std::size_t kVoices = 10;
  const T mass = T(0.003);
  auto s = std::make_shared<State>();
  for (std::size_t voice = 0; voice < kVoices; ++voice)
    s->model.add(parts<T>().table, bare(parts<T>().modes), parts<T>().strike, parts<T>().pickup,
                 {.hammer_mass_kg = mass});
  return in_blocks<T>(s, held_for, [s, held_for, mass](std::size_t n, std::size_t block, Record& record) {
    using Ranges = ControlRanges<T>;
    double work = 0, energy = 0;
    for (std::size_t voice = 0; voice < kVoices; ++voice) {
      if (held_for > 1 || n % 50 == 0) {
        const T speed = s->random.any(Ranges::speed_m_per_s);
        s->model.strike(voice, speed, s->random.any(Ranges::throw_distance_m));
        work += thrown_j(mass, speed);
      }
      s->model.controls(voice) = {mass, any_contact(s->random), s->random.any(Ranges::damping_per_s)};
      s->model.mix(voice) = {s->random.any(Ranges::gain), s->random.any(Ranges::pan)};
    }
    s->model.process(std::span(s->left).first(block), std::span(s->right).first(block));
    for (std::size_t i = 0; i < block; ++i) {
      record.demand_finite(s->left[i]);
      record.demand_finite(s->right[i]);
    }
    for (std::size_t voice = 0; voice < kVoices; ++voice) energy += s->model.model(voice).string().energy();
    return Flow{work, energy};
  });
}

/// The most energy that the knock of a strike adds to a board [J]. By the triangle inequality of its square roots:
/// what the impulse gives a board at rest, J^2/2 times the sum of shape^2/mass, beside what is stored already.
template <typename Piano>
double knock_j(double impulse_n_s, double stored_j) {
  using Board = typename Piano::body;
  double inverse_mass = 0;
  for (std::size_t i = 0; i < Board::modes; ++i)
    inverse_mass += Board::knock_shapes[i] * Board::knock_shapes[i] / modes_in<Board>[i].mass_kg;
  const double at_rest_j = impulse_n_s * impulse_n_s * inverse_mass / 2;
  return at_rest_j + 2 * std::sqrt(at_rest_j * stored_j);
}

/// A whole piano: keys struck, pressed and released at random, under all pedals. Few of them where controls jump:
/// each sample is a block then.
template <typename T>
std::function<void(Record&)> keyboard_instrument(std::size_t held_for) {
  using Piano = keyboards::piano;
  struct State {
    KeyboardInstrument<Piano, T> model{kHz};
    RandomControls<T> random{1, seed()};
    std::vector<T> left = std::vector<T>(kHeld), right = std::vector<T>(kHeld);
    T mass_ratio = 1;  // the value that acts
  };
  auto s = std::make_shared<State>();
  return in_blocks<T>(s, held_for, [s, held_for](std::size_t n, std::size_t block, Record& record) {
    using Ranges = ControlRanges<T>;
    const T mass_ratio = s->random.any({T(1e-6), T(1e6)});
    s->model.set_hammers(mass_ratio, any_contact(s->random));
    s->mass_ratio = held(s->mass_ratio, mass_ratio, {T(1e-6), T(1e6)});
    const std::size_t key = s->random.below(Piano::keys + 2);  // also beyond the last one
    double work = 0;
    if (held_for > 1 || n % 500 == 0) {
      const T speed = s->random.any(Ranges::speed_m_per_s);
      s->model.strike(key, speed);
      if (key < Piano::keys) {
        const T mass_kg =
            static_cast<T>(Piano::strings[key]) * s->mass_ratio * static_cast<T>(Piano::hammer_masses[key]);
        work = thrown_j(mass_kg, speed);
        const double impulse_n_s =
            std::min(std::sqrt(2 * static_cast<double>(mass_kg) * work), 1e3);  // Body::knock()
        work += knock_j<Piano>(impulse_n_s, s->model.energy());
      }
    }
    s->random.once_in(2) ? s->model.press(s->random.below(Piano::keys + 2)) : s->model.release(key);
    s->model.sustain(static_cast<double>(s->random.any({0, 1})));
    s->model.sostenuto(s->random.once_in(2));
    s->model.una_corda(static_cast<double>(s->random.any({0, 1})));
    s->model.bend(s->random.below(Piano::keys + 2), static_cast<double>(s->random.any({-4800, 4800})));
    work += Piano::keys * kStiffeningPower_w * static_cast<double>(block) / kHz;  // largest work of the bends
    s->model.process(std::span(s->left).first(block), std::span(s->right).first(block));
    for (std::size_t i = 0; i < block; ++i) {
      record.demand_finite(s->left[i]);
      record.demand_finite(s->right[i]);
    }
    return Flow{work, s->model.energy()};
  });
}

/// A slide-string or a fret-string.
template <typename RandomModel, typename T>
std::function<void(Record&)> along_a_string(std::size_t held_for) {
  struct State {
    RandomModel played{parts<T>()};
    RandomControls<T> random;
    ModeShapes<T> pluck = ModeShapes<T>(parts<T>().modes.size());
  };
  auto s = std::make_shared<State>();
  s->random = RandomControls<T>(held_for, seed());
  parts<T>().places.at(T(0.1), s->pluck);
  return [s, take = std::shared_ptr<Take<T>>()](Record& record) mutable {
    if (!take) take = std::make_shared<Take<T>>(record);
    const auto& model = s->played.model;
    if (record.samples % samples_of_take < kSlice) s->played = RandomModel(parts<T>()), take->restart();
    for (std::size_t n = 0; n < kSlice; ++n, ++record.samples) {
      s->random.next();
      const double displacement = model.string().displacement(s->pluck);
      const double work = s->played.tick(s->random);
      const double moved = model.string().displacement(s->pluck) - displacement;
      record.demand_finite(model.force());
      record.demand_finite(model.compression());
      take->close(work + s->played.pluck_force * moved, model.string().energy());
    }
  };
}

/// Three keys on a soundboard, struck at random.
template <typename T>
std::function<void(Record&)> body(std::size_t held_for) {
  struct State {
    std::vector<HammerString<T>> keys;
    std::vector<BridgeShapes<T>> bridges;
    std::unique_ptr<Body<T>> body;
    RandomControls<T> random;
  };
  auto s = std::make_shared<State>();
  s->random = RandomControls<T>(held_for, seed());
  BridgeStiffness stiffness;
  for (const StruckString& struck : {c2(), c4(), c7()}) {
    const auto modes = audible_modes(struck);
    std::vector<double> bridge;
    for (const auto& mode : modes) bridge.push_back(bridge_shape(struck.string, mode));
    stiffness += bridge_stiffness(struck.string, modes);
    s->keys.emplace_back(SegmentTable<T>(parts<T>().table), bare(modes),
                         shapes<T>(modes, &ResonatorMode::strike_shape), kHz);
    s->bridges.push_back(s->keys.back().bridge(ModeShapes<T>(bridge)));
  }
  const Plate plate{1.39, 0.91, 0.018, 392, 11.5e9, 8e9, 1.5e9, 0.3, {8, 0.29}};
  const auto board = modes_of({"board", "", plate, {0.62, 0, 0.51}, {0.87, 0, 0.29}, 120}, 22050).modes;
  s->body = std::make_unique<Body<T>>(bare(board), shapes<T>(board, &ResonatorMode::strike_shape), stiffness, kHz);
  return [s, held_for, take = std::shared_ptr<Take<T>>()](Record& record) mutable {
    using Ranges = ControlRanges<T>;
    if (!take) take = std::make_shared<Take<T>>(record);
    if (record.samples % samples_of_take < kSlice) {
      for (auto& key : s->keys) key.reset();
      s->body->reset();
      take->restart();
    }
    double work = 0;
    for (std::size_t n = 0; n < kSlice; ++n, ++record.samples) {
      s->random.next();
      T force = 0;
      const T mass = T(0.003);
      for (std::size_t k = 0; k < s->keys.size(); ++k) {
        if (n % (held_for > 1 ? held_for : 50) == 0) {
          const T speed = s->random.any(Ranges::speed_m_per_s);
          s->keys[k].strike(speed, s->random.any(Ranges::throw_distance_m));
          work += thrown_j(mass, speed);
        }
        force += s->keys[k].tick({mass, any_contact(s->random), s->random.any(Ranges::damping_per_s)}, s->bridges[k],
                                 s->body->change());
      }
      s->body->tick(force);
      record.demand_finite(s->body->displacement());
      if (n % 64 != 0) continue;
      double energy = s->body->energy();
      for (const auto& key : s->keys) energy += key.string().energy();
      take->close(std::exchange(work, 0), energy);
    }
  };
}

/// An instrument of a file.
template <typename T>
std::function<void(Record&)> instrument(const InstrumentData& data, std::size_t held_for) {
  struct State {
    SeenNetwork<T> model;
    RandomControls<T> random;
  };
  auto s = std::make_shared<State>(State{{data, kHz}, RandomControls<T>(held_for, seed())});
  return [s, data, held_for, take = std::shared_ptr<Take<T>>()](Record& record) mutable {
    if (!take) take = std::make_shared<Take<T>>(record);
    auto& model = s->model;
    const auto rest = [&] {
      model.reset();
      take->restart();
      take->close(model.energy(), model.energy());  // energy of a spring that is not relaxed
    };
    if (record.samples % samples_of_take < kSlice) rest();
    for (std::size_t n = 0; n < kSlice; ++n, ++record.samples) {
      s->random.next();
      if (held_for == 1 || n % held_for == 0)
        for (std::size_t i = 0; i < data.controls.size(); ++i)
          model.set(i, s->random.any(control_quantity<T>(data.controls[i].quantity).range));
      if (n % (held_for > 1 ? held_for : 500) == 0)
        for (const Event& event : model.events()) play_event(model, event, s->random.any({-100, 100}));
      model.tick();
      for (std::size_t i = 0; i < data.sources.size(); ++i) record.demand_finite(model.output(i));
      take->close(model.work() - model.dissipated(), model.energy());
    }
    const std::size_t bounded = model.bounded();
    if (sizeof(T) == sizeof(double) && bounded > record.bounded) record.fault("coupled contacts did not converge");
    record.bounded = bounded;
  };
}

template <typename... Emitted>
void add_instruments(std::vector<Soaked>& models, const std::string& end, std::size_t held_for,
                     ::testing::Types<Emitted...> /*all*/) {
  (models.emplace_back(std::string(Emitted::data::view().name) + end,
                       instrument<typename Emitted::value_type>(Emitted::data::view(), held_for)),
   ...);
}

template <typename T>
void add_models(std::vector<Soaked>& models) {
  const std::string precision = sizeof(T) == sizeof(double) ? ".double" : ".float";
  for (const std::size_t held_for : {kHeld, std::size_t{1}}) {
    const std::string end = precision + (held_for > 1 ? ".played" : ".jumping");
    models.emplace_back("mass-barrier" + end, mass_barrier<T>(held_for));
    models.emplace_back("hammer-string" + end, hammer_string<T>(held_for));
    models.emplace_back("slide-string" + end, along_a_string<RandomSlide<T>, T>(held_for));
    models.emplace_back("fret-string" + end, along_a_string<RandomFret<T>, T>(held_for));
    models.emplace_back("keyboard-voice" + end, keyboard_voice<T>(held_for));
    models.emplace_back("ensemble" + end, ensemble<T>(held_for));
    models.emplace_back("body" + end, body<T>(held_for));
    models.emplace_back("keyboard-instrument" + end, keyboard_instrument<T>(held_for));
    add_instruments(models, end, held_for, ShippedInstruments<T>{});
  }
}

using Clock = std::chrono::steady_clock;

double elapsed(Clock::time_point since) {
  return std::chrono::duration<double>(Clock::now() - since).count();
}

/// Plays all models by turns.
void play_in_turn(std::vector<Soaked>& models, double seconds) {
  const auto begin = Clock::now();
  do {
    for (Soaked& model : models) {
      const auto turn = Clock::now();
      do model.play(model.record);
      while (elapsed(turn) < std::min(1.0, seconds / 10));
    }
  } while (elapsed(begin) < seconds);
}

/// Plays one model after the other, each for so many seconds of its own time, without a rest.
void play_own_time(std::vector<Soaked>& models, double seconds) {
  samples_of_take = std::numeric_limits<std::size_t>::max();
  for (Soaked& model : models) do
      model.play(model.record);
    while (static_cast<double>(model.record.samples) < seconds * kHz && model.record.faults == 0);
}

int soak(bool in_own_time, double seconds, const std::vector<std::string_view>& names) {
  std::vector<Soaked> models;
  add_models<double>(models);
  add_models<float>(models);
  if (!names.empty())
    std::erase_if(models, [&](const Soaked& model) {
      return std::ranges::none_of(names,
                                  [&](std::string_view name) { return model.record.model.find(name) != name.npos; });
    });
  const auto begin = Clock::now();
  in_own_time ? play_own_time(models, seconds) : play_in_turn(models, seconds);
  std::size_t samples = 0, faults = 0;
  for (const Soaked& model : models) {
    std::printf(
        "%-32s %12zu samples, at most %8.2g J, %8.2g J beyond the work, %zu faults, %zu by the bounding law\n",
        model.record.model.c_str(), model.record.samples, model.record.peak_j, model.record.excess_j,
        model.record.faults, model.record.bounded);
    samples += model.record.samples, faults += model.record.faults;
  }
  std::printf("%-32s %12zu samples in %.0f s, %zu faults\n", "together", samples, elapsed(begin), faults);
  return faults > 0 || models.empty() ? 1 : 0;
}

}  // namespace
}  // namespace contactspline::testing

int main(int count, char** arguments) {
  const std::vector<std::string_view> given(arguments + 1, arguments + count);
  const bool in_own_time = !given.empty() && given[0] == "--own-time";
  const std::size_t seconds = in_own_time ? 1 : 0;
  if (given.size() <= seconds) {
    std::fputs("usage: soak [--own-time] SECONDS [NAME...]\n", stderr);
    return 2;
  }
  return contactspline::testing::soak(in_own_time, std::atof(arguments[1 + seconds]),
                                      {given.begin() + std::ptrdiff_t(seconds) + 1, given.end()});
}
