// SPDX-License-Identifier: MIT
#include "generator/player/midi_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "contactspline/midi/midi_message.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr int kTrackName = 3, kEndOfTrack = 0x2f, kTempo = 0x51;  // meta events
constexpr std::size_t kLongestTitle = 100, kChunkHead = 8;
constexpr std::int64_t kLastTick = std::int64_t{1} << 40;  // far beyond an hour

/// What is not read as it stands: of each kind the first place, and how often.
class Remarks {
 public:
  void add(std::string_view what, int track, std::size_t byte) {
    const auto found = std::ranges::find(kinds_, what, &Kind::what);
    if (found != kinds_.end())
      ++found->count;
    else
      kinds_.push_back({what, track, byte, 1});
  }
  [[nodiscard]] std::vector<std::string> in_words() const {
    std::vector<std::string> words;
    for (const auto& [what, track, byte, count] : kinds_)
      words.push_back(fmt::format("track {}, byte {}: {}{}", track, byte, what,
                                  count > 1 ? fmt::format(" ({} times)", count) : ""));
    return words;
  }

 private:
  struct Kind {
    std::string_view what;
    int track;
    std::size_t byte, count;
  };
  std::vector<Kind> kinds_;
};

/// A message at a tick, or a tempo.
struct Ticked {
  std::int64_t tick;
  std::vector<std::uint8_t> bytes;  ///< empty: a tempo
  int quarter_us = 0;
};

/// Reads the events of one track.
class TrackReader {
 public:
  /// begin, end: of the content of its chunk, in the file.
  TrackReader(std::string_view file, std::size_t begin, std::size_t end, int track, Remarks& remarks)
      : file_(file), at_(begin), end_(end), track_(track), remarks_(remarks) {}

  void read(std::int64_t first_tick) {
    tick_ = first_tick;
    while (at_ < end_ && !has_ended_) read_event();
    if (!has_ended_) remarks_.add(at_ > end_ ? "the track breaks off" : "the track has no end", track_, end_);
  }
  [[nodiscard]] std::vector<Ticked>&& events() { return std::move(events_); }
  [[nodiscard]] std::int64_t tick() const { return tick_; }
  [[nodiscard]] std::size_t end() const { return std::min(at_, end_); }
  [[nodiscard]] const std::string& title() const { return title_; }

 private:
  // 0 beyond the end, which read() notices.
  int byte() { return at_ < end_ ? static_cast<unsigned char>(file_[at_++]) : (++at_, 0); }
  [[nodiscard]] bool has_broken_off() const { return at_ > end_; }

  // Of at most four bytes; the fourth counts as the last.
  std::size_t length() {
    std::size_t value = 0;
    for (int n = 0; n < 4; ++n) {
      const int next = byte();
      value = value << 7 | static_cast<std::size_t>(next & 0x7f);
      if (next < 0x80) return value;
    }
    remarks_.add("a number is longer than four bytes", track_, at_ - 1);
    return value;
  }

  std::string_view content(std::size_t length) {
    const auto part = file_.substr(std::min(at_, end_), std::min(length, end_ - std::min(at_, end_)));
    at_ += length;
    return part;
  }

  void read_event() {
    const auto begin = static_cast<std::int64_t>(length());
    tick_ = std::min(tick_ + begin, kLastTick);
    event_ = at_;
    if (at_ >= end_) return;
    const int first = byte();
    if (first == 0xff) return read_meta();
    if (first == 0xf0 || first == 0xf7) return read_exclusive(first);
    if (first >= 0xf0) return skip_system(first);
    if (first >= 0x80) return read_message(status_ = first, {});
    if (status_ == 0) return skip_to_status();
    if (is_interrupted_) remarks_.add("running status goes on after another event", track_, event_);
    read_message(status_, first);
  }

  void read_message(int status, std::optional<int> first) {
    std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(status)};
    is_interrupted_ = false;
    if (first) bytes.push_back(static_cast<std::uint8_t>(*first));
    while (bytes.size() <= midi_data_bytes(status)) bytes.push_back(static_cast<std::uint8_t>(byte()));
    if (has_broken_off()) return;
    if (std::ranges::any_of(std::span(bytes).subspan(1), [](int data) { return data > 127; }))
      return remarks_.add("left out: an event with a data byte above 127", track_, event_);
    events_.push_back({tick_, std::move(bytes)});
  }

  void read_meta() {
    is_interrupted_ = true;
    const int type = byte();
    const std::string_view text = content(length());
    if (has_broken_off()) return;
    if (type == kEndOfTrack) has_ended_ = true;
    if (type == kTrackName && title_.empty() && !text.empty()) title_ = shown(text, kLongestTitle);
    if (type != kTempo) return;
    int quarter_us = 0;
    for (const char digit : text.substr(0, 3)) quarter_us = quarter_us << 8 | static_cast<unsigned char>(digit);
    if (text.size() != 3 || quarter_us == 0) return remarks_.add("left out: a tempo that is none", track_, event_);
    events_.push_back({tick_, {}, quarter_us});
  }

  // A system-exclusive message may come in several packets; the last one ends in 0xf7.
  void read_exclusive(int first) {
    is_interrupted_ = true;
    const std::string_view data = content(length());
    if (has_broken_off() || (first == 0xf7 && exclusive_.empty())) return;
    if (first == 0xf0) exclusive_ = {0xf0};
    exclusive_.insert(exclusive_.end(), data.begin(), data.end());
    if (exclusive_.back() == 0xf7) events_.push_back({tick_, std::exchange(exclusive_, {})});
  }

  void skip_system(int status) {
    is_interrupted_ = true;
    remarks_.add("left out: a message that has no place in a file", track_, event_);
    (void)content(status == 0xf2 ? 2 : status == 0xf1 || status == 0xf3 ? 1 : 0);
  }

  // The first event of a track needs a status.
  void skip_to_status() {
    remarks_.add("left out: data without a status", track_, event_);
    while (at_ < end_ && static_cast<unsigned char>(file_[at_]) < 0x80) ++at_;
    const int status = byte();
    if (has_broken_off()) return;
    if (status == 0xff) return read_meta();
    if (status < 0xf0) read_message(status_ = status, {});
  }

  std::string_view file_;
  std::size_t at_, end_, event_ = 0;
  int track_;
  Remarks& remarks_;
  std::vector<Ticked> events_;
  std::vector<std::uint8_t> exclusive_;
  std::string title_;
  std::int64_t tick_ = 0;
  int status_ = 0;  // running; 0: none yet
  bool is_interrupted_ = false, has_ended_ = false;
};

