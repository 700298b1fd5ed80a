// SPDX-License-Identifier: MIT
// An instrument file that a plug-in plays in the place of what it was built from, read again whenever it changes. The
// library for C reads it. It is loaded when a plug-in is told to watch: others need not have it.
#pragma once

#ifndef _WIN32
#include <dlfcn.h>
#endif

#include <concepts>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
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

  [[nodiscard]] bool is_there() const { return !file_.empty(); }  ///< does the environment tell one?

  /// The instrument of the file, if this or one that it names has changed since the last call, and it can be used.
  /// Not prepared.
  [[nodiscard]] Handle<T> changed(double sample_rate_hz) {
    if (!is_there()) return nullptr;
    Files files = files_now();
    if (!files.contains(file_) || !has_changed(files)) return nullptr;
    std::ifstream stream(file_);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream || !text) return nullptr;  // the next call tries again
    seen_ = std::move(files);
    read_ = std::move(text).str();
    Handle<T> handle = read(read_, sample_rate_hz);
    if (handle) text_ = read_;
    return handle;
  }
  /// The same of the last text that could be used; null where there is none.
  [[nodiscard]] Handle<T> last(double sample_rate_hz) const {
    return text_.empty() ? nullptr : read(text_, sample_rate_hz);
  }

 private:
  struct State {
    std::filesystem::file_time_type time;
    std::uintmax_t bytes;
    bool operator==(const State&) const = default;
  };
  using Files = std::map<std::filesystem::path, State>;

  // The files of the folder: an instrument may name materials beside it.
  [[nodiscard]] Files files_now() const {
    Files files;
    std::error_code failed;
    for (std::filesystem::directory_iterator entry(file_.parent_path(), failed), end; !failed && entry != end;
         entry.increment(failed)) {
      if (entry->path().extension() != ".json") continue;
      std::error_code unknown;
      const State state{entry->last_write_time(unknown),
                        entry->is_regular_file(unknown) ? entry->file_size(unknown) : 0};
      if (!unknown) files.emplace(entry->path(), state);
    }
    if (failed) files.clear();  // what is missing would count as changed
    return files;
  }

  // Is the file another one than was seen, or one whose name stands in what was read?
  [[nodiscard]] bool has_changed(const Files& now) const {
    const auto differs = [&](const Files& files, const Files& others) {
      for (const auto& [path, state] : files)
        if (path == file_ || read_.find(path.stem().string()) != std::string::npos)
          if (const auto other = others.find(path); other == others.end() || other->second != state) return true;
      return false;
    };
    return differs(now, seen_) || differs(seen_, now);
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
  Files seen_;                  // as they were when the file was read
  std::string read_, text_;     // the last, and the last that could be used
};

}  // namespace contactspline
