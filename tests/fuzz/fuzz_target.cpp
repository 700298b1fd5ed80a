// SPDX-License-Identifier: MIT
// What libFuzzer calls (scripts/fuzz). CONTACTSPLINE_FUZZ is the name of a path, for its reader alone, or
// "NAME.play".
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

#include "fuzz/paths.hpp"
#include "generator/support/error.hpp"

namespace contactspline::testing {
namespace {

constexpr std::string_view kPlay = ".play";

struct Target {
  std::string_view file;
  TakeBytes take;
};

Target chosen_target() {
  const char* chosen = std::getenv("CONTACTSPLINE_FUZZ");
  if (chosen == nullptr) throw std::runtime_error("CONTACTSPLINE_FUZZ is not set");
  std::string_view name = chosen;
  const bool plays = name.ends_with(kPlay);
  if (plays) name.remove_suffix(kPlay.size());
  const Path& path = path_of(name);
  return {path.file, plays ? path.play : path.read};
}

}  // namespace
}  // namespace contactspline::testing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace contactspline::testing;
  static const Target target = chosen_target();
  try {
    target.take({reinterpret_cast<const char*>(data), size});
  } catch (const contactspline::BadInput& refusal) {
    if (const auto fault = fault_of_message(refusal.what(), target.file); !fault.empty()) {
      std::fprintf(stderr, "A message %s: %s\n", std::string(fault).c_str(), refusal.what());
      std::abort();
    }
  }
  return 0;
}
