// SPDX-License-Identifier: MIT
// The file of contact steps and their 113-bit answers that step_reference writes and step_checker reads.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "contactspline/step/contact.hpp"

namespace contactspline::testing {

/// Unit roundoff of T.
template <typename T>
inline constexpr double kRoundoff = static_cast<double>(std::numeric_limits<T>::epsilon()) / 2;

/// One step, its exact answer on the table as stored, and the bounds derived in step_reference.cpp.
template <typename T>
struct StepCase {
  std::uint32_t table;
  T compression;           ///< y0 [m]
  T free_increment;        ///< xf [m]
  T receptance;            ///< xi [m/N]
  double increment;        ///< x [m]
  double increment_error;  ///< allowed, in both directions [m]
  double force;            ///< f [N]
  double min_force;        ///< allowed [N]
  double max_force;        ///< allowed [N]
};

/// A step down to the smallest numbers of T: only to be finite and not negative.
template <typename T>
struct ExtremeStep {
  std::uint32_t table;
  T compression, free_increment, receptance;
};

template <typename T>
struct StepCases {
  std::vector<std::vector<Segment<T>>> tables;
  std::vector<StepCase<T>> cases;
  std::vector<ExtremeStep<T>> extremes;
};

namespace detail {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

inline constexpr std::uint64_t kMagic = 0x3150'4554'532d'5343;  // "CS-STEP1"

inline File open(const std::string& path, const char* mode) {
  File file(std::fopen(path.c_str(), mode), &std::fclose);
  if (!file) throw std::runtime_error(path + ": missing data: cannot be opened");
  return file;
}

template <typename Item>
void write_items(std::FILE* file, const std::vector<Item>& items) {
  const std::array<std::uint64_t, 2> head = {items.size(), sizeof(Item)};
  if (std::fwrite(head.data(), sizeof head, 1, file) != 1 ||
      std::fwrite(items.data(), sizeof(Item), items.size(), file) != items.size())
    throw std::runtime_error("cannot write");
}

template <typename Item>
std::vector<Item> read_items(std::FILE* file) {
  std::array<std::uint64_t, 2> head{};
  if (std::fread(head.data(), sizeof head, 1, file) != 1 || head[1] != sizeof(Item) || head[0] >> 32 != 0)
    throw std::runtime_error("missing data: the file breaks off or is of another kind");
  std::vector<Item> items(static_cast<std::size_t>(head[0]));
  if (std::fread(items.data(), sizeof(Item), items.size(), file) != items.size())
    throw std::runtime_error("missing data: the file breaks off");
  return items;
}

}  // namespace detail

template <typename T>
void write_step_cases(const std::string& path, const StepCases<T>& set) {
  const auto file = detail::open(path, "wb");
  detail::write_items(file.get(), std::vector<std::uint64_t>{detail::kMagic, set.tables.size()});
  for (const auto& table : set.tables) detail::write_items(file.get(), table);
  detail::write_items(file.get(), set.cases);
  detail::write_items(file.get(), set.extremes);
  if (std::fflush(file.get()) != 0) throw std::runtime_error(path + ": cannot write");
}

/// Throws where the file is missing, of another kind, or shorter than it says.
template <typename T>
StepCases<T> read_step_cases(const std::string& path) {
  const auto file = detail::open(path, "rb");
  const auto head = detail::read_items<std::uint64_t>(file.get());
  if (head.size() != 2 || head[0] != detail::kMagic)
    throw std::runtime_error(path + ": missing data: of another kind");
  StepCases<T> set;
  for (std::uint64_t i = 0; i < head[1]; ++i) set.tables.push_back(detail::read_items<Segment<T>>(file.get()));
  set.cases = detail::read_items<StepCase<T>>(file.get());
  set.extremes = detail::read_items<ExtremeStep<T>>(file.get());
  return set;
}

}  // namespace contactspline::testing
