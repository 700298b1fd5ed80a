// SPDX-License-Identifier: MIT
#include "generator/dataset/shard_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <limits>

#include "generator/dataset/hdf5_handle.hpp"
#include "generator/dataset/pending_shard.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlockBytes = 1 << 18;    // of an array, which is read as a whole
constexpr std::size_t kStoredAtOnce = 1 << 24;  // bytes that go to the disk while others are written
// Sizes at most. In the heading and the array, without texts and samples; beside a block, its checksum and its place
// in the index; of each shard in an array that is joined. HDF5 takes the spare ones while it writes.
constexpr std::size_t kHeadingBytes = 3072, kArrayBytes = 512, kBytesBesideBlock = 32, kJoinedShardBytes = 512,
                      kSpareBytes = 1 << 16;
constexpr unsigned kMaxAttributes = 64;        // more would lie outside of the object's header
constexpr std::size_t kMaxBlockRow = 1 << 20;  // values; a block is smaller than 4 GiB

/// A name in a group, with its unit and the type and length of the row of each sample.
struct ArrayPlan {
  std::string path, unit;
  hid_t type;
  std::size_t length;  ///< 0: one number of each sample
  std::size_t block_rows, block_length;

  [[nodiscard]] std::size_t values_of_a_row() const { return std::max<std::size_t>(length, 1); }
};

std::size_t parts_of(std::size_t whole, std::size_t largest_part) {
  return (whole + largest_part - 1) / largest_part;
}

// The size of equal parts, no larger than necessary: a block at the end of an array is stored as a whole.
std::size_t equal_part(std::size_t whole, std::size_t largest_part) {
  return parts_of(whole, parts_of(whole, largest_part));
}

// rows: of the samples in a file.
std::vector<ArrayPlan> arrays_of(const Plan& plan, std::size_t rows) {
  std::vector<ArrayPlan> arrays;
  const auto add = [&](std::string path, const std::string& unit, hid_t type, std::size_t length) {
    ArrayPlan array{std::move(path), unit, type, length, 0, 0};
    const std::size_t row_bytes = array.values_of_a_row() * H5Tget_size(type);
    array.block_rows = equal_part(rows, std::max<std::size_t>(1, kBlockBytes / row_bytes));
    array.block_length = equal_part(array.values_of_a_row(), kMaxBlockRow);
    arrays.push_back(std::move(array));
  };
  for (const PlanColumn& column : plan.columns) add("parameters/" + column.name, column.unit, H5T_NATIVE_DOUBLE, 0);
  for (const Recorded& one : plan.recorded)
    add("outputs/" + one.name, one.unit, one.kind == Recorded::kEnergy ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT,
        plan.length_of(one));
  return arrays;
}

Hdf5Handle space_of(const ArrayPlan& array, std::size_t rows) {
  const hsize_t sizes[] = {rows, array.length};
  return {H5Screate_simple(array.length == 0 ? 1 : 2, sizes, nullptr), H5Sclose};
}

void select_rows(hid_t space, const ArrayPlan& array, std::size_t first, std::size_t count) {
  const hsize_t begin[] = {first, 0}, sizes[] = {count, array.length};
  checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, begin, nullptr, sizes, nullptr));
}

// Without times, so that the same samples make the same file; with checksums of all that describes the arrays.
Hdf5Handle create_file(const fs::path& path) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  checked(H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110));
  checked(H5Pset_file_locking(access, 0, 1));  // the writer has locked it
  checked(H5Pset_obj_track_times(creation, 0));
  checked(H5Pset_attr_phase_change(creation, kMaxAttributes, 0));
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose};
}

Hdf5Handle open_file(const fs::path& path) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  checked(H5Pset_file_locking(access, 0, 1));
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose};
}

std::string inputs_text(const Plan& plan) {
  std::string text;
  for (const auto& [path, content] : plan.inputs)
    text += fmt::format("{}{}: {}", text.empty() ? "{" : ", ", json_string(path), json_string(content));
  return text.empty() ? "{}" : text + "}";
}

std::vector<Hdf5Attribute> attributes_of(const Plan& plan, const ShardHeading& heading) {
  std::vector<Hdf5Attribute> attributes;
  attributes.emplace_back("program", heading.program);
  attributes.emplace_back("plan", plan.text);
  attributes.emplace_back("inputs", inputs_text(plan));
  attributes.emplace_back("description", plan.description);
  attributes.emplace_back("instrument", plan.instrument);
  attributes.emplace_back("license", plan.license);
  attributes.emplace_back("sample_rate_hz", plan.sample_rate_hz);
  attributes.emplace_back("first_sample", heading.range.first);
  attributes.emplace_back("samples", heading.range.count);
  attributes.emplace_back("samples_of_plan", plan.count);
  return attributes;
}

