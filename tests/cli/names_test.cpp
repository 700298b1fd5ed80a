// SPDX-License-Identifier: MIT
// Names: those that the program accepts compile, those of materials as the README uses them. Macros are refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

constexpr auto kHeaders =
    "#include <algorithm>\n#include <cassert>\n#include <cerrno>\n#include <cmath>\n#include <complex>\n#include "
    "<csetjmp>\n"
    "#include <csignal>\n#include <cstdarg>\n#include <cstdio>\n#include <cstdlib>\n#include <ctime>\n#include "
    "<string>\n"
    "#include <thread>\n#include <arpa/inet.h>\n#include <fcntl.h>\n#include <net/if.h>\n#include <netdb.h>\n"
    "#include <netinet/in.h>\n#include <sys/ioctl.h>\n#include <sys/param.h>\n#include <sys/resource.h>\n"
    "#include <sys/socket.h>\n#include <sys/stat.h>\n#include <sys/time.h>\n#include <sys/types.h>\n#include "
    "<unistd.h>\n";

std::string material(const std::string& name) {
  return fmt::format(R"({{"name": "{}", "contact": {{"stiffness_n_per_m_alpha": 1e9, "exponent": 2}},
    "spline": {{"knots": "uniform", "segments": 4, "max_compression_m": 1e-3}}}})",
                     name);
}

// Lower-case names that a material could have.
std::set<std::string> macros_in(const std::string& list) {
  std::set<std::string> names;
  std::istringstream lines(list);
  for (std::string define, name; lines >> define >> name; std::getline(lines, define)) {
    name = name.substr(0, name.find('('));
    if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos && name.front() != '_' &&
        name.find("__") == std::string::npos)
      names.insert(name);
  }
  return names;
}

TEST(Names, OfMacrosAreRefused) {
  const Sandbox box;
  write_file(box / "all.cpp", kHeaders);
  const Outcome found =
      run_program({.arguments = {"-std=gnu++20", "-dM", "-E", "all.cpp"}, .folder = box.path(), .program = "c++"});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const auto names = macros_in(found.out);
  EXPECT_GT(names.size(), 20u);
  for (const std::string& name : names) {
    write_file(box / "probe.json", material(name));
    expect_refused(run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()}),
                   "probe.json: name: ", "no keyword, macro or library");
  }
}

/// A program that includes headers beside it.
void expect_compiles(const Sandbox& box, const std::string& source) {
  write_file(box / "use.cpp", source);
  const Outcome compiled = run_program(
      {.arguments = {"-std=gnu++20", "-fsyntax-only", "-I.", fmt::format("-I{}/runtime", SOURCE_FOLDER), "use.cpp"},
       .folder = box.path(),
       .program = "c++"});
  EXPECT_EQ(compiled.exit_code, 0) << compiled.err;
}

// Behind a using-declaration, as in the README, with names that stand for something else elsewhere.
TEST(Names, ThatAreAcceptedCompile) {
  const Sandbox box;
  std::string includes = kHeaders, uses;
  includes += "#include \"contactspline/models/mass_barrier.hpp\"\n";
  for (const std::string name : {"printf", "size_t", "materials", "resonators", "detail", "main", "y0", "data",
                                 "table", "segment", "float_t", "a", "hammer"}) {
    write_file(box / "probe.json", material(name));
    succeed({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
    includes += fmt::format("#include \"out/{}.hpp\"\n", name);
    uses += fmt::format(
        "inline double use_{0}() {{\n  using contactspline::materials::{0};\n  constexpr auto& knots = "
        "contactspline::segments_of<{0}, float>;\n  contactspline::MassBarrier<float, knots.size()> model(knots, "
        "44100.0f);\n"
        "  model.throw_from(-0.001f, 2.0f);\n  return model.force() + {0}::max_compression_m;\n}}\n",
        name);
  }
  expect_compiles(box, includes + uses);
}

std::string resonator(const std::string& name) {
  return fmt::format(R"({{"name": "{}", "modes": [{{"frequency_hz": 440, "decay_per_s": 1, "mass_kg": 0.01,
    "strike_shape": 1, "pickup_shape": 1}}]}})",
                     name);
}

std::string instrument(const std::string& name) {
  return fmt::format(R"({{"name": "{}", "bodies": [{{"name": "a", "mass_kg": 0.1}}, {{"name": "b", "mass_kg": 1}}],
    "contacts": [{{"name": "c", "between": ["a", "b"], "material": "felt_c4"}}], "strikes": ["a"],
    "controls": [{{"name": "d", "damping_per_s": "b"}}], "outputs": [{{"name": "o", "force_n": "c"}}]}})",
                     name);
}

std::string keyboard(const std::string& name) {
  std::string text = read_file(SOURCE_FOLDER "/tests/fuzz/corpus/keyboard/two.json");
  const std::string before = R"("name": "two")";
  return text.replace(text.find(before), before.size(), fmt::format(R"("name": "{}")", name));
}

std::set<std::string> words_in(const std::string& text) {
  std::set<std::string> words;
  std::string word;
  for (const char c : text + " ") {
    if (c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0) {
      word += c;
    } else {
      words.insert(word);
      word.clear();
    }
  }
  return words;
}

struct Kind {
  std::string folder;
  std::string (*file)(const std::string& name);
  std::string use;  // uses a name of that namespace
};

void PrintTo(const Kind& kind, std::ostream* stream) {
  *stream << kind.folder;
}

class EmittedHeader : public ::testing::TestWithParam<Kind> {};

// Each word of an emitted header as a name. All headers stand in one program: a name must not break the next ones.
TEST_P(EmittedHeader, MayHaveEachOfItsWordsAsAName) {
  const Sandbox box;
  const auto generate = [&](const std::string& name) {
    write_file(box / "probe.json", GetParam().file(name));
    return run({.arguments = {"generate", "probe.json", "--emit", "cpp", "-o", "out"}, .folder = box.path()});
  };
  succeed(generate("probe"));
  const auto words = words_in(read_file(box / "out/probe.hpp"));
  std::string includes, uses;
  for (const std::string& word : words) {
    if (generate(word).exit_code != 0) continue;
    includes += fmt::format("#include \"out/{}.hpp\"\n", word);
    uses += fmt::format(fmt::runtime(GetParam().use), fmt::format("contactspline::{}::{}", GetParam().folder, word));
  }
  EXPECT_NE(includes.find("out/probe.hpp"), std::string::npos);
  expect_compiles(box, includes + uses);
}

INSTANTIATE_TEST_SUITE_P(Names, EmittedHeader,
                         ::testing::Values(Kind{"materials", material, "static_assert({}::segments > 0);\n"},
                                           Kind{"resonators", resonator, "static_assert({}::modes > 0);\n"},
                                           Kind{"keyboards", keyboard, "static_assert({}::keys > 0);\n"},
                                           Kind{"instruments", instrument, "template class {}<double>;\n"}),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace contactspline::testing
