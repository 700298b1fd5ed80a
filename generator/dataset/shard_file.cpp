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
constexpr std::size_t kRoomForHeading = 1 << 16, kBytesInIndex = 32;
constexpr hsize_t kMaxBlockRow = 1 << 20;  // values; a block is smaller than 4 GiB

/// A name in a group, with its unit and the type and length of the row of each sample.
struct ArrayPlan {
  std::string path, unit;
  hid_t type;
  std::size_t length;  ///< 0: one number of each sample
  hsize_t block_rows;
};

std::vector<ArrayPlan> arrays_of(const Plan& plan) {
  std::vector<ArrayPlan> arrays;
  for (const PlanColumn& column : plan.columns)
    arrays.push_back({"parameters/" + column.name, column.unit, H5T_NATIVE_DOUBLE, 0, kBlockBytes / sizeof(double)});
  for (const Recorded& one : plan.recorded) {
    const bool is_energy = one.kind == Recorded::kEnergy;
    const std::size_t length = plan.length_of(one), bytes = length * (is_energy ? sizeof(double) : sizeof(float));
    arrays.push_back({"outputs/" + one.name, one.unit, is_energy ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT, length,
                      std::max<hsize_t>(1, kBlockBytes / std::max<std::size_t>(bytes, 1))});
  }
  return arrays;
}

Hdf5Handle space_of(const ArrayPlan& array, std::size_t rows) {
  const hsize_t sizes[] = {rows, array.length};
  return {H5Screate_simple(array.length == 0 ? 1 : 2, sizes, nullptr), H5Sclose, "space"};
}

void select_rows(hid_t space, const ArrayPlan& array, std::size_t first, std::size_t count) {
  const hsize_t begin[] = {first, 0}, sizes[] = {count, array.length};
  checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, begin, nullptr, sizes, nullptr), "selection");
}

// Without times, so that the same samples make the same file; with sums of all that describes the arrays.
Hdf5Handle create_file(const fs::path& path) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file"),
      creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "file");
  checked(H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110), "file");
  checked(H5Pset_file_locking(access, 0, 1), "file");  // the writer has locked it
  checked(H5Pset_obj_track_times(creation, 0), "file");
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, "file"};
}

Hdf5Handle open_file(const fs::path& path) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file");
  checked(H5Pset_file_locking(access, 0, 1), "file");
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose, "file"};
}

std::string inputs_text(const Plan& plan) {
  std::string text;
  for (const auto& [path, content] : plan.inputs)
    text += fmt::format("{}{}: {}", text.empty() ? "{" : ", ", json_string(path), json_string(content));
  return text.empty() ? "{}" : text + "}";
}

void write_heading(hid_t file, const Plan& plan, const std::string& program, const SampleRange& range) {
  write_attribute(file, "program", program);
  write_attribute(file, "plan", plan.text);
  write_attribute(file, "inputs", inputs_text(plan));
  write_attribute(file, "instrument", plan.instrument);
  write_attribute(file, "license", plan.license);
  write_attribute(file, "sample_rate_hz", plan.sample_rate_hz);
  write_attribute(file, "first_sample", range.first);
  write_attribute(file, "samples", range.count);
  write_attribute(file, "samples_of_plan", plan.count);
  const Hdf5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "group");
  checked(H5Pset_obj_track_times(creation, 0), "group");
  for (const char* group : {"parameters", "outputs"})
    Hdf5Handle(H5Gcreate2(file, group, H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, group).close();
}

Hdf5Handle properties_of_array() {
  Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "array");
  checked(H5Pset_obj_track_times(properties, 0), "array");
  return properties;
}

Hdf5Handle create_array(hid_t file, const ArrayPlan& array, hid_t space, hid_t properties) {
  Hdf5Handle made(H5Dcreate2(file, array.path.c_str(), array.type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                  H5Dclose, array.path.c_str());
  write_attribute(made, "unit", array.unit);
  return made;
}

Hdf5Handle create_summed_array(hid_t file, const ArrayPlan& array, std::size_t rows) {
  const Hdf5Handle properties = properties_of_array();
  const hsize_t block[] = {std::min<hsize_t>(array.block_rows, rows), std::min<hsize_t>(array.length, kMaxBlockRow)};
  checked(H5Pset_chunk(properties, array.length == 0 ? 1 : 2, block), "block");
  checked(H5Pset_fletcher32(properties), "sums");
  return create_array(file, array, space_of(array, rows), properties);
}

// Reads all rows: HDF5 checks the sums.
void read_through(hid_t file, const ArrayPlan& array, std::size_t rows) {
  const Hdf5Handle data(H5Dopen2(file, array.path.c_str(), H5P_DEFAULT), H5Dclose, array.path.c_str());
  const Hdf5Handle space(H5Dget_space(data), H5Sclose, "space");
  const auto values_of_a_row = static_cast<hssize_t>(std::max<std::size_t>(array.length, 1));
  if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(rows) * values_of_a_row)
    throw Hdf5Failure(array.path);
  std::vector<char> values;
  for (std::size_t row = 0; row < rows; row += array.block_rows) {
    const std::size_t count = std::min<std::size_t>(array.block_rows, rows - row);
    values.resize(count * std::max<std::size_t>(array.length, 1) * H5Tget_size(array.type));
    select_rows(space, array, row, count);
    checked(H5Dread(data, array.type, space_of(array, count), space, H5P_DEFAULT, values.data()), "sum");
  }
}

