// SPDX-License-Identifier: MIT
// What is refused: bad files and bad command lines, read from the files of cases/.
//
// A case is one line, or several of which all but the first begin with blanks:
//
//     name | what is changed in the good file | key | what the message says
//     name | words of the command line | how the message begins | what it says
//
// A change is "from => to" with a text that occurs just once; "from =>" leaves it out, and " && " stands between
// several. "@base" in front names another good file than the first. "= text" is the whole file instead. The
// characters of C, \n, \t, \r, \xHH and a doubled backslash, stand for themselves in it; ".." is the same as in the
// case above. Cases stand below the name of their section, [Section]; a line that begins with # is a comment.
//
// All the errors that a number of a good file can have are one line:
//
//     path of the number | its value | what the message allows | values out of range
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {

struct BadFile {
  std::string test;
  std::string text;  ///< text of the file
  std::string key;   ///< the message begins with "file: key: "
  std::string says;
};

struct BadLine {
  std::string test;
  Words words;
  std::string beginning;  ///< the message begins with it
  std::string says;
};

void PrintTo(const BadFile& bad, std::ostream* stream);
void PrintTo(const BadLine& bad, std::ostream* stream);

/// Good files by the names that cases give them; "" is the one they mean without a name.
using Bases = std::map<std::string, std::string>;

/// The cases of a section of cases/`file`.txt. Throws if there are none, or one that cannot be read.
std::vector<BadFile> bad_files(const std::string& file, const std::string& section, const Bases& bases);
std::vector<BadFile> bad_numbers(const std::string& file, const std::string& section, const Bases& bases);
std::vector<BadLine> bad_lines(const std::string& file, const std::string& section);

/// `good` with its one `from` replaced.
std::string changed(const std::string& good, const std::string& from, const std::string& to);

/// Both lists.
std::vector<BadFile> followed_by(std::vector<BadFile> cases, const std::vector<BadFile>& more);

/// The bad file, as probe.json, is refused by `generate` in one line, and nothing is written.
void expect_refused_by_generate(const BadFile& bad);

}  // namespace contactspline::testing

/// A suite of bad files that `generate` refuses; CONTACTSPLINE_CASES lists them.
#define CONTACTSPLINE_REFUSED_BY_GENERATE(Suite)             \
  class Suite : public ::testing::TestWithParam<BadFile> {}; \
  TEST_P(Suite, IsRefusedInOneLineAndNothingIsWritten) {     \
    expect_refused_by_generate(GetParam());                  \
  }                                                          \
  static_assert(true)
