// SPDX-License-Identifier: MIT
// Ten minutes of controls that leap at random: everything stays finite, and energy is accounted for.
#include "contactspline/models/slide_string.hpp"
#include "energy.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/precisions.hpp"
#include "support/random.hpp"

namespace contactspline::testing {
namespace {

constexpr double kSeconds = 600;
constexpr std::size_t kModes = 12;

/// Now nothing, now something between.
double between_or_0(Random& random, double low, double high) {
  return random.below(2) == 0 ? 0 : random.between(low, high);
}

std::vector<ResonatorMode> lowest_modes(const StruckString& struck) {
  auto modes = audible_modes(struck);
  modes.resize(kModes);
  return modes;
}

/// C4 and its hammer.
template <typename T>
class Piano {
 public:
  explicit Piano(double rate)
      : modes_(lowest_modes(c4())),
        felt_(table_in<T>(felt_table(c4(), 32))),
        places_(wavenumbers_of(modes_)),
        rate_(rate),
        hammer_({felt_, bare(modes_), at(0.0744), rate}, felt_, rate) {}

  EnergyBooks process() {
    Random random(4);
    HammerStringControls<T> controls{.hammer_mass_kg = T(0.003)};
    for (int n = 0; n < kSeconds * rate_; ++n) {
      if (random.once_in(300)) move_one(controls, random);
      if (random.once_in(2000)) hammer_.model().strike_at(at(random.between(0, 0.62)));
      if (random.once_in(3000)) hammer_.strike(T(random.log_between(0.05, 10)), T(random.between(0, 1e-3)), controls);
      hammer_.tick(controls);
    }
    return hammer_.books();
  }

 private:
  [[nodiscard]] ModeShapes<T> at(double place_m) const {
    ModeShapes<T> at(kModes);
    places_.at(T(place_m), at);
    return at;
  }

  // As far as the sliders of hammer_string.dsp go.
  static void move_one(HammerStringControls<T>& controls, Random& random) {
    switch (random.below(4)) {
      case 0:
        controls.hammer_mass_kg = T(random.log_between(5e-4, 0.05));
        break;
      case 1:
        controls.felt.stiffness_ratio = T(random.log_between(1e-3, 1e3));
        break;
      case 2:
        controls.felt.loss_s_per_m = T(between_or_0(random, 0, 2));
        break;
      default:
        controls.damping_per_s = T(random.below(2) == 0 ? 0 : random.log_between(0.1, 1000));
    }
  }

  std::vector<ResonatorMode> modes_;
  std::vector<Segment<T>> felt_;
  StringShapes<T> places_;
  double rate_;
  HammerBooks<T> hammer_;
};

constexpr double kPluck = 0.13;  // m
const StruckString kGuitar{"guitar", {0.65, 0.0036, 70, 3e-4, {0.4, 2e-4}}, 0, {1e8, 1.5}, kPluck};

/// A guitar string under a slide, with its books kept.
template <typename T>
class Guitar {
 public:
  explicit Guitar(double rate)
      : modes_(lowest_modes(kGuitar)),
        table_(table_in<T>(segment_table(uniform_spline({"slide", "", kGuitar.felt, {}, {32, 2e-4}}, "slide")))),
        shapes_(wavenumbers_of(modes_)),
        pluck_(kModes),
        rest_(kModes),
        rate_(rate),
        model_(contact(), bare(modes_), shapes_, T(kPluck), rate),
        place_(shapes_, T(0.3), shapes_.longest_step(bare(modes_), rate)) {
    shapes_.at(T(kPluck), pluck_);
    model_.place(T(0.3), T(1e-3));
    shapes_.at(T(0.15), rest_);
    books_.work = stored();
  }

