// SPDX-License-Identifier: MIT
// A handle that runs at a multiple of its host's rate: for contacts that are too short for it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/host/any_instrument.hpp"
#include "contactspline/step/half_band.hpp"

namespace contactspline {

/// Plays an instrument at 2, 4 or 8 times the rate of its host. Its outputs come through a Decimator, latency()
/// samples late, and so does the force, of which each sample tells the largest of those that it stands for. Its input
/// is held over each sample of the host, which is what a force over a sample means. Books and values are those of the
/// instrument, now. The constructor and prepare() allocate, nothing else.
template <std::floating_point T>
class Oversampled final : public AnyInstrument<T> {
 public:
  /// factor: one of kOversamplings.
  Oversampled(Handle<T> instrument, int factor)
      : instrument_(std::move(instrument)),
        factor_(Decimator<T>(factor).factor()),
        latency_(Decimator<T>(factor).delay()),
        decimators_(instrument_->outputs().size(), Decimator<T>(factor)),
        scratch_(decimators_.size(), std::vector<T>(kBlock * factor_)),
        finer_(decimators_.size()),
        forces_(kBlock * factor_),
        inputs_(kBlock * factor_),
        late_forces_(latency_) {}

  [[nodiscard]] std::size_t latency() const { return latency_; }  ///< [samples]

  [[nodiscard]] const char* name() const override { return instrument_->name(); }
  [[nodiscard]] const char* description() const override { return instrument_->description(); }
  [[nodiscard]] const char* license() const override { return instrument_->license(); }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return instrument_->parameters(); }
  [[nodiscard]] std::span<const Event> events() const override { return instrument_->events(); }
  [[nodiscard]] std::span<const Output> outputs() const override { return instrument_->outputs(); }
  [[nodiscard]] std::span<const Preset> presets() const override { return instrument_->presets(); }
  [[nodiscard]] std::optional<std::size_t> event_of(int key) const override { return instrument_->event_of(key); }
  [[nodiscard]] bool has_key(int key) const override { return instrument_->has_key(key); }
  [[nodiscard]] bool bends_keys() const override { return instrument_->bends_keys(); }
  [[nodiscard]] bool moves_keys(std::size_t parameter) const override { return instrument_->moves_keys(parameter); }

  void prepare(double sample_rate_hz) override {
    instrument_->prepare(sample_rate_hz * static_cast<double>(factor_));
    drop_sound();
  }
  void play(const TimedEvent& event) override { instrument_->play(event); }
  void reset() override {
    instrument_->reset();
    drop_sound();
  }
  void process(Outputs<T> outputs, std::span<T> force, std::span<const T> input = {}) override {
    std::size_t samples = force.size();
    for (const std::span<T> output : outputs) samples = (std::max)(samples, output.size());
    for (std::size_t done = 0; done < samples;) {
      const std::size_t length = (std::min)(samples - done, kBlock);
      process_block(outputs, force, input, done, length);
      done += length;
    }
  }

  [[nodiscard]] double value(std::size_t parameter) const override { return instrument_->value(parameter); }
  [[nodiscard]] bool is_silent(double limit_j) const override { return instrument_->is_silent(limit_j); }
  [[nodiscard]] bool is_at_rest(double limit_j) const override { return instrument_->is_at_rest(limit_j); }
  [[nodiscard]] double input_scale_n() const override { return instrument_->input_scale_n(); }
  [[nodiscard]] bool sleeps() const override { return instrument_->sleeps(); }
  [[nodiscard]] Books books() const override { return instrument_->books(); }
  [[nodiscard]] bool has_next() const override { return instrument_->has_next(); }

 private:
  static constexpr std::size_t kBlock = 64;  // samples of the host

  void process_block(Outputs<T> outputs, std::span<T> force, std::span<const T> input, std::size_t done,
                     std::size_t length) {
    const std::size_t finer = length * factor_;
    for (std::size_t o = 0; o < finer_.size(); ++o)
      finer_[o] = o < outputs.size() && !outputs[o].empty() ? std::span(scratch_[o]).first(finer) : std::span<T>();
    const auto forces = std::span(forces_).first(finer);
    for (std::size_t n = 0; n < (input.empty() ? 0 : finer); ++n) inputs_[n] = input[done + n / factor_];
    instrument_->process(finer_, forces, std::span<const T>(inputs_).first(input.empty() ? 0 : finer));
    for (std::size_t o = 0; o < finer_.size(); ++o)
      finer_[o].empty() ? decimators_[o].reset()
                        : decimators_[o].process(finer_[o], outputs[o].subspan(done, length));
    for (std::size_t n = 0; n < length; ++n) {
      const T largest = *std::max_element(forces.begin() + std::ptrdiff_t(n * factor_),
                                          forces.begin() + std::ptrdiff_t((n + 1) * factor_));
      const T late = delayed(largest);
      if (!force.empty()) force[done + n] = late;
    }
  }

  T delayed(T force) {
    if (late_forces_.empty()) return force;
    std::swap(late_forces_[at_], force);
    at_ = (at_ + 1) % late_forces_.size();
    return force;
  }

  void drop_sound() {
    for (Decimator<T>& decimator : decimators_) decimator.reset();
    std::fill(late_forces_.begin(), late_forces_.end(), T(0));
  }

  Handle<T> instrument_;
  std::size_t factor_, latency_;
  std::vector<Decimator<T>> decimators_;  // of the outputs
  std::vector<std::vector<T>> scratch_;
  std::vector<std::span<T>> finer_;
  std::vector<T> forces_, inputs_, late_forces_;
  std::size_t at_ = 0;  // the oldest of late_forces_
};

}  // namespace contactspline
