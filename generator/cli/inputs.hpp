// SPDX-License-Identifier: MIT
// The arguments of the command line that name a file or something that ships: MATERIAL and SCORE. kStandardInput in
// place of a file is standard input.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/emit/emitter.hpp"
#include "generator/instrument/instrument.hpp"
#include "generator/material/friction_reader.hpp"
#include "generator/player/score.hpp"
#include "generator/player/tuning.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

/// Reads and designs a MATERIAL: a file if it ends in .json or .mid or has a slash, else the name of one that ships.
/// `of_any_kind`: messages say that resonators, keyboards and instruments are allowed, too. Throws BadInput.
[[nodiscard]] Design design_argument(const std::string& argument, bool of_any_kind = false);

/// The file that an argument names: none for a shipped name.
[[nodiscard]] std::vector<std::filesystem::path> input_files(const std::string& argument);

/// The files that a MATERIAL argument was read from: none for a shipped name.
[[nodiscard]] std::vector<std::filesystem::path> input_files(const std::string& argument, const Material& material);

/// The resonator of such an argument, or nothing if it is not a resonator. Throws BadInput.
[[nodiscard]] std::optional<Resonator> resonator_argument(const std::string& argument);

/// The friction of such an argument, or nothing if it is not a friction. Throws BadInput.
[[nodiscard]] std::optional<RubbingSurfaces> friction_argument(const std::string& argument);

/// The keyboard of such an argument, or nothing if it is not a keyboard. Throws BadInput.
[[nodiscard]] std::optional<Keyboard> keyboard_argument(const std::string& argument);

/// An instrument and the files it was read from.
struct InstrumentSource {
  InstrumentModel model;
  std::vector<std::filesystem::path> files;
};

/// The instrument of such an argument, or nothing if it is not an instrument. Throws BadInput.
[[nodiscard]] std::optional<InstrumentSource> instrument_argument(const std::string& argument);

/// What `generate` turns into source text: a material, a resonator, a keyboard or an instrument.
struct Source {
  std::string name;
  std::function<std::string(const Emitter&, std::string_view command)> emit;
  std::vector<std::filesystem::path> files;        ///< it was read from; none for a shipped name
  std::optional<std::string> faust_obstacle = {};  ///< why it cannot be written in Faust
  std::string remark = {};                         ///< a line on what it does at this rate, or nothing
};

/// Reads a MATERIAL argument of `generate`. Resonators and instruments keep their modes below
/// max_frequency_hz; if a resonator's own limit leaves out some of them, a line on standard error says so. Throws
/// BadInput.
[[nodiscard]] Source source_argument(const std::string& argument, double max_frequency_hz);

/// A score and the files it was read from.
struct ScoreSource {
  Score score;
  std::vector<std::filesystem::path> files;
};

/// Reads a SCORE and the resonators and materials it names: a file if it ends in .json or .mid or has a slash, else
/// the name of one that ships. `channels` (1 to 16) chooses those of a MIDI file; empty: all but the tenth. Throws
/// BadInput.
/// `instrument`: what plays: an instrument with keys for a MIDI file, as MATERIAL, or the library of a model of the
/// user's own (.so), also for a score; empty: the piano. `tuning`: of its keys, in place of the score's.
[[nodiscard]] ScoreSource score_argument(const std::string& argument, const std::vector<int>& channels = {},
                                         const std::string& instrument = {}, const Tuning& tuning = {});

/// The bytes of a SCORE that is a MIDI file; nothing for another one. Throws BadInput.
[[nodiscard]] std::optional<std::string> midi_bytes(const std::string& argument);

/// The tuning of files of Scala, each empty or a path, and of a pitch of A4. Throws BadInput.
[[nodiscard]] Tuning tuning_argument(const std::string& scale, const std::string& keymap,
                                     std::optional<double> a4_hz);

}  // namespace contactspline