  EnergyBooks process() {
    Random random(4);
    SlideStringControls<T> controls{.place_m = T(0.3), .slide_mass_kg = T(0.02), .hand_stiffness_n_per_m = 500};
    T target = controls.place_m, reach = 0;
    for (int n = 0; n < kSeconds * rate_; ++n) {
      if (random.once_in(300)) move_one(controls, random);
      if (random.once_in(4000)) {  // glides at up to 30 m/s, as slide_string.dsp makes of a leap
        target = T(random.between(0, 0.65));
        reach = T(random.log_between(0.1, 30) / rate_);
      }
      controls.place_m += std::clamp(target - controls.place_m, -reach, reach);
      tick(controls);
    }
    return books_;
  }

  /// Compression less slide - string: 0 but for rounding.
  [[nodiscard]] double drift() const {
    ModeShapes<T> at(kModes);
    shapes_.at(place_.place(), at);
    return static_cast<double>(model_.compression()) - model_.slide() + model_.string().displacement(at);
  }

 private:
  // About as far as the sliders of slide_string.dsp go; the hand always holds the slide, or it would fall for metres.
  static void move_one(SlideStringControls<T>& controls, Random& random) {
    switch (random.below(8)) {
      case 0:
        controls.slide_mass_kg = T(random.log_between(0.01, 0.1));
        break;
      case 1:
        controls.hand_force_n = T(random.between(-2, 10));
        break;
      case 2:
        controls.hand_stiffness_n_per_m = T(random.log_between(500, 5000));
        break;
      case 3:
        controls.hand_resistance_n_s_per_m = T(between_or_0(random, 0, 20));
        break;
      case 4:
        controls.rest_resistance_n_s_per_m = T(between_or_0(random, 0, 20));
        break;
      case 5:
        controls.pluck_force_n = T(between_or_0(random, 0, 5));
        break;
      case 6:
        controls.contact.stiffness_ratio = T(random.log_between(1e-3, 1e3));
        break;
      default:
        controls.contact.loss_s_per_m = T(between_or_0(random, 0, 2));
    }
  }

  void tick(const SlideStringControls<T>& controls) {
    if (place_.move_to(controls.place_m)) shapes_.at(place_.place() / 2, rest_);
    const SlideStringControls<T> before = model_.controls();
    const double u = model_.slide(), v = model_.slide_velocity(), pluck = displacement(pluck_),
                 rest = displacement(rest_);
    const T y = model_.compression(), last = model_.memory().last_increment();
    model_.tick(controls);
    const SlideStringControls<T>& now = model_.controls();
    // Who changes the mass, a stiffness or the hand's spring does the work of it, and no more than
    // docs/how-to/slide-string.md says. A mass that is added is at rest.
    const double m = before.slide_mass_kg, kept = now.slide_mass_kg > m ? v * m / now.slide_mass_kg : v;
    const double of_mass = (now.slide_mass_kg * kept * kept - m * v * v) / 2;
    const double of_spring =
        (static_cast<double>(now.hand_stiffness_n_per_m) - before.hand_stiffness_n_per_m) * u * u / 2;
    const double of_ratio =
        (static_cast<double>(now.contact.stiffness_ratio) - before.contact.stiffness_ratio) * potential(contact(), y);
    EXPECT_LE(of_mass, 1e-6 * m * v * v);
    if (++ticks_ > 1) {
      EXPECT_LE(of_spring, 1.001 / rate_);
      EXPECT_LE(of_ratio, 1.001 / rate_);
    }
    books_.work += of_mass + of_spring + of_ratio;
    const double moved = model_.slide() - u;
    books_.work +=
        controls.hand_force_n * moved + controls.pluck_force_n * (displacement(pluck_) - pluck) + model_.work_along();
    books_.dissipated += controls.hand_resistance_n_s_per_m * moved * moved * rate_ + model_.string().dissipated() -
                         model_.rest_force() * (displacement(rest_) - rest) +
                         contact_loss(contact(), now.contact, rate_, y, last, model_);
    books_.close(stored());
  }

