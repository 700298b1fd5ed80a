// SPDX-License-Identifier: MIT
// Waiting until a file changes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace contactspline {

/// Files and the states in which they were last seen: time of the last change, and size.
class WatchedFiles {
 public:
  /// Adds files in their states of now. Those that are watched already keep the states they were seen in.
  void add(std::span<const std::filesystem::path> files);

  /// Waits until one of the files exists in another state than before, and all of them stayed as they are for 10 ms:
  /// what writes a file in parts, or removes it first, is waited for.
  void wait_for_change();

 private:
  using State = std::optional<std::pair<std::filesystem::file_time_type, std::uintmax_t>>;
  using States = std::map<std::filesystem::path, State>;

  [[nodiscard]] static State state_of(const std::filesystem::path& file);
  [[nodiscard]] States states_now() const;

  States seen_;
};

}  // namespace contactspline
