// SPDX-License-Identifier: MIT
// The matrix of a form by which a body stretches, in blocks that vectors multiply.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/mode.hpp"
#include "contactspline/simd/kernel_data.hpp"

namespace contactspline::detail {

/// The squares and products of a form with products as a symmetric matrix. Rows that follow each other and have
/// numbers in the same columns share a block, so that the fewest blocks are there where modes that couple alike
/// follow each other.
template <std::floating_point T>
class FormMatrix {
 public:
  FormMatrix() = default;
  FormMatrix(const StretchForm& form, std::size_t modes) {
    std::vector<std::vector<Entry>> rows(modes);
    for (std::size_t i = 0; i < form.squares_per_m2.size(); ++i)
      if (form.squares_per_m2[i] != 0) rows[i].push_back({i, form.squares_per_m2[i]});
    for (const auto& [first, second, factor] : form.products) {
      rows[first].push_back({second, factor});
      rows[second].push_back({first, factor});
    }
    for (std::vector<Entry>& row : rows)
      std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.column < b.column; });
    std::vector<T> factors;
    for (std::size_t first = 0; first < modes;) {
      std::size_t count = 1;
      while (count < kRowsTogether && first + count < modes && have_same_columns(rows[first], rows[first + count]))
        ++count;
      add_rows(std::span(rows).subspan(first, count), first, factors);
      first += count;
    }
    factors_ = ModalArray<T>(factors.size());
    std::copy(factors.begin(), factors.end(), factors_.data());
  }

  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] FormBlocks<T> blocks() const { return {rows_, runs_.data(), factors_.data()}; }

  /// use(row, column, factor) for each number.
  void for_each(auto use) const {
    const FormColumns* run = runs_.data();
    const T* factor = factors_.data();
    for (const auto& [first, count, runs] : rows_)
      for (const FormColumns* const end = run + runs; run != end; ++run)
        for (std::size_t j = run->first; j < run->first + run->count; ++j, factor += kRowsTogether)
          for (std::size_t r = 0; r < count; ++r) use(first + r, j, factor[r]);
  }

 private:
  struct Entry {
    std::size_t column;
    double factor;
  };

  static bool have_same_columns(const std::vector<Entry>& a, const std::vector<Entry>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Entry& x, const Entry& y) { return x.column == y.column; });
  }

  void add_rows(std::span<const std::vector<Entry>> rows, std::size_t first, std::vector<T>& factors) {
    rows_.push_back({first, rows.size(), 0});
    for (std::size_t e = 0; e < rows[0].size(); ++e) {
      const std::size_t column = rows[0][e].column;
      if (e == 0 || column != rows[0][e - 1].column + 1) {
        runs_.push_back({column, 0});
        ++rows_.back().runs;
      }
      ++runs_.back().count;
      for (std::size_t r = 0; r < kRowsTogether; ++r)
        factors.push_back(r < rows.size() ? static_cast<T>(rows[r][e].factor) : T(0));
    }
  }

  std::vector<FormRows> rows_;
  std::vector<FormColumns> runs_;
  ModalArray<T> factors_;
};

}  // namespace contactspline::detail
