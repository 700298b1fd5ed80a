// SPDX-License-Identifier: MIT
// Lists and matrices whose memory is reserved once, and Cholesky factors of I + positive semidefinite matrices.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/simd/kernels.hpp"

namespace contactspline::detail {

/// A list of no more elements than were reserved: to add one is to store it.
template <typename Element>
class ReservedList {
 public:
  void reserve(std::size_t size) { elements_.resize(size); }
  void clear() { size_ = 0; }
  void push_back(const Element& element) { elements_[size_++] = element; }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const Element* begin() const { return elements_.data(); }
  [[nodiscard]] const Element* end() const { return elements_.data() + size_; }
  [[nodiscard]] const Element& operator[](std::size_t i) const { return elements_[i]; }
  [[nodiscard]] const Element* data() const { return begin(); }
  friend bool operator==(const ReservedList& a, const ReservedList& b) {
    if (a.size_ != b.size_) return false;
    for (std::size_t i = 0; i < a.size_; ++i)  // faster than a call where lists are short
      if (a[i] != b[i]) return false;
    return true;
  }

 private:
  std::vector<Element> elements_;
  std::size_t size_ = 0;
};

using IndexList = ReservedList<std::size_t>;

/// A symmetric matrix, or the lower triangle of one. Its columns begin on cache lines.
template <std::floating_point T>
class ColumnMatrix {
 public:
  ColumnMatrix() = default;
  explicit ColumnMatrix(std::size_t size) : stride_(padded(size)), values_(stride_ * size) {}

  /// n rounded up to whole cache lines.
  [[nodiscard]] static std::size_t padded(std::size_t n) { return in_whole_lines<T>(n); }
  /// From the beginning of a column to that of the next one.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] T* column(std::size_t j) { return values_.data() + j * stride_; }
  [[nodiscard]] const T* column(std::size_t j) const { return values_.data() + j * stride_; }
  [[nodiscard]] T operator()(std::size_t i, std::size_t j) const { return column(j)[i]; }
  [[nodiscard]] T& operator()(std::size_t i, std::size_t j) { return column(j)[i]; }

 private:
  std::size_t stride_ = 0;
  ModalArray<T> values_;
};

/// factorise() of a matrix of these rows.
template <std::floating_point T>
void factorise(ColumnMatrix<T>& factor, std::size_t m) {
  factorise(m, factor.column(0), factor.stride());
}

/// right becomes factor^-1 right. From row ends[j] on, column j is 0.
template <std::floating_point T>
void solve_forwards(const ColumnMatrix<T>& factor, const std::vector<std::size_t>& ends, T* right) {
  solve_forwards(
      ends.size(), factor.column(0), factor.stride(), [&](std::size_t j) { return ends[j]; }, right);
}

/// right becomes factor^-T right.
template <std::floating_point T>
void solve_backwards(const ColumnMatrix<T>& factor, const std::vector<std::size_t>& ends, T* right) {
  solve_backwards(
      ends.size(), factor.column(0), factor.stride(), [&](std::size_t j) { return ends[j]; }, right);
}

/// A system of equations whose matrix is I + a positive semidefinite one, of up to a given number of rows.
template <std::floating_point T>
class LinearSystem {
 public:
  explicit LinearSystem(std::size_t max_rows) : matrix_(max_rows), right_(max_rows) {}

  /// For the caller to fill in before solve(): column j and the right side. Rows m to padded(m) of a column are 0.
  [[nodiscard]] T* column(std::size_t j) { return matrix_.column(j); }
  [[nodiscard]] std::size_t padded(std::size_t m) const { return matrix_.padded(m); }
  [[nodiscard]] T& right(std::size_t i) { return right_[i]; }

  /// Solves m rows. The right side becomes the solution, the matrix scratch.
  void solve(std::size_t m) {
    if (m == 1) return solve_few<1>();
    if (m == 2) return solve_few<2>();
    if (m == 3) return solve_few<3>();
    if (m == 4) return solve_few<4>();
    std::fill(right_.data() + m, right_.data() + matrix_.padded(m), T(0));
    kernels<T>.solve_positive_definite(m, matrix_.column(0), matrix_.stride(), right_.data());
  }

 private:
  // The same for so few rows that they fit into registers.
  template <std::size_t kRows>
  void solve_few() {
    T l[kRows][kRows], x[kRows];
    for (std::size_t j = 0; j < kRows; ++j) {
      T diagonal = matrix_(j, j);
      x[j] = right_[j];
      for (std::size_t k = 0; k < j; ++k) {
        l[j][k] = matrix_(j, k);
        for (std::size_t q = 0; q < k; ++q) l[j][k] -= l[j][q] * l[k][q];
        l[j][k] *= l[k][k];
        diagonal -= l[j][k] * l[j][k];
        x[j] -= l[j][k] * x[k];
      }
      l[j][j] = 1 / std::sqrt((std::max)(diagonal, T(1)));
      x[j] *= l[j][j];
    }
    for (std::size_t j = kRows; j-- > 0;) {
      for (std::size_t k = j + 1; k < kRows; ++k) x[j] -= l[k][j] * x[k];
      right_[j] = x[j] *= l[j][j];
    }
  }

  ColumnMatrix<T> matrix_;
  ModalArray<T> right_;
};

}  // namespace contactspline::detail
