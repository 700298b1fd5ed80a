// SPDX-License-Identifier: MIT
// The line that says what takes so long, on a terminal and on none.
#include "generator/cli/waiting_line.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "generator/cli/parallel.hpp"
#include "program.hpp"

namespace contactspline::testing {
namespace {

/// What a task, which gets its file, leaves on a terminal.
template <typename Task>
std::string on_terminal(Task task) {
  int terminal = -1, end = -1;
  if (::openpty(&terminal, &end, nullptr, nullptr, nullptr) != 0) throw std::runtime_error("no terminal");
  const int saved = ::dup(STDERR_FILENO);
  ::dup2(end, STDERR_FILENO);
  task(terminal);
  std::fflush(stderr);
  ::dup2(saved, STDERR_FILENO);
  ::close(saved);
  ::close(end);
  std::string text;
  std::array<char, 4096> part;
  for (ssize_t got; (got = ::read(terminal, part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  ::close(terminal);
  return text;
}

TEST(WaitingLine, ComesAfterASecondAndIsWiped) {
  const std::string text = on_terminal([](int terminal) {
    const WaitingLine line("designing my_felt.json");
    pollfd written{terminal, POLLIN, 0};
    EXPECT_EQ(::poll(&written, 1, 60'000), 1);
  });
  EXPECT_TRUE(text.starts_with("\rdesigning my_felt.json: 1 s")) << text;
  EXPECT_TRUE(text.ends_with("\r\x1b[K")) << text;
}

// Tasks have lines of their own, which are silent meanwhile.
TEST(WaitingLine, OfSeveralFilesCountsThem) {
  const std::string text = on_terminal([](int terminal) {
    in_parallel(3, 2, "emitted", [&](std::size_t i) {
      if (i == 0) return;
      const WaitingLine line("emitting my_felt.json");
      pollfd written{terminal, POLLIN, 0};
      EXPECT_EQ(::poll(&written, 1, 60'000), 1);
      std::this_thread::sleep_for(std::chrono::milliseconds(300));  // a second line would be here by now
    });
  });
  EXPECT_TRUE(text.starts_with("\remitted 1 of 3 files: 1 s")) << text;
  EXPECT_EQ(text.find("my_felt"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("\r\x1b[K")) << text;
}

TEST(WaitingLine, DoesNotComeWhereNothingTakesLong) {
  EXPECT_EQ(on_terminal([](int) { const WaitingLine line("designing my_felt.json"); }), "");
}

TEST(WaitingLine, StaysOutOfFiles) {
  const CapturedStream err(stderr, "stderr");
  {
    const WaitingLine line("designing my_felt.json");
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  }
  EXPECT_EQ(err.text(), "");
}

}  // namespace
}  // namespace contactspline::testing
