// SPDX-License-Identifier: MIT
// An instrument whose kind is known at run time only.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "contactspline/instrument/instrument.hpp"

namespace contactspline {

/// The concept Instrument as an interface; meets Instrument itself.
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
  virtual void prepare(double sample_rate_hz) = 0;
  virtual void set(std::size_t parameter, double value) = 0;
  [[nodiscard]] virtual double value(std::size_t parameter) const = 0;
  virtual void note_on(int key, double velocity) = 0;
  virtual void note_off(int key) = 0;
  virtual void strike(std::size_t number, T speed_m_per_s) = 0;
  virtual void release(std::size_t number) = 0;
  virtual void pluck(std::size_t number, T force_n, double rise_s) = 0;
  virtual void process(Outputs<T> outputs, std::span<T> force) = 0;
  virtual void reset() = 0;
  [[nodiscard]] virtual bool is_silent(double limit_j) const = 0;
  [[nodiscard]] virtual double energy() const = 0;
  [[nodiscard]] virtual double string_energy() const = 0;  ///< without a hammer that flies [J]
  [[nodiscard]] virtual bool sleeps() const = 0;           ///< is it silent until it is played?
};

/// Makes an AnyInstrument of a class that meets the concept Instrument.
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
  void prepare(double sample_rate_hz) override { instrument_.prepare(sample_rate_hz); }
  void set(std::size_t parameter, double value) override { instrument_.set(parameter, value); }
  [[nodiscard]] double value(std::size_t parameter) const override { return instrument_.value(parameter); }
  void note_on(int key, double velocity) override { instrument_.note_on(key, velocity); }
  void note_off(int key) override { instrument_.note_off(key); }
  void strike(std::size_t number, T speed_m_per_s) override { instrument_.strike(number, speed_m_per_s); }
  void release(std::size_t number) override { instrument_.release(number); }
  void pluck(std::size_t number, T force_n, double rise_s) override { instrument_.pluck(number, force_n, rise_s); }
  void process(Outputs<T> outputs, std::span<T> force) override { instrument_.process(outputs, force); }
  void reset() override { instrument_.reset(); }
  [[nodiscard]] bool is_silent(double limit_j) const override { return instrument_.is_silent(limit_j); }
  [[nodiscard]] double energy() const override { return instrument_.energy(); }
  [[nodiscard]] double string_energy() const override {
    if constexpr (requires { instrument_.string_energy(); })
      return instrument_.string_energy();
    else
      return instrument_.energy();
  }
  [[nodiscard]] bool sleeps() const override {
    return requires {
      I::kSleeps;
    };
  }

  [[nodiscard]] I& instrument() { return instrument_; }

 private:
  I instrument_;
};

}  // namespace contactspline
