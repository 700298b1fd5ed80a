// SPDX-License-Identifier: MIT
// The one place where bytes of MIDI are checked.
#include "contactspline/host/hosted.hpp"

namespace contactspline::testing {
namespace {

TEST(MidiMessage, IsReadFromWholeMessagesOnly) {
  for (int status = 0; status < 256; ++status)
    for (const int first : {0, 60, 127, 128, 200, 255})
      for (const int second : {0, 127, 128, 255}) {
        const std::array bytes = {static_cast<std::uint8_t>(status), static_cast<std::uint8_t>(first),
                                  static_cast<std::uint8_t>(second)};
        const auto message = midi_message(bytes);
        // A status has the highest bit, data have not; from 0xf0 on a message is the system's.
        ASSERT_EQ(message.has_value(), status >= 128 && status < 240 && first < 128 && second < 128) << status;
        if (!message) continue;
        EXPECT_EQ(message->status, status - status % 16);
        EXPECT_EQ(message->first, first);
        EXPECT_EQ(message->second, second);
      }
  const std::array<std::uint8_t, 4> long_one = {0x90, 60, 100, 0};
  EXPECT_FALSE(midi_message(long_one));
  EXPECT_FALSE(midi_message(std::span(long_one).first(2)));
  EXPECT_FALSE(midi_message({}));
}

}  // namespace
}  // namespace contactspline::testing