  [[nodiscard]] SegmentTable<T> contact() const { return table_; }
  [[nodiscard]] double displacement(const ModeShapes<T>& at) const { return model_.string().displacement(at); }
  [[nodiscard]] double stored() const {
    const double v = model_.slide_velocity(), u = model_.slide();
    const SlideStringControls<T>& now = model_.controls();
    return model_.string().energy() + now.slide_mass_kg * v * v / 2 + now.hand_stiffness_n_per_m * u * u / 2 +
           now.contact.stiffness_ratio * potential(contact(), model_.compression());
  }

  std::vector<ResonatorMode> modes_;
  std::vector<Segment<T>> table_;
  StringShapes<T> shapes_;
  ModeShapes<T> pluck_, rest_;
  double rate_;
  SlideString<T> model_;
  MovingPlace<T> place_;
  int ticks_ = 0;
  EnergyBooks books_;
};

// Dissipation never adds energy: `dissipated` sums what cannot be negative. So where the books are right, what
// is stored is never more than the work put in. In double they are right to 1e-12 of the peak, as over 10 s. In
// single a sample's rounding is some 2^-24 of what is stored; at random signs over 2e7 samples that is 3e-4 of the
// peak.
template <typename T>
constexpr double kBound = std::is_same_v<T, double> ? 1e-12 : 1e-3;

CONTACTSPLINE_EACH_PRECISION(LiveControl);

TYPED_TEST(LiveControl, OfAHammerStringIsAccountedForOverTenMinutes) {
  Piano<TypeParam> piano(44100);
  const EnergyBooks books = piano.process();
  EXPECT_TRUE(within(books.worst, 0, kBound<TypeParam> * books.peak));
  EXPECT_LE(books.peak, books.work);
  EXPECT_GT(books.work, 10);
  this->RecordProperty("relative", std::to_string(1e15 * books.worst / books.peak) + "e-15");
}

TYPED_TEST(LiveControl, OfASlideStringIsAccountedForOverTenMinutes) {
  Guitar<TypeParam> guitar(22050);
  const EnergyBooks books = guitar.process();
  EXPECT_TRUE(within(books.worst, 0, kBound<TypeParam> * books.peak));
  EXPECT_TRUE(within(guitar.drift(), 0, 10 * kBound<TypeParam>));
  this->RecordProperty("relative", std::to_string(1e15 * books.worst / books.peak) + "e-15");
  this->RecordProperty("peak_j", std::to_string(books.peak));
}

// A hammer in flight keeps the mass, felt and place it was thrown with, so that no control clicks or adds energy.
TEST(HammerString, KeepsItsHammerUntilTheNextThrow) {
  const auto modes = audible_modes(c4());
  const auto felt = felt_table(c4(), 32);
  const auto strike = shapes<double>(modes, &ResonatorMode::strike_shape);
  HammerString<double> still(felt, bare(modes), strike, 44100), moved(felt, bare(modes), strike, 44100);
  const auto other_place = shapes<double>(modes, &ResonatorMode::pickup_shape);
  const HammerStringControls<double> controls{.hammer_mass_kg = 0.003};
  const HammerStringControls<double> others{.hammer_mass_kg = 0.03, .felt = {.stiffness_ratio = 100}};
  std::vector<double> expected, found, next;
  for (int n = 0; n < 2000; ++n) {
    if (n % 1000 == 0) still.strike(2, 1e-4), moved.strike(2, 1e-4);
    if (n == 20) moved.strike_at(other_place);
    still.tick(controls);
    moved.tick(n < 20 ? controls : others);
    if (n < 1000) expected.push_back(still.force()), found.push_back(moved.force());
    if (n >= 1000) next.push_back(std::abs(still.force() - moved.force()));
  }
  EXPECT_GT(expected[20], 0);
  EXPECT_EQ(found, expected);
  EXPECT_GT(*std::ranges::max_element(next), 10);
}

}  // namespace
}  // namespace contactspline::testing
