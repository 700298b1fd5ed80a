// SPDX-License-Identifier: MIT
// Types for what several threads use at the same time. contactspline_plugin() puts them in place of the framework's:
// it shares plain numbers between the audio thread, the host's main thread and the window.
#pragma once

#include <atomic>
#include <cstdint>
#include <extra/RingBuffer.hpp>

START_NAMESPACE_DISTRHO

/// A value that one thread reads while another one sets it, without a lock. Stores release and loads acquire: a
/// thread that reads a value also reads what the other thread had written before it. As large as a T, for the
/// framework clears arrays of them by the size of T.
template <typename T>
class SharedValue {
 public:
  SharedValue(T value = T()) noexcept : value_(value) {}
  SharedValue(const SharedValue& other) noexcept : value_(T(other)) {}
  SharedValue& operator=(const SharedValue& other) noexcept {
    *this = T(other);
    return *this;
  }
  T operator=(T value) noexcept {
    value_.store(value, std::memory_order_release);
    return value;
  }
  operator T() const noexcept { return value_.load(std::memory_order_acquire); }

 private:
  std::atomic<T> value_;
  static_assert(std::atomic<T>::is_always_lock_free && sizeof(std::atomic<T>) == sizeof(T));
};

/// The framework's SmallStackBuffer for one thread that writes and one that reads.
struct SharedBuffer {
  static constexpr uint32_t size = SmallStackBuffer::size;
  SharedValue<uint32_t> head, tail;
  uint32_t wrtn;  // only the thread that writes uses it
  bool invalidateCommit;
  uint8_t buf[size];
};

/// The framework's SmallStackRingBuffer with such a buffer.
class SharedRingBuffer : public RingBufferControl<SharedBuffer> {
 public:
  SharedRingBuffer() noexcept { setRingBuffer(&buffer_, true); }

 private:
  SharedBuffer buffer_ = StackBuffer_INIT;
};

END_NAMESPACE_DISTRHO
