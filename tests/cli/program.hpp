// SPDX-License-Identifier: MIT
// The command line as a user runs it: arguments, folder, environment and limits in; exit code and streams out. run()
// calls it within the test where it can; run_program() starts the built program.
#pragma once

#include <sys/resource.h>

#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sandbox.hpp"

namespace contactspline::testing {

constexpr auto kProgram = CONTACTSPLINE_PROGRAM;

/// A short score of one blow.
constexpr auto kStroke = R"({
  "instrument": "trichord_c4", "duration_s": 0.05, "events": [ { "time_s": 0, "hammer_speed_m_per_s": 2 } ] })";

/// A score of one blow, of a hammer of a material on a resonator: names or files. Its outputs are the force on the
/// end of a string and that of the felt. more: keys of the score.
std::string hammer_score(const std::string& resonator, const std::string& material, double duration_s = 0.05,
                         double mass_kg = 0.003, const std::string& more = "");

using Words = std::vector<std::string>;

Words followed_by(Words words, const Words& more);

struct Call {
  Words arguments;
  fs::path folder = {};                                 ///< to run in
  std::map<std::string, std::string> environment = {};  ///< beside or instead of ours
  std::optional<rlim_t> largest_file_bytes = {};        ///< stands for a full disk
  fs::path standard_input = "/dev/null";
  fs::path standard_output = {};  ///< instead of being captured
  std::optional<mode_t> umask = {};
  bool as_nobody = false;  ///< root reads what it likes
  bool traced = false;     ///< for Process::kill_at_stop
  std::string program = kProgram;
};

struct Outcome {
  int exit_code;  ///< minus the signal that ended it
  std::string out, err;
};

constexpr int kNotStarted = 127;

class Process {
 public:
  explicit Process(const Call& call);
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  void kill() const;

  /// Lets a traced program go on to the `stop`-th time it enters or leaves a system call, and kills it there. Returns
  /// the number of times it got to: fewer where it ended before.
  std::size_t kill_at_stop(std::size_t stop);

  /// Sends a traced program SIGTERM the `stop`-th time it enters or leaves a system call, and waits for its end.
  void terminate_at_stop(std::size_t stop);

  Outcome wait();

 private:
  struct Stream {
    std::array<int, 2> ends{};
    std::string text;

    [[nodiscard]] int reading() const { return ends[0]; }
    [[nodiscard]] int writing() const { return ends[1]; }
  };

  [[noreturn]] void become(const Call& call) const;
  void read_streams();
  static bool read_some(Stream& stream);

  std::array<Stream, 2> streams_;
  pid_t pid_ = -1;
};

/// Starts the program and waits for its end.
Outcome run_program(const Call& call);

/// While one lives, what is written to a stream goes to a file in memory.
class CapturedStream {
 public:
  CapturedStream(std::FILE* stream, const char* name);
  CapturedStream(const CapturedStream&) = delete;
  CapturedStream& operator=(const CapturedStream&) = delete;
  ~CapturedStream();

  [[nodiscard]] std::string text() const;

 private:
  std::FILE* stream_;
  int saved_, file_;
};

/// Runs the command line within the test.
Outcome run_in_process(const Call& call);

/// Within the test if possible, which takes a hundredth of the time.
Outcome run(const Call& call);

/// Exit code 0 and nothing on standard error; returns what was printed.
std::string succeed(const Outcome& outcome);
std::string succeed(const Call& call);

/// The contract of bad input: exit code 2, nothing on standard output and one readable line on standard error that
/// begins with "contactspline: `beginning`" and holds `says`.
void expect_refused(const Outcome& outcome, std::string_view beginning, std::string_view says);

}  // namespace contactspline::testing
