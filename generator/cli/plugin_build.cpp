// SPDX-License-Identifier: MIT
#include "generator/cli/plugin_build.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>
#include <vector>

#include "generator/cli/waiting_line.hpp"
#include "generator/support/error.hpp"

extern char** environ;

namespace contactspline {
namespace {

namespace fs = std::filesystem;

constexpr auto kWithoutBuilding = "--no-build, which writes the project only";

bool is_installed(const char* program) {
  std::istringstream folders(std::getenv("PATH") == nullptr ? "" : std::getenv("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

// The package that this program belongs to, wherever it was moved; empty where it was not installed.
std::string own_package() {
  std::error_code error;
  const fs::path prefix = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
  for (const char* folder : {"lib", "lib64"})
    if (fs::exists(prefix / folder / "cmake/ContactSpline/ContactSplineConfig.cmake", error)) return prefix.string();
  for (const auto& folder : fs::directory_iterator(prefix / "lib", error))
    if (fs::exists(folder.path() / "cmake/ContactSpline/ContactSplineConfig.cmake", error)) return prefix.string();
  return {};
}

// Runs a program with its output behind a file. Its exit code, or 127 where it cannot be started.
int run(std::vector<std::string> words, const fs::path& log) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  int status = 127 << 8;
  if (::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ) == 0)
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  posix_spawn_file_actions_destroy(&actions);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

// What CMake or the compiler complained about first, in one line.
std::string first_error(const fs::path& log) {
  std::ifstream file(log);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  std::size_t begin = text.find("CMake Error");
  std::size_t end = text.find("\n\n\n", begin);
  if (const std::size_t stack = text.find("\nCall Stack", begin); stack < end) end = stack;
  if (begin == std::string::npos) {
    begin = text.find("error: ");
    end = text.find('\n', begin);
  }
  if (begin == std::string::npos) return "failed";
  std::istringstream words(text.substr(begin, end - begin));
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line.substr(0, 400);
}

}  // namespace

void require_compiler() {
  const bool is_chosen = std::getenv("CXX") != nullptr;
  const bool has_compiler = is_chosen || is_installed("c++") || is_installed("g++") || is_installed("clang++");
  if (!has_compiler || !is_installed("cmake"))
    throw BadInput(fmt::format("{}: not installed; allowed: install cmake, g++ and dpf-source, or {}",
                               has_compiler ? "cmake" : "compiler", kWithoutBuilding));
}

void build_plugin(const fs::path& project, const std::string& name) {
  const WaitingLine line("building " + name);
  const fs::path folder = project / "build", log = folder / "build.log";
  std::error_code error;
  fs::create_directories(folder, error);
  fs::remove(log, error);
  std::vector<std::string> configure = {"cmake", "-S", project.string(), "-B", folder.string()};
  if (const std::string package = own_package(); !package.empty())
    configure.push_back("-DContactSpline_ROOT=" + package);
  const unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  if (run(configure, log) != 0 ||
      run({"cmake", "--build", folder.string(), "--parallel", std::to_string(jobs)}, log) != 0)
    refuse(log.string(), "build", first_error(log),
           std::string("an installed Contact Spline with dpf-source, or ") + kWithoutBuilding);
}

}  // namespace contactspline
