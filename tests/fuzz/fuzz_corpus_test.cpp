// SPDX-License-Identifier: MIT
// Every input in corpus/, also those that once broke something, is played to the end or refused in one readable line.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fuzz/paths.hpp"
#include "generator/support/error.hpp"

namespace contactspline::testing {
namespace {

namespace fs = std::filesystem;

class FuzzCorpus : public ::testing::TestWithParam<Path> {};

TEST_P(FuzzCorpus, IsPlayedOrRefusedInOneLine) {
  int played = 0, refused = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(CORPUS) / GetParam().name)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    ASSERT_TRUE(stream) << entry.path();
    SCOPED_TRACE(entry.path());
    try {
      GetParam().play(bytes);
      ++played;
    } catch (const BadInput& refusal) {
      ++refused;
      EXPECT_EQ(fault_of_message(refusal.what(), GetParam().file), "") << refusal.what();
    } catch (const std::exception& fault) {
      ADD_FAILURE() << fault.what();
    }
  }
  EXPECT_GT(played, 0) << refused << " refused";
}

INSTANTIATE_TEST_SUITE_P(Paths, FuzzCorpus, ::testing::ValuesIn(paths().begin(), paths().end()),
                         [](const auto& path) { return std::string(path.param.name); });

}  // namespace
}  // namespace contactspline::testing
