// SPDX-License-Identifier: MIT
// An instrument of the library for C that is destroyed with its owner.
#pragma once

#include <memory>

#include "contactspline.h"

namespace contactspline::testing {

struct Destroy {
  void operator()(contactspline_instrument* instrument) const { contactspline_destroy(instrument); }
};
using Handle = std::unique_ptr<contactspline_instrument, Destroy>;

}  // namespace contactspline::testing
