// SPDX-License-Identifier: MIT
// The keys of an instrument: those of a piano, or a button for each event.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "window/canvas.hpp"
#include "window/window_source.hpp"

namespace contactspline {

class Keyboard {
 public:
  Keyboard(const WindowTable& table, const Box& box) : box_(box) {
    if (table.keys.empty()) return;
    if (table.has_buttons)
      place_buttons(table.keys);
    else
      place_keys(table.keys);
  }

  struct Press {
    int key, velocity;
  };

  /// The key at a point, and how hard it is struck: the lower, the harder.
  [[nodiscard]] std::optional<Press> at(double x, double y) const {
    for (auto key = keys_.rbegin(); key != keys_.rend(); ++key) {  // black ones lie on top
      if (!key->plays || !key->box.has(x, y)) continue;
      const double depth = (y - key->box.y) / key->box.height;
      return Press{key->number, std::clamp(static_cast<int>(30 + 97 * depth), 1, 127)};
    }
    return {};
  }

  /// is_held(key): is it down?
  template <typename IsHeld>
  void draw(Canvas& canvas, const IsHeld& is_held) const {
    for (const Key& key : keys_) {
      const bool is_down = key.plays && is_held(key.number);
      const Colour up = !key.is_piano_key ? colours::kPanel : key.is_black ? colours::kBlackKey : colours::kWhiteKey;
      canvas.lay({key.box.x, key.box.y, key.box.width - kGap, key.box.height}, is_down     ? colours::kAccent
                                                                               : key.plays ? up
                                                                                           : colours::kLine);
      if (key.words.empty()) continue;
      const Box bottom{key.box.x + 1, key.box.y + key.box.height - kWords, key.box.width - 2, 14};
      if (key.is_piano_key)
        canvas.text(bottom, key.words, 9, colours::kOnLight, Side::kMiddle);
      else
        canvas.text(key.box.inner(6), key.words, 13, is_down ? colours::kBackground : colours::kText, Side::kMiddle);
    }
  }

  /// Of each key that is held elsewhere than at its own pitch: a mark where that pitch is on the keyboard, and, above
  /// it, the distance in cents, where there is room. cents_of(key): of a held key, in whole cents.
  template <typename CentsOf>
  void draw_bends(Canvas& canvas, const CentsOf& cents_of) const {
    constexpr float kMark = 3, kSize = 11;
    std::vector<std::pair<float, int>> marks;
    for (const Key& key : keys_) {
      const std::optional<int> cents = key.plays ? cents_of(key.number) : std::nullopt;
      if (cents.value_or(0) != 0) marks.emplace_back(place_of(key, *cents), *cents);
    }
    std::sort(marks.begin(), marks.end());
    float end = 0;  // of the last number
    for (const auto& [x, cents] : marks) {
      if (keys_.front().is_piano_key)
        canvas.fill({x - kMark / 2, box_.y, kMark, box_.height - kWords}, colours::kMark);
      const std::string words = (cents > 0 ? "+" : "") + std::to_string(cents);
      const float width = canvas.width_of(words, kSize) + 2;
      const float left = std::clamp(x - width / 2, box_.x, box_.x + box_.width - width);
      if (left < end) continue;
      canvas.text({left, box_.y - 14, width, 13}, words, kSize, colours::kMark, Side::kMiddle);
      end = left + width + 3;
    }
  }

  /// Where a key is drawn, for tests.
  [[nodiscard]] Box box_of(int number) const {
    const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const Key& k) { return k.number == number; });
    return key == keys_.end() ? Box{} : key->box;
  }

 private:
  static constexpr float kGap = 1, kWords = 17;  // between keys, below on them

  struct Key {
    int number;
    Box box;
    std::string words;
    bool is_black = false, plays = true, is_piano_key = true;
  };

  // The middle of a key, or between two of them where its pitch is; within the keyboard.
  [[nodiscard]] float place_of(const Key& key, int cents) const {
    const auto middle = [](const Box& box) { return box.x + (box.width - kGap) / 2; };
    if (!key.is_piano_key) return middle(key.box);
    const auto [first, last] = std::minmax_element(keys_.begin(), keys_.end(),
                                                   [](const Key& a, const Key& b) { return a.number < b.number; });
    const float pitch = std::clamp(static_cast<float>(key.number) + static_cast<float>(cents) / 100,
                                   static_cast<float>(first->number), static_cast<float>(last->number));
    const int below = static_cast<int>(pitch), above = std::min(below + 1, last->number);
    return std::lerp(middle(box_of(below)), middle(box_of(above)), pitch - static_cast<float>(below));
  }

  static bool is_black(int number) {
    constexpr std::array<bool, 12> kBlack = {false, true,  false, true,  false, false,
                                             true,  false, true,  false, true,  false};
    return kBlack[static_cast<std::size_t>(number % 12)];
  }

  void place_buttons(const std::vector<WindowKey>& keys) {
    constexpr float kDistance = 8, kWidest = 220;
    const float count = static_cast<float>(keys.size());
    const float width = std::min(kWidest, (box_.width - kDistance * (count - 1)) / count);
    float x = box_.x + (box_.width - count * width - (count - 1) * kDistance) / 2;
    for (const WindowKey& key : keys) {
      keys_.push_back({key.number, {x, box_.y, width, box_.height}, key.event, false, true, false});
      x += width + kDistance;
    }
  }

  // White keys first. Whole octaves around the keys that play.
  void place_keys(const std::vector<WindowKey>& keys) {
    constexpr float kWidest = 30;
    int first = keys.front().number, last = keys.back().number;
    if (first > 21) first -= first % 12;
    if (last < 108) last += 11 - last % 12;
    int whites = 0;
    for (int number = first; number <= last; ++number) whites += is_black(number) ? 0 : 1;
    const float width = std::min(kWidest, box_.width / static_cast<float>(whites));
    const float left = box_.x + (box_.width - width * static_cast<float>(whites)) / 2;
    std::vector<Key> blacks;
    float x = left;
    for (int number = first; number <= last; ++number) {
      const bool plays =
          std::any_of(keys.begin(), keys.end(), [&](const WindowKey& key) { return key.number == number; });
      if (is_black(number)) {
        blacks.push_back(
            {number, {x - 0.3f * width, box_.y, 0.6f * width, 0.62f * box_.height}, "", true, plays, true});
        continue;
      }
      const std::string octave = number % 12 == 0 ? "C" + std::to_string(number / 12 - 1) : "";
      keys_.push_back({number, {x, box_.y, width, box_.height}, octave, false, plays, true});
      x += width;
    }
    keys_.insert(keys_.end(), blacks.begin(), blacks.end());
  }

  Box box_;
  std::vector<Key> keys_;
};

}  // namespace contactspline
