// SPDX-License-Identifier: MIT
// The plan of a data set: what is played, over which values, and what is kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/data/timed_event.hpp"
#include "generator/dataset/distribution.hpp"
#include "generator/material/contact_reader.hpp"
#include "generator/player/instrument_maker.hpp"

namespace contactspline {

/// What happens to each sample at a time: an event of the instrument by the value of its parameter, a key,
/// or a new value.
struct PlannedEvent {
  enum Kind : unsigned char { kPlay, kKey, kSet };
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::size_t sample;
  Kind kind;
  std::size_t number;                      ///< of the event among those of its kind; of the parameter of kSet
  std::size_t key = kNone, value = kNone;  ///< columns: the key, its velocity or the new value
  std::size_t end = kNone;                 ///< sample at which a hold ends
  Action action = Action::kNoteOn;         ///< of kPlay
  double rise_s = 0;                       ///< of a pluck
};

/// Something that is kept of each sample.
struct Recorded {
  enum Kind : unsigned char { kOutput, kForce, kEnergy };
  std::string name, unit;
  Kind kind;
  std::size_t output;  ///< number of the output
};

/// A parameter that takes the values of a column.
struct FirstValue {
  std::size_t parameter, column;
};

struct Plan {
  std::string file;                           ///< for messages
  std::string name;                           ///< of the data set's files
  std::string text;                           ///< of the plan
  std::map<std::string, std::string> inputs;  ///< the texts of the files that it names, by path
  InstrumentMaker maker;
  std::string instrument, description, license;
  std::vector<PlanColumn> columns;
  std::vector<FirstValue> first;
  std::vector<PlannedEvent> events;  ///< by rising time
  std::vector<Recorded> recorded;
  Sequence sequence = Sequence::kRandom;
  std::uint64_t seed = 0;
  std::size_t count = 0;        ///< of samples
  std::size_t length = 0;       ///< of a sample's sound, in samples of sound
  std::size_t energy_step = 0;  ///< samples of sound between two energies; 0: none
  double sample_rate_hz = 44100;
  bool is_double = false;

  /// Number of values that one sample has of it: 32 bits each, energies 64 bits.
  [[nodiscard]] std::size_t length_of(const Recorded& recorded_one) const;
  [[nodiscard]] std::size_t bytes_per_sample() const;
};

/// Parses a plan: JSON with comments (docs/how-to/datasets.md). `read` reads the files that it names. Throws
/// BadInput.
[[nodiscard]] Plan parse_plan(std::string_view text, const std::string& file, const ReadFile& read);

}  // namespace contactspline
