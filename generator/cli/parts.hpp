// SPDX-License-Identifier: MIT
// The instruments that play a MIDI file together: each has channels of its own.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "generator/cli/inputs.hpp"
#include "generator/cli/midi_mix.hpp"
#include "generator/player/score_player.hpp"

namespace contactspline {

/// An instrument and what it plays.
struct Part {
  std::string instrument;          ///< as of score_argument(): empty is the piano
  std::vector<int> channels;       ///< 1 to 16; empty: those that score_argument() chooses
  std::vector<int> programs = {};  ///< 1 to 128, as General MIDI counts
  bool has_others = false;         ///< plays what no other part does
};

/// Who plays a score.
struct Parts {
  std::vector<Part> list;
  bool by_channel = false;  ///< of a MIDI file; else there is one part
};

/// The parts of --instrument: a NAME alone, which plays `channels`; or a list of CHANNEL=NAME, pPROGRAM=NAME and, for
/// the other channels, *=NAME or a NAME alone. A name that stands there twice is one part. The path of a file that
/// exists is a name, whatever is in it. Throws BadInput.
[[nodiscard]] Parts parts_argument(std::span<const std::string> instruments, const std::vector<int>& channels);

/// The parts of such a list, of which each has what stands before = and a name. Throws BadInput.
[[nodiscard]] Parts parts_by_channel(std::span<const std::pair<std::string, std::string>> list);

/// A part that has notes.
struct PartSource {
  std::string name;  ///< of its instrument
  ScoreSource source;
  std::vector<MixGains> mix = {};  ///< of a list of parts
};

struct PartSources {
  std::vector<PartSource> list;      ///< at least one
  std::vector<std::string> remarks;  ///< lines on parts without notes, and on channels without a part
};

/// What each part plays of a SCORE: the messages of its channels, and those of no channel. The program of a channel
/// is that of its first note; the tenth, of drums, has none and is not among the others. `tuning` tunes the parts
/// that have a pitch, of which there must be one. Throws BadInput, also where no part has notes.
[[nodiscard]] PartSources read_parts(const std::string& score, const Parts& parts, const Tuning& tuning);

/// 2 where the sides of a sound differ, by itself or as it is mixed; else 1.
[[nodiscard]] int channels_of(const Score& score, const PlayOptions& options, std::span<const MixGains> mix);

/// The precision that is asked for, or the only one in which a model of the user's own computes.
[[nodiscard]] Precision precision_of(const Score& score, Precision asked);

/// What a host plays as 1: of several parts each sounds as loud as in a host.
[[nodiscard]] double full_scale_of(const Score& score, const PlayOptions& how);

/// Adds a part, its samples divided by its full scale and mixed, to others at the same rate. A part of one channel is
/// on both sides of a sum of two.
void add_part(Performance& sum, const Performance& part, double full_scale, std::span<const MixGains> mix);

}  // namespace contactspline
