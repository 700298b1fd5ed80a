// SPDX-License-Identifier: MIT
// A JACK server without sound card, and a client of it that plays and records, for tests of what runs in JACK.
#pragma once

#include <gtest/gtest.h>
#include <jack/jack.h>
#include <jack/midiport.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <span>

#include "plugins/child_process.hpp"

namespace contactspline::testing {

using namespace std::chrono_literals;

inline constexpr int kRate = 48000;

/// Waits until something is so, at most for a time.
inline bool becomes_true(const std::function<bool()>& is_so, std::chrono::milliseconds max = 10s) {
  const auto end = std::chrono::steady_clock::now() + max;
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

inline std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct CloseClient {
  void operator()(jack_client_t* client) const { jack_client_close(client); }
};
using Client = std::unique_ptr<jack_client_t, CloseClient>;

inline Client open_client() {
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

  /// Plays; false where the ports are not there or time runs out.
  bool play(const std::string& midi_input, const std::string& output) {
    if (jack_activate(client_.get()) != 0) return false;
    if (jack_connect(client_.get(), jack_port_name(midi_), midi_input.c_str()) != 0) return false;
    if (jack_connect(client_.get(), output.c_str(), jack_port_name(audio_)) != 0) return false;
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

/// A test with a server of its own, skipped where it does not start.
class JackTest : public ::testing::TestWithParam<std::string> {
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

  std::string folder_ = std::filesystem::temp_directory_path() / ("contactspline_jack_" + std::to_string(getpid()));
  std::optional<ChildProcess> server_;
};

}  // namespace contactspline::testing
