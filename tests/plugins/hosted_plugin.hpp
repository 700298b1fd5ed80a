// SPDX-License-Identifier: MIT
// What the tests ask of a plug-in, whatever its format.
#pragma once

#include <dlfcn.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "plugins/count_calls.hpp"

namespace contactspline::testing {

/// A parameter as the host sees it.
struct HostedParameter {
  std::string name, unit;
  double min, max, initial;
};

/// A plug-in in a host, stereo, in blocks of kBlock samples unless others are asked for.
class HostedPlugin {
 public:
  static constexpr std::size_t kBlock = 256, kMaxBlock = 8192;
  using Sound = std::array<std::vector<float>, 2>;

  HostedPlugin() = default;
  HostedPlugin(const HostedPlugin&) = delete;
  HostedPlugin& operator=(const HostedPlugin&) = delete;
  virtual ~HostedPlugin() = default;

  [[nodiscard]] virtual std::vector<HostedParameter> parameters() const = 0;
  /// What a host can only read.
  [[nodiscard]] virtual std::vector<HostedParameter> readings() const = 0;
  /// Of a parameter or a reading.
  [[nodiscard]] virtual double value(const std::string& parameter) = 0;
  /// So many samples after the beginning of the next block. LV2 has beginnings only.
  virtual void set(const std::string& parameter, double value, std::uint32_t time = 0) = 0;
  /// A message of MIDI, so many samples after the beginning of the next block. In the order of the times. VST3 has
  /// notes, controllers and the pitch wheel only.
  virtual void send(std::uint32_t time, std::array<std::uint8_t, 3> message) = 0;
  /// Names of the programs; empty if the format has none.
  [[nodiscard]] virtual std::vector<std::string> programs() = 0;
  virtual void load_program(std::size_t index) = 0;
  /// What a host writes into its project.
  [[nodiscard]] virtual std::string save() = 0;
  virtual void restore(std::string saved) = 0;

  /// [samples], as hosts of the format ask for it; and how often the plug-in has told that it changes. LV2 has a
  /// port.
  [[nodiscard]] virtual std::uint32_t latency() = 0;
  [[nodiscard]] virtual std::size_t latency_changes() const = 0;

  /// Opens the window in one of the host's, of X11, at a scale. Throws if it has none. The host then calls
  /// idle_window() about 60 times a second.
  virtual void open_window(std::uintptr_t parent, double scale) = 0;
  /// As the plug-in has told it. LV2 tells changes only.
  [[nodiscard]] virtual std::pair<std::uint32_t, std::uint32_t> window_size() = 0;
  /// Of LV2, hosts resize the window itself.
  virtual void resize_window(std::uint32_t width, std::uint32_t height) = 0;
  virtual void idle_window() = 0;
  virtual void close_window() = 0;
  /// Parameters that the window has moved, with the values that the host was told, in their order.
  [[nodiscard]] virtual std::vector<std::pair<std::string, double>> told() = 0;

  /// Plays so many blocks of a length up to kMaxBlock.
  [[nodiscard]] Sound run(std::size_t blocks, std::size_t length = kBlock) {
    Sound sound;
    for (auto& side : sound) side.resize(blocks * length);
    for (std::size_t begin = 0; begin < blocks * length; begin += length) {
      const std::size_t allocations_before = allocations, locks_before = locks;
      process(nullptr, {sound[0].data() + begin, sound[1].data() + begin}, static_cast<std::uint32_t>(length));
      allocated_ += allocations - allocations_before;
      locked_ += locks - locks_before;
    }
    return sound;
  }

  /// Has it an audio input? A host of VST3 activates it in this call.
  [[nodiscard]] virtual bool has_input() = 0;

  /// Plays a block under an input. is_in_place: the array of the input is that of the right side, too.
  [[nodiscard]] Sound run_under(std::vector<float> input, bool is_in_place) {
    Sound sound = {std::vector<float>(input.size()), input};
    const std::size_t allocations_before = allocations, locks_before = locks;
    process(is_in_place ? sound[1].data() : input.data(), {sound[0].data(), sound[1].data()},
            static_cast<std::uint32_t>(input.size()));
    allocated_ += allocations - allocations_before;
    locked_ += locks - locks_before;
    return sound;
  }

  /// Allocations and locks in all blocks so far.
  [[nodiscard]] std::size_t allocated() const { return allocated_; }
  [[nodiscard]] std::size_t locked() const { return locked_; }

 private:
  /// Plays a block and forgets the events. input: null where the host has none for it.
  virtual void process(float* input, std::array<float*, 2> outputs, std::uint32_t samples) = 0;

  std::size_t allocated_ = 0, locked_ = 0;
};

/// What the thread of windows hands to the audio thread. Without a lock that is counted.
template <typename T>
class HandOver {
 public:
  void push(T item) {
    const Hold hold(is_held_);
    items_.push_back(std::move(item));
  }
  /// All so far.
  [[nodiscard]] std::vector<T> take() {
    const Hold hold(is_held_);
    return std::exchange(items_, {});
  }

 private:
  struct Hold {
    explicit Hold(std::atomic_flag& flag) : is_held(flag) {
      while (is_held.test_and_set(std::memory_order_acquire)) {
      }
    }
    ~Hold() { is_held.clear(std::memory_order_release); }
    std::atomic_flag& is_held;
  };

  std::atomic_flag is_held_;
  std::vector<T> items_;
};

/// A shared library, closed at the end.
class Library {
 public:
  explicit Library(const std::filesystem::path& file) : handle_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (handle_ == nullptr) throw std::runtime_error(dlerror());
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() { dlclose(handle_); }

  template <typename Symbol>
  [[nodiscard]] Symbol* symbol(const char* name) const {
    void* const found = dlsym(handle_, name);
    if (found == nullptr) throw std::runtime_error(std::string("no symbol ") + name);
    return reinterpret_cast<Symbol*>(found);
  }
  [[nodiscard]] void* handle() const { return handle_; }

 private:
  void* handle_;
};

}  // namespace contactspline::testing
