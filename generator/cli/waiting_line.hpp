// SPDX-License-Identifier: MIT
// A line on the terminal while something takes longer than a second.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace contactspline {

/// While one lives, and if standard error is a terminal, a line there says what takes so long: after one second and
/// then every second, with the time. It is wiped at the end. While one lives, others are silent.
class WaitingLine {
 public:
  /// what: says what takes so long; called on another thread.
  explicit WaitingLine(std::function<std::string()> what);
  explicit WaitingLine(std::string what);
  WaitingLine(const WaitingLine&) = delete;
  WaitingLine& operator=(const WaitingLine&) = delete;
  ~WaitingLine();

 private:
  void show();

  std::function<std::string()> what_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::thread thread_;
};

}  // namespace contactspline
