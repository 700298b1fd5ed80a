// SPDX-License-Identifier: MIT
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "generator/cli/system.hpp"

namespace contactspline {

namespace fs = std::filesystem;

std::vector<std::string> begin_program(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a full disk or a quota is an error to report, not a reason to die
  return {argv, argv + argc};
}

bool is_terminal(std::FILE* stream) {
  return ::isatty(::fileno(stream)) != 0;
}

struct EndWaits::Before {
  sigset_t signals;
};

EndWaits::EndWaits() : before_(std::make_unique<Before>()) {
  sigset_t ending;
  ::sigemptyset(&ending);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&ending, signal);
  ::sigprocmask(SIG_BLOCK, &ending, &before_->signals);
}

EndWaits::~EndWaits() {
  ::sigprocmask(SIG_SETMASK, &before_->signals, nullptr);
}

int create_temporary(const fs::path& target, fs::path& name) {
  std::string pattern = (folder_of(target) / ".contactspline-XXXXXX").string();
  const int descriptor = ::mkstemp(pattern.data());
  name = pattern;
  return descriptor;
}

bool write_bytes(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

namespace {

// Those of the file that is replaced; for a new file rw-rw-rw- without the bits of the user's mask.
mode_t permissions_of(const fs::path& replaced) {
  struct stat old {};
  if (::stat(replaced.c_str(), &old) == 0) return old.st_mode & 07777;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

}  // namespace

bool bring_to_disk(int descriptor, const fs::path& replaced) {
  return ::fchmod(descriptor, permissions_of(replaced)) == 0 && ::fsync(descriptor) == 0;
}

// A second name of the same file, which costs nothing.
fs::path back_up(const fs::path& file) {
  fs::path name;
  const int descriptor = create_temporary(file, name);  // for a name that is free
  if (descriptor < 0) return {};
  close_file(descriptor);
  ::unlink(name.c_str());
  return ::link(file.c_str(), name.c_str()) == 0 ? name : fs::path();
}

bool close_file(int descriptor) {
  return ::close(descriptor) == 0;
}

}  // namespace contactspline
