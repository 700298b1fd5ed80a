// SPDX-License-Identifier: MIT
// Every plug-in in Ardour, without its window: found as an instrument, a note recorded, preset and parameter restored
// in a new process, which bounces the note into a file. The piano plays a chord of MPE. Skipped where
// Ardour is not installed.
#include <gtest/gtest.h>
#include <sndfile.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>

#include "plugins/child_process.hpp"
#include "plugins/open_plugin.hpp"
#include "support/compare.hpp"
#include "support/spectrum.hpp"

// Not counted here.
constinit thread_local std::size_t contactspline::testing::allocations = 0, contactspline::testing::locks = 0;

namespace contactspline::testing {
namespace {

using namespace std::chrono_literals;

constexpr int kRate = 48000;

std::optional<int> run(std::vector<std::string> command, const std::string& log) {
  return ChildProcess(std::move(command), log).exit_code(120s);
}

std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The lines of a kind that the script has written: the words behind the kind.
using Lines = std::vector<std::vector<std::string>>;
std::map<std::string, Lines> lines_of(const std::string& file) {
  std::map<std::string, Lines> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream rest(line);
    std::vector<std::string> words;
    for (std::string word; std::getline(rest, word, '\t');) words.push_back(word);
    const std::string kind = words.front();
    words.erase(words.begin());
    lines[kind].push_back(words);
  }
  return lines;
}

/// The lines about a track, without its name.
Lines about(const std::string& track, const Lines& lines) {
  Lines own;
  for (const auto& words : lines)
    if (words.front() == track) own.emplace_back(words.begin() + 1, words.end());
  return own;
}

/// Samples of "beats:ticks" at 120 beats a minute.
std::size_t samples_of(const std::string& time) {
  constexpr int kTicks = 1920;  // in a beat
  const std::size_t colon = time.find(':');
  return static_cast<std::size_t>((std::stoi(time) * kTicks + std::stoi(time.substr(colon + 1))) * (kRate / 2.0) /
                                  kTicks);
}

std::vector<float> samples_of_file(const std::string& file) {
  SF_INFO info = {};
  SNDFILE* const sound = sf_open(file.c_str(), SFM_READ, &info);
  if (sound == nullptr) return {};
  std::vector<float> samples(info.channels == 1 && info.samplerate == kRate ? static_cast<std::size_t>(info.frames)
                                                                            : 0);
  samples.resize(
      static_cast<std::size_t>(sf_readf_float(sound, samples.data(), static_cast<sf_count_t>(samples.size()))));
  sf_close(sound);
  return samples;
}

class Ardour : public ::testing::Test {
 protected:
  void SetUp() override {
    if (run({"ardour7-lua", "--version"}, "/dev/null") != 0)
      GTEST_SKIP() << "Ardour 7 is not installed: scripts/install-packages studio";
    std::filesystem::create_directories(folder_ + "/home");
    setenv("HOME", (folder_ + "/home").c_str(), 1);
    std::filesystem::create_directory_symlink(PLUGINS "/vst3", folder_ + "/home/.vst3");
    std::string scan =
        "LD_LIBRARY_PATH=/usr/lib/ardour7 exec /usr/lib/ardour7/ardour-vst3-scanner -f -q " PLUGINS "/vst3/*.vst3";
    ASSERT_EQ(run({"sh", "-c", scan}, log_), 0) << text_of(log_);
  }
  // Records the note, or the keys and cents of a chord, and restores and bounces it.
  void play(const std::vector<std::string>& chord = {}) {
    for (const std::string mode : {"record", "restore"}) {
      std::vector<std::string> command = {"ardour7-lua", SCRIPT, mode, folder_};
      command.insert(command.end(), chord.begin(), chord.end());
      ASSERT_EQ(run(command, log_), 0) << mode << "\n" << text_of(log_);
    }
  }
  [[nodiscard]] std::vector<float> sound_of(const std::string& track) const {
    return samples_of_file(folder_ + "/session/interchange/session/audiofiles/" + track + "%L.wav");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string folder_ = std::filesystem::temp_directory_path() / ("contactspline_ardour_" + std::to_string(getpid()));
  std::string log_ = folder_ + "/log";
};

TEST_F(Ardour, RecordsAndRestoresEveryInstrument) {
  ASSERT_NO_FATAL_FAILURE(play());
  auto recorded = lines_of(folder_ + "/record.txt"), restored = lines_of(folder_ + "/restore.txt");
  std::istringstream names(CONTACTSPLINE_PLUGINS);
  for (std::string name; names >> name;) {
    for (const std::string format : {"lv2", "vst3"}) {
      std::string track = format + " Contact Spline " + name;
      std::replace(track.begin(), track.end(), '_', ' ');
      SCOPED_TRACE(track);
      EXPECT_EQ(about(track, recorded["found"]), Lines{{"true"}});  // an instrument
      // What is loaded and set is there in the next process.
      const Lines values = about(track, recorded["value"]), preset = about(track, recorded["preset"]);
      EXPECT_EQ(about(track, restored["value"]), values);
      EXPECT_EQ(about(track, restored["preset"]), preset);
      const auto reference = open_plugin(format, name, kRate);
      ASSERT_EQ(values.size(), reference->parameters().size());
      ASSERT_EQ(preset.size(), 1u);
      const auto programs = reference->programs();
      if (programs.size() > 1 || format == "lv2") {
        EXPECT_EQ(std::count(programs.begin(), programs.end(), preset[0].at(0)), 1) << preset[0][0];
      }

      const Lines notes = about(track, recorded["note"]);
      ASSERT_EQ(notes.size(), 1u);
      EXPECT_EQ(notes[0][0], "60");
      EXPECT_EQ(notes[0][1], "100");
      const std::size_t begin = samples_of(notes[0][2]), length = samples_of(notes[0][3]);
      const auto sound = sound_of(track);
      ASSERT_GE(sound.size(), begin + length);

      // The same by the host of the tests. Of the preset, it knows the values that Ardour shows.
      for (const auto& value : values) reference->set(value[0], std::stod(value[1]));
      (void)reference->run(begin / HostedPlugin::kBlock);
      reference->send(begin % HostedPlugin::kBlock, {0x90, 60, 100});
      const auto expected = reference->run(length / HostedPlugin::kBlock + 2)[0];
      const auto partial = [length](const std::vector<float>& from, std::size_t place) {
        return strongest_partial(std::span(from).subspan(place, length), kRate, 40, 4000);
      };
      const Partial heard = partial(sound, begin), meant = partial(expected, begin % HostedPlugin::kBlock);
      // 0.02 of a bin, 1/length, each. The time of the note is rounded to 12.5 samples.
      EXPECT_TRUE(within(heard.frequency_hz, meant.frequency_hz, 0.04 * kRate / static_cast<double>(length)));
      EXPECT_TRUE(relatively_within(heard.amplitude, meant.amplitude, 0.01));
      if (name == "piano") {
        const double c4_hz = 440 * std::exp2(-9 / 12.0);
        const double found_hz =
            strongest_partial(std::span(sound).subspan(begin, length), kRate, 0.97 * c4_hz, 1.03 * c4_hz)
                .frequency_hz;
        EXPECT_TRUE(within(1200 * std::log2(found_hz / c4_hz), 0, 2));
      }
      std::printf("%s: %.2f Hz, peak %.4f\n", track.c_str(), heard.frequency_hz, heard.amplitude);
    }
  }
}

// Channels 2 to 5 each bend their own note. No harmonic of one is near another.
TEST_F(Ardour, PlaysMpe) {
  constexpr std::pair<int, int> kChord[] = {{48, 35}, {55, -60}, {64, 150}, {71, -20}};  // keys, cents
  std::vector<std::string> chord;
  for (const auto& [key, cents] : kChord) chord.push_back(std::to_string(key) + ":" + std::to_string(cents));
  ASSERT_NO_FATAL_FAILURE(play(chord));
  auto recorded = lines_of(folder_ + "/record.txt");
  // Not of VST3, in which Ardour 7.3 passes no notes by name and the wheels of all channels are one.
  for (const std::string track : {"lv2 Contact Spline piano", "lv2 Contact Spline fret guitar"}) {
    SCOPED_TRACE(track);
    Lines notes = about(track, recorded["note"]);
    std::sort(notes.begin(), notes.end());
    ASSERT_EQ(notes.size(), std::size(kChord));
    std::size_t begin = 0, end = std::numeric_limits<std::size_t>::max();
    for (std::size_t i = 0; i < notes.size(); ++i) {
      EXPECT_EQ(notes[i][0], std::to_string(kChord[i].first));
      EXPECT_EQ(notes[i].back(), std::to_string(i + 1));  // from 0 on
      begin = std::max(begin, samples_of(notes[i][2]));
      end = std::min(end, samples_of(notes[i][2]) + samples_of(notes[i][3]));
    }
    ASSERT_GT(end, begin + kRate / 2);
    const std::size_t length = end - begin;
    const auto sound = sound_of(track);
    ASSERT_GE(sound.size(), end);
    for (const auto& [key, cents] : kChord) {
      const double hz = 440 * std::exp2((key - 69 + cents / 100.0) / 12);
      const double found_hz =
          strongest_partial(std::span(sound).subspan(begin, length), kRate, 0.97 * hz, 1.03 * hz).frequency_hz;
      const double off_cents = 1200 * std::log2(found_hz / hz);
      std::printf("%s, key %d by %d cents: %.2f Hz, %.2f cents off\n", track.c_str(), key, cents, found_hz,
                  off_cents);
      EXPECT_TRUE(within(off_cents, 0, 3)) << key;
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
