// SPDX-License-Identifier: MIT
#include "generator/support/input_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <ios>
#include <iterator>
#include <string_view>
#include <system_error>

#include "generator/support/error.hpp"

namespace contactspline {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxInputBytes = 1 << 20;

[[noreturn]] void fail_to_read(const fs::path& path, std::string_view what) {
  throw BadInput(fmt::format("{}: file: {}; allowed: a file of at most 1 MiB that can be read", path.string(), what));
}

}  // namespace

std::string read_input(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) fail_to_read(path, error ? error.message() : "does not exist");
  if (!fs::is_regular_file(path, error)) fail_to_read(path, "is not a regular file");
  if (fs::file_size(path, error) > kMaxInputBytes || error) fail_to_read(path, "is larger than 1 MiB");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail_to_read(path, std::strerror(errno));
  try {
    return {std::istreambuf_iterator<char>(stream), {}};
  } catch (const std::ios_base::failure& failure) {
    fail_to_read(path, failure.code().message());
  }
}

const std::string& read_standard_input() {
  static const std::string text = [] {
    std::string read(kMaxInputBytes + 1, '\0');
    read.resize(std::fread(read.data(), 1, read.size(), stdin));
    if (std::ferror(stdin) != 0) fail_to_read(kStandardInput, std::strerror(errno));
    if (read.size() > kMaxInputBytes) fail_to_read(kStandardInput, "is larger than 1 MiB");
    return read;
  }();
  return text;
}

}  // namespace contactspline
