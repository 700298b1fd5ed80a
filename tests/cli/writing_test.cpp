// SPDX-License-Identifier: MIT
// A file is old or new and always whole: full disks, kills at any moment, two writers at once.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using Contents = std::map<std::string, std::string>;

std::string material(const std::string& name, const std::string& exponent, int segments) {
  return fmt::format(R"({{"name": "{}", "contact": {{"stiffness_n_per_m_alpha": 1e9, "exponent": {}}},
                         "spline": {{"knots": "uniform", "segments": {}, "max_compression_m": 1e-3}}}})",
                     name, exponent, segments);
}

// Materials of the same names in two folders: "first" and "second" give different files of the same names.
class Variants {
 public:
  Variants(const Sandbox& box, int materials, int segments) : box_(box) {
    for (const auto& [variant, exponent] : {std::pair{"first", "1.5"}, std::pair{"second", "2.5"}}) {
      fs::create_directories(box / variant);
      for (int i = 0; i < materials; ++i) {
        const std::string name = fmt::format("m{}", i);
        const std::string path = fmt::format("{}/{}.json", variant, name);
        write_file(box / path, material(name, exponent, segments));
        inputs_[variant].push_back(path);
      }
      const std::string folder = fmt::format("expected_{}", variant);
      succeed(generating(variant, folder));
      expected_[variant] = contents(folder);
    }
  }

  [[nodiscard]] Call generating(const std::string& variant, const std::string& folder) const {
    return {.arguments = followed_by({"generate", "-o", folder}, inputs_.at(variant)), .folder = box_.path()};
  }

  /// Every file of a folder but the temporary ones a kill may leave.
  [[nodiscard]] Contents contents(const std::string& folder) const {
    Contents found;
    for (const auto& entry : fs::directory_iterator(box_ / folder))
      if (!is_temporary(entry.path())) found[entry.path().filename().string()] = read_file(entry.path());
    return found;
  }

  [[nodiscard]] const Contents& expected(const std::string& variant) const { return expected_.at(variant); }

  /// Number of files that hold just what `variant` gives.
  [[nodiscard]] std::size_t count_of(const std::string& variant, const Contents& found) const {
    std::size_t count = 0;
    for (const auto& [name, bytes] : expected(variant)) count += found.contains(name) && found.at(name) == bytes;
    return count;
  }

  static bool is_temporary(const fs::path& path) { return path.filename().string().starts_with("."); }

 private:
  const Sandbox& box_;
  std::map<std::string, Words> inputs_;
  std::map<std::string, Contents> expected_;
};

class FullDisk : public ::testing::TestWithParam<rlim_t> {};

TEST_P(FullDisk, LeavesEveryOldFileWholeAndNothingElse) {
  const Sandbox box;
  const Variants variants(box, 2, 64);
  succeed(variants.generating("first", "out"));
  const auto before = box.listing();
  Call call = variants.generating("second", "out");
  call.largest_file_bytes = GetParam();
  expect_refused(run(call), "out/m0.", ": file: cannot be written: File too large");
  EXPECT_EQ(names_in(box.listing()), names_in(before));
  EXPECT_TRUE(box.listing() == before);
}

// The outputs are about 8, 14 and 11 kB: with 12 kB the first fits and the second does not.
INSTANTIATE_TEST_SUITE_P(Bytes, FullDisk, ::testing::Values(0, 1, 100, 4096, 7000, 12000));

TEST(FullDisk, IsReportedForEveryKindOfFile) {
  const Sandbox box;
  fs::create_directories(box / "tmp");
  const auto before = box.listing();
  for (const Words& arguments :
       std::vector<Words>{{"generate", "mb1", "--emit", "json", "-o", "out", "--depfile", "d"},
                          {"inspect", "mb1", "--figure", "out/mb1.svg"},
                          {"render", "mass-barrier", "--duration", "0.1", "-o", "out/a.wav"}}) {
    if (arguments.front() != "generate") fs::create_directory(box / "out");
    const auto outcome = run({.arguments = arguments,
                              .folder = box.path(),
                              .environment = {{"TMPDIR", (box / "tmp").string()}},
                              .largest_file_bytes = 2000});
    expect_refused(outcome, "", arguments.front() == "inspect" ? "figure: " : "File too large");
    fs::remove(box / "out");  // an empty folder may stay
    EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  }
}