// Ends a file. Returns its size.
std::size_t close_file(Hdf5Handle& file) {
  checked(H5Fflush(file, H5F_SCOPE_LOCAL), "flush");
  hsize_t bytes = 0;
  checked(H5Fget_filesize(file, &bytes), "size");
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

ShardState state_of_shard(const fs::path& path, const Plan& plan, const ShardHeading& heading, bool check_sums) {
  std::error_code error;
  if (!fs::exists(path, error)) return ShardState::kAbsent;
  const Hdf5IsSilent silent;
  try {
    const Hdf5Handle file = open_file(path);
    const bool is_same = text_attribute(file, "program") == heading.program &&
                         text_attribute(file, "plan") == plan.text &&
                         text_attribute(file, "inputs") == inputs_text(plan) &&
                         number_attribute(file, "first_sample") == heading.range.first &&
                         number_attribute(file, "samples") == heading.range.count;
    if (!is_same) return ShardState::kOfOthers;
    for (const ArrayPlan& array : arrays_of(plan))
      if (check_sums) read_through(file, array, heading.range.count);
    return ShardState::kComplete;
  } catch (const Hdf5Failure&) {
    return ShardState::kDamaged;
  }
}

struct ShardWriter::File {
  explicit File(const fs::path& path) : pending(path) {}

  PendingShard pending;
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
  file_->plans = arrays_of(plan);
  file_->bytes_per_sample = plan.bytes_per_sample();
  for (const Recorded& one : plan.recorded) file_->kinds.push_back(one.kind);
  // Blocks at the end of arrays are whole, and blocks have an index.
  std::size_t bytes =
      kRoomForHeading + plan.text.size() + inputs_text(plan).size() + heading.range.count * plan.bytes_per_sample();
  for (const ArrayPlan& array : file_->plans)
    bytes += 2 * kBlockBytes + kBytesInIndex * (heading.range.count / array.block_rows + array.length / kMaxBlockRow);
  file_->pending.reserve(kRoomForHeading);
  guarded(path, [&] {
    file_->file = create_file(file_->pending.pending());
    file_->pending.reserve(bytes);
    write_heading(file_->file, plan, heading.program, heading.range);
    for (const ArrayPlan& array : file_->plans)
      file_->arrays.push_back(create_summed_array(file_->file, array, heading.range.count));
  });
}

ShardWriter::~ShardWriter() {
  const Hdf5IsSilent silent;
  file_.reset();
}

void ShardWriter::write(const SampleRows& rows) {
  const auto write_rows = [&](std::size_t a, const void* values) {
    const ArrayPlan& array = file_->plans[a];
    const Hdf5Handle space(H5Dget_space(file_->arrays[a]), H5Sclose, "space");
    select_rows(space, array, file_->written, rows.count);
    checked(H5Dwrite(file_->arrays[a], array.type, space_of(array, rows.count), space, H5P_DEFAULT, values), "write");
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
  pending.reserve(kRoomForHeading + plan.text.size() + inputs_text(plan).size());
  std::size_t bytes = 0;
  guarded(path, [&] {
    Hdf5Handle file = create_file(pending.pending());
    write_heading(file, plan, program, {0, plan.count});
    for (const ArrayPlan& array : arrays_of(plan)) {
      const Hdf5Handle properties = properties_of_array(), all = space_of(array, plan.count);
      const double missing = std::numeric_limits<double>::quiet_NaN();
      checked(H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &missing), "fill");
      for (std::size_t s = 0; s < shards.size(); ++s) {
        select_rows(all, array, ranges[s].first, ranges[s].count);
        checked(H5Pset_virtual(properties, all, shards[s].filename().c_str(), array.path.c_str(),
                               space_of(array, ranges[s].count)),
                "join");
      }
      checked(H5Sselect_all(all), "join");
      create_array(file, array, all, properties);
    }
    bytes = close_file(file);
  });
  pending.rename_into_place(bytes);
}

}  // namespace contactspline
