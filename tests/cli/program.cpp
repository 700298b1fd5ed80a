// SPDX-License-Identifier: MIT
#include "program.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "generator/cli/command_line.hpp"

namespace contactspline::testing {
namespace {

// While one lives, the working folder and these variables of the environment are others.
class Surroundings {
 public:
  Surroundings(const fs::path& folder, const std::map<std::string, std::string>& environment)
      : folder_(fs::current_path()) {
    for (const auto& [name, value] : environment) {
      const char* old = std::getenv(name.c_str());
      old_[name] = old == nullptr ? std::nullopt : std::optional<std::string>(old);
      ::setenv(name.c_str(), value.c_str(), 1);
    }
    if (!folder.empty()) fs::current_path(folder);
  }
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;
  ~Surroundings() {
    std::error_code ignored;
    fs::current_path(folder_, ignored);
    for (const auto& [name, value] : old_)
      value ? ::setenv(name.c_str(), value->c_str(), 1) : ::unsetenv(name.c_str());
  }

 private:
  fs::path folder_;
  std::map<std::string, std::optional<std::string>> old_;
};

// Does a call ask for nothing that only a process of its own can have?
bool fits_in_process(const Call& call) {
  return call.program == kProgram && !call.largest_file_bytes && call.standard_input == "/dev/null" &&
         call.standard_output.empty() && !call.umask && !call.as_nobody && !call.traced;
}

}  // namespace

CapturedStream::CapturedStream(std::FILE* stream, const char* name)
    : stream_(stream), saved_(::dup(::fileno(stream))), file_(::memfd_create(name, MFD_CLOEXEC)) {
  if (saved_ < 0 || file_ < 0) throw std::runtime_error("no place to capture a stream");
  std::fflush(stream_);
  ::dup2(file_, ::fileno(stream_));
}

CapturedStream::~CapturedStream() {
  std::fflush(stream_);
  ::dup2(saved_, ::fileno(stream_));
  ::close(saved_);
  ::close(file_);
}

std::string CapturedStream::text() const {
  std::fflush(stream_);
  std::string text(static_cast<std::size_t>(::lseek(file_, 0, SEEK_END)), '\0');
  if (::pread(file_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
    throw std::runtime_error("a captured stream cannot be read");
  return text;
}

std::string hammer_score(const std::string& resonator, const std::string& material, double duration_s, double mass_kg,
                         const std::string& more) {
  return fmt::format(R"({{ "instrument": {{ "name": "probe",
      "bodies": [ {{ "name": "string", "resonator": "{}" }}, {{ "name": "hammer", "mass_kg": {} }} ],
      "places": [ {{ "name": "struck", "body": "string", "position_m": 0.0744 }} ],
      "contacts": [ {{ "name": "felt", "between": ["hammer", "struck"], "material": "{}", "gap_m": 1e-4 }} ],
      "strikes": ["hammer"],
      "outputs": [ {{ "name": "string", "end_force_n": "string" }}, {{ "name": "felt", "force_n": "felt" }} ] }},
    "duration_s": {}, {}"events": [ {{ "time_s": 0.01, "hammer_speed_m_per_s": 2.5 }} ] }})",
                     resonator, mass_kg, material, duration_s, more);
}

Words followed_by(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Process::Process(const Call& call) {
  for (Stream& stream : streams_)
    if (::pipe2(stream.ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ == 0) become(call);
  for (const Stream& stream : streams_) ::close(stream.writing());
}

Process::~Process() {
  if (pid_ > 0) kill(), wait();
  for (const Stream& stream : streams_) ::close(stream.reading());
}

void Process::kill() const {
  ::kill(pid_, SIGKILL);
}

std::size_t Process::kill_at_stop(std::size_t stop) {
  for (std::size_t stops = 0;; ++stops) {
    int status = 0;
    if (::waitpid(pid_, &status, 0) < 0) throw std::runtime_error("waitpid failed");
    if (!WIFSTOPPED(status)) pid_ = -1;
    if (WIFSTOPPED(status) && stops == stop) kill();
    if (!WIFSTOPPED(status) || stops == stop) return stops;
    const long signal = WSTOPSIG(status) == SIGTRAP ? 0 : WSTOPSIG(status);
    ::ptrace(PTRACE_SYSCALL, pid_, nullptr, signal);
  }
}

void Process::terminate_at_stop(std::size_t stop) {
  for (std::size_t stops = 0;; ++stops) {
    int status = 0;
    if (::waitpid(pid_, &status, 0) < 0) throw std::runtime_error("waitpid failed");
    if (!WIFSTOPPED(status)) {
      pid_ = -1;
      return;
    }
    if (stops == stop) ::kill(pid_, SIGTERM);
    const long signal = WSTOPSIG(status) == SIGTRAP ? 0 : WSTOPSIG(status);
    ::ptrace(PTRACE_SYSCALL, pid_, nullptr, signal);
  }
}

Outcome Process::wait() {
  read_streams();
  int status = 0;
  if (::waitpid(std::exchange(pid_, -1), &status, 0) < 0) throw std::runtime_error("waitpid failed");
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), streams_[0].text, streams_[1].text};
}

