// SPDX-License-Identifier: MIT
// The command line: subcommands, and every failure as one line.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <string>

#include "generator/cli/commands.hpp"
#include "generator/error.hpp"

namespace {

constexpr int kStale = 1;
constexpr int kBadInput = 2;

int complain(std::string message, int exit_code) {
  std::ranges::replace(message, '\n', ' ');
  fmt::print(stderr, "contactspline: {}\n", message);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a full disk or a quota is an error to report, not a reason to die
  CLI::App app(
      "Collisions in musical instruments without iteration: splines of contact potentials for Faust and C++.",
      "contactspline");
  app.set_version_flag("--version", "contactspline " CONTACTSPLINE_VERSION);
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
  contactspline::add_impact(app);
  contactspline::add_render(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& request) {
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return complain(error.what(), kBadInput);
  } catch (const contactspline::Stale& error) {
    return complain(error.what(), kStale);
  } catch (const contactspline::BadInput& error) {
    return complain(error.what(), kBadInput);
  } catch (const std::exception& error) {
    return complain(fmt::format("internal error, please report: {}", error.what()), kBadInput);
  }
}
