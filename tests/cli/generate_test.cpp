// SPDX-License-Identifier: MIT
// contactspline generate: what it writes, and what it leaves alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <ranges>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "generator/emit/emitter.hpp"
#include "generator/spline/design.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;
constexpr auto kMaterial = R"({
  "name": "probe",
  "description": "a probe",
  "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
  "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },
  "spline": { "knots": "uniform", "segments": 8 }
})";

const Words kShipped = {"felt_c2",        "felt_c4",        "felt_c7", "felt_live",      "felt_over_wood",
                        "felt_stulov_c4", "felt_synthetic", "mb1",     "rubber_on_wood", "steel_ball_on_plate",
                        "steel_on_steel"};
const Words kResonators = {"string_c2", "marimba_c4"};
const Words kFormats = {"faust", "cpp", "json"};

Words sorted_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return {names.begin(), names.end()};
}

std::string printed(const Words& arguments, const fs::path& folder = {}) {
  return succeed({.arguments = arguments, .folder = folder});
}

TEST(Generate, PrintsTheKeysOfTheContractWithTheValuesOfTheLibrary) {
  const Sandbox box;
  write_file(box / "probe.json", kMaterial);
  const Json json = Json::parse(printed({"generate", "probe.json", "--emit", "json", "-o", "-"}, box.path()));
  const Spline spline = design_material(kMaterial, "probe.json").spline;

  std::vector<double> knots, energies, forces, half_curvatures;
  for (const auto& s : spline.segments) {
    knots.push_back(s.knot);
    energies.push_back(s.energy);
    forces.push_back(s.force);
    half_curvatures.push_back(s.half_curvature);
  }
  EXPECT_EQ(json.at("name"), "probe");
  EXPECT_EQ(json.at("knots_m"), knots);
  EXPECT_EQ(json.at("energy_j"), energies);
  EXPECT_EQ(json.at("force_n"), forces);
  EXPECT_EQ(json.at("half_curvature_n_per_m"), half_curvatures);
  EXPECT_EQ(json.at("regular"), (Json{{"a", spline.regular.a}, {"b", spline.regular.b}, {"c", spline.regular.c}}));
  EXPECT_EQ(json.at("normalised"),
            (Json{{"a", spline.normalised.a}, {"b", spline.normalised.b}, {"c", spline.normalised.c}}));
  EXPECT_EQ(json.at("segment_width_m"), spline.length_scale_m);
  EXPECT_EQ(json.at("knots_m").size(), 8u);
  EXPECT_EQ(json.at("quality").size(), 8u);
  for (const auto& [key, value] : json.at("quality").items()) EXPECT_TRUE(value.is_number_float()) << key;
}

TEST(Generate, PrintsWhatItWrites) {
  const Sandbox box;
  printed({"generate", "mb1", "-o", (box / "out").string()});
  EXPECT_EQ(printed({"generate", "mb1", "--emit", "json", "-o", "-"}), read_file(box / "out/mb1.json"));
  EXPECT_EQ(printed({"generate", "mb1", "--emit", "faust", "-o", "-"}), read_file(box / "out/mb1.lib"));
  EXPECT_EQ(printed({"generate", "mb1", "--emit=cpp", "--output=-"}), read_file(box / "out/mb1.hpp"));
}

TEST(Generate, WritesEveryFormatUnlessSomeAreNamed) {
  const Sandbox box;
  printed({"generate", "mb1", "-o", "all"}, box.path());
  printed({"generate", "mb1", "--emit", "json", "--emit", "cpp", "--emit", "json", "-o", "two"}, box.path());
  EXPECT_EQ(sorted_names(box / "all"), (Words{"mb1.hpp", "mb1.json", "mb1.lib"}));
  EXPECT_EQ(sorted_names(box / "two"), (Words{"mb1.hpp", "mb1.json"}));
}

