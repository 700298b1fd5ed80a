// SPDX-License-Identifier: MIT
// MTS-ESP (ODDSound): a program that tunes all instruments of a session, through a library that is found while the
// plug-in runs. Without it, or while no program tunes, nothing happens.
#pragma once

#include <cstdlib>
#include <string>

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace contactspline {

/// The library, loaded once and never unloaded. The names of its functions are those of its public interface.
class MtsLibrary {
 public:
  /// Loads it where that has not been done. Not on the audio thread.
  static const MtsLibrary& get() {
    static const MtsLibrary library;
    return library;
  }

  void (*add_client)() = nullptr;
  void (*remove_client)() = nullptr;
  bool (*has_master)() = nullptr;
  const double* (*table_hz)() = nullptr;              ///< of the 128 keys
  bool (*filters)(char key, char channel) = nullptr;  ///< does a key not sound?

  [[nodiscard]] bool is_there() const {
    return add_client != nullptr && remove_client != nullptr && has_master != nullptr && table_hz != nullptr &&
           filters != nullptr;
  }

 private:
  MtsLibrary() {
    load(add_client, "MTS_RegisterClient");
    load(remove_client, "MTS_DeregisterClient");
    load(has_master, "MTS_HasMaster");
    load(table_hz, "MTS_GetTuningTable");
    load(filters, "MTS_ShouldFilterNote");
  }

  template <typename Function>
  void load(Function& function, const char* name) const {
#ifdef _WIN32
    if (library_ != nullptr)
      function = reinterpret_cast<Function>(reinterpret_cast<void*>(GetProcAddress(library_, name)));
#else
    if (library_ != nullptr) function = reinterpret_cast<Function>(dlsym(library_, name));
#endif
  }

#ifdef _WIN32
  // Where its installer puts it.
  static HMODULE open() {
    const char* const folder = std::getenv("CommonProgramFiles");
    return folder == nullptr ? nullptr : LoadLibraryA((std::string(folder) + "\\MTS-ESP\\LIBMTS.dll").c_str());
  }
  HMODULE library_ = open();
#else
  // Where its installer puts it, or where the system looks.
  static void* open() {
    void* const library = dlopen("/usr/local/lib/libMTS.so", RTLD_NOW | RTLD_LOCAL);
    return library != nullptr ? library : dlopen("libMTS.so", RTLD_NOW | RTLD_LOCAL);
  }
  void* library_ = open();
#endif
};

/// A client of it.
class MtsClient {
 public:
  MtsClient() {
    if (library_.is_there()) library_.add_client();
  }
  ~MtsClient() {
    if (library_.is_there()) library_.remove_client();
  }
  MtsClient(const MtsClient&) = delete;
  MtsClient& operator=(const MtsClient&) = delete;

  // On the audio thread.
  [[nodiscard]] bool is_tuned() const { return library_.is_there() && library_.has_master(); }
  [[nodiscard]] bool filters(int key, int channel) const {
    return library_.filters(static_cast<char>(key), static_cast<char>(channel));
  }
  [[nodiscard]] double frequency_hz(int key) const { return library_.table_hz()[key]; }

 private:
  const MtsLibrary& library_ = MtsLibrary::get();
};

}  // namespace contactspline
