// SPDX-License-Identifier: MIT
// The vectorised bank and linear solver against plain sums, on every instruction set of this machine.
#include <gtest/gtest.h>

#include <limits>

#include "contactspline/modal/form_matrix.hpp"
#include "kernel_targets.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/precisions.hpp"
#include "support/random.hpp"

namespace contactspline::testing {
namespace {

CONTACTSPLINE_EACH_PRECISION(KernelAlgebra);

// One sample of a bank under forces at several places, and what places will move by, as predict(), push(), commit()
// and sums over the modes compute them one after the other.
TYPED_TEST(KernelAlgebra, AdvanceABankUnderForces) {
  using T = TypeParam;
  Random random(1);
  const auto number = [&] { return random.between(-1, 1); };
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    for (const std::size_t size : {1u, 2u, 5u, 8u, 17u, 56u, 120u})
      for (std::size_t places = 0; places < 15; ++places) {
        std::vector<Mode> modes;
        for (std::size_t i = 0; i < size; ++i) modes.push_back({100.0 + 900.0 * static_cast<double>(i), 30, 1e-3});
        ModalBank<T> plain(modes, 44100), tested(modes, 44100);
        std::vector<ModeShapes<T>> shapes(places, ModeShapes<T>(size));
        std::vector<const T*> at;
        for (auto& shape : shapes) {
          for (std::size_t i = 0; i < size; ++i) shape[i] = static_cast<T>(number());
          at.push_back(shape.data());
        }
        std::vector<T> forces(places), increments(places);
        const T damping = T(0.01) * static_cast<T>(places % 2), gain = 1 / (1 + damping);
        T travel = 0;
        for (int n = 0; n < 5; ++n) {
          plain.predict(damping);
          for (std::size_t p = 0; p < places; ++p) {
            forces[p] = static_cast<T>(number());
            plain.push(shapes[p], gain * forces[p]);
          }
          plain.commit();
          travel = tested.advance(damping, at, forces.data(), at, increments.data());
        }
        const double eps = 64 * double(std::numeric_limits<T>::epsilon());
        plain.predict();
        double expected_travel = 0;
        for (std::size_t i = 0; i < size; ++i) {
          const double q = double(plain.arrays().displacement[i]), d = double(plain.arrays().free_increment[i]);
          expected_travel += std::abs(d);
          ASSERT_TRUE(within(double(tested.arrays().displacement[i]), q, eps * 1e-4)) << size << " " << places;
          ASSERT_TRUE(within(double(tested.arrays().free_increment[i]), d, eps * 1e-4)) << size << " " << places;
        }
        const double bound = eps * std::max(expected_travel, 1e-6);
        EXPECT_TRUE(within(double(travel), expected_travel, bound)) << size << " " << places;
        for (std::size_t p = 0; p < places; ++p)
          EXPECT_TRUE(within(double(increments[p]), double(plain.increment(shapes[p])), bound))
              << size << " " << places;
      }
  }
}

// A sample of a body that stretches by one form without products, beside the plain loops.
TYPED_TEST(KernelAlgebra, AdvanceABodyThatStretches) {
  using T = TypeParam;
  Random random(3);
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    for (const std::size_t size : {1u, 2u, 5u, 8u, 17u, 56u, 120u}) {
      std::vector<Mode> modes;
      for (std::size_t i = 0; i < size; ++i) modes.push_back({100.0 + 900.0 * static_cast<double>(i), 30, 1e-3});
      ModalBank<T> plain(modes, 44100), tested(modes, 44100);
      detail::ModalArray<T> squares(size), gradient(size), plain_motion(size), motion(size);
      for (std::size_t i = 0; i < size; ++i) {
        squares[i] = static_cast<T>(random.between(-1, 1));
        plain_motion[i] = motion[i] = static_cast<T>(random.between(-1, 1));
        const auto q = static_cast<T>(random.between(-1, 1)), v = static_cast<T>(random.between(-1, 1));
        plain.set_motion(i, q, v);
        tested.set_motion(i, q, v);
        plain.arrays().change[i] = tested.arrays().change[i] = static_cast<T>(random.between(-1, 1));
      }
      T sums[4], plain_sums[4];
      const auto moved_by = static_cast<T>(random.between(-1, 1));
      detail::portable::advance_stretching<T>(
          plain.arrays(), {squares.data(), gradient.data(), plain_motion.data(), moved_by}, plain_sums);
      detail::kernels<T>.advance_stretching(tested.arrays(),
                                            {squares.data(), gradient.data(), motion.data(), moved_by}, sums);
      // All numbers are below 10. The sums have `size` terms, or the terms of the last one a receptance each.
      const double eps = 64 * double(std::numeric_limits<T>::epsilon());
      const double bounds[] = {eps * double(size), eps * double(size), eps * double(size),
                               eps * double(size) * double(plain.receptance(0))};
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_TRUE(within(double(sums[k]), double(plain_sums[k]), bounds[k])) << size << " " << k;
      for (std::size_t i = 0; i < size; ++i) {
        const auto a = plain.arrays(), b = tested.arrays();
        ASSERT_TRUE(within(double(b.change[i]), double(a.change[i]), eps));
        ASSERT_TRUE(within(double(b.displacement[i]), double(a.displacement[i]), eps));
        ASSERT_TRUE(within(double(b.free_increment[i]), double(a.free_increment[i]), eps));
        ASSERT_TRUE(within(double(motion[i]), double(plain_motion[i]), eps * double(plain.receptance(i))));
      }
    }
  }
}

