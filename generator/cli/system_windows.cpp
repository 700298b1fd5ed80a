// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <mutex>
#include <random>

#include "generator/cli/system.hpp"

#define WIN32_LEAN_AND_MEAN
#include <shellapi.h>
#include <windows.h>

namespace contactspline {

namespace fs = std::filesystem;

namespace {

std::recursive_mutex ending;

// On a thread of the system; after it Windows ends the program. What would begin now waits for that.
BOOL WINAPI wait_to_end(DWORD) {
  ending.lock();  // for ever
  return FALSE;
}

}  // namespace

std::vector<std::string> begin_program(int argc, char** argv) {
  for (std::FILE* const stream : {stdin, stdout, stderr}) _setmode(_fileno(stream), _O_BINARY);
  SetConsoleOutputCP(CP_UTF8);
  SetConsoleCtrlHandler(wait_to_end, TRUE);
  int count = 0;
  wchar_t** const wide = CommandLineToArgvW(GetCommandLineW(), &count);
  if (wide == nullptr) return {argv, argv + argc};
  std::vector<std::string> words;
  for (int i = 0; i < count; ++i) words.push_back(fs::path(wide[i]).string());
  LocalFree(wide);
  // From char the standard library of mingw-w64 makes other paths than to char, beyond ASCII.
  for (const std::string& word : words) {
    if (std::ranges::all_of(word, [](char c) { return static_cast<unsigned char>(c) < 128; })) continue;
    std::fprintf(stderr, "contactspline: %s: has a letter beyond ASCII; allowed on Windows: ASCII\n", word.c_str());
    std::exit(2);
  }
  return words;
}

bool is_terminal(std::FILE* stream) {
  return _isatty(_fileno(stream)) != 0;
}

struct EndWaits::Before {};

EndWaits::EndWaits() {
  ending.lock();
}

EndWaits::~EndWaits() {
  ending.unlock();
}

int create_temporary(const fs::path& target, fs::path& name) {
  std::random_device random;
  int descriptor = -1;
  for (int attempt = 0; attempt < 100; ++attempt) {
    name = folder_of(target) / (".contactspline-" + std::to_string(random()));
    descriptor = _wopen(name.c_str(), _O_RDWR | _O_CREAT | _O_EXCL | _O_BINARY, _S_IREAD | _S_IWRITE);
    if (descriptor >= 0 || errno != EEXIST) break;
  }
  return descriptor;
}

bool write_bytes(int descriptor, std::string_view bytes) {
  constexpr std::size_t kMax = 1 << 24;
  while (!bytes.empty()) {
    const int written = _write(descriptor, bytes.data(), static_cast<unsigned>(std::min(kMax, bytes.size())));
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

bool bring_to_disk(int descriptor, const fs::path& /*replaced*/) {
  return _commit(descriptor) == 0;
}

// A copy: while somebody has the file open, Windows would not let go a second name of it.
fs::path back_up(const fs::path& file) {
  fs::path name;
  const int descriptor = create_temporary(file, name);
  if (descriptor < 0) return {};
  close_file(descriptor);
  if (CopyFileW(file.c_str(), name.c_str(), FALSE) != 0) return name;
  DeleteFileW(name.c_str());
  return {};
}

bool close_file(int descriptor) {
  return _close(descriptor) == 0;
}

}  // namespace contactspline
