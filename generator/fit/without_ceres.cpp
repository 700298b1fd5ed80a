// SPDX-License-Identifier: MIT
// fit_material() of a program that was built without Ceres.
#include "generator/fit/fit.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

Fit fit_material(const Measurements& /*measured*/, const std::string& file,
                 const std::function<void(const std::string&)>& /*tell*/) {
  refuse(file, "fit", "this program was built without Ceres", "a build with CONTACTSPLINE_BUILD_FIT ON");
}

}  // namespace contactspline
