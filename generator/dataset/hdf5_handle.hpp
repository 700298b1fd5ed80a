// SPDX-License-Identifier: MIT
// What HDF5 opens, closed at the end, and its attributes.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>

namespace contactspline {

/// HDF5 could not do something.
struct Hdf5Failure : std::exception {};

/// Returns what a call of HDF5 gives. Throws Hdf5Failure where it is negative.
template <typename Result>
Result checked(Result result) {
  if (result < 0) throw Hdf5Failure();
  return result;
}

/// A file, group, array, type, space or list of properties.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close closing) : id_(checked(id)), close_(closing) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }

  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor)

  /// Closes it now. Throws Hdf5Failure where that fails: what was written may not be on the disk.
  void close() {
    if (id_ >= 0) checked(close_(std::exchange(id_, -1)));
  }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// While one lives, HDF5 prints nothing of its errors.
class Hdf5IsSilent {
 public:
  Hdf5IsSilent() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Hdf5IsSilent(const Hdf5IsSilent&) = delete;
  Hdf5IsSilent& operator=(const Hdf5IsSilent&) = delete;
  ~Hdf5IsSilent() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// A name with a text or a number.
class Hdf5Attribute {
 public:
  // HDF5 crashes on a damaged text of variable size, which no checksum protects. A fixed size lies under one.
  Hdf5Attribute(const char* name, const std::string& text)
      : name_(name), type_(H5Tcopy(H5T_C_S1), H5Tclose), bytes_(text.c_str(), text.size() + 1) {
    checked(H5Tset_size(type_, bytes_.size()));
    checked(H5Tset_cset(type_, H5T_CSET_UTF8));
  }
  Hdf5Attribute(const char* name, double number) : Hdf5Attribute(name, H5T_NATIVE_DOUBLE, &number, sizeof number) {}
  Hdf5Attribute(const char* name, std::uint64_t number)
      : Hdf5Attribute(name, H5T_NATIVE_UINT64, &number, sizeof number) {}

  void write_to(hid_t object) const {
    const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle made(H5Acreate2(object, name_, type_, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    checked(H5Awrite(made, type_, bytes_.data()));
  }

  /// True if the object has an attribute of this name, type and value.
  [[nodiscard]] bool is_of(hid_t object) const {
    if (checked(H5Aexists(object, name_)) == 0) return false;
    const Hdf5Handle found(H5Aopen(object, name_, H5P_DEFAULT), H5Aclose), type(H5Aget_type(found), H5Tclose);
    if (checked(H5Tequal(type, type_)) == 0 || H5Aget_storage_size(found) != bytes_.size()) return false;
    std::string bytes(bytes_.size(), '\0');
    checked(H5Aread(found, type_, bytes.data()));
    return bytes == bytes_;
  }

 private:
  Hdf5Attribute(const char* name, hid_t type, const void* number, std::size_t size)
      : name_(name), type_(H5Tcopy(type), H5Tclose), bytes_(static_cast<const char*>(number), size) {}

  const char* name_;
  Hdf5Handle type_;
  std::string bytes_;
};

}  // namespace contactspline
