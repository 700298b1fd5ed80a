// SPDX-License-Identifier: MIT
// contactspline render: the sound is the model's motion, the figure can be drawn.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "contactspline/models/mass_barrier.hpp"
#include "generator/contact/barrier_impact.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

// Renders in a sandbox and returns what was printed.
std::string render(const Sandbox& box, const Words& options, const std::string& name = "a.wav") {
  return succeed({.arguments = followed_by({"render", "mass-barrier", "-o", name}, options), .folder = box.path()});
}

Sound sound_of(const Words& options) {
  const Sandbox box;
  render(box, options);
  return read_sound(box / "a.wav");
}

Design shipped(const std::string& file) {
  const auto texts = embedded_files(Shipped::kMaterials);
  return design_material(std::ranges::find(texts, file, &EmbeddedFile::name)->content, file);
}

/// Displacement [m] and contact force [N] of a bouncing mass, sample by sample.
struct Motion {
  std::vector<double> displacement_m, force_n;
};

Motion motion_of(const Design& design, double duration_s, double rate_hz) {
  const auto table = segment_table(design.spline);
  MassBarrier<double> model(table, rate_hz);
  model.throw_from(-0.001, design.material.impact->max_speed_m_per_s);
  Motion motion;
  for (int n = 0; n < static_cast<int>(std::llround(duration_s * rate_hz)); ++n) {
    model.tick({.mass_kg = design.material.impact->mass_kg, .gravity_m_per_s2 = 9.81});
    motion.displacement_m.push_back(model.displacement());
    motion.force_n.push_back(model.force());
  }
  return motion;
}

// The last 10 ms fade to 0 by a raised cosine.
double fade(std::size_t sample, std::size_t samples, double rate_hz) {
  const double from_end = static_cast<double>(samples - 1 - sample) / (0.01 * rate_hz);
  return from_end >= 1 ? 1 : std::pow(std::sin(std::numbers::pi / 2 * from_end), 2);
}

void expect_is(const Sound& sound, std::vector<double> motion) {
  double largest = 0;
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] *= fade(i, motion.size(), sound.rate);
  for (const double value : motion) largest = std::max(largest, std::abs(value));
  ASSERT_GT(largest, 0);
  std::vector<double> expected;
  for (const double value : motion) expected.push_back(value * kPeak / largest);
  EXPECT_TRUE(sequences_within<double>(sound.samples, expected, 1.01 * kLevel / kPeak));
}

TEST(Render, WritesTheForceOfTheModel) {
  const Sandbox box;
  render(box, {"--duration", "0.5"});
  const Sound sound = read_sound(box / "a.wav");
  EXPECT_EQ(sound.rate, 44100);
  EXPECT_EQ(sound.channels, 1);
  EXPECT_EQ(sound.format, SF_FORMAT_WAV | SF_FORMAT_PCM_24);
  EXPECT_EQ(sound.samples.size(), 22050u);
  EXPECT_TRUE(within(sound.peak(), kPeak, kLevel));
  expect_is(sound, motion_of(shipped("rubber_on_wood.json"), 0.5, 44100).force_n);
  expect_drawn(box / "a.svg", 3);
}

TEST(Render, HasTheMaterialsLossUnlessAnotherIsGiven) {
  const Words felt = {"--material", "felt_synthetic", "--duration", "0.1"};
  const auto own = sound_of(felt).samples;
  EXPECT_EQ(own, sound_of(followed_by(felt, {"--loss", "0.1"})).samples);
  EXPECT_NE(own, sound_of(followed_by(felt, {"--loss", "0"})).samples);
}

TEST(Render, WritesTheDisplacementOfTheModel) {
  const Sound sound = sound_of({"--duration", "1", "--signal", "displacement", "--material", "felt_c4"});
  EXPECT_TRUE(within(sound.peak(), kPeak, kLevel));
  expect_is(sound, motion_of(shipped("felt_c4.json"), 1, 44100).displacement_m);
}

