// SPDX-License-Identifier: MIT
// An instrument file that a plug-in plays in the place of what it was built from, read again whenever it changes. The
// library for C reads it. It is loaded when a plug-in is told to watch: others need not have it.
#pragma once

#ifndef _WIN32
#include <dlfcn.h>
#endif

#include <concepts>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>

#include "contactspline/host/any_instrument.hpp"
#include "contactspline/host/model_module.hpp"
#include "contactspline/step/version.hpp"

namespace contactspline {

/// The file NAME.json in the folder that the variable CONTACTSPLINE_WATCH of the environment tells, if it does. What
/// is wrong with it is a line on standard error. Not for the audio thread.
template <std::floating_point T>
class WatchedFile {
 public:
  explicit WatchedFile(const std::string& instrument) {
    const char* const folder = std::getenv("CONTACTSPLINE_WATCH");
    if (folder != nullptr && *folder != '\0') file_ = std::filesystem::path(folder) / (instrument + ".json");
  }

  /// The instrument of the file, if this or another one of its folder has changed since the last call, and it can be
  /// used. Not prepared.
  [[nodiscard]] Handle<T> changed(double sample_rate_hz) {
    if (file_.empty() || !is_newer()) return nullptr;
    std::ifstream stream(file_);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) return nullptr;
    Handle<T> handle = read(text, sample_rate_hz);
    if (handle) text_ = std::move(text);
    return handle;
  }
  /// The same of the last text that could be used; null where there is none.
  [[nodiscard]] Handle<T> last(double sample_rate_hz) const {
    return text_.empty() ? nullptr : read(text_, sample_rate_hz);
  }

 private:
  using Time = std::filesystem::file_time_type;

  [[nodiscard]] bool is_newer() {
    const Time time = newest();
    return time != std::exchange(seen_, time);
  }

  // When a file of the folder has changed last: an instrument may name materials beside it.
  [[nodiscard]] Time newest() const {
    Time newest = Time::min();
    std::error_code failed;
    for (const auto& entry : std::filesystem::directory_iterator(file_.parent_path(), failed))
      if (entry.path().extension() == ".json")
        if (const Time time = entry.last_write_time(failed); !failed && time > newest) newest = time;
    return newest;
  }

  // Of the library for C, which stays loaded; null where it is missing, as it always is on Windows.
  static void* function([[maybe_unused]] const char* name) {
#ifdef _WIN32
    return nullptr;
#else
    static void* const library = ::dlopen("libcontactspline.so.0", RTLD_NOW | RTLD_LOCAL);
    return library == nullptr ? nullptr : ::dlsym(library, name);
#endif
  }

  [[nodiscard]] Handle<T> read(const std::string& text, double sample_rate_hz) const {
    void* const get = function("contactspline_handle");
    if (get == nullptr) {
      std::fprintf(stderr,
                   "contactspline: CONTACTSPLINE_WATCH: libcontactspline.so.0 of version %d.%d.%d is missing\n",
                   kVersionMajor, kVersionMinor, kVersionPatch);
      return nullptr;
    }
    void* const made = reinterpret_cast<GetHandle*>(get)(text.c_str(), file_.string().c_str(), sample_rate_hz,
                                                         std::is_same_v<T, float> ? 1 : 0, ModelModule());
    if (made == nullptr)
      std::fprintf(stderr, "contactspline: %s\n",
                   reinterpret_cast<const char* (*)()>(function("contactspline_last_error"))());
    return Handle<T>(static_cast<AnyInstrument<T>*>(made));
  }

  std::filesystem::path file_;  // empty: nobody watches
  Time seen_ = Time::min();
  std::string text_;  // the last that could be used
};

}  // namespace contactspline
