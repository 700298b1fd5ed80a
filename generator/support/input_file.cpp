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

constexpr std::uintmax_t kMib = 1 << 20;

[[noreturn]] void fail_to_read(const fs::path& path, std::string_view what, int max_mib = 1) {
  throw BadInput(
      fmt::format("{}: file: {}; allowed: a file of at most {} MiB that can be read", path.string(), what, max_mib));
}

}  // namespace

std::string read_input(const fs::path& path) {
  return read_large_input(path, 1);
}

std::string read_large_input(const fs::path& path, int max_mib) {
  const auto fail = [&](std::string_view what) { fail_to_read(path, what, max_mib); };
  std::error_code error;
  if (!fs::exists(path, error)) fail(error ? error.message() : "does not exist");
  if (!fs::is_regular_file(path, error)) fail("is not a regular file");
  if (fs::file_size(path, error) > kMib * static_cast<std::uintmax_t>(max_mib) || error)
    fail(fmt::format("is larger than {} MiB", max_mib));
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(std::strerror(errno));
  try {
    return {std::istreambuf_iterator<char>(stream), {}};
  } catch (const std::ios_base::failure& failure) {
    fail_to_read(path, failure.code().message(), max_mib);
  }
}

const std::string& read_standard_input() {
  static const std::string text = [] {
    std::string read(kMib + 1, '\0');
    read.resize(std::fread(read.data(), 1, read.size(), stdin));
    if (std::ferror(stdin) != 0) fail_to_read(kStandardInput, std::strerror(errno));
    if (read.size() > kMib) fail_to_read(kStandardInput, "is larger than 1 MiB");
    return read;
  }();
  return text;
}

}  // namespace contactspline
