// SPDX-License-Identifier: MIT
// write_files FOLDER: writes files as the program does on Windows, over old ones, and over one that Windows does not
// let go. Fails with a line unless all are as they must be.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "generator/cli/files.hpp"
#include "generator/support/error.hpp"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

namespace {

using namespace contactspline;
namespace fs = std::filesystem;

std::string content_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

std::size_t count_files(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Names beyond ASCII; line ends stay as they are.
void test_writing(const fs::path& folder) {
  const std::vector<OutputFile> files = {{folder / u8"Für Elise.txt", "a\nb\r\n"}, {folder / u8"弦.txt", ""}};
  require(write_files(files).size() == 2, "new files are not written");
  require(content_of(files[0].path) == "a\nb\r\n", "a new file has other bytes");
  require(write_files(files).empty(), "files that are current are written again");
  const std::vector<OutputFile> changed = {{files[0].path, std::string(100'000, '\n')}, {files[1].path, "x"}};
  require(write_files(changed).size() == 2, "old files are not replaced");
  require(content_of(changed[0].path) == changed[0].bytes && content_of(changed[1].path) == "x", "other bytes");
  require(count_files(folder) == 2, "temporary files are left");
}

// The second file cannot be replaced while somebody has it open: the first one is put back.
void test_failure(const fs::path& folder) {
  const std::vector<OutputFile> old = {{folder / "first", "old"}, {folder / "second", "old"}};
  const std::vector<OutputFile> files = {
      {folder / "first", "new"}, {folder / "second", "new"}, {folder / "third", "new"}};
  require(write_files(old).size() == 2, "old files are not written");
  const HANDLE open = CreateFileW(old[1].path.c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr,
                                  OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  require(open != INVALID_HANDLE_VALUE, "a file cannot be opened");
  try {
    write_files(files);
    throw std::runtime_error("an open file is replaced");
  } catch (const BadInput& error) {
    require(std::string(error.what()).find("second: file: cannot be written: ") != std::string::npos, error.what());
  }
  CloseHandle(open);
  require(content_of(old[0].path) == "old" && content_of(old[1].path) == "old", "old files are not put back");
  require(count_files(folder) == 2, "files are left");
  require(write_files(files).size() == 3, "a file that is free again is not replaced");
  require(content_of(files[1].path) == "new", "other bytes");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  for (void (*test)(const fs::path&) : {test_writing, test_failure}) {
    fs::remove_all(argv[1]);
    fs::create_directories(argv[1]);
    test(argv[1]);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