TEST(Render, HasTheRateAndLengthAskedFor) {
  for (const auto& [rate, duration, samples] : std::vector<std::tuple<int, double, std::size_t>>{
           {1000, 0.001, 1}, {8000, 0.1, 800}, {48000, 0.25, 12000}, {96000, 0.01, 960}, {768000, 0.001, 768}}) {
    const Sound sound = sound_of({"--rate", fmt::format("{}", rate), "--duration", fmt::format("{}", duration)});
    EXPECT_EQ(sound.rate, rate);
    EXPECT_EQ(sound.samples.size(), samples);
    EXPECT_TRUE(within(sound.peak(), kPeak, kLevel)) << rate;
  }
}

TEST(Render, SaysWhatItRendered) {
  const Sandbox box;
  for (const char* folder : {"p", "s"}) fs::create_directory(box / folder);
  const std::string report = render(box, {"--duration", "1", "--figure", "p/b.svg"}, "s/a.wav");
  const auto motion = motion_of(shipped("rubber_on_wood.json"), 1, 44100);
  const double largest = std::ranges::max(motion.force_n);
  std::size_t contacts = 0;
  for (std::size_t i = 1; i < motion.force_n.size(); ++i)
    contacts += motion.force_n[i] > 0 && motion.force_n[i - 1] == 0;
  EXPECT_EQ(report, fmt::format("{} contacts in 1 s, largest contact force {:.4g} N\n"
                                "full scale of the sound: {:.4g} N (contact force)\n"
                                "sound:  s/a.wav\nfigure: p/b.svg\n",
                                contacts, largest, largest / kPeak));
  expect_drawn(box / "p/b.svg", 3);
  EXPECT_FALSE(fs::exists(box / "s/a.svg"));
}

TEST(Render, GivesTheSameBytesFromAnyFolderByAnyPath) {
  const Sandbox box;
  const auto texts = embedded_files(Shipped::kMaterials);
  fs::create_directories(box / "some/where");
  write_file(box / "some/mb1.json", std::ranges::find(texts, "mb1.json", &EmbeddedFile::name)->content);
  const auto render_from = [&](const fs::path& folder, const std::string& material, const std::string& sound) {
    succeed({.arguments = {"render", "mass-barrier", "--material", material, "--duration", "0.1", "-o", sound},
             .folder = folder});
  };
  render_from(box.path(), "mb1", "a.wav");
  render_from(box / "some", "./mb1.json", "where/b.wav");
  render_from("/", (box / "some/mb1.json").string(), (box / "c.wav").string());
  for (const std::string kind : {"wav", "svg"}) {
    EXPECT_TRUE(read_file(box / ("some/where/b." + kind)) == read_file(box / ("a." + kind)));
    EXPECT_TRUE(read_file(box / ("c." + kind)) == read_file(box / ("a." + kind)));
  }
}

// Duration of the first contact in a rendered force, to a fraction of a sample of its ends.
double contact_duration_s(const Sound& force) {
  const auto touches = [](double sample) { return sample > 0; };
  const auto begin = std::ranges::find_if(force.samples, touches);
  const auto end = std::find_if_not(begin, force.samples.end(), touches);
  EXPECT_NE(begin, force.samples.end());
  EXPECT_NE(end, force.samples.end());
  return static_cast<double>(end - begin) / force.rate;
}

// T ~ k^(-1/(a + 1)). The speed keeps every contact inside the spline's range and over several of its segments.
TEST(Render, StiffnessRatioShortensTheContactByTheScalingLaw) {
  for (const auto& [name, speed] :
       std::vector<std::pair<std::string, double>>{{"rubber_on_wood", 2}, {"felt_c4", 3}}) {
    const auto design = shipped(name + ".json");
    const double exponent = design.material.contact.power_law()->exponent;
    const double exact_s = contact_duration(design.material.contact, design.material.impact->mass_kg, speed);
    for (const double ratio : {0.25, 1.0, 4.0, 16.0}) {
      const Sound sound = sound_of({"--material", name, "--stiffness-ratio", fmt::format("{}", ratio), "--speed",
                                    fmt::format("{}", speed), "--gravity", "0", "--start", "0", "--rate", "768000",
                                    "--duration", "0.02"});
      const double scaled_s = exact_s * std::pow(ratio, -1 / (exponent + 1));
      EXPECT_TRUE(within(contact_duration_s(sound), scaled_s, 0.006 * scaled_s + 2.0 / 768000)) << name << ratio;
    }
  }
}