TEST(Generate, CreatesFoldersAndNamesWhatItWrote) {
  const Sandbox box;
  EXPECT_EQ(printed({"generate", "rubber_on_wood", "-o", "a/b c/../d"}, box.path()),
            "wrote a/b c/../d/rubber_on_wood.lib\nwrote a/b c/../d/rubber_on_wood.hpp\nwrote a/b "
            "c/../d/rubber_on_wood.json\n");
  EXPECT_EQ(sorted_names(box / "a/d"), (Words{"rubber_on_wood.hpp", "rubber_on_wood.json", "rubber_on_wood.lib"}));
}

TEST(Generate, WritesToTheWorkingFolderByDefault) {
  const Sandbox box;
  printed({"generate", "mb1"}, box.path());
  EXPECT_EQ(sorted_names(box.path()), (Words{"mb1.hpp", "mb1.json", "mb1.lib"}));
}

TEST(Generate, LeavesAnUnchangedFileUntouched) {
  const Sandbox box;
  const Words arguments = {"generate", "rubber_on_wood", "-o", "out", "--depfile", "out/rubber_on_wood.d"};
  printed(arguments, box.path());
  const auto before = box.listing();
  EXPECT_EQ(printed(arguments, box.path()), "3 files are current\n");
  EXPECT_TRUE(box.listing() == before) << "time or inode changed";
}

TEST(Generate, ReplacesJustTheFileThatChanged) {
  const Sandbox box;
  printed({"generate", "rubber_on_wood", "-o", "out"}, box.path());
  const auto before = box.listing();
  write_file(box / "out/rubber_on_wood.hpp", before.at("out/rubber_on_wood.hpp").content + " ");
  EXPECT_EQ(printed({"generate", "rubber_on_wood", "-o", "out"}, box.path()), "wrote out/rubber_on_wood.hpp\n");
  const auto after = box.listing();
  EXPECT_EQ(names_in(after), names_in(before));
  EXPECT_TRUE(after.at("out/rubber_on_wood.lib") == before.at("out/rubber_on_wood.lib"));
  EXPECT_TRUE(after.at("out/rubber_on_wood.json") == before.at("out/rubber_on_wood.json"));
  EXPECT_EQ(after.at("out/rubber_on_wood.hpp").content, before.at("out/rubber_on_wood.hpp").content);
}

TEST(GenerateCheck, PassesWhereAllIsFresh) {
  const Sandbox box;
  printed({"generate", "mb1", "felt_c4", "-o", "out"}, box.path());
  const auto before = box.listing();
  EXPECT_EQ(printed({"generate", "mb1", "felt_c4", "-o", "out", "--check"}, box.path()), "");
  EXPECT_TRUE(box.listing() == before);
}

