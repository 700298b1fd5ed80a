// SPDX-License-Identifier: MIT
// The instruments of the page, in any precision: those that ship, strings of a guitar with a slide and a
// fret, and the course of a dulcimer.
#pragma once

#include <concepts>
#include <span>

#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "generated/cello.hpp"
#include "generated/classical_guitar.hpp"
#include "generated/dulcimer_g4.hpp"
#include "generated/felt_c4.hpp"
#include "generated/fret_guitar.hpp"
#include "generated/gong.hpp"
#include "generated/guitar_d3.hpp"
#include "generated/guitar_g3.hpp"
#include "generated/kalimba.hpp"
#include "generated/kit.hpp"
#include "generated/lap_steel.hpp"
#include "generated/marimba.hpp"
#include "generated/piano.hpp"
#include "generated/prepared_piano.hpp"
#include "generated/slap_bass.hpp"
#include "generated/snare.hpp"
#include "generated/steel_on_steel.hpp"
#include "generated/tanpura.hpp"
#include "generated/tom.hpp"
#include "generated/trichord_c4.hpp"
#include "generated/violin.hpp"

namespace contactspline::web {

/// A slide on a guitar string, held as in the score slide_guitar. Its last output is the force on the bridge.
template <std::floating_point T>
class SlideGuitar : public SlideStringOf<materials::steel_on_steel, resonators::guitar_g3, T> {
 public:
  SlideGuitar() {
    using P = SlideStringParameter;
    this->set_initial(P::kSlideMass, 0.05);
    this->set_initial(P::kHandForce, 8);
    this->set_initial(P::kHandStiffness, 300);
    this->set_initial(P::kHandResistance, 3);
    this->set_initial(P::kRestResistance, 1.5);
    this->set_initial(P::kLoss, 0.2);
    this->set_initial(P::kPluck, 5);
  }
  static std::span<const Output> outputs() { return StringOutput::kList; }
};

/// A guitar string over a fret, as in the score fret_buzz. Its last output is the force on the bridge.
template <std::floating_point T>
class FretGuitar : public FretStringOf<materials::steel_on_steel, resonators::guitar_d3, T> {
 public:
  FretGuitar() {
    using P = FretStringParameter;
    this->set_initial(P::kPlace, 0.635);
    this->set_initial(P::kGap, 0.00006);
    this->set_initial(P::kLoss, 0.3);
  }
  static std::span<const Output> outputs() { return StringOutput::kList; }
};

/// A felt hammer on a course of two strings, as in the score dulcimer. Its last output is the force on the bridge.
template <std::floating_point T>
class Dulcimer : public HammerStringOf<materials::felt_c4, resonators::dulcimer_g4, T> {
 public:
  static constexpr double kHammer_kg = 0.006;  // this, the loss and the speed are those of the score `dulcimer`

  Dulcimer() : HammerStringOf<materials::felt_c4, resonators::dulcimer_g4, T>(kHammer_kg) {
    using P = HammerStringParameter;
    this->set_initial(P::kLoss, 0.1);
    this->set_initial(P::kSpeed, 1.5);
  }
  static const char* name() { return "dulcimer"; }
  static const char* description() { return "Felt hammer on a course of two strings, 1.2 cents apart"; }
  static std::span<const Output> outputs() { return StringOutput::kList; }
};

/// Calls visit.template operator()<I>() for the class I<T> of each file in data/instruments.
template <typename Visitor>
void each_instrument_of_a_file(const Visitor& visit) {
  visit.template operator()<instruments::tanpura>();
  visit.template operator()<instruments::classical_guitar>();
  visit.template operator()<instruments::fret_guitar>();
  visit.template operator()<instruments::lap_steel>();
  visit.template operator()<instruments::slap_bass>();
  visit.template operator()<instruments::trichord_c4>();
  visit.template operator()<instruments::prepared_piano>();
  visit.template operator()<instruments::marimba>();
  visit.template operator()<instruments::kalimba>();
  visit.template operator()<instruments::snare>();
  visit.template operator()<instruments::tom>();
  visit.template operator()<instruments::gong>();
  visit.template operator()<instruments::kit>();
  visit.template operator()<instruments::violin>();
  visit.template operator()<instruments::cello>();
}

}  // namespace contactspline::web
