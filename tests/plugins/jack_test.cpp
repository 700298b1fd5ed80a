// SPDX-License-Identifier: MIT
// The programs for the JACK server, on a server of the test's own without sound card: played by MIDI, recorded.
#include <jack/jack.h>
#include <jack/midiport.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "child_process.hpp"
#include "spectrum.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using namespace std::chrono_literals;

constexpr int kRate = 48000;

/// Waits until something is so, at most for a time.
bool becomes_true(const std::function<bool()>& is_so, std::chrono::milliseconds max = 10s) {
  const auto end = std::chrono::steady_clock::now() + max;
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct CloseClient {
  void operator()(jack_client_t* client) const { jack_client_close(client); }
};
using Client = std::unique_ptr<jack_client_t, CloseClient>;

Client open_client() {
  return Client(jack_client_open("test", jack_options_t(JackNoStartServer | JackUseExactName), nullptr));
}

/// A message at a time in samples after the recording begins.
struct Message {
  std::size_t time;
  jack_midi_data_t bytes[3];
};

/// Sends messages to a program and records its first output.
class Player {
 public:
  Player(Client client, std::vector<Message> messages, std::size_t samples)
      : messages_(std::move(messages)),
        sound_(samples),
        midi_(jack_port_register(client.get(), "midi", JACK_DEFAULT_MIDI_TYPE, JackPortIsOutput, 0)),
        audio_(jack_port_register(client.get(), "audio", JACK_DEFAULT_AUDIO_TYPE, JackPortIsInput, 0)),
        client_(std::move(client)) {
    jack_set_process_callback(
        client_.get(), [](jack_nframes_t n, void* self) { return static_cast<Player*>(self)->process(n); }, this);
  }

  /// Plays; false where the program is not there or time runs out.
  bool play(const std::string& program, bool by_midi) {
    const auto port = [&](const char* name) { return program + ":" + name; };
    if (jack_activate(client_.get()) != 0) return false;
    if (by_midi && jack_connect(client_.get(), jack_port_name(midi_), port("midi_in_1").c_str()) != 0) return false;
    if (jack_connect(client_.get(), port("out_0").c_str(), jack_port_name(audio_)) != 0) return false;
    is_connected_ = true;
    const bool is_recorded = becomes_true([&] { return time_ >= sound_.size(); }, 20s);
    jack_deactivate(client_.get());
    return is_recorded;
  }

  [[nodiscard]] std::span<const float> sound() const { return sound_; }

 private:
  int process(jack_nframes_t frames) {
    void* midi = jack_port_get_buffer(midi_, frames);
    const auto* audio = static_cast<const float*>(jack_port_get_buffer(audio_, frames));
    jack_midi_clear_buffer(midi);
    if (!is_connected_) return 0;
    const std::size_t begin = time_;
    for (const Message& message : messages_)
      if (message.time >= begin && message.time < begin + frames)
        jack_midi_event_write(midi, static_cast<jack_nframes_t>(message.time - begin), message.bytes, 3);
    const std::size_t end = std::min<std::size_t>(begin + frames, sound_.size());
    for (std::size_t n = begin; n < end; ++n) sound_[n] = audio[n - begin];
    time_ = end;
    return 0;
  }

  std::vector<Message> messages_;
  std::vector<float> sound_;
  std::atomic<bool> is_connected_ = false;
  std::atomic<std::size_t> time_ = 0;
  jack_port_t *midi_, *audio_;
  Client client_;
};

class JackProgram : public ::testing::TestWithParam<std::string> {
 protected:
  // A server on its own name, in real time but without its privileges, that waits for its clients in every cycle.
  void SetUp() override {
    setenv("JACK_DEFAULT_SERVER", ("contactspline_test_" + std::to_string(getpid())).c_str(), 1);
    setenv("JACK_NO_START_SERVER", "1", 1);
    setenv("JACK_NO_AUDIO_RESERVATION", "1", 1);
    setenv("HOME", folder_.c_str(), 1);  // the programs keep their last settings there
    std::filesystem::create_directories(folder_);
    jack_set_error_function([](const char*) {});  // no message while it tries to find the server
    server_.emplace(
        std::vector<std::string>{JACKD, "--no-realtime", "--sync", "--name", getenv("JACK_DEFAULT_SERVER"), "-d",
                                 "dummy", "-r", std::to_string(kRate), "-p", "512"},
        folder_ + "/jackd.log");
    const bool starts = becomes_true([&] { return !server_->is_running() || open_client(); });
    if (!starts || !server_->is_running()) {
      const std::string why = text_of(folder_ + "/jackd.log");
      server_.reset();
      GTEST_SKIP() << "jackd does not start here: " << why;
    }
  }

  void TearDown() override {
    server_.reset();
    std::filesystem::remove_all(folder_);
  }

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

  std::string folder_ = std::filesystem::temp_directory_path() / ("contactspline_jack_" + std::to_string(getpid()));
  std::optional<ChildProcess> server_, program_;
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
  ASSERT_TRUE(player.play(GetParam(), true));
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
  ASSERT_TRUE(player.play("piano", true)) << text_of(folder_ + "/program.log");
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