// The matrix of a form with products of two modes, beside a sum over its terms: blocks of one to eight rows, columns
// with gaps, rows without any.
TYPED_TEST(KernelAlgebra, MultiplyByAForm) {
  using T = TypeParam;
  Random random(4);
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    for (const std::size_t size : {1u, 2u, 7u, 8u, 17u, 56u}) {
      StretchForm form{1, {}};
      detail::ModalArray<T> q(size), product(size);
      std::vector<double> expected(size);
      for (std::size_t i = 0; i < size; ++i) {
        q[i] = static_cast<T>(random.between(-1, 1));
        form.squares_per_m2.push_back(i % 3 == 0 ? 0 : double(static_cast<T>(random.between(-1, 1))));
        expected[i] += form.squares_per_m2[i] * double(q[i]);
      }
      for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          if (i / 10 % 2 == j / 10 % 2 && random.between(0, 1) < 0.9) continue;
          form.products.push_back({j, i, double(static_cast<T>(random.between(-1, 1)))});
          expected[i] += form.products.back().factor_per_m2 * double(q[j]);
          expected[j] += form.products.back().factor_per_m2 * double(q[i]);
        }
      detail::kernels<T>.multiply_form(detail::FormMatrix<T>(form, size).blocks(), q.data(), product.data());
      for (std::size_t i = 0; i < size; ++i)
        EXPECT_TRUE(
            within(double(product[i]), expected[i], double(std::numeric_limits<T>::epsilon()) * double(size * size)))
            << size << ' ' << i;
    }
  }
}

// Modes whose frequencies change, beside a bank that has been made with the new ones and moves as they do: from 0 Hz
// to half the sample rate, more modes than a call has. A decay that changes takes another way. Sines of 3 units in
// the last place, and the quotients behind them; near half the rate the cosine has lost pi/2 over itself.
TYPED_TEST(KernelAlgebra, RetuneModes) {
  using T = TypeParam;
  constexpr double kRate = 44100;
  Random random(6);
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    for (const std::size_t size : {1u, 3u, 64u, 70u})
      for (const bool is_decay_new : {false, true}) {
        std::vector<Mode> before, after;
        for (std::size_t i = 0; i < size; ++i) {
          const auto frequency = [&] { return i == 0 ? 0 : 2 * std::numbers::pi * random.between(20, 21000); };
          before.push_back({frequency(), random.between(0.1, 100), random.between(0.001, 0.01)});
          after.push_back({frequency(), before[i].decay_per_s * (is_decay_new ? 2 : 1), before[i].mass_kg});
        }
        if (size > 2) after[2].angular_frequency_rad_per_s = std::numbers::pi * kRate;
        ModalBank<T> bank(before, kRate), expected(after, kRate);
        std::vector<T> velocities(size);
        ModeShapes<T> one(size);
        for (std::size_t i = 0; i < size; ++i) {
          const T q = static_cast<T>(random.between(-1e-3, 1e-3));
          velocities[i] = static_cast<T>(random.between(-1, 1));
          bank.set_motion(i, q, velocities[i]);
          expected.set_motion(i, q, velocities[i]);
        }
        bank.retune(after);
        for (std::size_t i = 0; i < size; ++i) {
          const bool sounds = i != 2;
          const double cosine = std::cos(after[i].angular_frequency_rad_per_s / kRate / 2),
                       eps = std::max(double(std::numeric_limits<T>::epsilon()), 1e-15 / (sounds ? cosine : 1));
          ASSERT_TRUE(relatively_within(double(bank.receptance(i)), double(expected.receptance(i)), 4 * eps)) << i;
          ASSERT_EQ(bank.displacement(i), sounds ? expected.displacement(i) : 0) << i;
          // A displacement of 1 mm and a speed of 1 m/s both move less than 1 mm a sample.
          const double moved = sounds ? double(expected.free_increments()[i]) : 0;
          ASSERT_TRUE(within(double(bank.free_increments()[i]), moved, 20 * eps * 2e-3)) << size << ' ' << i;
          if (sounds) {
            ASSERT_TRUE(relatively_within(bank.energy(i), expected.energy(i), 100 * eps)) << i;
          }
        }
      }
  }
}

// Positive definite systems of every size up to 40: what was multiplied by the matrix comes back.
TYPED_TEST(KernelAlgebra, SolvePositiveDefiniteSystems) {
  using T = TypeParam;
  Random random(2);
  const auto number = [&] { return random.between(-1, 1); };
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    for (std::size_t size = 1; size <= 40; ++size) {
      constexpr std::size_t kStride = 48;
      detail::ModalArray<T> matrix(kStride * size), right(kStride);
      std::vector<double> rows(size * size), solution(size);
      for (double& value : rows) value = number();
      for (double& value : solution) value = number();
      for (std::size_t j = 0; j < size; ++j) {
        double sum = 0;
        for (std::size_t i = 0; i < size; ++i) {
          double value = i == j ? 1 : 0;
          for (std::size_t k = 0; k < size; ++k) value += rows[i * size + k] * rows[j * size + k];
          matrix[j * kStride + i] = static_cast<T>(value);
          sum += value * solution[i];
        }
        right[j] = static_cast<T>(sum);
      }
      detail::kernels<T>.solve_positive_definite(size, matrix.data(), kStride, right.data());
      // The condition number is at most 1 + |rows|^2 <= 1 + size^2.
      const double bound = 8 * double(std::numeric_limits<T>::epsilon()) * static_cast<double>(1 + size * size);
      for (std::size_t i = 0; i < size; ++i)
        ASSERT_TRUE(within(double(right[i]), solution[i], bound)) << size << ", row " << i;
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
