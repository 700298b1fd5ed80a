// SPDX-License-Identifier: MIT
// MIDI files as other programs write them, as small as they can be. A tick is 1/960 s.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace contactspline::testing::midi {

inline std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

/// A number of seven bits a byte.
inline std::string number(int n) {
  std::string text(1, static_cast<char>(n & 127));
  while (n >>= 7) text.insert(text.begin(), static_cast<char>((n & 127) | 128));
  return text;
}

inline std::string chunk(const std::string& kind, const std::string& content) {
  const auto size = static_cast<int>(content.size());
  return kind + bytes({0, size >> 16, size >> 8 & 255, size & 255}) + content;
}

using Events = std::vector<std::pair<int, std::string>>;  // tick and bytes

inline std::string track(const Events& events, int end = 0) {
  std::string content;
  int last = 0;
  for (const auto& [tick, event] : events) {
    content += number(tick - last) + event;
    last = tick;
  }
  return chunk("MTrk", content + number(end > last ? end - last : 0) + bytes({0xff, 0x2f, 0}));
}

/// Chunks after a header; `count`: of the tracks.
inline std::string file(const std::string& chunks, int count = 1, int format = 1) {
  return chunk("MThd", bytes({0, format, 0, count, 1, 480 - 256})) + chunks;
}

inline std::string on(int key, int velocity = 90, int channel = 0) {
  return bytes({0x90 | channel, key, velocity});
}
inline std::string off(int key, int channel = 0, int velocity = 64) {
  return bytes({0x80 | channel, key, velocity});
}
inline std::string controller(int number, int value, int channel = 0) {
  return bytes({0xb0 | channel, number, value});
}
inline std::string wheel(int value, int channel = 0) {
  return bytes({0xe0 | channel, value & 127, value >> 7});
}
/// As it stands in a file.
inline std::string exclusive(const std::string& data) {
  return bytes({0xf0}) + number(static_cast<int>(data.size()) + 1) + data + bytes({0xf7});
}

inline constexpr int kSecond = 960;  // ticks

inline Events followed_by(Events first, const Events& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}
inline Events registered(int parameter) {
  return {{0, controller(101, 0)}, {0, controller(100, parameter)}};
}

inline const Events kNote = {{0, on(60)}, {kSecond, off(60)}};
inline const Events kBentNote = followed_by({{0, wheel(16383)}}, kNote);

/// A parameter set by so many data entries, before a note.
inline std::string set_by(int parameter, const Events& entries, const Events& note) {
  return file(track(followed_by(followed_by(registered(parameter), entries), note)));
}

}  // namespace contactspline::testing::midi
