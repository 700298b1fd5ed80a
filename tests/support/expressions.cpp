// SPDX-License-Identifier: MIT
#include "expressions.hpp"

#include <map>
#include <regex>

namespace contactspline::testing {
namespace {

const std::regex& compiled(const std::string& expression) {
  static std::map<std::string, std::regex> known;
  const auto [at, is_new] = known.try_emplace(expression);
  if (is_new) at->second = std::regex(expression);
  return at->second;
}

Groups groups_of(const std::smatch& match) {
  return {match.begin(), match.end()};
}

}  // namespace

std::vector<Groups> matches_of(const std::string& text, const std::string& expression) {
  std::vector<Groups> found;
  for (std::sregex_iterator at(text.begin(), text.end(), compiled(expression)), end; at != end; ++at)
    found.push_back(groups_of(*at));
  return found;
}

std::optional<Groups> first_match(const std::string& text, const std::string& expression) {
  std::smatch match;
  if (!std::regex_search(text, match, compiled(expression))) return std::nullopt;
  return groups_of(match);
}

std::optional<Groups> whole_match(const std::string& text, const std::string& expression) {
  std::smatch match;
  if (!std::regex_match(text, match, compiled(expression))) return std::nullopt;
  return groups_of(match);
}

std::string replaced(const std::string& text, const std::string& expression, const std::string& with) {
  return std::regex_replace(text, compiled(expression), with);
}

}  // namespace contactspline::testing