// The depfile comes last; the outputs must not be replaced where it fails.
TEST(FullDisk, OfTheLastFileLeavesTheFirst) {
  const Sandbox box;
  const Variants variants(box, 1, 64);
  succeed(variants.generating("first", "out"));
  const auto before = box.listing();
  const Call call = variants.generating("second", "out");
  expect_refused(run({.arguments = followed_by(call.arguments, {"--depfile", "/dev/full"}), .folder = box.path()}),
                 "/dev/full: file: ", "is not a regular file");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

TEST(FullDisk, OfARealFileSystemLeavesTheOldFileWhole) {
  const Sandbox box;
  const Variants variants(box, 2, 64);
  fs::create_directories(box / "disk");
  const auto size = std::string("size=120k");
  if (::mount("none", (box / "disk").c_str(), "tmpfs", 0, size.c_str()) != 0)
    GTEST_SKIP() << "SKIPPED: no file system can be mounted here: " << std::strerror(errno);
  const auto unmount = [](const fs::path* path) { ::umount2(path->c_str(), MNT_DETACH); };
  const fs::path disk = box / "disk";
  const std::unique_ptr<const fs::path, decltype(unmount)> mounted(&disk, unmount);

  succeed(variants.generating("first", "disk"));  // fits once, not twice
  const auto before = box.listing();
  expect_refused(run(variants.generating("second", "disk")), "disk/m", "No space left on device");
  EXPECT_EQ(names_in(box.listing()), names_in(before));
  EXPECT_TRUE(box.listing() == before);
}

TEST(FullStandardOutput, IsReported) {
  const Sandbox box;
  for (const Words& arguments : std::vector<Words>{{"generate", "mb1", "--emit", "json", "-o", "-"},
                                                   {"generate", "mb1", "-o", "out"},  // "wrote ..."
                                                   {"generate", "mb1", "-o", "out"},  // "... are current"
                                                   {"inspect", "mb1"},
                                                   {"list", "materials"},
                                                   {"impact", "mb1"},
                                                   {"render", "mass-barrier", "--duration", "0.1", "-o", "a.wav"},
                                                   {"--help"},
                                                   {"generate", "--help"},
                                                   {"--version"}})
    expect_refused(run({.arguments = arguments, .folder = box.path(), .standard_output = "/dev/full"}),
                   "standard output: cannot be written", "No space left on device");
}

// Nobody to complain to is no reason to crash.
TEST(FullStandardError, LeavesTheExitCode) {
  for (const std::string redirection : {"2>/dev/full", "2>&-", ">&- 2>&-"}) {
    const std::string command = fmt::format("'{}' inspect gone.json {}", kProgram, redirection);
    EXPECT_EQ(run({.arguments = {"-c", command}, .program = "sh"}).exit_code, 2) << redirection;
  }
}

void expect_old_or_new(const Variants& variants, const Contents& found) {
  for (const auto& [name, bytes] : variants.expected("first")) {
    ASSERT_TRUE(found.contains(name)) << name << " is gone";
    EXPECT_TRUE(found.at(name) == bytes || found.at(name) == variants.expected("second").at(name))
        << name << " is neither old nor new: " << found.at(name).size() << " bytes";
  }
  EXPECT_EQ(found.size(), variants.expected("first").size());
}

std::size_t remove_temporaries(const fs::path& folder) {
  std::size_t removed = 0;
  for (const auto& entry : fs::directory_iterator(folder))
    if (Variants::is_temporary(entry.path())) removed += fs::remove(entry.path());
  return removed;
}

// In memory where that is possible: a kill does not ask what the disk is, and fsync() takes long.
fs::path quick_folder() {
  return ::access("/dev/shm", W_OK) == 0 ? fs::path("/dev/shm") : fs::temp_directory_path();
}

Call traced(Call call) {
  call.traced = true;
  call.environment["ASAN_OPTIONS"] = "detect_leaks=0";  // it cannot look for leaks while being traced
  return call;
}

// 60 kills over 102 files, each at a random system call: two thirds anywhere in the run, one third while it renames.
TEST(Killed, LeavesEveryFileOldOrNew) {
  const Sandbox box(quick_folder());
  const Variants variants(box, 34, 48);
  ASSERT_EQ(variants.expected("first").size(), 102u);
  std::string now = "first", next = "second";
  succeed(variants.generating(next, "out"));
  const std::size_t stops = Process(traced(variants.generating(now, "out"))).kill_at_stop(1'000'000);
  if (stops < 1000) GTEST_SKIP() << "SKIPPED: programs cannot be traced here";
  std::mt19937 random(20260101);
  std::uniform_int_distribution<std::size_t> anywhere(1, stops - 1), renaming(stops - 440, stops - 220);
  int killed = 0, mixed = 0, with_temporaries = 0;
  for (int i = 0; i < 60; ++i) {
    {
      Process process(traced(variants.generating(next, "out")));
      const std::size_t stop = i % 3 == 0 ? renaming(random) : anywhere(random);
      killed += process.kill_at_stop(stop) == stop;
    }
    const Contents found = variants.contents("out");
    expect_old_or_new(variants, found);
    with_temporaries += remove_temporaries(box / "out") > 0;
    const auto renamed = variants.count_of(next, found);
    const bool is_mixed = renamed > 0 && renamed < found.size();
    mixed += is_mixed;
    if (is_mixed) succeed(variants.generating(next, "out"));
    if (renamed > 0) std::swap(now, next);
  }
  Measured() << killed << " of 60 killed at work, " << mixed << " between the first and the last rename, "
             << with_temporaries << " with temporary files; a whole run stops " << stops << " times";
  EXPECT_GE(killed, 57) << "too few kills came in time to prove anything";
  EXPECT_GE(mixed, 4);
  EXPECT_GE(with_temporaries, 20);
}

// SIGTERM waits while files are written: afterwards all of them are old, or all new, and no temporary file is left.
TEST(Terminated, LeavesAllFilesOldOrAllNew) {
  const Sandbox box(quick_folder());
  const Variants variants(box, 4, 48);
  std::string now = "first", next = "second";
  succeed(variants.generating(now, "out"));
  succeed(variants.generating(next, "trial"));
  const std::size_t stops = Process(traced(variants.generating(now, "trial"))).kill_at_stop(1'000'000);
  if (stops < 100) GTEST_SKIP() << "SKIPPED: programs cannot be traced here";
  std::mt19937 random(20260102);
  std::uniform_int_distribution<std::size_t> anywhere(1, stops - 1), near_end(stops - 200, stops - 5);
  int new_ones = 0;
  for (int i = 0; i < 40; ++i) {
    Process(traced(variants.generating(next, "out")))
        .terminate_at_stop(i % 2 == 0 ? near_end(random) : anywhere(random));
    EXPECT_EQ(remove_temporaries(box / "out"), 0u);
    const auto renamed = variants.count_of(next, variants.contents("out"));
    EXPECT_TRUE(renamed == 0 || renamed == 12) << renamed;
    expect_old_or_new(variants, variants.contents("out"));
    if (renamed > 0) std::swap(now, next), ++new_ones;
  }
  EXPECT_GE(new_ones, 5);
  EXPECT_LE(new_ones, 35);
}

// A file of another user in a folder with the sticky bit cannot be replaced: the files before it stay old, too.
TEST(Renaming, ThatFailsPutsTheOldFilesBack) {
  if (::geteuid() != 0) GTEST_SKIP() << "SKIPPED: only root can make files of another user";
  for (const bool exists : {true, false}) {  // the first file
    const Sandbox box;
    const Variants variants(box, 1, 48);
    succeed(variants.generating("first", "out"));
    ASSERT_EQ(::chmod((box / "out").c_str(), 01777), 0);
    for (const auto name : {"out/m0.lib", "out/m0.json"}) ASSERT_EQ(::chown((box / name).c_str(), 65534, 65534), 0);
    if (!exists) fs::remove(box / "out/m0.lib");
    const auto before = variants.contents("out");
    Call call = variants.generating("second", "out");
    call.as_nobody = true;
    expect_refused(run(call), "out/m0.hpp: file: cannot be written", "");
    EXPECT_TRUE(variants.contents("out") == before);
    EXPECT_EQ(remove_temporaries(box / "out"), 0u);
  }
}

// An old file of 64 GB, which takes no space on the disk, is neither read nor kept in memory.
TEST(LargeOldFile, IsComparedByItsSize) {
  const Sandbox box;
  const Words generate = {"generate", "mb1", "--emit", "json", "-o", "out"};
  succeed({.arguments = generate, .folder = box.path()});
  const std::string bytes = read_file(box / "out/mb1.json");
  std::error_code error;
  fs::resize_file(box / "out/mb1.json", std::uintmax_t{64} << 30, error);
  if (error) GTEST_SKIP() << "SKIPPED: no file with holes can be made here: " << error.message();
  const Outcome check = run({.arguments = followed_by(generate, {"--check"}), .folder = box.path()});
  EXPECT_EQ(check.exit_code, 1) << check.err;
  succeed({.arguments = generate, .folder = box.path()});
  EXPECT_TRUE(read_file(box / "out/mb1.json") == bytes);
}

// What a kill leaves behind does not hinder the next run, which makes all files whole and new.
TEST(Killed, IsMendedByTheNextRun) {
  const Sandbox box(quick_folder());
  const Variants variants(box, 4, 48);
  succeed(variants.generating("first", "out"));
  const std::size_t stops = Process(traced(variants.generating("second", "trial"))).kill_at_stop(1'000'000);
  if (stops < 100) GTEST_SKIP() << "SKIPPED: programs cannot be traced here";
  Process(traced(variants.generating("second", "out"))).kill_at_stop(stops - 20);
  EXPECT_GT(std::distance(fs::directory_iterator(box / "out"), {}), 12) << "killed when all was done";
  succeed(variants.generating("second", "out"));
  EXPECT_TRUE(variants.contents("out") == variants.expected("second"));
}

TEST(TwoWriters, LeaveEveryFileWhole) {
  const Sandbox box(quick_folder());
  const Variants variants(box, 10, 48);
  for (int i = 0; i < 40; ++i) {
    const std::string folder = fmt::format("out{}/made/by/both", i);
    Process first(variants.generating("first", folder));
    Process second(variants.generating("second", folder));
    for (Process* process : {&first, &second}) {
      const auto outcome = process->wait();
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    expect_old_or_new(variants, variants.contents(folder));
    EXPECT_EQ(std::distance(fs::directory_iterator(box / folder), {}), 30) << "a temporary file is left";
  }
}

// Of a file, not of a folder that an option names or of a rule for make: those are made.
TEST(MissingFolder, OfAFileIsAnErrorAndNothingIsWritten) {
  const Sandbox box;
  write_file(box / "score.json", R"({"instrument": "tom", "duration_s": 0.01,
    "events": [ { "time_s": 0, "stick_speed_m_per_s": 1 } ] })");
  const Words render = {"render", "score.json", "-o"};
  const auto before = box.listing();
  for (const auto& [arguments, file] : std::vector<std::pair<Words, std::string>>{
           {followed_by(render, {"gone/a.wav", "--no-figure"}), "gone/a.wav"},
           {followed_by(render, {"a.wav", "--figure", "gone/a.svg"}), "gone/a.svg"},
           {{"render", "mass-barrier", "--duration", "0.01", "-o", "gone/deep/a.wav"}, "gone/deep/a.wav"},
           {{"inspect", "mb1", "--figure", "gone/a.svg"}, "gone/a.svg"},
           {{"inspect", "mb1", "--compare", "--figure", "gone/a.svg"}, "gone/a.svg"},
           {{"inspect", "tom", "--figure", "gone/a.svg"}, "gone/a.svg"},
           {{"impact", "mb1", "--figure", "gone/a.svg"}, "gone/a.svg"},
           {{"impact", "mb1", "--trace", "gone/a.csv"}, "gone/a.csv"}}) {
    expect_refused(run({.arguments = arguments, .folder = box.path()}), file + ": file: its folder gone",
                   " does not exist; allowed: a folder that exists");
    EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  }
  succeed({.arguments = followed_by(render, {"a.wav", "--no-figure", "--stems", "new/stems"}), .folder = box.path()});
  EXPECT_TRUE(fs::exists(box / "new/stems/tom.wav")) << names_in(box.listing());
}

// Files and links of the names that other programs choose for what is not finished.
TEST(TemporaryFile, IsNoFileOfAnotherAndFollowsNoLink) {
  const Sandbox box;
  write_file(box / "precious.txt", "precious");
  for (const std::string name : {"a.wav", "a.svg"})
    for (const std::string ending : {".part", ".tmp", "~"}) fs::create_symlink("precious.txt", box / (name + ending));
  const auto before = box.listing();
  succeed({.arguments = {"render", "mass-barrier", "--duration", "0.01", "-o", "a.wav"}, .folder = box.path()});
  auto after = box.listing();
  for (const char* written : {"a.wav", "a.svg"}) EXPECT_EQ(after.erase(written), 1u);
  EXPECT_TRUE(after == before) << names_in(after);
}

}  // namespace
}  // namespace contactspline::testing
