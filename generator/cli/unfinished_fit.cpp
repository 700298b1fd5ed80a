// SPDX-License-Identifier: MIT
#include "generator/cli/unfinished_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "generator/cli/files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"

namespace contactspline {
namespace {

constexpr auto kInputs = "inputs ";

// Above the results.
std::string header(const std::string& inputs) {
  return fmt::format("{}: what a fit has found so far. The same command goes on from there.\n{}{}\n", mark(), kInputs,
                     inputs);
}

// Of a line that was written; those before what is no number.
std::vector<double> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  double number = 0;
  for (const char *at = line.data(), *end = at + line.size(); at != end;) {
    const auto result = std::from_chars(at, end, number);
    if (result.ec != std::errc()) break;
    numbers.push_back(number);
    at = result.ptr + (result.ptr != end ? 1 : 0);
  }
  return numbers;
}

}  // namespace

UnfinishedFit::UnfinishedFit(const std::filesystem::path& output, bool force, std::function<void()> goes_on)
    : file_(file_of(output)), force_(force), goes_on_(std::move(goes_on)) {}

std::filesystem::path UnfinishedFit::file_of(const std::filesystem::path& output) {
  return output.string() + ".part";
}

StepResults UnfinishedFit::read(const std::string& inputs) {
  constexpr int kMaxMib = 64;
  std::error_code error;
  is_ours_ = true;
  if (!std::filesystem::exists(file_, error)) return {};
  std::istringstream text(read_large_input(file_, kMaxMib));
  std::string line;
  std::getline(text, line);
  std::getline(text, line);
  if (line != kInputs + inputs) {
    is_ours_ = force_;
    if (force_) return {};
    refuse(file_.string(), "inputs", "an interrupted fit of other files left it, or one by another program",
           "the files of that fit to go on, another -o, or --force to begin anew");
  }
  StepResults results;
  while (std::getline(text, line)) results.push_back(numbers_of(line));
  goes_on_();
  return results;
}

void UnfinishedFit::write(const std::string& inputs, const StepResults& results) {
  constexpr std::chrono::milliseconds kBetween(250);
  const auto now = std::chrono::steady_clock::now();
  if (now < written_ + kBetween) return;
  written_ = now;
  std::string text = header(inputs);
  for (const std::vector<double>& result : results) text += fmt::format("{}\n", fmt::join(result, " "));
  try {
    write_files({{OutputFile{file_, std::move(text)}}});
  } catch (const BadInput&) {  // on a full disk the fit goes on
  }
}

void UnfinishedFit::remove() {
  std::error_code error;
  if (is_ours_) std::filesystem::remove(file_, error);
}

}  // namespace contactspline
