// SPDX-License-Identifier: MIT
// Counts what is allocated by new.
#include "support/count_allocations.hpp"

#include <cstdlib>
#include <new>

namespace contactspline::testing {

std::atomic<std::size_t> allocations = 0;

namespace {

void* counted(void* memory) {
  ++allocations;
  if (memory != nullptr) return memory;
  throw std::bad_alloc();
}

}  // namespace
}  // namespace contactspline::testing

void* operator new(std::size_t size) {
  return contactspline::testing::counted(std::malloc(size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto line = static_cast<std::size_t>(alignment);
  return contactspline::testing::counted(std::aligned_alloc(line, (size + line - 1) / line * line));
}
// Libraries define this one for themselves; those of the address sanitizer would not fit the delete below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++contactspline::testing::allocations;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
