// SPDX-License-Identifier: MIT
// Straight-line calculations as Faust text.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace contactspline {

/// Writes definitions of signals, each by those before it, as a chain of Faust functions `first : second : ...`.
/// Every function takes the signals that are still used and adds its own. So each signal is computed once; Faust
/// would copy a named expression to wherever it is used.
class FaustChain {
 public:
  /// A signal by an expression of signals that were there before this function.
  void add(std::string name, std::string expression) {
    add(std::vector<std::string>{std::move(name)}, std::move(expression));
  }
  /// Several signals by an expression with as many outputs.
  void add(std::vector<std::string> names, std::string expression);
  /// Begins a new function: what was added so far may be used from here on.
  void next() {
    if (!steps_.back().empty()) steps_.emplace_back();
  }

  /// The definitions of the functions and of `name`, which takes `inputs` and returns `outputs`.
  [[nodiscard]] std::string text(const std::string& name, const std::vector<std::string>& inputs,
                                 const std::vector<std::string>& outputs) const;

 private:
  struct Definition {
    std::vector<std::string> names;
    std::string expression;
  };
  std::vector<std::vector<Definition>> steps_{1};
};

/// A sum, term after term; empty for 0.
class FaustSum {
 public:
  FaustSum& add(const std::string& term, bool is_negative = false);
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::string or_zero() const { return text_.empty() ? "0.0" : text_; }

 private:
  std::string text_;
};

/// A number that may stand in a product or a sum. Faust takes "-1" for a unary minus only after an operator.
[[nodiscard]] std::string faust_number(double value);
/// A product, empty for 0.
[[nodiscard]] std::string faust_product(const std::string& a, const std::string& b);
/// An expression whose terms Faust keeps together; empty for 0.
[[nodiscard]] std::string faust_kept(const std::string& expression);

/// Names or expressions, separated by commas, wrapped at 110 columns and indented.
[[nodiscard]] std::string faust_list(const std::vector<std::string>& items, std::string_view indent);

}  // namespace contactspline
