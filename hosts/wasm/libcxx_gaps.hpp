// SPDX-License-Identifier: MIT
// What the project uses of C++20 and libc++ 13, the library of Debian 12's Emscripten, lacks: the algorithms of
// std::ranges and std::from_chars for double. Included before every file of the WebAssembly build and of no other.
// When Debian's Emscripten brings them, the #if lets the file become empty.
#pragma once

#include <version>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 14000

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

namespace std {

// The text up to `last` is a whole number, as from fmt or a field of a CSV file. musl's strtod rounds correctly.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  if (first == last || !((*first >= '0' && *first <= '9') || *first == '-' || *first == '.'))
    return {first, errc::invalid_argument};
  const string text(first, last);
  char* end = nullptr;
  errno = 0;
  const double number = strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  const char* stop = first + (end - text.c_str());
  if (errno == ERANGE) return {stop, errc::result_out_of_range};
  value = number;
  return {stop, errc()};
}

template <typename To, typename From>
[[nodiscard]] constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  return __builtin_bit_cast(To, from);
}

namespace ranges {

template <typename Range, typename Value, typename Projection = identity>
constexpr auto find(Range&& range, const Value& value, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& element) { return std::invoke(projection, element) == value; });
}

template <typename Range, typename Predicate, typename Projection = identity>
constexpr auto find_if(Range&& range, Predicate holds, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& element) { return std::invoke(holds, std::invoke(projection, element)); });
}

template <typename Range, typename Value>
constexpr void replace(Range&& range, const Value& before, const Value& after) {
  std::replace(std::begin(range), std::end(range), before, after);
}

#define CONTACTSPLINE_ALGORITHM(name)                                      \
  template <typename Range, typename Predicate>                            \
  constexpr auto name(Range&& range, Predicate holds) {                    \
    return std::name(std::begin(range), std::end(range), std::ref(holds)); \
  }
CONTACTSPLINE_ALGORITHM(any_of)
CONTACTSPLINE_ALGORITHM(all_of)
CONTACTSPLINE_ALGORITHM(none_of)
CONTACTSPLINE_ALGORITHM(count_if)
#undef CONTACTSPLINE_ALGORITHM

template <typename Range, typename Value, typename Projection = identity>
constexpr auto count(Range&& range, const Value& value, Projection projection = {}) {
  return std::count_if(std::begin(range), std::end(range),
                       [&](const auto& element) { return std::invoke(projection, element) == value; });
}

template <typename Range, typename Value>
constexpr void fill(Range&& range, const Value& value) {
  std::fill(std::begin(range), std::end(range), value);
}

template <typename Range, typename Out>
constexpr auto copy(Range&& range, Out out) {
  return std::copy(std::begin(range), std::end(range), out);
}

template <typename Range, typename Out, typename Predicate>
constexpr auto copy_if(Range&& range, Out out, Predicate holds) {
  return std::copy_if(std::begin(range), std::end(range), out, std::ref(holds));
}

template <typename Range, typename Out, typename Function>
constexpr auto transform(Range&& range, Out out, Function function) {
  return std::transform(std::begin(range), std::end(range), out, std::ref(function));
}

template <typename Range, typename Predicate, typename Value>
constexpr void replace_if(Range&& range, Predicate holds, const Value& value) {
  std::replace_if(std::begin(range), std::end(range), std::ref(holds), value);
}

// The order of two elements by a comparison of their projections.
template <typename Less, typename Projection>
constexpr auto by_projection(Less& less, Projection& projection) {
  return [&](const auto& a, const auto& b) {
    return std::invoke(less, std::invoke(projection, a), std::invoke(projection, b));
  };
}

template <typename Range, typename Less = std::less<>, typename Projection = identity>
constexpr void sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::sort(std::begin(range), std::end(range), by_projection(less, projection));
}

template <typename Range, typename Less = std::less<>, typename Projection = identity>
constexpr void stable_sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::stable_sort(std::begin(range), std::end(range), by_projection(less, projection));
}

template <typename Range, typename Value, typename Less = std::less<>, typename Projection = identity>
constexpr auto upper_bound(Range&& range, const Value& value, Less less = {}, Projection projection = {}) {
  return std::upper_bound(std::begin(range), std::end(range), value, [&](const Value& v, const auto& element) {
    return std::invoke(less, v, std::invoke(projection, element));
  });
}

template <typename Range, typename Value, typename Less = std::less<>, typename Projection = identity>
constexpr auto lower_bound(Range&& range, const Value& value, Less less = {}, Projection projection = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value, [&](const auto& element, const Value& v) {
    return std::invoke(less, std::invoke(projection, element), v);
  });
}

template <typename Range, typename Less = std::less<>, typename Projection = identity>
constexpr auto max(Range&& range, Less less = {}, Projection projection = {}) {
  return *std::max_element(std::begin(range), std::end(range), by_projection(less, projection));
}

template <typename Range, typename Less = std::less<>, typename Projection = identity>
constexpr auto min(Range&& range, Less less = {}, Projection projection = {}) {
  return *std::min_element(std::begin(range), std::end(range), by_projection(less, projection));
}

template <typename Range, typename Less = std::less<>, typename Projection = identity>
constexpr auto max_element(Range&& range, Less less = {}, Projection projection = {}) {
  return std::max_element(std::begin(range), std::end(range), by_projection(less, projection));
}

template <typename Range, typename Less = std::less<>, typename Projection = identity>
constexpr auto min_element(Range&& range, Less less = {}, Projection projection = {}) {
  return std::min_element(std::begin(range), std::end(range), by_projection(less, projection));
}

template <typename Range, typename Among>
constexpr auto find_first_of(Range&& range, Among&& among) {
  return std::find_first_of(std::begin(range), std::end(range), std::begin(among), std::end(among));
}

template <typename Range>
constexpr void reverse(Range&& range) {
  std::reverse(std::begin(range), std::end(range));
}

template <typename Range>
constexpr auto minmax(Range&& range) {
  const auto [min, max] = std::minmax_element(std::begin(range), std::end(range));
  return std::pair(*min, *max);
}

}  // namespace ranges
}  // namespace std

#endif
