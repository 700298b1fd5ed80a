// SPDX-License-Identifier: MIT
// A handle whose instrument is replaced by another one while it plays.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "contactspline/data/timed_event.hpp"
#include "contactspline/host/any_instrument.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// Plays an instrument until another thread offers the next one, which takes its place at the next event or block.
/// The old one, and what it still rings, fades out within kFade_s while the new one fades in; the sum of both gains
/// is 1. Where the old one is silent, or has not sounded since it was brought to rest, the new one is there at once.
/// Keys that are held are held in the old one only: the new one plays what begins from then on. The lists stay those
/// of the first instrument, which lives as long as this. The others are played by the names that they share with it:
/// parameters that have been set keep their values, outputs that are missing are 0. A parameter that has not been set
/// has the first value of the new instrument. An input pushes all that have one, by the full scale of the first. The
/// constructor, prepare() and offer() allocate, nothing else; only they and the destructor delete. No lock.
template <std::floating_point T>
class Replaceable final : public AnyInstrument<T> {
 public:
  static constexpr double kFade_s = 0.01;

  explicit Replaceable(Handle<T> first)
      : first_(std::make_unique<Player>(std::move(first), nullptr)),
        now_(first_.get()),
        set_(parameters().size()),
        mixed_(outputs().size()),
        scratch_(outputs().size()),
        fading_(outputs().size()) {}
  ~Replaceable() override {
    let_go(old_);
    let_go(now_);
    let_go(offered_.load());
    delete_retired();
  }

  /// Offers an instrument that is prepared at the rate of this one. On any thread but that of play() and process(),
  /// by one thread at a time. One that was offered before and has not begun to play is deleted, and those that have
  /// ended. Where memory is missing, it throws and `next` stays the caller's.
  void offer(Handle<T>&& next) {
    delete_retired();
    auto player = std::make_unique<Player>(std::move(next), first_->handle.get());
    pass_on_values(*player);
    let_go(offered_.exchange(player.release(), std::memory_order_acq_rel));
  }