void Process::become(const Call& call) const {
  const int out =
      call.standard_output.empty() ? streams_[0].writing() : ::open(call.standard_output.c_str(), O_WRONLY);
  ::dup2(::open(call.standard_input.c_str(), O_RDONLY), STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(streams_[1].writing(), STDERR_FILENO);
  for (const auto& [name, value] : call.environment) ::setenv(name.c_str(), value.c_str(), 1);
  if (call.umask) ::umask(*call.umask);
  if (!call.folder.empty() && ::chdir(call.folder.c_str()) != 0) ::_exit(kNotStarted);
  if (call.as_nobody && ::geteuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) ::_exit(kNotStarted);
  if (call.largest_file_bytes) {
    const rlimit limit{*call.largest_file_bytes, *call.largest_file_bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (call.traced && ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) ::_exit(kNotStarted);
  std::vector<char*> words{const_cast<char*>(call.program.c_str())};
  for (const auto& argument : call.arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execvp(words.front(), words.data());
  ::_exit(kNotStarted);
}

// Both at once: a program that fills one waits until it is read.
void Process::read_streams() {
  std::array<pollfd, 2> open{};
  for (std::size_t i = 0; i < 2; ++i) open[i] = {streams_[i].reading(), POLLIN, 0};
  while ((open[0].fd >= 0 || open[1].fd >= 0) && ::poll(open.data(), open.size(), -1) > 0)
    for (std::size_t i = 0; i < 2; ++i)
      if (open[i].revents != 0 && !read_some(streams_[i])) open[i].fd = -1;
}

bool Process::read_some(Stream& stream) {
  std::array<char, 65536> part{};
  const ssize_t got = ::read(stream.reading(), part.data(), part.size());
  if (got > 0) stream.text.append(part.data(), static_cast<std::size_t>(got));
  return got > 0;
}

Outcome run_program(const Call& call) {
  return Process(call).wait();
}

Outcome run_in_process(const Call& call) {
  std::vector<const char*> words{"contactspline"};
  for (const auto& argument : call.arguments) words.push_back(argument.c_str());
  const int count = static_cast<int>(words.size());
  words.push_back(nullptr);
  const Surroundings surroundings(call.folder, call.environment);
  const CapturedStream out(stdout, "stdout"), err(stderr, "stderr");
  const int exit_code = run_command_line(count, words.data());
  return {exit_code, out.text(), err.text()};
}

Outcome run(const Call& call) {
  return fits_in_process(call) ? run_in_process(call) : run_program(call);
}

std::string succeed(const Outcome& outcome) {
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return outcome.out;
}

std::string succeed(const Call& call) {
  return succeed(run(call));
}

void expect_refused(const Outcome& outcome, std::string_view beginning, std::string_view says) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_TRUE(outcome.out.empty()) << outcome.out.substr(0, 500);
  EXPECT_TRUE(outcome.err.starts_with("contactspline: " + std::string(beginning))) << outcome.err;
  EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err << "does not say: " << says;
  EXPECT_TRUE(outcome.err.ends_with('\n'));
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  EXPECT_EQ(std::ranges::count_if(outcome.err, is_control), 1) << "more than one line, or control characters";
  EXPECT_LT(outcome.err.size(), 1000u);
}

}  // namespace contactspline::testing
