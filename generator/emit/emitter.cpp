// SPDX-License-Identifier: MIT
#include "generator/emit/emitter.hpp"

#include <array>

namespace contactspline {

std::span<const Emitter> emitters() {
  static constexpr std::array kEmitters = {Emitter{"faust", "lib"}, Emitter{"cpp", "hpp"}, Emitter{"json", "json"}};
  return kEmitters;
}

}  // namespace contactspline
