// SPDX-License-Identifier: MIT
// The steps of a search, so that an interrupted one goes on.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace contactspline {

/// What each step found, in their order.
using StepResults = std::vector<std::vector<double>>;

/// Where results stay beside a search. `inputs`: a digest of all that they depend on.
struct StepsOnDisk {
  std::function<StepResults(const std::string& inputs)> read;
  std::function<void(const std::string& inputs, const StepResults& results)> write;
};

/// A search with the same inputs takes the same steps with the same results to the bit, so those that are known need
/// not be computed again.
class SearchSteps {
 public:
  SearchSteps() = default;
  SearchSteps(std::string inputs, StepsOnDisk disk)
      : inputs_(std::move(inputs)), disk_(std::move(disk)), results_(disk_.read(inputs_)) {}

  /// The result of the next step, so many numbers: as it is known, or as `compute` returns it.
  std::vector<double> next(std::size_t numbers, const std::function<std::vector<double>()>& compute) {
    if (taken_ < results_.size() && results_[taken_].size() == numbers) return results_[taken_++];
    results_.resize(taken_++);
    results_.push_back(compute());
    if (disk_.write) disk_.write(inputs_, results_);
    return results_.back();
  }

 private:
  std::string inputs_;
  StepsOnDisk disk_;
  StepResults results_;
  std::size_t taken_ = 0;
};

}  // namespace contactspline
