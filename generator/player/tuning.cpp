// SPDX-License-Identifier: MIT
#include "generator/player/tuning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "contactspline/step/controls.hpp"
#include "generator/support/error.hpp"
#include "generator/support/text_encoding.hpp"

namespace contactspline {
namespace {

constexpr int kMaxTones = 10000, kMaxMap = 1024, kUnmapped = -1;
constexpr Range kToneCents{-120000, 120000}, kReference_hz{1, 50000};
constexpr int kMiddleC = 60, kA4 = 69;

std::string_view first_word(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  return line.substr(0, line.find_first_of(kBlank));
}

/// A number that a word is as a whole, or nothing.
template <typename Number>
std::optional<Number> number_of(std::string_view word) {
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(number) : std::nullopt;
}

/// The lines of a file of Scala but for its comments.
class ScalaLines {
 public:
  explicit ScalaLines(const TuningText& text) : text_(in_utf8(text.text)), file_(text.file) {}

  /// The next line, also if it is blank; nothing behind the last one.
  std::optional<std::string_view> next() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('\n');
      const std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      if (!line.starts_with('!')) return line;
    }
    return {};
  }
  /// The first word of the next line that is not blank, or nothing.
  std::optional<std::string_view> next_word() {
    while (const auto line = next())
      if (const std::string_view word = first_word(*line); !word.empty()) return word;
    return {};
  }

  /// The same, which must be there. what: that the file lacks otherwise.
  std::string_view word(std::string_view what, std::string_view allowed) {
    const auto word = next_word();
    if (!word)
      contactspline::refuse(file_, fmt::format("line {}", number_ + 1), fmt::format("{} is missing", what), allowed);
    return *word;
  }
  int integer(std::string_view what, int min, int max, std::string_view example) {
    const std::string allowed = fmt::format("an integer from {} to {}, such as {}", min, max, example);
    const std::string_view word = this->word(what, allowed);
    const auto number = number_of<int>(word);
    if (!number) refuse(fmt::format("{}: '{}' is no integer", what, shown(word)), allowed);
    if (*number < min || *number > max) refuse(fmt::format("{}: {} is out of range", what, *number), allowed);
    return *number;
  }

  [[noreturn]] void refuse(std::string_view wrong, std::string_view allowed) const {
    contactspline::refuse(file_, fmt::format("line {}", number_), wrong, allowed);
  }

 private:
  std::string text_;
  std::string_view rest_ = text_;
  std::string file_;
  int number_ = 0;
};

/// Cents of a scale's tones above the first; the last one is where the scale begins again.
using Tones = std::vector<double>;

double read_cents(const ScalaLines& lines, std::string_view word) {
  const auto cents = number_of<double>(word);
  const std::string allowed =
      fmt::format("cents with a point from {}. to {}., such as 701.955", kToneCents.min, kToneCents.max);
  if (!cents) lines.refuse(fmt::format("'{}' is no number of cents", shown(word)), allowed);
  if (!(*cents >= kToneCents.min && *cents <= kToneCents.max))
    lines.refuse(fmt::format("{} cents are out of range", shown(word)), allowed);
  return *cents;
}

double read_ratio(const ScalaLines& lines, std::string_view word) {
  const std::size_t slash = word.find('/');
  const auto above = number_of<std::int64_t>(word.substr(0, slash));
  const auto below = slash == std::string_view::npos ? 1 : number_of<std::int64_t>(word.substr(slash + 1));
  constexpr auto kAllowed = "a ratio of integers from 1 on, such as 3/2, or cents with a point, such as 701.955";
  if (!above || !below) lines.refuse(fmt::format("'{}' is no pitch", shown(word)), kAllowed);
  if (*above < 1 || *below < 1) lines.refuse(fmt::format("the ratio {} is not positive", shown(word)), kAllowed);
  return 1200 * (std::log2(static_cast<double>(*above)) - std::log2(static_cast<double>(*below)));
}

Tones equal_temperament() {
  Tones scale;
  for (int tone = 1; tone <= 12; ++tone) scale.push_back(100.0 * tone);
  return scale;
}

// A description, the number of tones, and so many lines of one pitch each.
Tones read_scale(const TuningText& text) {
  ScalaLines lines(text);
  (void)lines.next();
  const int tones = lines.integer("the number of tones", 1, kMaxTones, "12");
  Tones scale;
  while (static_cast<int>(scale.size()) < tones) {
    const std::string_view word = lines.word(fmt::format("pitch {} of {}", scale.size() + 1, tones),
                                             "a pitch in each line, such as 3/2 or 701.955");
    scale.push_back(word.find('.') == std::string_view::npos ? read_ratio(lines, word) : read_cents(lines, word));
  }
  return scale;
}

double cents_of_degree(const Tones& scale, int degree) {
  const int tones = static_cast<int>(scale.size());
  const int periods = degree >= 0 ? degree / tones : -((tones - 1 - degree) / tones);
  const int tone = degree - periods * tones;
  return periods * scale.back() + (tone == 0 ? 0 : scale[static_cast<std::size_t>(tone - 1)]);
}

/// Which degree of a scale a key plays.
struct KeyMap {
  int first = 0, last = 127;  ///< others keep their pitch
  int middle = kMiddleC;      ///< plays the first entry
  int reference = kMiddleC;
  std::optional<double> reference_hz = {};  ///< none: its own
  int octave = 0;                 ///< degree by which the next pattern is higher; 0: the last one of the scale
  std::vector<int> degrees = {};  ///< empty: one after the other

