// SPDX-License-Identifier: MIT
// A Faust program to drive: set its controls by label, run it over whole signals.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace contactspline::testing {

template <std::floating_point T>
using Signals = std::vector<std::vector<T>>;  ///< [channel][sample]

template <std::floating_point T>
class FaustProgram {
 public:
  virtual ~FaustProgram() = default;

  /// Moves the slider or button of that label. Throws where there is none.
  virtual void set(const std::string& label, T value) = 0;

  /// Outputs over `samples`, in blocks of an odd size: the state must carry over.
  [[nodiscard]] Signals<T> run(Signals<T> inputs, std::size_t samples) {
    constexpr std::size_t kBlock = 37;
    if (inputs.size() != input_count()) throw std::invalid_argument("wrong number of inputs");
    Signals<T> outputs(output_count(), std::vector<T>(samples));
    for (std::size_t begin = 0; begin < samples; begin += kBlock)
      compute(static_cast<int>(std::min(kBlock, samples - begin)), channels(inputs, begin).data(),
              channels(outputs, begin).data());
    return outputs;
  }

 protected:
  [[nodiscard]] virtual std::size_t input_count() = 0;
  [[nodiscard]] virtual std::size_t output_count() = 0;
  virtual void compute(int samples, T** inputs, T** outputs) = 0;

 private:
  static std::vector<T*> channels(Signals<T>& signals, std::size_t begin) {
    std::vector<T*> pointers;
    for (auto& signal : signals) pointers.push_back(signal.data() + begin);
    return pointers;
  }
};

}  // namespace contactspline::testing