TEST(Render, MassSpeedGravityLossAndStartReachTheModel) {
  const Words plain = {"--duration", "0.3"};
  const auto reference = sound_of(plain).samples;
  for (const Words& option : std::vector<Words>{{"--mass", "0.01"},
                                                {"--speed", "3.9"},
                                                {"--gravity", "9.8"},
                                                {"--loss", "0.01"},
                                                {"--start", "-0.0011"},
                                                {"--stiffness-ratio", "1.01"}})
    EXPECT_NE(sound_of(followed_by(plain, option)).samples, reference) << option.front();
  const auto defaults = sound_of(followed_by(plain, {"--mass", "0.009", "--speed", "4", "--gravity", "9.81", "--loss",
                                                     "0", "--start", "-0.001", "--stiffness-ratio", "1"}));
  EXPECT_EQ(defaults.samples, reference);
}

struct Extreme {
  std::string test;
  Words options;
  std::string says;
  bool is_silent = false;
};

void PrintTo(const Extreme& extreme, std::ostream* stream) {
  *stream << extreme.test;
}

class RenderExtreme : public ::testing::TestWithParam<Extreme> {};

TEST_P(RenderExtreme, GivesASoundAndAFigure) {
  const Sandbox box;
  const std::string report = render(box, GetParam().options);
  EXPECT_NE(report.find(GetParam().says), std::string::npos) << report;
  for (const auto word : {"nan", "inf"}) EXPECT_EQ(report.find(word), std::string::npos) << report;
  const double peak = read_sound(box / "a.wav").peak();
  EXPECT_TRUE(within(peak, GetParam().is_silent ? 0 : kPeak, kLevel));
  expect_drawn(box / "a.svg", report.starts_with("0 contacts") ? 1 : 3);  // then the force has no panels
}

INSTANTIATE_TEST_SUITE_P(
    , RenderExtreme,
    ::testing::Values(
        Extreme{"no_contact_in_the_time", {"--start", "-100", "--duration", "0.1"}, "0 contacts", true},
        Extreme{"no_contact_at_all", {"--speed", "0", "--gravity", "0", "--duration", "0.1"}, "0 contacts", true},
        Extreme{"one_sample", {"--rate", "1000", "--duration", "0.001"}, "1 contacts"},
        Extreme{
            "one_sample_of_silence", {"--rate", "1000", "--duration", "0.001", "--start", "-1"}, "0 contacts", true},
        Extreme{"two_samples", {"--rate", "1000", "--duration", "0.002"}, "1 contacts"},
        Extreme{"shorter_than_a_contact", {"--start", "0", "--rate", "192000", "--duration", "0.001"}, "1 contacts"},
        Extreme{"ten_minutes", {"--rate", "4000", "--duration", "600"}, "contacts in 600 s"},
        Extreme{
            "at_rest_in_contact", {"--start", "0", "--speed", "0", "--loss", "10", "--duration", "20"}, "1 contacts"},
        Extreme{"deep_in_the_barrier", {"--start", "1", "--duration", "0.1"}, "contacts"},
        Extreme{
            "softest_and_slowest", {"--stiffness-ratio", "1e-6", "--speed", "1e-6", "--duration", "1"}, "contacts"},
        Extreme{
            "stiffest_and_fastest", {"--stiffness-ratio", "1e6", "--speed", "1000", "--duration", "0.1"}, "contacts"},
        Extreme{"lightest", {"--mass", "1e-9", "--material", "steel_on_steel", "--duration", "0.1"}, "contacts"},
        Extreme{"heaviest", {"--mass", "1e4", "--material", "steel_on_steel", "--duration", "0.1"}, "contacts"},
        Extreme{"max_gravity_and_loss", {"--gravity", "1000", "--loss", "1000", "--duration", "0.1"}, "contacts"},
        Extreme{
            "far_below", {"--start", "-1000", "--speed", "1000", "--duration", "1.1", "--rate", "8000"}, "contacts"},
        Extreme{"displacement_of_nothing",
                {"--start", "0", "--speed", "0", "--gravity", "0", "--signal", "displacement", "--duration", "0.1"},
                "0 contacts",
                true}),
    ::testing::PrintToStringParamName());

