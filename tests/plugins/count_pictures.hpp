// SPDX-License-Identifier: MIT
// Counts the pictures that windows of plug-ins show. In one source of a program, which exports its symbols.
#pragma once

#include <dlfcn.h>

#include "plugins/x11.hpp"

namespace contactspline::testing {
inline int pictures = 0;
}  // namespace contactspline::testing

extern "C" void glXSwapBuffers(Display* display, Window window) {
  static const auto swap =
      reinterpret_cast<void (*)(Display*, Window)>(dlsym(dlopen("libGL.so.1", RTLD_NOW), "glXSwapBuffers"));
  ++contactspline::testing::pictures;
  swap(display, window);
}
