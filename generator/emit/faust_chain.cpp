// SPDX-License-Identifier: MIT
#include "generator/emit/faust_chain.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

// The identifiers in an expression.
std::set<std::string> identifiers_in(std::string_view expression) {
  const auto belongs = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
  };
  std::set<std::string> found;
  for (std::size_t i = 0; i < expression.size();) {
    std::size_t end = i;
    while (end < expression.size() && belongs(expression[end])) ++end;
    if (end > i) found.insert(std::string(expression.substr(i, end - i)));
    i = std::max(end, i + 1);
  }
  return found;
}

}  // namespace

FaustSum& FaustSum::add(const std::string& term, bool is_negative) {
  if (term.empty()) return *this;
  if (text_.empty() && is_negative) text_ = "0.0";
  text_ += text_.empty() ? term : fmt::format(" {} {}", is_negative ? "-" : "+", term);
  return *this;
}

std::string faust_number(double value) {
  return value < 0 ? fmt::format("(0.0 - {})", literal(-value)) : literal(value);
}

std::string faust_product(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return "";
  return a == "1.0" ? b : b == "1.0" ? a : fmt::format("{} * {}", a, b);
}

std::string faust_kept(const std::string& expression) {
  return expression.empty() ? "" : fmt::format("keep({})", expression);
}

std::string faust_list(const std::vector<std::string>& items, std::string_view indent) {
  std::string text(indent);
  std::size_t column = indent.size();
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string item = items[i] + (i + 1 < items.size() ? "," : "");
    if (column + item.size() > 110 && column > indent.size()) {
      text += fmt::format("\n{}", indent);
      column = indent.size();
    } else if (i > 0) {
      text += ' ';
    }
    text += item;
    column += item.size() + 1;
  }
  return text;
}

void FaustChain::add(std::vector<std::string> names, std::string expression) {
  steps_.back().push_back({std::move(names), std::move(expression)});
}

std::string FaustChain::text(const std::string& name, const std::vector<std::string>& inputs,
                             const std::vector<std::string>& outputs) const {
  // From the end: the signals that are used after each step.
  std::vector<std::set<std::string>> used_after(steps_.size() + 1);
  used_after.back() = {outputs.begin(), outputs.end()};
  for (std::size_t s = steps_.size(); s-- > 0;) {
    used_after[s] = used_after[s + 1];
    for (const Definition& definition : steps_[s]) {
      for (const std::string& own : definition.names) used_after[s].erase(own);
      used_after[s].merge(identifiers_in(definition.expression));
    }
  }
  std::string text;
  std::vector<std::string> live = inputs, functions;
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    const std::string function = fmt::format("{}_{}", name, s);
    std::vector<std::string> after, expressions;
    for (const std::string& signal : live)
      if (used_after[s + 1].contains(signal)) after.push_back(signal);
    expressions = after;
    for (const Definition& definition : steps_[s]) {
      after.insert(after.end(), definition.names.begin(), definition.names.end());
      expressions.push_back(definition.expression);
    }
    text += fmt::format("{}(\n{}) =\n{};\n", function, faust_list(live, "    "), faust_list(expressions, "  "));
    functions.push_back(function);
    live = after;
  }
  const std::string function = name + "_outputs";
  text += fmt::format("{}(\n{}) =\n{};\n", function, faust_list(live, "    "), faust_list(outputs, "  "));
  functions.push_back(function);
  return text + fmt::format("{} = {};\n", name, fmt::join(functions, " : "));
}

}  // namespace contactspline