// The motion of displacement is far from 0 at the end.
TEST(Render, FadesTheEnd) {
  for (const int rate : {8000, 44100, 96000}) {
    const Sound sound = sound_of({"--signal", "displacement", "--start", "-100", "--speed", "0", "--gravity", "0",
                                  "--duration", "0.1", "--rate", fmt::format("{}", rate)});
    ASSERT_EQ(sound.samples.size(), static_cast<std::size_t>(rate / 10));
    for (std::size_t i = 0; i < sound.samples.size(); ++i)
      ASSERT_TRUE(within(sound.samples[i], -kPeak * fade(i, sound.samples.size(), rate), 1.01 * kLevel)) << i;
  }
}

// A gain is relative to 1 N; without one no word of clipping, with a large one a count.
TEST(Render, HasTheGainAskedFor) {
  const auto force = motion_of(shipped("rubber_on_wood.json"), 0.1, 44100).force_n;
  for (const auto& [gain, scale, full_scale] :
       std::vector<std::tuple<std::string, double, std::string>>{{"-40", 0.01, "100 N"},
                                                                 {"-120", 1e-6, "1e+06 N"},
                                                                 {"off", 1, "1 N"},
                                                                 {"0", 1, "1 N"},
                                                                 {"-36.5", 0.0149623565, "66.83 N"}}) {
    const Sandbox box;
    const Outcome outcome = run(
        {.arguments = {"render", "mass-barrier", "--duration", "0.1", "--gain", gain, "--no-figure", "-o", "a.wav"},
         .folder = box.path()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("full scale of the sound: " + full_scale + " (contact force)\n"), std::string::npos)
        << outcome.out;
    const Sound sound = read_sound(box / "a.wav");
    std::size_t clipped = 0;
    double largest = 0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double expected = scale * force[i] * fade(i, force.size(), 44100);
      clipped += expected > 1;
      largest = std::max(largest, expected);
      ASSERT_TRUE(within(sound.samples[i], std::min(expected, 1.0), 1.01 * kLevel)) << gain << " " << i;
    }
    const double over_db = 20 * std::log10(largest);
    EXPECT_EQ(outcome.err, clipped == 0
                               ? ""
                               : fmt::format("contactspline: a.wav: {} samples exceed full scale, by {:.1f} dB, "
                                             "and are clipped; a lower --gain or --level keeps them\n",
                                             clipped, over_db));
    EXPECT_EQ(clipped > 0, scale > 0.0149) << gain;
  }
}

TEST(Render, WritesTheFormatOfTheName) {
  const std::vector<double> wav = sound_of({"--duration", "0.1"}).samples;
  for (const auto& [name, format] :
       std::vector<std::pair<std::string, int>>{{"a.WAV", SF_FORMAT_WAV | SF_FORMAT_PCM_24},
                                                {"a.flac", SF_FORMAT_FLAC | SF_FORMAT_PCM_24},
                                                {"a.aiff", SF_FORMAT_AIFF | SF_FORMAT_PCM_24},
                                                {"a.b.Aif", SF_FORMAT_AIFF | SF_FORMAT_PCM_24},
                                                {"a.ogg", SF_FORMAT_OGG | SF_FORMAT_VORBIS}}) {
    const Sandbox box;
    render(box, {"--duration", "0.1", "--no-figure"}, name);
    EXPECT_EQ(names_in(box.listing()), name + "\n");
    const Sound sound = read_sound(box / name);
    EXPECT_EQ(sound.format, format) << name;
    EXPECT_EQ(sound.rate, 44100) << name;
    ASSERT_EQ(sound.samples.size(), wav.size()) << name;
    if (format != (SF_FORMAT_OGG | SF_FORMAT_VORBIS)) {
      EXPECT_TRUE(sequences_within<double>(sound.samples, wav, 1.01 * kLevel / kPeak)) << name;
      continue;
    }
    double difference = 0, energy = 0;  // Vorbis loses what is hardly audible
    for (std::size_t i = 0; i < wav.size(); ++i) {
      difference += (sound.samples[i] - wav[i]) * (sound.samples[i] - wav[i]);
      energy += wav[i] * wav[i];
    }
    EXPECT_LT(difference, 0.05 * energy) << name;
  }
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8 | static_cast<unsigned char>(bytes[at + i]);
  return number;
}

