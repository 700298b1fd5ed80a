// SPDX-License-Identifier: MIT
// A folder of a test's own, and all that can be seen of it.
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <compare>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace contactspline::testing {

namespace fs = std::filesystem;

inline std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_file(const fs::path& path, std::string_view bytes) {
  std::ofstream stream(path, std::ios::binary);
  stream << bytes << std::flush;
  if (!stream) throw std::runtime_error("cannot write " + path.string());
}

/// What a file is: an untouched one compares equal, whatever else was written and renamed.
struct FileState {
  mode_t mode;
  ino_t inode;
  long long modified_ns;
  std::string content;  ///< content of a regular file; target of a link

  auto operator<=>(const FileState&) const = default;
};

inline FileState state_of(const fs::path& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0) throw std::runtime_error("no file " + path.string());
  const bool is_folder = S_ISDIR(found.st_mode);  // its time changes when a temporary file comes and goes
  return {found.st_mode, found.st_ino, is_folder ? 0 : found.st_mtim.tv_sec * 1'000'000'000LL + found.st_mtim.tv_nsec,
          S_ISREG(found.st_mode)   ? read_file(path)
          : S_ISLNK(found.st_mode) ? fs::read_symlink(path).string()
                                   : ""};
}

/// A new empty folder, by default under the system's temporary folder, removed at the end.
class Sandbox {
 public:
  explicit Sandbox(const fs::path& parent = fs::temp_directory_path())
      : path_((parent / "contactspline-test-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no sandbox");
    fs::permissions(path_, fs::perms(0755));
  }
  Sandbox(const Sandbox&) = delete;
  Sandbox& operator=(const Sandbox&) = delete;
  ~Sandbox() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  [[nodiscard]] fs::path path() const { return path_; }
  [[nodiscard]] fs::path operator/(const fs::path& name) const { return path() / name; }

  /// Every file and folder in it by its relative path.
  [[nodiscard]] std::map<std::string, FileState> listing() const {
    std::map<std::string, FileState> found;
    for (const auto& entry : fs::recursive_directory_iterator(path_))
      found[fs::path(entry.path()).lexically_relative(path_).string()] = state_of(entry.path());
    return found;
  }

 private:
  std::string path_;
};

/// Names in a listing, for a readable failure.
inline std::string names_in(const std::map<std::string, FileState>& listing) {
  std::string names;
  for (const auto& [name, state] : listing) names += name + "\n";
  return names;
}

/// A good material file.
inline constexpr auto kProbeMaterial = R"({
  "name": "probe",
  "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
  "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },
  "spline": { "knots": "uniform", "segments": 8 }
})";

}  // namespace contactspline::testing
