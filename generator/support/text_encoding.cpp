// SPDX-License-Identifier: MIT
#include "generator/support/text_encoding.hpp"

#include <cstddef>

namespace contactspline {
namespace {

unsigned byte_at(std::string_view text, std::size_t i) {
  return static_cast<unsigned char>(text[i]);
}

void append(std::string& text, unsigned code) {
  const auto add = [&](unsigned byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return add(code);
  if (code < 0x800) {
    add(0xc0 | (code >> 6));
  } else {
    add(0xe0 | (code >> 12));
    add(0x80 | ((code >> 6) & 0x3f));
  }
  add(0x80 | (code & 0x3f));
}

// How many bytes follow the first one of a character; 4 of none.
std::size_t bytes_after(unsigned first) {
  return first < 0x80 ? 0 : first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc2 ? 1 : 4;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t after = bytes_after(byte_at(text, i));
    if (after == 4 || i + after >= text.size()) return false;
    for (std::size_t k = 1; k <= after; ++k)
      if ((byte_at(text, i + k) & 0xc0) != 0x80) return false;
    i += after + 1;
  }
  return true;
}

// low: the place of the lower byte in each pair.
std::string from_utf_16(std::string_view pairs, std::size_t low) {
  std::string text;
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
    const unsigned code = byte_at(pairs, i + low) | (byte_at(pairs, i + 1 - low) << 8);
    const bool is_half = code >= 0xd800 && code < 0xe000;
    if (!is_half || code < 0xdc00) append(text, is_half ? '?' : code);
  }
  return text;
}

std::string from_latin_1(std::string_view bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) append(text, byte_at(bytes, i));
  return text;
}

}  // namespace

bool is_marked_utf_16(std::string_view text) {
  return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
}

std::string in_utf8(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) return std::string(text.substr(3));
  if (text.starts_with("\xff\xfe")) return from_utf_16(text.substr(2), 0);
  if (text.starts_with("\xfe\xff")) return from_utf_16(text.substr(2), 1);
  if (text.size() >= 2 && (text[0] == 0) != (text[1] == 0)) return from_utf_16(text, text[1] == 0 ? 0 : 1);
  return is_utf8(text) ? std::string(text) : from_latin_1(text);
}

}  // namespace contactspline
