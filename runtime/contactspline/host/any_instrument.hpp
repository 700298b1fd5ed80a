// SPDX-License-Identifier: MIT
// The handle of what plays: an instrument whose kind is known at run time only.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "contactspline/data/pluck.hpp"
#include "contactspline/data/timed_event.hpp"
#include "contactspline/instrument/instrument.hpp"

namespace contactspline {

/// The concept Instrument as an interface; meets Instrument itself. What can happen to it is a TimedEvent.
template <std::floating_point T>
class AnyInstrument {
 public:
  using value_type = T;

  AnyInstrument() = default;
  AnyInstrument(const AnyInstrument&) = delete;
  AnyInstrument& operator=(const AnyInstrument&) = delete;
  virtual ~AnyInstrument() = default;

  [[nodiscard]] virtual const char* name() const = 0;
  [[nodiscard]] virtual const char* description() const = 0;
  [[nodiscard]] virtual const char* license() const = 0;
  [[nodiscard]] virtual std::span<const Parameter> parameters() const = 0;
  [[nodiscard]] virtual std::span<const Event> events() const = 0;
  [[nodiscard]] virtual std::span<const Output> outputs() const = 0;
  [[nodiscard]] virtual std::span<const Preset> presets() const = 0;
  /// The event that a key of MIDI plays, if it plays one; and whether it plays at all.
  [[nodiscard]] virtual std::optional<std::size_t> event_of(int key) const = 0;
  [[nodiscard]] virtual bool has_key(int key) const = 0;
  [[nodiscard]] virtual bool bends_keys() const = 0;  ///< does Action::kBendKey bend a key alone?
  /// Does Action::kMoveKey move this parameter of a key alone?
  [[nodiscard]] virtual bool moves_keys(std::size_t parameter) const = 0;

  virtual void prepare(double sample_rate_hz) = 0;
  /// Does what an event says, now; its time does not count.
  virtual void play(const TimedEvent& event) = 0;
  /// input: a force on the body over each sample [N], or empty.
  virtual void process(Outputs<T> outputs, std::span<T> force, std::span<const T> input = {}) = 0;
  virtual void reset() = 0;

  [[nodiscard]] virtual double value(std::size_t parameter) const = 0;
  [[nodiscard]] virtual bool is_silent(double limit_j) const = 0;
  [[nodiscard]] virtual bool is_at_rest(double limit_j) const = 0;  ///< false where the instrument does not say
  [[nodiscard]] virtual bool sleeps() const = 0;                    ///< is it silent until it is played?
  [[nodiscard]] virtual Books books() const = 0;
  [[nodiscard]] virtual double input_scale_n() const { return 0; }  ///< 0: it has no input
  /// Does another instrument wait to take its place at the next event or block?
  [[nodiscard]] virtual bool has_next() const { return false; }

  void set(std::size_t parameter, double value) { play({0, Action::kSet, parameter, value}); }
  void note_on(int key, double velocity) { play({0, Action::kNoteOn, static_cast<std::size_t>(key), velocity}); }
  void note_off(int key) { play({0, Action::kNoteOff, static_cast<std::size_t>(key)}); }
  void strike(std::size_t number, T speed_m_per_s) {
    if (is_number(speed_m_per_s)) play({0, Action::kStrike, number, double(speed_m_per_s)});
  }
  void release(std::size_t number) { play({0, Action::kRelease, number}); }
  void pluck(std::size_t number, T force_n, double rise_s = kPluckRise_s) {
    if (is_number(force_n)) play({0, Action::kPluck, number, double(force_n), rise_s});
  }
  [[nodiscard]] double energy() const { return books().stored_j; }
};

/// A handle that owns its instrument.
template <std::floating_point T>
using Handle = std::unique_ptr<AnyInstrument<T>>;

/// An instrument behind the interface.
template <Instrument I>
class InstrumentBehind final : public AnyInstrument<typename I::value_type> {
  using T = typename I::value_type;

 public:
  template <typename... Args>
  explicit InstrumentBehind(Args&&... args) : instrument_(std::forward<Args>(args)...) {}

  [[nodiscard]] const char* name() const override { return instrument_.name(); }
  [[nodiscard]] const char* description() const override { return instrument_.description(); }
  [[nodiscard]] const char* license() const override { return license_of(instrument_); }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return instrument_.parameters(); }
  [[nodiscard]] std::span<const Event> events() const override { return instrument_.events(); }
  [[nodiscard]] std::span<const Output> outputs() const override { return instrument_.outputs(); }
  [[nodiscard]] std::span<const Preset> presets() const override { return instrument_.presets(); }
  [[nodiscard]] std::optional<std::size_t> event_of(int key) const override {
    return contactspline::event_of(instrument_, key);
  }
  [[nodiscard]] bool has_key(int key) const override { return contactspline::has_key(instrument_, key); }
  [[nodiscard]] bool bends_keys() const override {
    if constexpr (requires { instrument_.bends_keys(); })
      return instrument_.bends_keys();
    else
      return requires(I & instrument) {
        instrument.bend_key(60, 0.0);
      };
  }