void write_heading(hid_t file, const Plan& plan, const ShardHeading& heading) {
  for (const Hdf5Attribute& attribute : attributes_of(plan, heading)) attribute.write_to(file);
  const Hdf5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  checked(H5Pset_obj_track_times(creation, 0));
  for (const char* group : {"parameters", "outputs"})
    Hdf5Handle(H5Gcreate2(file, group, H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose).close();
}

// At most.
std::size_t heading_bytes(const Plan& plan) {
  return kHeadingBytes + plan.text.size() + inputs_text(plan).size() + plan.description.size() + plan.license.size();
}

Hdf5Handle properties_of_array() {
  Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  checked(H5Pset_obj_track_times(properties, 0));
  return properties;
}

Hdf5Handle create_array(hid_t file, const ArrayPlan& array, hid_t space, hid_t properties) {
  Hdf5Handle made(H5Dcreate2(file, array.path.c_str(), array.type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                  H5Dclose);
  Hdf5Attribute("unit", array.unit).write_to(made);
  return made;
}

Hdf5Handle create_array_with_checksums(hid_t file, const ArrayPlan& array, std::size_t rows) {
  const Hdf5Handle properties = properties_of_array();
  const hsize_t block[] = {array.block_rows, array.block_length};
  checked(H5Pset_chunk(properties, array.length == 0 ? 1 : 2, block));
  checked(H5Pset_fletcher32(properties));
  return create_array(file, array, space_of(array, rows), properties);
}

// True if the array is in the file, and has its unit. reads_all: reads it, so that HDF5 checks the checksums.
bool is_array_of(hid_t file, const ArrayPlan& array, std::size_t rows, bool reads_all) {
  const Hdf5Handle data(H5Dopen2(file, array.path.c_str(), H5P_DEFAULT), H5Dclose);
  const Hdf5Handle space(H5Dget_space(data), H5Sclose);
  const hssize_t values_in_file = checked(H5Sget_simple_extent_npoints(space));
  if (static_cast<std::size_t>(values_in_file) != rows * array.values_of_a_row()) return false;
  if (!Hdf5Attribute("unit", array.unit).is_of(data)) return false;
  std::vector<char> values;
  for (std::size_t row = 0; reads_all && row < rows; row += array.block_rows) {
    const std::size_t count = std::min(array.block_rows, rows - row);
    values.resize(count * array.values_of_a_row() * H5Tget_size(array.type));
    select_rows(space, array, row, count);
    checked(H5Dread(data, array.type, space_of(array, count), space, H5P_DEFAULT, values.data()));
  }
  return true;
}

// Ends a file. Returns its size.
std::size_t close_file(Hdf5Handle& file) {
  checked(H5Fflush(file, H5F_SCOPE_LOCAL));
  hsize_t bytes = 0;
  checked(H5Fget_filesize(file, &bytes));
  file.close();
  return bytes;
}

// Calls write(); a failure of HDF5 becomes a message of the file.
template <typename Write>
void guarded(const fs::path& path, const Write& write) {
  const Hdf5IsSilent silent;
  errno = 0;
  try {
    write();
  } catch (const Hdf5Failure&) {
    fail_to_write(path);
  }
}

}  // namespace

void let_hdf5_end_in_silence() {
  H5dont_atexit();
}

std::size_t largest_shard_bytes(const Plan& plan, const ShardHeading& heading) {
  const std::size_t rows = heading.range.count;
  std::size_t bytes = heading_bytes(plan);
  for (const ArrayPlan& array : arrays_of(plan, rows)) {
    const std::size_t block_bytes = array.block_rows * array.block_length * H5Tget_size(array.type);
    const std::size_t blocks =
        parts_of(rows, array.block_rows) * parts_of(array.values_of_a_row(), array.block_length);
    bytes += kArrayBytes + blocks * (block_bytes + kBytesBesideBlock);
  }
  return bytes;
}

ShardState state_of_shard(const fs::path& path, const Plan& plan, const ShardHeading& heading, bool reads_all) {
  std::error_code error;
  if (!fs::exists(path, error)) return ShardState::kAbsent;
  if (!fs::is_regular_file(path, error)) return ShardState::kDamaged;  // opening a pipe would wait for its writer
  const Hdf5IsSilent silent;
  try {
    const Hdf5Handle file = open_file(path);
    const std::vector<Hdf5Attribute> attributes = attributes_of(plan, heading);
    const std::vector<ArrayPlan> arrays = arrays_of(plan, heading.range.count);
    const bool is_same = std::ranges::all_of(attributes, [&](const Hdf5Attribute& one) { return one.is_of(file); }) &&
                         std::ranges::all_of(arrays, [&](const ArrayPlan& one) {
                           return is_array_of(file, one, heading.range.count, reads_all);
                         });
    return is_same ? ShardState::kComplete : ShardState::kOfOthers;
  } catch (const Hdf5Failure&) {
    return ShardState::kDamaged;
  }
}

struct ShardWriter::File {
  explicit File(const fs::path& path) : pending(path) {}

  PendingShard pending;
  Hdf5IsSilent silent;
  std::size_t bytes_per_sample = 0, written = 0, unstored = 0;  // samples, bytes
  std::vector<ArrayPlan> plans;
  std::vector<Recorded::Kind> kinds;
  Hdf5Handle file;
  std::vector<Hdf5Handle> arrays;
};

ShardWriter::ShardWriter(const fs::path& path, const Plan& plan, const ShardHeading& heading) {
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (error) fail_to_write(path, fmt::format("its folder cannot be created: {}", error.message()));
  file_ = std::make_unique<File>(path);
  file_->plans = arrays_of(plan, heading.range.count);
  file_->bytes_per_sample = plan.bytes_per_sample();
  for (const Recorded& one : plan.recorded) file_->kinds.push_back(one.kind);
  guarded(path, [&] {
    file_->file = create_file(file_->pending.pending());
    file_->pending.reserve(largest_shard_bytes(plan, heading) + kSpareBytes);
    write_heading(file_->file, plan, heading);
    for (const ArrayPlan& array : file_->plans)
      file_->arrays.push_back(create_array_with_checksums(file_->file, array, heading.range.count));
  });
}

ShardWriter::~ShardWriter() = default;

void ShardWriter::write(const SampleRows& rows) {
  const auto write_rows = [&](std::size_t a, const void* values) {
    const ArrayPlan& array = file_->plans[a];
    const Hdf5Handle space(H5Dget_space(file_->arrays[a]), H5Sclose);
    select_rows(space, array, file_->written, rows.count);
    checked(H5Dwrite(file_->arrays[a], array.type, space_of(array, rows.count), space, H5P_DEFAULT, values));
  };
  guarded(file_->pending.path(), [&] {
    const std::size_t columns = rows.columns.size();
    for (std::size_t c = 0; c < columns; ++c) write_rows(c, rows.columns[c].data());
    for (std::size_t r = 0; r < file_->kinds.size(); ++r) {
      if (file_->kinds[r] == Recorded::kEnergy)
        write_rows(columns + r, rows.energy.data());
      else
        write_rows(columns + r, rows.sounds[r].data());
    }
  });
  file_->written += rows.count;
  file_->unstored += rows.count * file_->bytes_per_sample;
  if (file_->unstored < kStoredAtOnce) return;
  file_->pending.begin_to_store();
  file_->unstored = 0;
}

void ShardWriter::finish() {
  std::size_t bytes = 0;
  guarded(file_->pending.path(), [&] {
    for (Hdf5Handle& array : file_->arrays) array.close();
    bytes = close_file(file_->file);
  });
  file_->pending.rename_into_place(bytes);
}

void join_shards(const fs::path& path, const Plan& plan, const std::string& program, std::span<const fs::path> shards,
                 std::span<const SampleRange> ranges) {
  PendingShard pending(path);
  const std::vector<ArrayPlan> arrays = arrays_of(plan, plan.count);
  std::size_t bytes = heading_bytes(plan);
  for (const ArrayPlan& array : arrays)
    bytes += kArrayBytes + shards.size() * (kJoinedShardBytes + path.filename().string().size() + array.path.size());
  guarded(path, [&] {
    Hdf5Handle file = create_file(pending.pending());
    pending.reserve(bytes + kSpareBytes);
    write_heading(file, plan, {program, {0, plan.count}});
    for (const ArrayPlan& array : arrays) {
      const Hdf5Handle properties = properties_of_array(), all = space_of(array, plan.count);
      const double missing = std::numeric_limits<double>::quiet_NaN();
      checked(H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &missing));
      for (std::size_t s = 0; s < shards.size(); ++s) {
        select_rows(all, array, ranges[s].first, ranges[s].count);
        checked(H5Pset_virtual(properties, all, shards[s].filename().c_str(), array.path.c_str(),
                               space_of(array, ranges[s].count)));
      }
      checked(H5Sselect_all(all));
      create_array(file, array, all, properties);
    }
    bytes = close_file(file);
  });
  pending.rename_into_place(bytes);
}

}  // namespace contactspline
