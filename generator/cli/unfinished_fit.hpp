// SPDX-License-Identifier: MIT
// What a fit has found so far, in a file beside its output until it ends.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "generator/listen/search_steps.hpp"

namespace contactspline {

class UnfinishedFit {
 public:
  /// output: of the fit. goes_on: called where the file of an interrupted fit is there, before that goes on.
  UnfinishedFit(const std::filesystem::path& output, bool force, std::function<void()> goes_on);

  [[nodiscard]] static std::filesystem::path file_of(const std::filesystem::path& output);

  /// Of inputs with this digest. Throws BadInput if the file is of others, unless `force`.
  StepResults read(const std::string& inputs);

  /// Writes the file anew, at most four times a second.
  void write(const std::string& inputs, const StepResults& results);

  /// The fit has ended. A file of other inputs stays.
  void remove();

 private:
  std::filesystem::path file_;
  bool force_, is_ours_ = false;
  std::function<void()> goes_on_;
  std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
};

}  // namespace contactspline