// By the polynomial of the PNG specification, which the chunks that gnuplot wrote confirm.
std::uint32_t crc_of(std::string_view bytes) {
  std::uint32_t crc = ~0u;
  for (const char byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool is_odd = ((crc ^ static_cast<std::uint32_t>(static_cast<unsigned char>(byte)) >> bit) & 1) != 0;
      crc = crc >> 1 ^ (is_odd ? 0xedb88320u : 0u);
    }
  return ~crc;
}

TEST(Render, DrawsAPngWithTheMarkInAChunkOfText) {
  const Sandbox box;
  render(box, {"--duration", "0.1", "--figure", "b.png"});
  EXPECT_EQ(names_in(box.listing()), "a.wav\nb.png\n");
  const std::string png = read_file(box / "b.png");
  ASSERT_TRUE(png.starts_with("\x89PNG\r\n\x1a\n"));
  std::vector<std::string> types;
  for (std::size_t at = 8; at + 12 <= png.size();) {
    const std::size_t length = big_endian(png, at);
    ASSERT_LE(at + 12 + length, png.size());
    types.push_back(png.substr(at + 4, 4));
    EXPECT_EQ(big_endian(png, at + 8 + length), crc_of(std::string_view(png).substr(at + 4, 4 + length)));
    if (types.back() == "tEXt") {
      EXPECT_EQ(
          png.substr(at + 8, length),
          std::string("Comment\0Written by contactspline " VERSION ", figure of a sound", 52 + sizeof VERSION - 1));
    }
    at += 12 + length;
  }
  EXPECT_EQ(types.front(), "IHDR");
  EXPECT_EQ(types.back(), "IEND");
  EXPECT_EQ(std::ranges::count(types, "tEXt"), 1);
  EXPECT_GE(big_endian(png, 16), 2000u) << "width";
}

TEST(Render, DrawsAPdf) {
  const Sandbox box;
  render(box, {"--duration", "0.1", "--figure", "b.pdf"});
  const std::string pdf = read_file(box / "b.pdf");
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  const auto end = pdf.rfind("%%EOF\n");
  ASSERT_NE(end, std::string::npos);
  EXPECT_EQ(pdf.substr(end + 6), "% Written by contactspline " VERSION ", figure of a sound\n");
}

// A title is text in every format, whatever gnuplot makes of its characters.
TEST(Render, DrawsAnyTitleInEveryFormat) {
  const Sandbox box;
  write_file(box / "probe.json", R"({ "name": "probe", "description": "it's `id` {/:Bold x} & <b> $(id) %d é",
    "contact": { "stiffness_n_per_m_alpha": 1e9, "exponent": 2 },
    "spline": { "knots": "uniform", "segments": 8, "max_compression_m": 1e-3 } })");
  for (const std::string figure : {"a.svg", "a.png", "a.pdf"}) {
    succeed({.arguments = {"inspect", "probe.json", "--figure", figure}, .folder = box.path()});
    EXPECT_GT(fs::file_size(box / figure), 5000u) << figure;
  }
  EXPECT_NE(read_svg(box / "a.svg").text.find("it's `id` {/:Bold x} & <b> $(id) %d é"), std::string::npos);
}

/// A folder for PATH with a gnuplot that fails, or without one.
Call render_with_gnuplot(const Sandbox& box, bool is_there, const Words& options) {
  fs::create_directories(box / "bin");
  if (is_there) {
    write_file(box / "bin/gnuplot", "#!/bin/sh\nexit 1\n");
    fs::permissions(box / "bin/gnuplot", fs::perms(0755));
  }
  return {.arguments = followed_by({"render", "mass-barrier", "--duration", "0.1", "-o", "a.wav"}, options),
          .folder = box.path(),
          .environment = {{"PATH", (box / "bin").string()}}};
}

