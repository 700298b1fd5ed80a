// SPDX-License-Identifier: MIT
// What HDF5 opens, closed at the end, and its attributes.
#pragma once

#include <hdf5.h>

#include <concepts>
#include <stdexcept>
#include <string>
#include <utility>

namespace contactspline {

/// HDF5 could not do something.
struct Hdf5Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns what a call of HDF5 gives. Throws Hdf5Failure where it is negative.
template <typename Result>
Result checked(Result result, const char* what) {
  if (result < 0) throw Hdf5Failure(what);
  return result;
}

/// A file, group, array, type, space or list of properties.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close closing, const char* what) : id_(checked(id, what)), close_(closing) {}
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
    if (id_ >= 0) checked(close_(std::exchange(id_, -1)), "close");
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

inline Hdf5Handle text_type() {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "text");
  checked(H5Tset_size(type, H5T_VARIABLE), "text");
  checked(H5Tset_cset(type, H5T_CSET_UTF8), "text");
  return type;
}

inline void write_attribute(hid_t object, const char* name, const std::string& text) {
  const Hdf5Handle type = text_type(), space(H5Screate(H5S_SCALAR), H5Sclose, name);
  const Hdf5Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  const char* const characters = text.c_str();
  checked(H5Awrite(attribute, type, &characters), name);
}

template <typename Number>
requires std::floating_point<Number> || std::integral<Number>
void write_attribute(hid_t object, const char* name, Number number) {
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose, name);
  const hid_t type = std::floating_point<Number> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
  const Hdf5Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  const auto value = static_cast<std::conditional_t<std::floating_point<Number>, double, long long>>(number);
  checked(H5Awrite(attribute, type, &value), name);
}

inline std::string text_attribute(hid_t object, const char* name) {
  const Hdf5Handle type = text_type(), attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name);
  char* characters = nullptr;
  checked(H5Aread(attribute, type, &characters), name);
  std::string text = characters == nullptr ? "" : characters;
  H5free_memory(characters);
  return text;
}

inline std::size_t number_attribute(hid_t object, const char* name) {
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name);
  long long number = -1;
  checked(H5Aread(attribute, H5T_NATIVE_INT64, &number), name);
  return static_cast<std::size_t>(number);
}

}  // namespace contactspline
