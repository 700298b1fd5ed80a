// SPDX-License-Identifier: MIT
// The rule for controls (docs/reference/controls.md): every control of every model, set to what is out of range or no
// number while it plays. Compiled once more with -Ofast, which assumes that all numbers are finite.
#include "contactspline/step/controls.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "band.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_live.hpp"
#include "contactspline/models/ensemble.hpp"
#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "contactspline/models/slide_string.hpp"
#include "contactspline/step/live_exponent.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {
namespace {

constexpr int kSamples = 1500, kBegin = 300, kEnd = 320;  // a control is wrong from kBegin to kEnd
constexpr double kHz = 44100;

/// A number that the compiler does not see, as it would see through a constant.
template <typename T>
T unseen(T value) {
  volatile T stored = value;
  return stored;
}
template <typename T>
T not_a_number() {
  return unseen(std::numeric_limits<T>::quiet_NaN());
}
template <typename T>
T infinite() {
  return unseen(std::numeric_limits<T>::infinity());
}

TEST(Controls, AreHeldInTheirRange) {
  const ControlRange<double> range{-1, 2};
  EXPECT_EQ(held(0.5, unseen(1.5), range), 1.5);
  EXPECT_EQ(held(0.5, unseen(-3.0), range), -1);
  EXPECT_EQ(held(0.5, unseen(3.0), range), 2);
  EXPECT_EQ(held(0.5, infinite<double>(), range), 2);
  EXPECT_EQ(held(0.5, unseen(-infinite<double>()), range), -1);
  EXPECT_EQ(held(0.5, not_a_number<double>(), range), 0.5);
  EXPECT_EQ(held(0.5, unseen(-not_a_number<double>()), range), 0.5);
  EXPECT_FALSE(is_number(not_a_number<float>()));
  EXPECT_TRUE(is_number(infinite<float>()));
  for (const float bad : {infinite<float>(), not_a_number<float>(), unseen(-infinite<float>())})
    for (std::size_t at = 0; at < 5; ++at) {
      std::array<float, 5> values{1, 2, 3, 4, 5};
      EXPECT_TRUE(contactspline::all_finite(std::span<const float>(values)));
      values[at] = bad;
      EXPECT_FALSE(contactspline::all_finite(std::span<const float>(values))) << at;
    }
}

/// A control, as a place in the struct of a model's controls.
template <typename T, typename Controls>
struct Control {
  const char* name;
  std::function<T&(Controls&)> of;
  ControlRange<T> range;
};

template <typename T>
std::vector<ResonatorMode> some_modes() {
  auto modes = audible_modes(c4());
  modes.resize(20);
  return modes;
}

/// Every model below has: Controls, controls() that play, the list of them, and play(), which calls `change` before
/// each sample and returns what it hears.
template <typename T>
struct Barrier {
  using Controls = MassBarrierControls<T>;
  using Ranges = ControlRanges<T>;
  static std::vector<Control<T, Controls>> list() {
    return {{"mass", [](Controls& c) -> T& { return c.mass_kg; }, Ranges::mass_kg},
            {"gravity", [](Controls& c) -> T& { return c.gravity_m_per_s2; }, Ranges::gravity_m_per_s2},
            {"ratio", [](Controls& c) -> T& { return c.contact.stiffness_ratio; }, Ranges::stiffness_ratio},
            {"loss", [](Controls& c) -> T& { return c.contact.loss_s_per_m; }, Ranges::loss_s_per_m}};
  }
  static Controls controls() { return {.mass_kg = T(0.003), .gravity_m_per_s2 = 50, .contact = {1, T(0.1)}}; }
  template <typename Change>
  std::vector<T> play(Change change) {
    model.throw_from(T(-0.0135), 2);  // in contact from kBegin on
    return each([&](int n) {
      Controls controls = Barrier::controls();
      change(n, controls);
      model.tick(controls);
      return model.displacement() + model.force();
    });
  }
  template <typename Tick>
  static std::vector<T> each(Tick tick) {
    std::vector<T> out;
    for (int n = 0; n < kSamples; ++n) out.push_back(tick(n));
    return out;
  }
  void reset() { model.reset(); }