  [[nodiscard]] const char* name() const override { return first().name(); }
  [[nodiscard]] const char* description() const override { return first().description(); }
  [[nodiscard]] const char* license() const override { return first().license(); }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return first().parameters(); }
  [[nodiscard]] std::span<const Event> events() const override { return first().events(); }
  [[nodiscard]] std::span<const Output> outputs() const override { return first().outputs(); }
  [[nodiscard]] std::span<const Preset> presets() const override { return first().presets(); }
  [[nodiscard]] std::optional<std::size_t> event_of(int key) const override { return first().event_of(key); }
  [[nodiscard]] bool has_key(int key) const override { return first().has_key(key); }
  [[nodiscard]] bool bends_keys() const override { return first().bends_keys(); }
  [[nodiscard]] bool moves_keys(std::size_t parameter) const override { return first().moves_keys(parameter); }

  /// Not on the audio thread. What is offered takes its place without a fade.
  void prepare(double sample_rate_hz) override {
    fade_ = static_cast<std::size_t>((std::max)(1.0, std::round(kFade_s * sample_rate_hz)));
    end_fade();
    if (Player* const next = offered_.exchange(nullptr, std::memory_order_acq_rel)) begin(next);
    end_fade();
    now_->handle->prepare(sample_rate_hz);
    has_sounded_ = false;
  }

  void play(const TimedEvent& event) override {
    take();
    if (event.action == Action::kSet && event.number < set_.size() && is_number(event.value)) {
      set_[event.number].value.store(event.value, std::memory_order_relaxed);
      set_[event.number].is_known.store(true, std::memory_order_release);
    }
    has_sounded_ |= event.action != Action::kSet;
    if (const auto own = now_->own_event(event)) now_->handle->play(*own);
  }

  void process(Outputs<T> outputs, std::span<T> force, std::span<const T> input = {}) override {
    take();
    has_sounded_ = true;
    std::size_t samples = force.size(), done = 0;
    for (const std::span<T> output : outputs) samples = (std::max)(samples, output.size());
    while (old_ != nullptr && done < samples) {
      const std::size_t length = (std::min)({samples - done, kBlock, fade_ - faded_});
      mix(outputs, force, input, done, length);
      done += length;
    }
    if (done == 0) return now_->process(outputs, force, input);
    const std::size_t rest = samples - done;
    if (rest > 0) now_->process(part_of(outputs, done, rest), part_of(force, done, rest), part_of(input, done, rest));
  }

  void reset() override {
    end_fade();
    take();
    end_fade();
    now_->handle->reset();
    has_sounded_ = false;
  }

  [[nodiscard]] double value(std::size_t parameter) const override {
    const std::size_t own = now_->parameters[parameter];
    if (own != kNone) return now_->handle->value(own);
    return set_[parameter].is_known ? set_[parameter].value.load() : first().value(parameter);
  }
  [[nodiscard]] bool is_silent(double limit_j) const override {
    return old_ == nullptr && now_->handle->is_silent(limit_j);
  }
  [[nodiscard]] bool is_at_rest(double limit_j) const override {
    return old_ == nullptr && now_->handle->is_at_rest(limit_j);
  }
  [[nodiscard]] double input_scale_n() const override { return first().input_scale_n(); }
  [[nodiscard]] bool sleeps() const override { return first().sleeps(); }
  [[nodiscard]] Books books() const override { return now_->handle->books(); }
  [[nodiscard]] bool has_next() const override { return offered_.load(std::memory_order_relaxed) != nullptr; }

 private:
  static constexpr std::size_t kBlock = 64;  // samples
  static constexpr std::size_t kNone = ~std::size_t(0);
  static constexpr double kSilent_J = 1e-24;  // as Sleeper has it

  // Where the rows of a list stand in another one, by name.
  template <typename Row>
  static std::vector<std::size_t> places(std::span<const Row> list, std::span<const Row> other) {
    std::vector<std::size_t> places;
    for (const Row& row : list) {
      const auto at = std::ranges::find(other, std::string_view(row.name), &Row::name);
      places.push_back(at == other.end() ? kNone : static_cast<std::size_t>(at - other.begin()));
    }
    return places;
  }

  /// An instrument that is played by the lists of the first one.
  struct Player {
    // Takes the instrument last, when nothing can fail any more.
    Player(Handle<T>&& instrument, const AnyInstrument<T>* first)
        : played_as(first != nullptr ? *first : *instrument),
          parameters(places(played_as.parameters(), instrument->parameters())),
          events(places(played_as.events(), instrument->events())),
          outputs(places(played_as.outputs(), instrument->outputs())),
          spans(instrument->outputs().size()),
          handle(std::move(instrument)) {}

    /// The event by this one's own numbers; nothing where it has none.
    [[nodiscard]] std::optional<TimedEvent> own_event(TimedEvent event) const {
      if (event.action == Action::kSet) {
        if (event.number >= parameters.size() || parameters[event.number] == kNone) return {};
        event.number = parameters[event.number];
      } else if (event.action == Action::kMoveKey) {
        if (event.parameter >= parameters.size() || parameters[event.parameter] == kNone) return {};
        event.parameter = parameters[event.parameter];
      } else if (event.action == Action::kStrike || event.action == Action::kRelease ||
                 event.action == Action::kPluck) {
        const EventKind kind = event.action == Action::kPluck ? EventKind::kPluck : EventKind::kStrike;
        const auto listed = played_as.events();
        for (std::size_t e = 0; e < listed.size(); ++e) {
          if (listed[e].kind != kind || listed[e].number != event.number) continue;
          if (events[e] == kNone || handle->events()[events[e]].kind != kind) return {};
          event.number = handle->events()[events[e]].number;
          return event;
        }
      }
      return event;
    }

    void process(Outputs<T> wanted, std::span<T> force, std::span<const T> input) {
      std::size_t samples = force.size();
      std::ranges::fill(spans, std::span<T>());
      bool is_any = !force.empty();
      for (std::size_t o = 0; o < outputs.size() && o < wanted.size(); ++o) {
        samples = (std::max)(samples, wanted[o].size());
        if (outputs[o] == kNone) {
          std::ranges::fill(wanted[o], T(0));
        } else {
          spans[outputs[o]] = wanted[o];
          is_any |= !wanted[o].empty();
        }
      }
      if (is_any) return handle->process(spans, force, input);
      // It advances by the length of its outputs: where it has none of those that are wanted, it writes the first.
      for (std::size_t done = 0; done < samples; done += kBlock) {
        const std::size_t length = (std::min)(kBlock, samples - done);
        spans.front() = std::span(unwanted).first(length);
        handle->process(spans, force, part_of(input, done, length));
      }
    }

    const AnyInstrument<T>& played_as;
    std::vector<std::size_t> parameters, events, outputs;  // its own numbers, of the lists that it is played by
    std::vector<std::span<T>> spans;
    Handle<T> handle;
    std::array<T, kBlock> unwanted;
    Player* next_retired = nullptr;
  };

  // A parameter that has been set; other threads read it.
  struct Set {
    std::atomic<double> value = 0;
    std::atomic<bool> is_known = false;
  };

  [[nodiscard]] const AnyInstrument<T>& first() const { return *first_->handle; }

  void pass_on_values(Player& player) const {
    for (std::size_t p = 0; p < set_.size(); ++p) {
      if (player.parameters[p] == kNone || !set_[p].is_known.load(std::memory_order_acquire)) continue;
      const double value = set_[p].value.load(std::memory_order_relaxed);
      if (player.handle->value(player.parameters[p]) != value) player.handle->set(player.parameters[p], value);
    }
  }

  void take() {
    if (old_ != nullptr || !has_next()) return;
    if (Player* const next = offered_.exchange(nullptr, std::memory_order_acq_rel)) begin(next);
  }

  void begin(Player* next) {
    pass_on_values(*next);  // what has been set since it was offered
    old_ = std::exchange(now_, next);
    faded_ = 0;
    if (!has_sounded_ || old_->handle->is_silent(kSilent_J)) end_fade();
  }

  void end_fade() {
    if (old_ == nullptr) return;
    old_->next_retired = retired_.load(std::memory_order_relaxed);
    while (!retired_.compare_exchange_weak(old_->next_retired, old_, std::memory_order_release,
                                           std::memory_order_relaxed)) {
    }
    old_ = nullptr;
  }

  // Whoever plays adds to the list; who offers takes all of it.
  void delete_retired() {
    for (Player* player = retired_.exchange(nullptr, std::memory_order_acquire); player != nullptr;)
      let_go(std::exchange(player, player->next_retired));
  }
  void let_go(Player* player) {
    if (player != first_.get()) delete player;
  }

  // Advances both by at most kBlock samples.
  void mix(Outputs<T> outputs, std::span<T> force, std::span<const T> input, std::size_t done, std::size_t length) {
    const Outputs<T> wanted = part_of(outputs, done, length);
    const std::span<T> wanted_force = part_of(force, done, length);
    input = part_of(input, done, length);
    now_->process(wanted, wanted_force, input);
    for (std::size_t o = 0; o < fading_.size(); ++o)
      fading_[o] = o < wanted.size() && !wanted[o].empty() ? std::span(scratch_[o]).first(length) : std::span<T>();
    const std::span<T> fading_force = std::span(scratch_force_).first(wanted_force.size());
    old_->process(fading_, fading_force, input);
    for (std::size_t n = 0; n < length; ++n) {
      const double x = static_cast<double>(++faded_) / static_cast<double>(fade_);
      const T old_part = static_cast<T>(1 - x * x * (3 - 2 * x));
      const auto blend = [&](T& now, T old) { now += old_part * (old - now); };
      for (std::size_t o = 0; o < fading_.size(); ++o)
        if (!fading_[o].empty()) blend(wanted[o][n], fading_[o][n]);
      if (!wanted_force.empty()) blend(wanted_force[n], fading_force[n]);
    }
    if (faded_ == fade_) end_fade();
  }

  template <typename X>
  static std::span<X> part_of(std::span<X> all, std::size_t begin, std::size_t length) {
    return all.empty() ? all : all.subspan(begin, length);
  }
  Outputs<T> part_of(Outputs<T> outputs, std::size_t begin, std::size_t length) {
    for (std::size_t o = 0; o < mixed_.size(); ++o)
      mixed_[o] = o < outputs.size() ? part_of(outputs[o], begin, length) : std::span<T>();
    return mixed_;
  }

  std::unique_ptr<Player> first_;
  Player* now_;
  Player* old_ = nullptr;  // that fades out
  std::atomic<Player*> offered_ = nullptr, retired_ = nullptr;
  bool has_sounded_ = false;          // since it was brought to rest
  std::vector<Set> set_;              // of the parameters
  std::size_t fade_ = 1, faded_ = 0;  // samples
  std::vector<std::span<T>> mixed_;
  std::vector<std::array<T, kBlock>> scratch_;  // of the one that fades out
  std::vector<std::span<T>> fading_;
  std::array<T, kBlock> scratch_force_;
};

}  // namespace contactspline
