// SPDX-License-Identifier: MIT
// A program that runs beside the test and never outlives it.
#pragma once

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace contactspline::testing {

class ChildProcess {
 public:
  /// Starts a program with its arguments, its output in a file.
  ChildProcess(std::vector<std::string> command, const std::string& output_file) {
    int input[2];
    if (pipe(input) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);  // whatever becomes of the test
      if (getppid() != parent) _exit(126);
      dup2(input[0], STDIN_FILENO);
      close(input[0]);
      close(input[1]);
      if (!freopen(output_file.c_str(), "w", stdout)) _exit(126);
      dup2(STDOUT_FILENO, STDERR_FILENO);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
    close(input[0]);
    input_ = input[1];
    if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  ~ChildProcess() {
    close(input_);
    if (!is_running()) return;
    kill(pid_, SIGTERM);
    if (exit_code(std::chrono::seconds(3))) return;
    kill(pid_, SIGKILL);
    (void)exit_code(std::chrono::seconds(3));
  }

  [[nodiscard]] pid_t process() const { return pid_; }

  /// Types at it.
  void write(const std::string& text) {
    if (::write(input_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      throw std::system_error(errno, std::generic_category(), "write");
  }

  [[nodiscard]] bool is_running() {
    if (!status_) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) == pid_) status_ = status;
    }
    return !status_;
  }

  /// What it exits with, 128 + n where signal n ended it; nothing if it does not end within a time.
  [[nodiscard]] std::optional<int> exit_code(std::chrono::milliseconds max) {
    const auto end = std::chrono::steady_clock::now() + max;
    while (is_running()) {
      if (std::chrono::steady_clock::now() > end) return {};
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return WIFEXITED(*status_) ? WEXITSTATUS(*status_) : 128 + WTERMSIG(*status_);
  }

 private:
  pid_t pid_ = -1;
  int input_ = -1;
  std::optional<int> status_;
};

}  // namespace contactspline::testing