  std::vector<Segment<T>> table = table_in<T>(felt_table(c4(), 16));
  MassBarrier<T> model{table, T(kHz)};
};

template <typename T>
struct Hammer {
  using Controls = HammerStringControls<T>;
  using Ranges = ControlRanges<T>;
  static std::vector<Control<T, Controls>> list() {
    return {{"mass", [](Controls& c) -> T& { return c.hammer_mass_kg; }, Ranges::mass_kg},
            {"ratio", [](Controls& c) -> T& { return c.felt.stiffness_ratio; }, Ranges::stiffness_ratio},
            {"loss", [](Controls& c) -> T& { return c.felt.loss_s_per_m; }, Ranges::loss_s_per_m},
            {"damping", [](Controls& c) -> T& { return c.damping_per_s; }, Ranges::damping_per_s}};
  }
  static Controls controls() { return {.hammer_mass_kg = T(0.003), .felt = {1, T(0.1)}, .damping_per_s = 3}; }
  template <typename Change>
  std::vector<T> play(Change change) {
    return Barrier<T>::each([&](int n) {
      if (n == 0 || n == kBegin + 5) model.strike(2, T(1e-4));
      Controls controls = Hammer::controls();
      change(n, controls);
      T sound, force;
      if (n % 2 == 0) {
        model.process(controls, pickup, std::span(&sound, 1), &force);
      } else {
        model.tick(controls);
        sound = model.string().displacement(pickup), force = model.force();
      }
      return sound + force;
    });
  }
  void reset() { model.reset(); }

  std::vector<ResonatorMode> modes = some_modes<T>();
  std::vector<Segment<T>> table = table_in<T>(felt_table(c4(), 40));
  ModeShapes<T> pickup = shapes<T>(modes, &ResonatorMode::pickup_shape);
  HammerString<T> model{table, bare(modes), shapes<T>(modes, &ResonatorMode::strike_shape), kHz};
};

template <typename T>
struct Voice : Hammer<T> {
  using Controls = HammerStringControls<T>;
  template <typename Change>
  std::vector<T> play(Change change) {
    return Barrier<T>::each([&](int n) {
      if (n == 0 || n == kBegin + 5) voice.strike(2);
      if (n == kBegin - 10 || n == kBegin + 15) voice.release();
      voice.controls() = Hammer<T>::controls();
      change(n, voice.controls());
      T sound;
      if (n % 2 == 0) voice.process(std::span(&sound, 1));
      return n % 2 == 0 ? sound : voice.tick();
    });
  }
  void reset() { voice.reset(); }

  std::vector<Mode> bare_modes = bare(this->modes);
  HammerVoice<T> voice{{.felt = this->table,
                        .modes = bare_modes,
                        .strike = shapes<T>(this->modes, &ResonatorMode::strike_shape),
                        .output = this->pickup,
                        .controls = Hammer<T>::controls()},
                       kHz};
};

/// A slide-string or a fret-string. Derived: its controls, and a height beside displacement and force.
template <typename Derived, typename Model, typename ModelControls, typename T>
struct ContactAlongString {
  using Controls = ModelControls;
  template <typename Change>
  std::vector<T> play(Change change) {
    model.place(T(0.3), Derived::kDistance_m);
    return Barrier<T>::each([&](int n) {
      Controls controls = Derived::controls();
      change(n, controls);
      model.tick(controls);
      return model.string().displacement(pickup) + model.force() + Derived::height(model);
    });
  }
  void reset() { model.reset(); }

