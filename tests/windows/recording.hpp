// SPDX-License-Identifier: MIT
// What record_plugin hears.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/sandbox.hpp"

namespace contactspline::testing {

/// recorder: the command that starts record_plugin; sound: a file that it writes.
inline std::vector<float> recorded(const std::string& recorder, const std::string& format,
                                   const std::filesystem::path& plugin, const std::filesystem::path& sound) {
  std::filesystem::remove(sound);
  const std::string command = recorder + " " + format + " " + plugin.string() + " " + sound.string();
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  const std::string bytes = read_file(sound);
  std::vector<float> samples(bytes.size() / sizeof(float));
  std::memcpy(samples.data(), bytes.data(), samples.size() * sizeof(float));
  return samples;
}

}  // namespace contactspline::testing