TEST(GenerateCheck, NamesJustTheStaleAndWritesNothing) {
  const Sandbox box;
  printed({"generate", "mb1", "felt_c4", "-o", "out"}, box.path());
  std::string bytes = read_file(box / "out/mb1.hpp");
  bytes[bytes.size() / 2] ^= 1;
  write_file(box / "out/mb1.hpp", bytes);
  fs::remove(box / "out/felt_c4.lib");
  fs::remove(box / "out/felt_c4.json");
  fs::create_directories(box / "out/felt_c4.json");
  const auto before = box.listing();
  const auto outcome =
      run({.arguments = {"generate", "mb1", "felt_c4", "-o", "out", "--check"}, .folder = box.path()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err,
            "contactspline: stale: out/mb1.hpp, out/felt_c4.lib, out/felt_c4.json; generate them again\n");
  EXPECT_TRUE(box.listing() == before);
}

TEST(GenerateCheck, FindsEverythingStaleInAFolderThatIsNotThere) {
  const Sandbox box;
  const auto outcome = run({.arguments = {"generate", "mb1", "-o", "gone", "--check"}, .folder = box.path()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "contactspline: stale: gone/mb1.lib, gone/mb1.hpp, gone/mb1.json; generate them again\n");
  EXPECT_TRUE(box.listing().empty());
}

// A pipe with no writer would hold up whoever opens it.
TEST(GenerateCheck, DoesNotWaitForAPipe) {
  const Sandbox box;
  fs::create_directories(box / "out");
  ASSERT_EQ(::mkfifo((box / "out/mb1.json").c_str(), 0600), 0);
  const Words arguments = {"generate", "mb1", "--emit", "json", "-o", "out"};
  const auto outcome = run({.arguments = arguments, .folder = box.path()});
  expect_refused(outcome, "out/mb1.json: file: ", "is not a regular file");
}

TEST(GenerateDepfile, NamesOutputsAndMaterialFiles) {
  const Sandbox box;
  write_file(box / "probe.json", kMaterial);
  printed({"generate", "probe.json", "mb1", "--emit", "cpp", "-o", "out", "--depfile", "deps/probe.d"}, box.path());
  EXPECT_EQ(read_file(box / "deps/probe.d"), "out/probe.hpp out/mb1.hpp: probe.json\n");
}

TEST(GenerateDepfile, DoesNotTakeAShippedNameForAFile) {
  const Sandbox box;
  fs::create_directories(box / "mb1");
  printed({"generate", "mb1", "--emit", "cpp", "-o", "out", "--depfile", "d"}, box.path());
  EXPECT_EQ(read_file(box / "d"), "out/mb1.hpp:\n");
}

TEST(GenerateDepfile, EscapesWhatMakeAndNinjaReadOtherwise) {
  const Sandbox box;
  const std::string folder = R"(a b#c$d\e\ f)";
  fs::create_directories(box / folder);
  write_file(box / folder / "probe.json", kMaterial);
  printed({"generate", folder + "/probe.json", "--emit", "cpp", "-o", folder, "--depfile", "d"}, box.path());
  EXPECT_EQ(read_file(box / "d"), R"(a\ b\#c$$d\e\\\ f/probe.hpp: a\ b\#c$$d\e\\\ f/probe.json)"
                                  "\n");
}

constexpr auto kHardFolder = R"(a b#c$d\e)";

// In single quotes for the shell; the path holds none.
std::string generate_command(const std::string& folder) {
  const std::string path = "'" + folder + "/";
  return std::string(kProgram) + " generate " + path + "probe.json' --emit cpp -o " + path + "out' --depfile d";
}

void write_material(const fs::path& path, const std::string& segments, std::chrono::seconds age) {
  std::string text = kMaterial;
  text.replace(text.find("\"segments\": 8"), 13, "\"segments\": " + segments);
  write_file(path, text);
  fs::last_write_time(path, fs::file_time_type::clock::now() - age);
}

TEST(GenerateDepfile, IsUnderstoodByNinja) {
  const std::string ninja = NINJA;
  if (ninja.empty()) GTEST_SKIP() << "ninja is not installed";
  const Sandbox box;
  fs::create_directories(box / kHardFolder);
  write_material(box / kHardFolder / "probe.json", "8", std::chrono::seconds(60));
  const std::string command = replaced(generate_command(kHardFolder), R"(\$)", "$$$$");
  write_file(box / "build.ninja", "rule generate\n  command = " + command +
                                      "\n  depfile = d\n  restat = 1\n"
                                      R"(build a$ b#c$$d\e/out/probe.hpp: generate)"
                                      "\n");
  const Call call = {.arguments = {}, .folder = box.path(), .program = ninja};
  EXPECT_NE(run(call).out.find("wrote"), std::string::npos);
  EXPECT_NE(run(call).out.find("no work to do"), std::string::npos);
  write_material(box / kHardFolder / "probe.json", "9", std::chrono::seconds(0));
  EXPECT_NE(run(call).out.find("wrote"), std::string::npos) << "ninja does not see that the material changed";
}

TEST(GenerateDepfile, IsUnderstoodByMake) {
  const std::string make = MAKE;
  if (make.empty()) GTEST_SKIP() << "make is not installed";
  const Sandbox box;
  fs::create_directories(box / kHardFolder);
  write_material(box / kHardFolder / "probe.json", "8", std::chrono::seconds(60));
  const std::string command = replaced(generate_command(kHardFolder), R"(\$)", "$$$$");
  const std::string target = R"(a\ b\#c$$d\e/out/probe.hpp)";
  write_file(box / "Makefile", "all: " + target + "\n-include d\n" + target + ":\n\t" + command + "\n");
  const Call call = {.arguments = {}, .folder = box.path(), .program = make};
  const Call up_to_date = {.arguments = {"-q"}, .folder = box.path(), .program = make};
  EXPECT_NE(run(call).out.find("wrote"), std::string::npos);
  write_material(box / kHardFolder / "probe.json", "9", std::chrono::seconds(0));
  EXPECT_EQ(run(up_to_date).exit_code, 1) << "make does not see that the material changed";
  EXPECT_NE(run(call).out.find("wrote"), std::string::npos);
  fs::last_write_time(box / kHardFolder / "out/probe.hpp",
                      fs::file_time_type::clock::now() + std::chrono::seconds(20));
  EXPECT_EQ(run(up_to_date).exit_code, 0);
}

TEST(GenerateBytes, AreTheSameFromAnyFolderByAnyPath) {
  const Sandbox box;
  fs::create_directories(box / "somewhere/else");
  write_file(box / "somewhere/probe.json", kMaterial);
  fs::create_hard_link(box / "somewhere/probe.json", box / "renamed.json");
  for (const std::string& format : kFormats) {
    const auto from = [&](const std::string& path, const fs::path& folder) {
      return printed({"generate", path, "--emit", format, "-o", "-"}, folder);
    };
    const std::string bytes = from("somewhere/probe.json", box.path());
    EXPECT_EQ(from("../probe.json", box / "somewhere/else"), bytes);
    EXPECT_EQ(from("./probe.json", box / "somewhere"), bytes);
    EXPECT_EQ(from((box / "somewhere/probe.json").string(), "/"), bytes);
    EXPECT_EQ(from("renamed.json", box.path()), bytes);
  }
}

TEST(GenerateBytes, AreTheSameForAShippedNameAndItsFile) {
  for (const auto& [folder, names] : {std::pair{"materials", kShipped}, std::pair{"resonators", kResonators}})
    for (const std::string& name : names)
      for (const std::string& format : kFormats) {
        const std::string file = (fs::path(SOURCE_FOLDER) / "data" / folder / (name + ".json")).string();
        EXPECT_EQ(printed({"generate", name, "--emit", format, "-o", "-"}),
                  printed({"generate", file, "--emit", format, "-o", "-"}));
      }
}

// de_DE.UTF-8 writes 1,5 for 1.5. It is built here, for a machine may lack it.
TEST(GenerateBytes, AreTheSameInEveryLocale) {
  const Sandbox box;
  const auto built = run(
      {.arguments = {"-i", "de_DE", "-f", "UTF-8", "./de_DE.UTF-8"}, .folder = box.path(), .program = "localedef"});
  if (built.exit_code != 0) GTEST_SKIP() << "no locale de_DE can be built: " << built.err;
  const auto in_locale = [&](const Words& arguments, const std::string& name) {
    return succeed({.arguments = arguments,
                    .environment = {{"LOCPATH", box.path().string()}, {"LC_ALL", name}, {"LANG", name}}});
  };
  for (const Words& arguments : std::vector<Words>{{"generate", "mb1", "--emit", "json", "-o", "-"},
                                                   {"generate", "mb1", "--emit", "cpp", "-o", "-"},
                                                   {"generate", "marimba_c4", "--emit", "faust", "-o", "-"},
                                                   {"inspect", "mb1"},
                                                   {"list", "materials"},
                                                   {"impact", "mb1", "--speed", "1.5", "--rate", "44100.5"}}) {
    EXPECT_EQ(in_locale(arguments, "de_DE.UTF-8"), in_locale(arguments, "C")) << arguments.front();
  }
}

TEST(GenerateBytes, HoldNoPathHostUserOrDate) {
  const Sandbox box;
  write_file(box / "probe.json", kMaterial);
  const std::string path = (box / "probe.json").string();
  succeed({.arguments = {"generate", path, "-o", (box / "out").string()}});
  succeed({.arguments = {"inspect", path, "--figure", (box / "out/a.svg").string()}});
  succeed({.arguments = {"render", "mass-barrier", "--material", path, "--duration", "0.01", "-o",
                         (box / "out/b.wav").string()}});
  std::string host(256, '\0');
  ASSERT_EQ(::gethostname(host.data(), host.size()), 0);
  host.resize(host.find('\0'));
  const char* date = R"(20\d\d-\d\d-\d\d|\d\d:\d\d:\d\d)"
                     R"(|\b(Mon|Tue|Wed|Thu|Fri|Sat|Sun|Jan|Feb|Mar|Apr|Jun|Jul|Aug|Sep|Oct|Nov|Dec)\b)";
  for (const auto& name : {"probe.lib", "probe.hpp", "probe.json", "a.svg", "b.svg", "b.wav"}) {
    const std::string bytes = read_file(box / "out" / name);
    for (const std::string& secret : Words{box.path().string(), fs::current_path().string(), SOURCE_FOLDER, kProgram,
                                           "/tmp/", "/home/", "/root/"})
      EXPECT_EQ(bytes.find(secret), std::string::npos) << name << " holds " << secret;
    EXPECT_TRUE(host.size() < 4 || bytes.find(host) == std::string::npos) << name << " holds " << host;
    EXPECT_FALSE(first_match(bytes, date)) << name;
  }
}

TEST(GeneratePermissions, FollowTheMask) {
  const Sandbox box;
  for (const auto& [mask, mode] : std::map<mode_t, mode_t>{{0022, 0644}, {0027, 0640}, {0077, 0600}, {0, 0666}}) {
    const std::string folder = std::to_string(mask);
    succeed({.arguments = {"generate", "mb1", "-o", folder}, .folder = box.path(), .umask = mask});
    for (const auto& file : fs::directory_iterator(box / folder))
      EXPECT_EQ(state_of(file).mode & 07777, mode) << file;
  }
}

// An output of an earlier version.
constexpr auto kOld = "// Written by contactspline 0.1.0\n";

TEST(GeneratePermissions, AreKept) {
  const Sandbox box;
  for (const mode_t mode : {0600u, 0755u, 0444u}) {
    write_file(box / "mb1.hpp", kOld);
    fs::permissions(box / "mb1.hpp", fs::perms(mode));
    printed({"generate", "mb1", "--emit", "cpp"}, box.path());
    EXPECT_EQ(state_of(box / "mb1.hpp").mode & 07777, mode);
    EXPECT_NE(read_file(box / "mb1.hpp"), kOld);
    fs::remove(box / "mb1.hpp");
  }
}

TEST(GenerateLink, StaysALinkAndItsTargetIsReplaced) {
  const Sandbox box;
  fs::create_directories(box / "store");
  write_file(box / "store/real.hpp", kOld);
  fs::create_symlink("store/real.hpp", box / "link.hpp");
  fs::create_symlink("link.hpp", box / "rubber_on_wood.hpp");
  const auto before = box.listing();
  EXPECT_EQ(printed({"generate", "rubber_on_wood", "--emit", "cpp"}, box.path()), "wrote ./rubber_on_wood.hpp\n");
  const auto after = box.listing();
  EXPECT_EQ(names_in(after), names_in(before));
  EXPECT_TRUE(after.at("rubber_on_wood.hpp") == before.at("rubber_on_wood.hpp"));
  EXPECT_TRUE(after.at("link.hpp") == before.at("link.hpp"));
  EXPECT_TRUE(S_ISREG(after.at("store/real.hpp").mode));
  EXPECT_EQ(after.at("store/real.hpp").content, printed({"generate", "rubber_on_wood", "--emit", "cpp", "-o", "-"}));
}

TEST(GenerateLink, ToAFolderIsAFolder) {
  const Sandbox box;
  fs::create_directories(box / "real");
  fs::create_directory_symlink("real", box / "out");
  printed({"generate", "mb1", "-o", "out"}, box.path());
  EXPECT_TRUE(fs::is_symlink(box / "out"));
  EXPECT_EQ(sorted_names(box / "real"), (Words{"mb1.hpp", "mb1.json", "mb1.lib"}));
}

TEST(GenerateName, OfAFileMayBeAsLongAsTheSystemAllows) {
  const Sandbox box;
  const std::string name(255, 'd');
  printed({"generate", "mb1", "-o", "out", "--depfile", name}, box.path());
  EXPECT_TRUE(fs::exists(box / name));
}

/// Waits up to a minute.
::testing::AssertionResult comes(const std::function<bool()>& is_there) {
  for (int i = 0; i < 6000; ++i) {
    if (is_there()) return ::testing::AssertionSuccess();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return ::testing::AssertionFailure() << "it never comes";
}

std::string probe_of(int exponent) {
  return replaced(kMaterial, R"("exponent": 2\.5)", fmt::format(R"("exponent": 2.{})", exponent));
}

// Written in place, renamed into place, and removed first, as editors do; with a bad file between.
TEST(GenerateWatch, WritesEachChangeAndSurvivesABadFile) {
  const Sandbox box;
  const fs::path file = box / "probe.json", made = box / "out/probe.lib", errors = box / "errors";
  const auto holds = [](const fs::path& path, const std::string& text) {
    return fs::exists(path) && read_file(path) == text;
  };
  std::vector<std::string> expected;
  for (int exponent = 1; exponent < 10; ++exponent) {
    write_file(file, probe_of(exponent));
    expected.push_back(printed({"generate", "probe.json", "--emit", "faust", "-o", "-"}, box.path()));
  }
  const std::string command = std::string(kProgram) + " generate probe.json --emit faust -o out --watch";
  const Process program(
      {.arguments = {"-c", "exec " + command + " 2>errors"}, .folder = box.path(), .program = "/bin/sh"});
  ASSERT_TRUE(comes([&] { return holds(made, expected.back()); }));
  for (int exponent = 1; exponent < 10; ++exponent) {
    if (exponent % 3 == 1) fs::remove(file);
    write_file(exponent % 3 == 0 ? box / "new" : file, probe_of(exponent));
    if (exponent % 3 == 0) fs::rename(box / "new", file);
    ASSERT_TRUE(comes([&] { return holds(made, expected[std::size_t(exponent) - 1]); })) << exponent;
  }
  write_file(file, "{");
  ASSERT_TRUE(comes([&] { return fs::file_size(errors) > 0; }));
  EXPECT_EQ(read_file(made), expected.back());
  write_file(file, probe_of(3));
  ASSERT_TRUE(comes([&] { return holds(made, expected[2]); }));
  EXPECT_TRUE(read_file(errors).starts_with("contactspline: probe.json: "));
}

TEST(GenerateWatch, NeedsFilesToWatchAndToWrite) {
  const Sandbox box;
  write_file(box / "probe.json", kMaterial);
  const auto refused = [&](const Words& words) {
    return run({.arguments = followed_by({"generate", "--watch"}, words), .folder = box.path()});
  };
  expect_refused(refused({"mb1"}), "mb1: --watch: is no file that can change", "my_felt.json");
  expect_refused(refused({"-"}), "standard input: --watch: is no file that can change", "my_felt.json");
  expect_refused(refused({"probe.json", "--check"}), "--watch: cannot be combined with --check", "-o DIR");
  expect_refused(refused({"probe.json", "-o", "-"}), "--watch: cannot be combined with -o -", "-o DIR");
}

// A struct must not be called like one of its members, and the emitted header must not hide what it uses.
TEST(GenerateName, CannotBeOneThatTheHeaderUses) {
  const Sandbox box;
  const std::string header = printed({"generate", "mb1", "--emit", "cpp", "--all-forms", "-o", "-"});
  const char* declared = R"((?:(?:double|size_t|segments>|struct) )([a-z_0-9]+)(?= =| \{))";
  std::set<std::string> names = {"std", "contactspline_modal", "motion"};
  for (const Groups& match : matches_of(header, declared)) names.insert(match[1]);
  names.erase("mb1");
  for (const std::string name : {"a", "b", "c"}) names.erase(name);  // members of `regular`, not of the struct
  EXPECT_GE(names.size(), 14u);
  for (const std::string& name : names) {
    std::string text = kMaterial;
    write_file(box / "probe.json", text.replace(text.find("probe"), 5, name));
    expect_refused(run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}),
                   "probe.json: name: '" + name + "' is not a usable identifier", "no name of the emitted files");
  }
}

}  // namespace
}  // namespace contactspline::testing
