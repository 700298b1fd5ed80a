// SPDX-License-Identifier: MIT
// fit_material() and read_recording() of a program that was built without Ceres, and so without libsndfile.
#include "generator/fit/fit.hpp"
#include "generator/fit/recorded_note.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

[[noreturn]] void refuse_fit(const std::string& file) {
  refuse(file, "fit", "this program was built without Ceres", "a build with CONTACTSPLINE_BUILD_FIT ON");
}

}  // namespace

Recording read_recording(std::string_view /*bytes*/, const std::string& file) {
  refuse_fit(file);
}

Fit fit_material(const Measurements& /*measured*/, const std::string& file,
                 const std::function<void(const std::string&)>& /*tell*/) {
  refuse_fit(file);
}

}  // namespace contactspline
