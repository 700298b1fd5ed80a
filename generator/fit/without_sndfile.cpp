// SPDX-License-Identifier: MIT
// read_recording() where there is no libsndfile.
#include "generator/fit/recorded_note.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

RecordedSound read_recording(std::string_view /*bytes*/, const std::string& file, int /*max_channels*/) {
  refuse(file, "file", "is no table, and this program was built without libsndfile", "a table of levels");
}

}  // namespace contactspline