  /// Not a number where the key is left out.
  [[nodiscard]] double cents(const Tones& scale, int key) const {
    const int from_middle = key - middle, size = static_cast<int>(degrees.size());
    if (size == 0) return cents_of_degree(scale, from_middle);
    const int pattern = from_middle >= 0 ? from_middle / size : -((size - 1 - from_middle) / size);
    const int degree = degrees[static_cast<std::size_t>(from_middle - pattern * size)];
    if (degree == kUnmapped) return std::numeric_limits<double>::quiet_NaN();
    return pattern * (octave == 0 ? scale.back() : cents_of_degree(scale, octave)) + cents_of_degree(scale, degree);
  }
};

double read_reference_hz(ScalaLines& lines) {
  const std::string allowed =
      fmt::format("a number from {} to {}, such as 440.0", kReference_hz.min, kReference_hz.max);
  const std::string_view word = lines.word("the frequency [Hz] of the reference key", allowed);
  const auto hz = number_of<double>(word);
  if (!hz || !(*hz >= kReference_hz.min && *hz <= kReference_hz.max))
    lines.refuse(fmt::format("the frequency [Hz] of the reference key: '{}' is no number in range", shown(word)),
                 allowed);
  return *hz;
}

// Keys at the end that are left out need no line.
std::vector<int> read_degrees(ScalaLines& lines, int size) {
  constexpr auto kAllowed = "a degree of the scale from 0 to 10000, such as 7, or x for a key that is left out";
  std::vector<int> degrees;
  while (static_cast<int>(degrees.size()) < size) {
    const auto word = lines.next_word();
    if (!word) break;
    const auto degree = *word == "x" || *word == "X" ? kUnmapped : number_of<int>(*word);
    if (!degree) lines.refuse(fmt::format("'{}' is no degree", shown(*word)), kAllowed);
    if (*word != "x" && *word != "X" && (*degree < 0 || *degree > kMaxTones))
      lines.refuse(fmt::format("degree {} is out of range", *degree), kAllowed);
    degrees.push_back(*degree);
  }
  degrees.resize(static_cast<std::size_t>(size), kUnmapped);
  return degrees;
}

KeyMap read_keymap(const TuningText& text) {
  ScalaLines lines(text);
  KeyMap map;
  const int size = lines.integer("the size of the map", 0, kMaxMap, "12, or 0 for all degrees one after the other");
  map.first = lines.integer("the first key", 0, 127, "0");
  map.last = lines.integer("the last key", 0, 127, "127");
  if (map.last < map.first)
    lines.refuse(fmt::format("the last key: {} is below the first one", map.last),
                 fmt::format("an integer from {} to 127, such as 127", map.first));
  map.middle = lines.integer("the key of the first entry", 0, 127, "60");
  map.reference = lines.integer("the reference key", 0, 127, "69");
  map.reference_hz = read_reference_hz(lines);
  map.octave = lines.integer("the degree of the octave", 0, kMaxTones, "12, or 0 for the last degree");
  map.degrees = read_degrees(lines, size);
  return map;
}

}  // namespace

KeyCents key_cents(const Tuning& tuning, double own_a4_hz) {
  if (tuning.a4_hz && !(*tuning.a4_hz >= kA4_hz.min && *tuning.a4_hz <= kA4_hz.max))
    refuse("tuning", "a4_hz", fmt::format("{} is out of range", *tuning.a4_hz),
           fmt::format("a number from {} to {}, such as 442", kA4_hz.min, kA4_hz.max));
  const Tones scale = tuning.scale ? read_scale(*tuning.scale) : equal_temperament();
  KeyMap map = tuning.keymap ? read_keymap(*tuning.keymap) : KeyMap();
  if (tuning.a4_hz) map.reference = kA4, map.reference_hz = tuning.a4_hz;
  const double reference = map.cents(scale, map.reference);
  if (!is_number(reference))
    refuse(tuning.keymap->file, tuning.a4_hz ? "the pitch of A4" : "the reference key",
           fmt::format("the map leaves out key {}, whose pitch is stated", map.reference),
           fmt::format("a key that has a degree, such as {}", map.middle));
  const double own = 100.0 * (map.reference - kA4);
  const double shift = map.reference_hz ? 1200 * std::log2(*map.reference_hz / own_a4_hz) - own : 0;
  KeyCents cents{};
  for (int key = map.first; key <= map.last; ++key)
    cents[static_cast<std::size_t>(key)] = shift + map.cents(scale, key) - reference - 100.0 * (key - map.reference);
  return cents;
}

Tuning read_tuning(const JsonObject& score, const ReadFile& read) {
  const auto text_of = [&](const char* key, const char* allowed) -> std::optional<TuningText> {
    if (!score.has(key)) return {};
    const std::string file = score.text(key, allowed);
    return TuningText{read_for_key(score.file(), score.key(key), file, read), file};
  };
  Tuning tuning{text_of("tuning", "a file of a scale (.scl)"), text_of("keymap", "a file of a key map (.kbm)")};
  if (score.has("a4_hz")) tuning.a4_hz = score.number("a4_hz", kA4_hz);
  return tuning;
}

}  // namespace contactspline