TEST(Render, WritesTheSoundWithoutGnuplot) {
  for (const bool is_there : {false, true}) {
    const Sandbox box;
    const Outcome outcome = run(render_with_gnuplot(box, is_there, {}));
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_TRUE(outcome.err.starts_with(is_there ? "contactspline: figure: gnuplot failed"
                                                 : "contactspline: figure: gnuplot is not installed"))
        << outcome.err;
    EXPECT_NE(outcome.err.find("--no-figure"), std::string::npos) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out.find("figure: "), std::string::npos) << outcome.out;
    EXPECT_EQ(read_sound(box / "a.wav").samples, sound_of({"--duration", "0.1"}).samples);
    EXPECT_FALSE(fs::exists(box / "a.svg"));
    succeed(render_with_gnuplot(box, is_there, {"--no-figure"}));
  }
}

TEST(Render, RefusesAFigureThatIsAskedForWithoutGnuplot) {
  const Sandbox box;
  const Call call = render_with_gnuplot(box, false, {"--figure", "a.png"});
  const auto before = box.listing();
  expect_refused(run(call), "--figure: gnuplot is not installed",
                 "install the package gnuplot-nox, or use --no-figure");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

TEST(Render, WritesTheSoundBeforeAFigureThatFails) {
  const Sandbox box;
  expect_refused(run(render_with_gnuplot(box, true, {"--figure", "a.png"})), "figure: gnuplot failed", "");
  EXPECT_EQ(read_sound(box / "a.wav").samples, sound_of({"--duration", "0.1"}).samples);
  EXPECT_FALSE(fs::exists(box / "a.png"));
}

TEST(Render, NamesTheSoundByWhatIsPlayed) {
  const Sandbox box;
  fs::create_directory(box / "in");
  write_file(box / "in/my.json", R"({"instrument": "tom", "duration_s": 0.01, "level_db": -20,
    "events": [ { "time_s": 0, "stick_speed_m_per_s": 1 } ] })");
  for (const Words& words : std::vector<Words>{{"mass-barrier", "felt_c4", "--duration", "0.01"},
                                               {"mass-barrier", "--duration", "0.01", "--material", "mb1"},
                                               {"in/my.json"}})
    succeed({.arguments = followed_by({"render"}, words), .folder = box.path()});
  for (const char* name : {"felt_c4.wav", "felt_c4.svg", "mb1.wav", "my.wav", "my.svg"})
    EXPECT_TRUE(fs::exists(box / name)) << names_in(box.listing());
}

// A level is that of the peak, whatever the signal; that of a score gives way to that of the command line.
TEST(Render, HasTheLevelAskedFor) {
  const Sandbox box;
  write_file(box / "my.json", R"({"instrument": "tom", "duration_s": 0.05, "level_db": -20,
    "events": [ { "time_s": 0, "stick_speed_m_per_s": 1 } ] })");
  for (const auto& [words, peak] : std::vector<std::pair<Words, double>>{
           {{"mass-barrier", "--duration", "0.1"}, kPeak},
           {{"mass-barrier", "--duration", "0.1", "--level", "-6"}, std::pow(10, -0.3)},
           {{"mass-barrier", "--duration", "0.1", "--level", "-40", "--signal", "displacement"}, 0.01},
           {{"mass-barrier", "--duration", "0.1", "--level", "0"}, 1},
           {{"my.json"}, 0.1},
           {{"my.json", "--level", "-40"}, 0.01}}) {
    const Words call = followed_by(followed_by({"render"}, words), {"--no-figure", "--force", "-o", "a.wav"});
    succeed({.arguments = call, .folder = box.path()});
    EXPECT_TRUE(within(read_sound(box / "a.wav").peak(), peak, kLevel)) << peak;
  }
}

}  // namespace
}  // namespace contactspline::testing
