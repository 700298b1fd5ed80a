// SPDX-License-Identifier: MIT
// The programs for the JACK server, on a server of the test's own without sound card: played by MIDI, recorded.
#include <sstream>

#include "plugins/jack_server.hpp"
#include "support/compare.hpp"
#include "support/spectrum.hpp"

namespace contactspline::testing {
namespace {

class JackProgram : public JackTest {
 protected:
  /// Starts one of the programs that ship; it is there when its first output is.
  void start(const std::string& name) {
    program_.emplace(std::vector<std::string>{PROGRAMS "/" + name}, folder_ + "/program.log");
    const Client client = open_client();
    ASSERT_TRUE(client);
    ASSERT_TRUE(becomes_true([&] { return jack_port_by_name(client.get(), (name + ":out_0").c_str()) != nullptr; }))
        << text_of(folder_ + "/program.log");
  }

  /// It ends when told to.
  void stop() {
    program_->write("q\n");
    EXPECT_EQ(program_->exit_code(10s), 0) << text_of(folder_ + "/program.log");
  }

  void TearDown() override {
    program_.reset();
    JackTest::TearDown();
  }

  std::optional<ChildProcess> program_;
};

std::vector<std::string> names() {
  std::istringstream list(CONTACTSPLINE_PROGRAMS);
  return {std::istream_iterator<std::string>(list), {}};
}
INSTANTIATE_TEST_SUITE_P(ThatShips, JackProgram, ::testing::ValuesIn(names()),
                         [](const auto& test) { return test.param; });

bool is_finite(std::span<const float> sound) {
  return std::all_of(sound.begin(), sound.end(), [](float x) { return std::isfinite(x); });
}

TEST_P(JackProgram, RunsAndEnds) {
  ASSERT_NO_FATAL_FAILURE(start(GetParam()));
  Player player(open_client(), {}, kRate / 10);
  ASSERT_TRUE(player.play(GetParam() + ":midi_in_1", GetParam() + ":out_0"));
  EXPECT_TRUE(is_finite(player.sound()));
  stop();
}

double pitch_hz(int note) {
  return 440 * std::exp2((note - 69) / 12.0);
}

class PianoProgram : public JackProgram {};

// A chord, one note of which is released. The spectrum's peak is within 0.02 of a bin of 2 Hz, 0.3 cent.
TEST_F(PianoProgram, IsPlayedByMidi) {
  ASSERT_NO_FATAL_FAILURE(start("piano"));
  constexpr std::size_t kOn = kRate / 4, kOff = kRate * 3 / 4, kEnd = kRate * 2;
  Player player(open_client(),
                {{kOn, {0x90, 60, 100}}, {kOn, {0x90, 64, 100}}, {kOn, {0x90, 67, 100}}, {kOff, {0x80, 64, 0}}},
                kEnd);
  ASSERT_TRUE(player.play("piano:midi_in_1", "piano:out_0")) << text_of(folder_ + "/program.log");
  stop();

  const auto sound = player.sound();
  ASSERT_TRUE(is_finite(sound));
  EXPECT_EQ(rms(sound.first(kOn)), 0);
  const auto held = sound.subspan(kOn, kOff - kOn), released = sound.last(kOff - kOn);
  const auto partial = [](std::span<const float> part, int note) {
    return strongest_partial(part, kRate, 0.98 * pitch_hz(note), 1.02 * pitch_hz(note));
  };
  for (const int note : {60, 64, 67})
    EXPECT_TRUE(within(1200 * std::log2(partial(held, note).frequency_hz / pitch_hz(note)), 0, 1)) << "note " << note;
  EXPECT_GT(partial(held, 64).amplitude, 0.1 * partial(held, 60).amplitude);
  EXPECT_LT(partial(released, 64).amplitude, 0.01 * partial(released, 60).amplitude);
}

}  // namespace
}  // namespace contactspline::testing
