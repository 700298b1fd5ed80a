// SPDX-License-Identifier: MIT
// What libFuzzer calls (scripts/fuzz). CONTACTSPLINE_FUZZ is the name of a path, for its reader alone, or
// "NAME.play". Prints at the end how many inputs were not refused.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <span>
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
  bool changes_numbers;
};

Target find_target() {
  const char* chosen = std::getenv("CONTACTSPLINE_FUZZ");
  if (chosen == nullptr) throw std::runtime_error("CONTACTSPLINE_FUZZ is not set");
  std::string_view name = chosen;
  const bool plays = name.ends_with(kPlay);
  if (plays) name.remove_suffix(kPlay.size());
  const Path& path = path_of(name);
  return {path.file, plays ? path.play : path.read, plays && name != "midi"};
}

const Target& chosen_target() {
  static const Target target = find_target();
  return target;
}

std::size_t accepted = 0;

/// Another value for a number of a text: near the old one, of another magnitude, an integer, or at an end.
std::string changed_number(const std::string& number, std::minstd_rand& random) {
  const double value = std::atof(number.c_str());
  const auto between = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  switch (random() % 8) {
    case 0:
      return fmt::format("{:.6g}", value * std::pow(10, between(-6, 6)));
    case 1:
      return fmt::format("{}", random() % 128);
    case 2:
      return random() % 2 == 0 ? fmt::format("{:.6g}", -value) : "0";
    case 3:
      return fmt::format("{:.3g}", between(0, 1));
    default:
      return number.find_first_not_of("0123456789") == number.npos ? fmt::format("{:.0f}", value + between(-2, 2))
                                                                   : fmt::format("{:.6g}", value * between(0.7, 1.4));
  }
}

/// Gives one of the numbers of a text another value, so that many inputs stay valid. False if there is none or no
/// space.
bool change_number(std::string& text, std::size_t max_size, std::minstd_rand& random) {
  constexpr std::string_view kDigits = "0123456789", kNumber = "+-.0123456789Ee";
  if (text.empty()) return false;
  std::size_t begin = text.find_first_of(kDigits, random() % text.size());
  if (begin == text.npos) begin = text.find_first_of(kDigits);
  if (begin == text.npos) return false;
  begin = text.find_last_not_of(kNumber, begin) + 1;
  const std::size_t end = std::min(text.find_first_not_of(kNumber, begin), text.size());
  text.replace(begin, end - begin, changed_number(text.substr(begin, end - begin), random));
  return text.size() <= max_size;
}

}  // namespace
}  // namespace contactspline::testing

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

// libFuzzer's own changes are of bytes; few texts stay valid. Where a text is played, it makes one change in ten.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  using contactspline::testing::change_number, contactspline::testing::chosen_target;
  std::minstd_rand random(seed);
  std::string text(reinterpret_cast<const char*>(data), size);
  if (!chosen_target().changes_numbers || random() % 10 == 0 || !change_number(text, max_size, random))
    return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  return std::atexit([] { std::fprintf(stderr, "stat::accepted: %zu\n", contactspline::testing::accepted); });
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace contactspline::testing;
  const Target& target = chosen_target();
  try {
    target.take({reinterpret_cast<const char*>(data), size});
    ++accepted;
  } catch (const contactspline::BadInput& refusal) {
    if (const auto fault = fault_of_message(refusal.what(), target.file); !fault.empty()) {
      std::fprintf(stderr, "A message %s: %s\n", std::string(fault).c_str(), refusal.what());
      std::abort();
    }
  }
  return 0;
}
