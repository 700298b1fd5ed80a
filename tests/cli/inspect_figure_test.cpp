// SPDX-License-Identifier: MIT
// contactspline inspect --figure: the figure can be drawn, and shows what it should.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

class Inspect : public ::testing::TestWithParam<int> {};

TEST_P(Inspect, DrawsAFigure) {
  const Sandbox box;
  write_file(box / "probe.json", material(GetParam()));
  fs::create_directory(box / "figures");
  const std::string report = printed(box, {"inspect", "probe.json", "--figure", "figures/probe.svg"});
  EXPECT_TRUE(report.ends_with("\nfigure: figures/probe.svg\n"));
  expect_drawn(box / "figures/probe.svg", 10);
  EXPECT_NE(read_svg(box / "figures/probe.svg").text.find(fmt::format("a probe: {} segments", GetParam())),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Segments, Inspect, ::testing::Values(1, 2, 3, 64, 1024, 65536));

TEST(InspectFigure, ShowsADescriptionAsItIs) {
  for (const std::string description :
       {"a < b & c > d ]]>", "don't", "it''s 'x'", "\xc3\xa4\xe2\x82\xac", "{/Symbol a}_{b}^2 @x %s", "-->",
        "$0 `date`", "&#x41; &#x1; &amp; &", "TITLE-OF-THE-FIGURE"}) {
    const Sandbox box;
    write_file(box / "probe.json", material(4, description));
    printed(box, {"inspect", "probe.json", "--figure", "a.svg"});
    EXPECT_NE(read_svg(box / "a.svg").text.find(description + ": 4 segments"), std::string::npos) << description;
  }
}

TEST(InspectFigure, AlignsItsPanels) {
  const Sandbox box;
  for (const std::string name : {"felt_c4", "felt_synthetic", "mb1"}) {
    printed(box, {"inspect", name, "--figure", name + ".svg"});
    EXPECT_EQ(columns_of(box / (name + ".svg")).size(), 2u) << name;
  }
  printed(box, {"inspect", "felt_c4", "--compare", "--figure", "families.svg"});
  EXPECT_EQ(columns_of(box / "families.svg").size(), 1u);
  printed(box, {"render", "mass-barrier", "--duration", "1", "-o", "bounce.wav"});
  EXPECT_EQ(columns_of(box / "bounce.svg").size(), 1u);
}

// The members lie below the other curves, the measured samples above: the names stand in the order of drawing.
TEST(InspectFigure, ShowsTheFamilyOfALiveExponentAndTheMeasuredSamples) {
  const Sandbox box;
  const auto names = [&](const std::string& material) {
    const std::string file = material + ".svg";
    printed(box, {"inspect", material, "--figure", file});
    expect_drawn(box / file, 11);
    return read_svg(box / file).text;
  };
  const std::string live = names("felt_live"), measured = names("felt_synthetic");
  EXPECT_LT(live.rfind("exponents 1.2 to 3.2"), live.rfind("power law"));
  ASSERT_NE(measured.rfind("measured"), std::string::npos);
  EXPECT_GT(measured.rfind("measured"), measured.rfind("smoothed curve"));
}

TEST(InspectFigure, OfTheDocsCutsNoLabelOff) {
  std::size_t figures = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(SOURCE_FOLDER) / "docs/figures")) {
    if (entry.path().extension() != ".svg" || entry.path().stem().string().ends_with("_blocks")) continue;
    expect_labels_whole(entry.path());
    ++figures;
  }
  EXPECT_GE(figures, 4u);
}

TEST(InspectFigure, DoesNotDependOnTheUserOrTheLocale) {
  const Sandbox box;
  const std::string folder = "it's \"a\" folder";
  fs::create_directories(box / folder);
  write_file(box / folder / ".gnuplot", "set logscale xy\nset title 'mine'\nset decimalsign ','\n");
  run({.arguments = {"-i", "de_DE", "-f", "UTF-8", "./de_DE.UTF-8"}, .folder = box.path(), .program = "localedef"});
  printed(box, {"inspect", "mb1", "--figure", "a.svg"});
  succeed({.arguments = {"inspect", "mb1", "--figure", "b.svg"},
           .folder = box.path(),
           .environment = {{"HOME", (box / folder).string()},
                           {"TMPDIR", (box / folder).string()},
                           {"LOCPATH", box.path().string()},
                           {"LC_ALL", "de_DE.UTF-8"}}});
  EXPECT_TRUE(read_file(box / "a.svg") == read_file(box / "b.svg"));
}

TEST(InspectFigure, IsUntouchedWhereNothingChanged) {
  const Sandbox box;
  printed(box, {"inspect", "mb1", "--figure", "a.svg"});
  const auto before = box.listing();
  printed(box, {"inspect", "mb1", "--figure", "a.svg"});
  EXPECT_TRUE(box.listing() == before);
}

TEST(InspectFigure, IsRefusedWhereItCannotBeDrawn) {
  const Sandbox box;
  fs::create_directories(box / "bin");
  write_file(box / "probe.json", material(1024));  // more than a pipe holds
  const auto refused = [&](const std::string& says) {
    const auto before = box.listing();
    const auto outcome = run({.arguments = {"inspect", "probe.json", "--figure", "a.svg"},
                              .folder = box.path(),
                              .environment = {{"PATH", (box / "bin").string()}}});
    expect_refused(outcome, "figure: ", says);
    EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  };
  const auto fake_gnuplot = [&](const std::string& script) {
    write_file(box / "bin/gnuplot", "#!/bin/sh\n" + script + "\n");
    fs::permissions(box / "bin/gnuplot", fs::perms(0755));
  };
  refused("gnuplot is not installed; install the package gnuplot-nox");
  fake_gnuplot("exit 1");
  refused("gnuplot failed");
  fake_gnuplot("kill -9 $$");
  refused("gnuplot failed");
  fake_gnuplot("exec /bin/cat >/dev/null");
  refused("gnuplot drew nothing");
  fake_gnuplot("/bin/cat >/dev/null; echo '<svg>'");
  refused("gnuplot drew nothing");
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// Speeds from 0.1 to 6 m/s on two axes, compressions from 0.104 to 1.085 mm on the third.
TEST(InspectFamilies, LabelEveryAxisOfTheFigure) {
  const Sandbox box;
  printed(box, {"inspect", "felt_c4", "--compare", "--figure", "families.svg"});
  const auto labels = read_svg(box / "families.svg").labels;
  for (const auto label : {"0.2", "0.5"}) EXPECT_EQ(std::ranges::count(labels, label), 3) << label;
}

TEST(InspectFamilies, LabelTheEndsOfAnAxisTooShortForMore) {
  const Sandbox box;
  std::string text = material(4);
  text.replace(text.find("\"max_speed_m_per_s\": 2, \"min_speed_m_per_s\": 0.1"), 47,
               R"("max_speed_m_per_s": 4.9, "min_speed_m_per_s": 2.1)");
  write_file(box / "probe.json", text);
  printed(box, {"inspect", "probe.json", "--compare", "--figure", "families.svg"});
  const std::string labels = read_svg(box / "families.svg").text;
  EXPECT_EQ(count_of(labels, "2.1"), 2u);
  EXPECT_EQ(count_of(labels, "4.9"), 2u);
}

}  // namespace
}  // namespace contactspline::testing
