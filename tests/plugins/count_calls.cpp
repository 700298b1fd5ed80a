// SPDX-License-Identifier: MIT
// Stands between the program with its libraries and the C library: the linker exports functions that a library that
// it links defines, too.
#include "plugins/count_calls.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <semaphore.h>

#include <cstdlib>

namespace contactspline::testing {

constinit thread_local std::size_t allocations = 0, locks = 0;

}  // namespace contactspline::testing

using contactspline::testing::allocations, contactspline::testing::locks;

extern "C" {

// glibc's own, under the names that it exports for this.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}

// A function that takes one pointer, as the next library defines it.
#define COUNTED(name, Type)                                                                      \
  int name(Type* object) {                                                                       \
    static int (*const next)(Type*) = reinterpret_cast<int (*)(Type*)>(dlsym(RTLD_NEXT, #name)); \
    ++locks;                                                                                     \
    return next(object);                                                                         \
  }
COUNTED(pthread_mutex_lock, pthread_mutex_t)
COUNTED(pthread_rwlock_rdlock, pthread_rwlock_t)
COUNTED(pthread_rwlock_wrlock, pthread_rwlock_t)
COUNTED(sem_wait, sem_t)
#undef COUNTED
}
