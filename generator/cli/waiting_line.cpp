// SPDX-License-Identifier: MIT
#include "generator/cli/waiting_line.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <utility>

#include "generator/cli/system.hpp"

namespace contactspline {

namespace {

std::atomic<bool> one_lives = false;

}  // namespace

WaitingLine::WaitingLine(std::function<std::string()> what) : what_(std::move(what)) {
  if (is_terminal(stderr) && !one_lives.exchange(true)) thread_ = std::thread([this] { show(); });
}

WaitingLine::WaitingLine(std::string what) : WaitingLine([what = std::move(what)] { return what; }) {}

WaitingLine::~WaitingLine() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    has_ended_ = true;
  }
  ended_.notify_one();
  thread_.join();
  one_lives = false;
}

void WaitingLine::show() {
  std::unique_lock lock(mutex_);
  int seconds = 0;
  while (!ended_.wait_for(lock, std::chrono::seconds(1), [this] { return has_ended_; }))
    std::fputs(fmt::format("\r{}: {} s\x1b[K", what_(), ++seconds).c_str(), stderr);
  if (seconds > 0) std::fputs("\r\x1b[K", stderr);
}

}  // namespace contactspline
