// SPDX-License-Identifier: MIT
// The command line: subcommands, and every failure as one line.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/output.hpp"
#include "generator/error.hpp"

namespace {

constexpr int kStale = 1;
constexpr int kBadInput = 2;

// One line that a terminal can show, whatever a file or an argument is called.
int complain(std::string message, int exit_code) {
  std::ranges::replace_if(
      message, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  std::fputs(("contactspline: " + message + "\n").c_str(), stderr);  // fmt::print would throw where nobody listens
  return exit_code;
}

void add_version(CLI::App& command) {
  command.set_version_flag("--version", "contactspline " CONTACTSPLINE_VERSION, "Print the version and exit");
  for (CLI::App* subcommand : command.get_subcommands([](CLI::App*) { return true; })) add_version(*subcommand);
}

const CLI::App& innermost_given(const CLI::App& app) {
  const auto given = app.get_subcommands();
  return given.empty() ? app : innermost_given(*given.front());
}

std::vector<std::string> words_of(const CLI::App& command) {
  std::vector<std::string> words;
  for (const auto* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
    words.push_back(subcommand->get_name());
  for (const auto* option : command.get_options()) words.push_back(option->get_name());
  return words;
}

// CLI11 says what is wrong, but not what is allowed.
std::string explained(const CLI::App& app, const CLI::ParseError& error) {
  const std::string wrong = error.what();
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr) return wrong;
  const CLI::App& command = innermost_given(app);
  for (const std::string& word : app.remaining(true))
    if (word != "--") return fmt::format("{}: unknown; allowed: {}", word, fmt::join(words_of(command), ", "));
  for (const auto* option : command.get_options()) {
    const std::string& name = option->get_name();
    if (wrong.find(name) == std::string::npos) continue;
    const std::string what = wrong == name + " is required" ? name + ": missing"
                             : wrong.starts_with(name)      ? wrong
                                                            : name + ": " + wrong;
    return fmt::format("{}; allowed: {}", what, option->get_description());
  }
  return fmt::format("SUBCOMMAND: missing; allowed: {}", fmt::join(words_of(command), ", "));
}

// Whatever CLI11 has to print goes out checked, like all other output.
void run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    std::ostringstream text;
    app.exit(request, text);
    contactspline::write_stdout(text.str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a full disk or a quota is an error to report, not a reason to die
  CLI::App app(
      "Collisions in musical instruments without iteration: splines of contact potentials for Faust and C++.",
      "contactspline");
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer(
      "A first try:\n"
      "  contactspline materials\n"
      "  contactspline inspect felt_c4 --svg felt_c4.svg\n"
      "  contactspline generate felt_c4 -o generated\n"
      "  contactspline render mass-barrier --material rubber_on_wood -o bounce.wav\n"
      "Exit status: 0; 1 where --check finds stale files; 2 for bad input, with one line that names it.");
  contactspline::add_generate(app);
  contactspline::add_inspect(app);
  contactspline::add_materials(app);
  contactspline::add_scores(app);
  contactspline::add_impact(app);
  contactspline::add_render(app);
  add_version(app);
  try {
    run(app, argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return complain(explained(app, error), kBadInput);
  } catch (const contactspline::Stale& error) {
    return complain(error.what(), kStale);
  } catch (const contactspline::BadInput& error) {
    return complain(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return complain("memory: not enough; allowed: a shorter duration, a lower rate or fewer segments", kBadInput);
  } catch (const std::exception& error) {
    return complain(fmt::format("internal error, please report: {}", error.what()), kBadInput);
  }
}