  [[nodiscard]] bool moves_keys([[maybe_unused]] std::size_t parameter) const override {
    if constexpr (requires { instrument_.moves_keys(parameter); })
      return instrument_.moves_keys(parameter);
    else
      return false;
  }

  void prepare(double sample_rate_hz) override { instrument_.prepare(sample_rate_hz); }
  void play(const TimedEvent& event) override {
    const int key = static_cast<int>(event.number);
    switch (event.action) {
      case Action::kStrike:
        return instrument_.strike(event.number, value_of(event, EventKind::kStrike));
      case Action::kRelease:
        return instrument_.release(event.number);
      case Action::kPluck:
        return instrument_.pluck(event.number, value_of(event, EventKind::kPluck), event.rise_s);
      case Action::kBow:
        if constexpr (requires { instrument_.bow(event.number, T(1)); })
          instrument_.bow(event.number, value_of(event, EventKind::kBow));
        return;
      case Action::kNoteOn:
        return instrument_.note_on(key, event.value);
      case Action::kNoteOff:
        return note_off_by(key, event.value);
      case Action::kSet:
        return instrument_.set(event.number, event.value);
      case Action::kBendKey:
      case Action::kDampKey:
      case Action::kPlaceKey:
      case Action::kMoveKey:
      case Action::kLevelKey:
      case Action::kPanKey:
        return change_key(event, key);
    }
  }
  void process(Outputs<T> outputs, std::span<T> force, std::span<const T> input = {}) override {
    process_under(instrument_, outputs, force, input);
  }
  void reset() override { instrument_.reset(); }

  [[nodiscard]] double value(std::size_t parameter) const override { return instrument_.value(parameter); }
  [[nodiscard]] bool is_silent(double limit_j) const override { return instrument_.is_silent(limit_j); }
  [[nodiscard]] bool is_at_rest([[maybe_unused]] double limit_j) const override {
    if constexpr (requires { instrument_.is_at_rest(limit_j); })
      return instrument_.is_at_rest(limit_j);
    else
      return false;
  }
  [[nodiscard]] double input_scale_n() const override { return input_scale_of(instrument_); }
  [[nodiscard]] bool sleeps() const override {
    return requires {
      I::kSleeps;
    };
  }
  [[nodiscard]] Books books() const override {
    Books books{instrument_.energy()};
    if constexpr (requires { instrument_.string_energy(); })
      books.string_j = instrument_.string_energy();
    else
      books.string_j = books.stored_j;
    if constexpr (requires { instrument_.work() + instrument_.dissipated(); }) {
      books.work_j = instrument_.work();
      books.heat_j = instrument_.dissipated();
    }
    if constexpr (requires { instrument_.contacts() + instrument_.failures(); }) {
      books.contacts = instrument_.contacts();
      books.failures = instrument_.failures();
    }
    return books;
  }

  [[nodiscard]] I& instrument() { return instrument_; }

 private:
  // An action on a single key, of an instrument that has voices for each.
  void change_key([[maybe_unused]] const TimedEvent& event, [[maybe_unused]] int key) {
    if constexpr (requires { instrument_.bend_key(key, event.value); })
      if (event.action == Action::kBendKey) instrument_.bend_key(key, event.value);
    if constexpr (requires { instrument_.damp_key(key, event.value); }) {
      if (event.action == Action::kDampKey) instrument_.damp_key(key, event.value);
      if (event.action == Action::kPlaceKey) instrument_.place_key(key, event.value);
    }
    if constexpr (requires { instrument_.move_key(key, event.parameter, event.value); })
      if (event.action == Action::kMoveKey) instrument_.move_key(key, event.parameter, event.value);
    if constexpr (requires { instrument_.level_key(key, event.value); }) {
      if (event.action == Action::kLevelKey) instrument_.level_key(key, event.value);
      if (event.action == Action::kPanKey) instrument_.pan_key(key, event.value);
    }
  }

  void note_off_by(int key, [[maybe_unused]] double velocity) {
    if constexpr (requires { instrument_.note_off(key, velocity); })
      instrument_.note_off(key, velocity);
    else
      instrument_.note_off(key);
  }

  // The value of an event; where it says so, that of its parameter.
  [[nodiscard]] T value_of(const TimedEvent& played, EventKind kind) const {
    if (!is_number(played.value))
      for (const Event& event : instrument_.events())
        if (event.kind == kind && event.number == played.number)
          return static_cast<T>(instrument_.value(event.parameter));
    return static_cast<T>(played.value);
  }

  I instrument_;
};

/// A handle on an instrument of a class.
template <Instrument I, typename... Args>
[[nodiscard]] Handle<typename I::value_type> handle_of(Args&&... args) {
  return std::make_unique<InstrumentBehind<I>>(std::forward<Args>(args)...);
}

}  // namespace contactspline