  std::vector<ResonatorMode> modes = some_modes<T>();
  std::vector<Segment<T>> table = table_in<T>(felt_table(c4(), 16));
  ModeShapes<T> pickup = shapes<T>(modes, &ResonatorMode::pickup_shape);
  Model model{table, bare(modes), StringShapes<T>(wavenumbers_of(modes)), T(0.1), kHz};
};

template <typename T>
struct Slide : ContactAlongString<Slide<T>, SlideString<T>, SlideStringControls<T>, T> {
  using Controls = SlideStringControls<T>;
  static constexpr T kDistance_m = T(1e-4);
  using Ranges = ControlRanges<T>;
  static std::vector<Control<T, Controls>> list() {
    return {{"place", [](Controls& c) -> T& { return c.place_m; }, {0, T(c4().string.length_m)}},
            {"mass", [](Controls& c) -> T& { return c.slide_mass_kg; }, Ranges::mass_kg},
            {"hand force", [](Controls& c) -> T& { return c.hand_force_n; }, Ranges::force_n},
            {"hand stiffness", [](Controls& c) -> T& { return c.hand_stiffness_n_per_m; },
             Ranges::hand_stiffness_n_per_m},
            {"hand resistance", [](Controls& c) -> T& { return c.hand_resistance_n_s_per_m; },
             Ranges::resistance_n_s_per_m},
            {"fingers", [](Controls& c) -> T& { return c.rest_resistance_n_s_per_m; }, Ranges::resistance_n_s_per_m},
            {"pluck", [](Controls& c) -> T& { return c.pluck_force_n; }, Ranges::force_n},
            {"ratio", [](Controls& c) -> T& { return c.contact.stiffness_ratio; }, Ranges::stiffness_ratio},
            {"loss", [](Controls& c) -> T& { return c.contact.loss_s_per_m; }, Ranges::loss_s_per_m}};
  }
  static Controls controls() {
    return {.place_m = T(0.3),
            .slide_mass_kg = T(0.02),
            .hand_force_n = 2,
            .hand_stiffness_n_per_m = 100,
            .hand_resistance_n_s_per_m = 1,
            .rest_resistance_n_s_per_m = T(0.5),
            .pluck_force_n = T(0.1),
            .contact = {1, T(0.1)}};
  }
  static T height(const SlideString<T>& model) { return model.slide(); }
};

template <typename T>
struct Fret : ContactAlongString<Fret<T>, FretString<T>, FretStringControls<T>, T> {
  using Controls = FretStringControls<T>;
  static constexpr T kDistance_m = T(-1e-4);
  using Ranges = ControlRanges<T>;
  static std::vector<Control<T, Controls>> list() {
    return {{"place", [](Controls& c) -> T& { return c.place_m; }, {0, T(c4().string.length_m)}},
            {"gap", [](Controls& c) -> T& { return c.gap_m; }, Ranges::gap_m},
            {"pluck", [](Controls& c) -> T& { return c.pluck_force_n; }, Ranges::force_n},
            {"damping", [](Controls& c) -> T& { return c.damping_per_s; }, Ranges::damping_per_s},
            {"ratio", [](Controls& c) -> T& { return c.contact.stiffness_ratio; }, Ranges::stiffness_ratio},
            {"loss", [](Controls& c) -> T& { return c.contact.loss_s_per_m; }, Ranges::loss_s_per_m}};
  }
  static Controls controls() {
    return {.place_m = T(0.3), .gap_m = T(-1e-4), .pluck_force_n = 1, .damping_per_s = 2, .contact = {1, T(0.1)}};
  }
  static T height(const FretString<T>&) { return 0; }
};

template <typename Model>
class ControlsOf : public ::testing::Test {};
using Models = ::testing::Types<Barrier<double>, Barrier<float>, Hammer<double>, Hammer<float>, Voice<double>,
                                Voice<float>, Slide<double>, Slide<float>, Fret<double>, Fret<float>>;
TYPED_TEST_SUITE(ControlsOf, Models);

/// Plays a model with one control set for a while, or not; to be compared bit by bit. One function for all, because
/// -Ofast rounds copies differently.
template <typename Model, typename Control, typename T>
[[gnu::noinline]] std::vector<T> play(Model& model, const Control& control, T value, bool is_set) {
  return model.play([&](int n, auto& controls) {
    if (is_set && n >= kBegin && n < kEnd) control.of(controls) = value;
  });
}

template <typename Model, typename Control, typename T>
std::vector<T> with(const Control& control, T value) {
  Model model;
  return play(model, control, value, true);
}

template <typename Model>
auto untouched(Model&& model) {
  const auto control = std::remove_cvref_t<Model>::list().front();
  return play(model, control, control.range.min, false);
}

// As if the last number had stayed, from then to the end.
TYPED_TEST(ControlsOf, ThatAreNotNumbersHoldTheLastOne) {
  const auto expected = untouched(TypeParam());
  using T = std::remove_cvref_t<decltype(expected[0])>;
  for (const auto& control : TypeParam::list())
    EXPECT_EQ((with<TypeParam>(control, not_a_number<T>())), expected) << control.name;
  EXPECT_TRUE(all_finite(expected));
  EXPECT_NE(expected[kSamples - 1], 0);
}

// As if the end of the range had been set, and it is heard: another sound than that of the control left alone.
TYPED_TEST(ControlsOf, OutOfRangeAreMovedToItsEnds) {
  const auto left_alone = untouched(TypeParam());
  using T = std::remove_cvref_t<decltype(left_alone[0])>;
  for (const auto& control : TypeParam::list()) {
    const T min = control.range.min, max = control.range.max;
    const auto lowest = with<TypeParam>(control, min), highest = with<TypeParam>(control, max);
    EXPECT_TRUE(all_finite(lowest)) << control.name;
    EXPECT_TRUE(all_finite(highest)) << control.name;
    EXPECT_TRUE(lowest != left_alone || highest != left_alone) << control.name;
    EXPECT_EQ((with<TypeParam>(control, unseen(-infinite<T>()))), lowest) << control.name;
    EXPECT_EQ((with<TypeParam>(control, T(min - 1))), lowest) << control.name;
    EXPECT_EQ((with<TypeParam>(control, infinite<T>())), highest) << control.name;
    EXPECT_EQ((with<TypeParam>(control, T(2 * max + 1))), highest) << control.name;
  }
}

// After a reset a model plays what a new one plays, whatever it did before.
TYPED_TEST(ControlsOf, ResetToRest) {
  const auto expected = untouched(TypeParam());
  TypeParam model;
  model.play([](int n, auto& controls) {
    for (const auto& control : TypeParam::list())
      control.of(controls) = n % 2 == 0 ? control.range.min : control.range.max;
  });
  const std::size_t before = allocations;
  model.reset();
  EXPECT_EQ(allocations, before);
  // The place glides back, the gap too: a model with a place is put there by play().
  EXPECT_EQ(untouched(model), expected);
}

// --- Calls ---

// A throw that is no number does not happen; one that is infinite happens at the end of the range.
TEST(Calls, WithoutANumberDoNothing) {
  using Model = Hammer<double>;
  // One function for all calls: -Ofast may round differently in each copy of it.
  const auto play = [](const std::function<void(HammerString<double>&)>& strike) {
    Model model;
    std::vector<double> out(2000);
    for (int part = 0; part < 4; ++part) {
      if (part == 0) model.model.strike(2, 1e-4);
      if (part == 1) strike(model.model);
      model.model.process(Model::controls(), model.pickup, std::span(out).subspan(500 * std::size_t(part), 500));
    }
    return out;
  };
  const auto nothing = [](auto&) {};
  const auto expected = play(nothing);
  EXPECT_EQ(play([](auto& model) { model.strike(not_a_number<double>(), 1e-4); }), expected);
  EXPECT_EQ(play([](auto& model) { model.strike(2, not_a_number<double>()); }), expected);
  const auto fastest = play([](auto& model) { model.strike(1e3, 0.05); });
  EXPECT_NE(fastest, expected);
  EXPECT_EQ(play([](auto& model) { model.strike(infinite<double>(), infinite<double>()); }), fastest);
  EXPECT_EQ(play([](auto& model) {
              ModeShapes<double> shapes(20);
              shapes[7] = not_a_number<double>();
              model.strike_at(shapes);
              model.strike(1e3, 0.05);
            }),
            fastest);
  for (double Mode::*number : {&Mode::angular_frequency_rad_per_s, &Mode::decay_per_s, &Mode::mass_kg})
    EXPECT_EQ(play([&](auto& model) {
                std::vector<Mode> modes(20, Mode{1000, 1, 0.001});
                modes[7].*number = not_a_number<double>();
                model.retune(modes);
                model.strike(1e3, 0.05);
              }),
              fastest);
}

TEST(Calls, ThatPlaceWithoutANumberDoNothing) {
  const double nan = not_a_number<double>();
  const auto play = [](auto model, auto call) {
    const auto before = model.play([](int, auto&) {});
    call(model.model);
    std::vector<double> out;
    for (int n = 0; n < 1000; ++n) {
      model.model.tick(model.controls());
      out.push_back(model.model.force());
    }
    return out;
  };
  const auto nothing = [](auto&) {};
  const auto slide = play(Slide<double>(), nothing), fret = play(Fret<double>(), nothing),
             barrier = play(Barrier<double>(), nothing);
  EXPECT_EQ(play(Slide<double>(), [&](auto& model) { model.place(nan, 0); }), slide);
  EXPECT_EQ(play(Slide<double>(), [&](auto& model) { model.place(0.2, nan); }), slide);
  EXPECT_EQ(play(Fret<double>(), [&](auto& model) { model.place(nan, 0); }), fret);
  EXPECT_EQ(play(Fret<double>(), [&](auto& model) { model.place(0.2, nan); }), fret);
  EXPECT_EQ(play(Barrier<double>(), [&](auto& model) { model.throw_from(nan, 0); }), barrier);
  EXPECT_EQ(play(Barrier<double>(), [&](auto& model) { model.throw_from(0, nan); }), barrier);
  EXPECT_NE(play(Slide<double>(), [&](auto& model) { model.place(0.2, 0); }), slide);
  EXPECT_NE(play(Fret<double>(), [&](auto& model) { model.place(0.2, 0); }), fret);
  EXPECT_NE(play(Barrier<double>(), [&](auto& model) { model.throw_from(0, 1); }), barrier);
}

// The place of the pluck is held as that of a slide is: within the string, at 0 if it is no number.
TEST(Calls, ThatPluckDoSoWithinTheString) {
  const auto plucked = [](auto model, double place_m) {
    model.model = {model.table, bare(model.modes), StringShapes<double>(wavenumbers_of(model.modes)), place_m, kHz};
    return model.play([](int, auto&) {});
  };
  const double nan = not_a_number<double>(), far = 1e30, infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(plucked(Slide<double>(), nan), plucked(Slide<double>(), 0));
  EXPECT_EQ(plucked(Fret<double>(), nan), plucked(Fret<double>(), 0));
  EXPECT_EQ(plucked(Slide<double>(), infinity), plucked(Slide<double>(), far));
  EXPECT_EQ(plucked(Fret<double>(), infinity), plucked(Fret<double>(), far));
  EXPECT_NE(plucked(Slide<double>(), 0.1), plucked(Slide<double>(), 0));
  EXPECT_NE(plucked(Fret<double>(), 0.1), plucked(Fret<double>(), 0));
}

// A release is heard although the damping of the controls is no number.
TEST(HammerVoice, LowersItsDamperWhateverTheControlsAre) {
  const auto energy_after = [](double damping, bool released) {
    Voice<double> player;
    player.voice.strike(2);
    std::vector<double> out(2000);
    player.voice.process(out);
    player.voice.controls().damping_per_s = damping;
    if (released) player.voice.release();
    player.voice.process(out);
    return player.voice.model().string().energy();
  };
  EXPECT_EQ(energy_after(not_a_number<double>(), false), energy_after(3, false));
  EXPECT_EQ(energy_after(not_a_number<double>(), true), energy_after(3, true));
  EXPECT_LT(energy_after(3, true), energy_after(3, false) / 2);
}

// tick() lowers the damper in holds of 16 samples, each at the mean of an exponential, and in the end all the way.
TEST(HammerVoice, LowersItsDamperExponentially) {
  constexpr double kDamping = 60, kTime_s = 0.005;
  Voice<double> player;
  HammerVoice<double>& voice = player.voice;
  voice.release();
  const double own = player.voice.controls().damping_per_s;
  for (int n = 0; n < 8000; ++n) {
    double mean = 0;
    for (int i = 1; i <= 16; ++i) mean += std::exp(-(n / 16 * 16 + i) / (kTime_s * kHz)) / 16;
    ASSERT_TRUE(within(voice.damping_per_s(), own + kDamping * (1 - mean), 1e-5)) << n;
    voice.tick();
  }
  EXPECT_EQ(voice.damping_per_s(), own + kDamping);
}

TEST(LiveExponent, KeepsTheLastNumber) {
  using Live = LiveExponent<materials::felt_live, float>;
  const auto table_at = [](float exponent) {
    std::vector<float> values;
    const Live felt(exponent);
    for (const auto& [knot, energy, force, half_curvature] : felt.table())
      values.insert(values.end(), {knot, energy, force, half_curvature});
    return values;
  };
  constexpr auto kMin = static_cast<float>(materials::felt_live::live::min_exponent);
  constexpr auto kMax = static_cast<float>(materials::felt_live::live::max_exponent);
  EXPECT_EQ(table_at(not_a_number<float>()), table_at(kMin));
  EXPECT_EQ(table_at(infinite<float>()), table_at(kMax));
  EXPECT_EQ(table_at(unseen(-infinite<float>())), table_at(kMin));
  Live felt(kMax);
  felt.set(not_a_number<float>());
  EXPECT_EQ(felt.table()[5].energy, Live(kMax).table()[5].energy);
  EXPECT_NE(felt.table()[5].energy, Live(kMin).table()[5].energy);
}

TEST(KeyboardVoice, TakesVelocitiesFrom0To1) {
  using Piano = keyboards::piano;
  EXPECT_EQ(strike_speed<Piano>(unseen(7.0)), strike_speed<Piano>(unseen(1.0)));
  EXPECT_EQ(strike_speed<Piano>(infinite<double>()), strike_speed<Piano>(unseen(1.0)));
  EXPECT_EQ(strike_speed<Piano>(unseen(-1.0)), strike_speed<Piano>(unseen(0.0)));
  KeyboardVoice<Piano, float> voice(60, kHz, 20);
  voice.strike(static_cast<float>(strike_speed<Piano>(not_a_number<double>())));
  EXPECT_EQ(voice.tick(), 0);
  EXPECT_FALSE(voice.model().is_hammer_flying());
}

TEST(KeyboardVoice, RefusesAKeyThatTheKeyboardLacks) {
  using Piano = keyboards::piano;
  for (const int key : {std::numeric_limits<int>::min(), 10, 20, 109, std::numeric_limits<int>::max()}) {
    EXPECT_THROW((KeyboardVoice<Piano, float>(key, kHz, 20)), std::out_of_range) << key;
    EXPECT_THROW((void)string_of<Piano>(key), std::out_of_range) << key;
  }
  EXPECT_NO_THROW((KeyboardVoice<Piano, float>(21, kHz, 20)));
  EXPECT_NO_THROW((KeyboardVoice<Piano, float>(108, kHz, 20)));
}

// The damper of a bank: a damping that is no number is the last one, one below 0 is 0.
TEST(ModalBank, HoldsItsDamping) {
  const auto modes = bare(some_modes<double>());
  const auto push = shapes<double>(some_modes<double>(), &ResonatorMode::strike_shape);
  const auto energy_with = [&](double first, double then) {
    ModalBank<double> bank(modes, kHz);
    for (int n = 0; n < 100; ++n) {
      bank.predict(n < 50 ? first : then);
      bank.push(push, n < 10 ? 1 : 0);
      bank.commit();
    }
    return bank.energy();
  };
  EXPECT_EQ(energy_with(1e-3, not_a_number<double>()), energy_with(1e-3, 1e-3));
  EXPECT_EQ(energy_with(1e-3, unseen(-1.0)), energy_with(1e-3, 0));
  EXPECT_EQ(energy_with(1e-3, infinite<double>()), energy_with(1e-3, 1e5));
  EXPECT_LT(energy_with(1e-3, 1e-3), energy_with(1e-3, 0));
}

// --- An ensemble ---

/// The sound of four voices; `damage` acts on the third, which is not heard where it is `alone`.
template <typename Damage>
std::vector<float> sound_of_three(bool with_third, Damage damage) {
  auto players = band<float>(4);
  if (with_third) damage(players[2]);
  auto ensemble = ensemble_of(players);
  for (std::size_t voice = 0; voice < 4; ++voice)
    if (voice != 2 || with_third) ensemble.strike(voice, 2, 1e-4f);
  std::vector<float> out(3000);
  ensemble.process(out);
  return out;
}

// Modes that are no numbers: the others play as if the voice were not there, up to the rounding of voices side by
// side (kernels_test). It is put to sleep at once.
TEST(EnsembleOfControls, LeavesAVoiceOutThatIsNotFinite) {
  const auto alone = sound_of_three(false, [](auto&) {});
  const auto is_alone = [&](auto damage) {
    return sequences_within<float>(sound_of_three(true, damage), alone, 5.6e-5);
  };
  EXPECT_TRUE(is_alone([](auto& player) { player.modes[3].mass_kg = not_a_number<double>(); }));
  EXPECT_TRUE(is_alone([](auto& player) { player.modes[0].decay_per_s = not_a_number<double>(); }));
  EXPECT_FALSE(is_alone([](auto&) {}));
  auto players = band<float>(4);
  players[2].modes[3].mass_kg = not_a_number<double>();
  auto ensemble = ensemble_of(players);
  for (std::size_t voice = 0; voice < 4; ++voice) ensemble.strike(voice, 2, 1e-4f);
  std::vector<float> out(128);
  ensemble.process(out);
  EXPECT_EQ(ensemble.awake(), 3u);
}

// Controls, gain and pan that are no numbers for a while: the mix is the one of the numbers before.
TEST(EnsembleOfControls, HoldsWhatIsNoNumber) {
  const auto players = band<double>(4);
  const auto play = [&](auto damage) {
    auto ensemble = ensemble_of(players);
    std::vector<double> left(4000), right(4000);
    for (std::size_t voice = 0; voice < 4; ++voice) ensemble.strike(voice, 2, 1e-4);
    ensemble.mix(2) = {2, 0.25};
    for (std::size_t block = 0; block < 4; ++block) {
      const auto controls = ensemble.controls(2);
      const auto mix = ensemble.mix(2);
      if (block == 2) damage(ensemble);
      ensemble.process(std::span(left).subspan(1000 * block, 1000), std::span(right).subspan(1000 * block, 1000));
      ensemble.controls(2) = controls, ensemble.mix(2) = mix;
    }
    left.insert(left.end(), right.begin(), right.end());
    return left;
  };
  const auto expected = play([](auto&) {});
  const double nan = not_a_number<double>();
  EXPECT_EQ(play([&](auto& ensemble) { ensemble.mix(2).gain = nan; }), expected);
  EXPECT_EQ(play([&](auto& ensemble) { ensemble.mix(2).pan = nan; }), expected);
  EXPECT_EQ(play([&](auto& ensemble) { ensemble.controls(2) = {nan, {nan, nan}, nan}; }), expected);
  EXPECT_EQ(play([&](auto& ensemble) { ensemble.strike(2, nan, 1e-4); }), expected);
  EXPECT_TRUE(all_finite(play([&](auto& ensemble) { ensemble.mix(2) = {infinite<double>(), 7}; })));
  EXPECT_EQ(play([&](auto& ensemble) { ensemble.mix(2).pan = -1; }),
            play([&](auto& ensemble) { ensemble.mix(2).pan = 0; }));
}

TEST(EnsembleOfControls, Resets) {
  const auto players = band<double>(9);
  auto ensemble = ensemble_of(players), fresh = ensemble_of(players);
  std::vector<double> out(500), expected(500);
  const auto strike_all = [](auto& struck) {
    for (std::size_t voice = 0; voice < 9; ++voice) struck.strike(voice, 2, 1e-4);
  };
  strike_all(ensemble);
  ensemble.process(out);
  const std::size_t before = allocations;
  ensemble.reset(4);
  EXPECT_EQ(ensemble.awake(), 8u);
  EXPECT_EQ(ensemble.model(4).string().energy(), 0);
  ensemble.reset();
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(ensemble.awake(), 0u);
  ensemble.process(out);
  EXPECT_EQ(out, std::vector<double>(500));
  strike_all(ensemble), strike_all(fresh);
  ensemble.process(out), fresh.process(expected);
  EXPECT_EQ(out, expected);
}

}  // namespace
}  // namespace contactspline::testing
