// SPDX-License-Identifier: MIT
#include "generator/cli/watched_files.hpp"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <thread>

namespace contactspline {

void WatchedFiles::add(std::span<const std::filesystem::path> files) {
  for (const auto& file : files) seen_.try_emplace(file, state_of(file));
}

// Nothing where there is no file, or an empty one, which is about to be written.
WatchedFiles::State WatchedFiles::state_of(const std::filesystem::path& file) {
  std::error_code no_time, no_size;
  const auto time = std::filesystem::last_write_time(file, no_time);
  const auto size = std::filesystem::file_size(file, no_size);
  return no_time || no_size || size == 0 ? State() : State({time, size});
}

WatchedFiles::States WatchedFiles::states_now() const {
  States states;
  for (const auto& [file, seen] : seen_) states.emplace(file, state_of(file));
  return states;
}

void WatchedFiles::wait_for_change() {
  constexpr auto kPause = std::chrono::milliseconds(10);
  const auto exists = [](const States::value_type& file) { return file.second.has_value(); };
  for (States before = seen_;;) {
    std::this_thread::sleep_for(kPause);
    States now = states_now();
    if (now != seen_ && now == before && std::ranges::all_of(now, exists)) {
      seen_ = std::move(now);
      return;
    }
    before = std::move(now);
  }
}

}  // namespace contactspline