/// Seconds from ticks that come in rising order.
class Clock {
 public:
  /// division: ticks a quarter, or, above 0x7fff, minus frames a second and ticks a frame in a byte each.
  explicit Clock(int division) {
    const int frames = 256 - (division >> 8);
    if (division > 0x7fff)
      tick_s_ = 1 / ((frames == 29 ? 29.97 : frames) * std::max(1, division & 0xff));
    else
      quarter_ticks_ = division, set_tempo(500'000);
  }

  double at(std::int64_t tick) {
    time_s_ += static_cast<double>(tick - tick_) * tick_s_;
    tick_ = tick;
    return time_s_;
  }
  void set_tempo(int microseconds) {
    if (quarter_ticks_ > 0) tick_s_ = 1e-6 * microseconds / quarter_ticks_;
  }

 private:
  int quarter_ticks_ = 0;
  double tick_s_ = 0, time_s_ = 0;
  std::int64_t tick_ = 0;
};

std::size_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::size_t number = 0;
  for (std::size_t n = 0; n < size && at + n < bytes.size(); ++n)
    number = number << 8 | static_cast<unsigned char>(bytes[at + n]);
  return number;
}

// Where the MIDI file begins: within the data chunk of a RIFF file, or at once.
std::size_t begin_of(std::string_view bytes, std::string_view file) {
  const std::size_t begin = bytes.starts_with("RIFF") ? bytes.find("MThd") : 0;
  if (begin >= bytes.size() || !bytes.substr(begin).starts_with("MThd"))
    refuse_midi(file, "it has no MThd at its beginning");
  return begin;
}

// Everything of all tracks, by rising tick.
struct Tracks {
  std::vector<Ticked> events;
  std::string title;
  std::int64_t end_tick = 0;
  int count = 0;
};

Tracks read_tracks(std::string_view bytes, std::size_t begin, bool follow, Remarks& remarks) {
  Tracks tracks;
  while (begin + kChunkHead <= bytes.size()) {
    const std::size_t content = begin + kChunkHead, length = number_at(bytes, begin + 4, 4);
    const std::size_t end = length > bytes.size() - content ? bytes.size() : content + length;
    const bool is_track = bytes.substr(begin, 4) == "MTrk";
    begin = end;
    if (!is_track) continue;
    ++tracks.count;
    if (length == 0) continue;
    TrackReader reader(bytes, content, end, tracks.count, remarks);
    reader.read(follow ? tracks.end_tick : 0);
    if (length > bytes.size() - content) begin = reader.end();  // the length is wrong; its end is known
    if (tracks.count == 1) tracks.title = reader.title();
    tracks.end_tick = std::max(tracks.end_tick, reader.tick());
    for (Ticked& event : reader.events()) tracks.events.push_back(std::move(event));
  }
  std::ranges::stable_sort(tracks.events, {}, &Ticked::tick);
  return tracks;
}

}  // namespace

void refuse_midi(std::string_view file, std::string_view wrong) {
  throw BadInput(fmt::format("{}: MIDI: {}; allowed: a standard MIDI file of format 0, 1 or 2", file, wrong));
}

MidiFile read_midi_file(std::string_view bytes, std::string_view file) {
  const std::size_t begin = begin_of(bytes, file), header = number_at(bytes, begin + 4, 4);
  const std::size_t format = number_at(bytes, begin + 8, 2), count = number_at(bytes, begin + 10, 2);
  const auto division = static_cast<int>(number_at(bytes, begin + 12, 2));
  if (header < 6 || bytes.size() < begin + kChunkHead + 6) refuse_midi(file, "its header is too short");
  if (format > 2) refuse_midi(file, fmt::format("byte {}: it has format {}", begin + 8, format));
  if (division == 0) refuse_midi(file, fmt::format("byte {}: its unit of time is 0", begin + 12));
  Remarks remarks;
  Tracks tracks = read_tracks(bytes, begin + kChunkHead + header, format == 2, remarks);
  if (tracks.count == 0) refuse_midi(file, fmt::format("no track follows its header, from byte {} on", begin + 14));
  MidiFile result{std::move(tracks.title), {}, 0, remarks.in_words()};
  if (static_cast<std::size_t>(tracks.count) < count)
    result.remarks.push_back(fmt::format("it has {} of {} tracks", tracks.count, count));
  if (format == 2 && tracks.count > 1) result.remarks.emplace_back("the tracks of format 2 follow each other");
  Clock clock(division);
  for (Ticked& event : tracks.events) {
    const double time_s = clock.at(event.tick);
    if (event.bytes.empty())
      clock.set_tempo(event.quarter_us);
    else
      result.messages.push_back({time_s, std::move(event.bytes)});
  }
  result.end_s = clock.at(tracks.end_tick);
  return result;
}

}  // namespace contactspline
