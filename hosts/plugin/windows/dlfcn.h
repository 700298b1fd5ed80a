// SPDX-License-Identifier: MIT
// The functions of POSIX that load a library, by those of Windows: a folder for the include path of Windows alone.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

constexpr int RTLD_NOW = 0, RTLD_LOCAL = 0;

/// Null, and a text for dlerror(), where the library cannot be loaded.
inline void* dlopen(const std::filesystem::path& file, int) {
  return reinterpret_cast<void*>(LoadLibraryW(file.c_str()));
}

inline void* dlsym(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}

inline int dlclose(void* library) {
  return FreeLibrary(static_cast<HMODULE>(library)) ? 0 : -1;
}

/// The last error of this thread.
inline const char* dlerror() {
  static thread_local std::string text;
  text = std::system_category().message(static_cast<int>(GetLastError()));
  return text.c_str();
}
