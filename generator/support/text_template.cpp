// SPDX-License-Identifier: MIT
#include "generator/support/text_template.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "generator/support/embedded_files.hpp"

namespace contactspline {
namespace {

constexpr std::string_view kKeyCharacters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

// Length of the placeholder "@KEY@" at the beginning of the text; 0 if there is none.
std::size_t placeholder_length(std::string_view text) {
  const auto end = text.find_first_not_of(kKeyCharacters, 1);
  return end != std::string_view::npos && end > 1 && text[end] == '@' ? end + 1 : 0;
}

}  // namespace

std::string_view emitted_template(std::string_view kind, std::string_view extension) {
  const std::string file_name = fmt::format("{}.{}.in", kind, extension);
  const EmbeddedFile* found = find_embedded(Shipped::kTemplates, file_name);
  if (found == nullptr) throw std::logic_error(fmt::format("no template {}", file_name));
  return found->content;
}

std::string fill_template(std::string_view text, const TemplateValues& values) {
  std::string filled;
  std::set<std::string_view> used;
  while (!text.empty()) {
    const auto at = text.find('@');
    filled += text.substr(0, at);
    if (at == std::string_view::npos) break;
    text.remove_prefix(at);
    const std::size_t length = placeholder_length(text);
    if (length == 0) {
      filled += '@';
      text.remove_prefix(1);
      continue;
    }
    const std::string_view key = text.substr(1, length - 2);
    const auto value = values.find(key);
    if (value == values.end()) throw std::logic_error(fmt::format("template: no value for @{}@", key));
    filled += value->second;
    used.insert(value->first);
    text.remove_prefix(length);
  }
  for (const auto& [key, value] : values)
    if (!used.contains(key)) throw std::logic_error(fmt::format("template: value {} is not used", key));
  return filled;
}

}  // namespace contactspline
