// SPDX-License-Identifier: MIT
// The arrays of an instrument as bytes, on their way from the generator's module to those that play and draw. All
// modules are built by one compiler, so that their structs are alike.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "contactspline/data/instrument_data.hpp"

namespace contactspline::web {

using Bytes = std::vector<std::byte>;

namespace packing {

// A part begins at a multiple of this.
inline constexpr std::size_t kAlignment = alignof(std::max_align_t);

class Packer {
 public:
  template <typename T>
  void take(std::span<const T>& array) {
    add(array.size());
    add_bytes(std::as_bytes(array));
  }
  void take(const char*& text) {
    std::span<const char> letters(text, std::strlen(text) + 1);
    take(letters);
  }
  template <typename T>
  requires std::is_arithmetic_v<T>
  void take(T& number) { add(number); }

  [[nodiscard]] Bytes bytes() && { return std::move(bytes_); }

 private:
  template <typename T>
  void add(const T& value) {
    add_bytes(std::as_bytes(std::span(&value, 1)));
  }
  void add_bytes(std::span<const std::byte> part) {
    bytes_.insert(bytes_.end(), part.begin(), part.end());
    bytes_.resize((bytes_.size() + kAlignment - 1) / kAlignment * kAlignment);
  }

  Bytes bytes_;
};

// Its arrays and texts lie in the bytes that it is given.
class Unpacker {
 public:
  explicit Unpacker(std::byte* next) : next_(next) {}
  [[nodiscard]] std::byte* next() const { return next_; }

  template <typename T>
  void take(std::span<const T>& array) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::size_t size = 0;
    take(size);
    array = {reinterpret_cast<const T*>(next_), size};
    skip(array.size_bytes());
  }
  void take(const char*& text) {
    std::span<const char> letters;
    take(letters);
    text = letters.data();
  }
  template <typename T>
  requires std::is_arithmetic_v<T>
  void take(T& number) {
    std::memcpy(&number, next_, sizeof number);
    skip(sizeof number);
  }

 private:
  void skip(std::size_t bytes) { next_ += (bytes + kAlignment - 1) / kAlignment * kAlignment; }

  std::byte* next_;
};

template <typename Archive, typename... Parts>
void take_all(Archive& archive, Parts&... parts) {
  (archive.take(parts), ...);
}

// Texts of the rows of an array. A Packer only reads them; those of an Unpacker lie in bytes that it may change.
template <typename Archive, typename Row, typename... Texts>
void take_texts(Archive& archive, std::span<const Row> rows, Texts Row::*... texts) {
  for (const Row& row : rows) take_all(archive, const_cast<Row&>(row).*texts...);
}

/// Takes every member of the arrays once, in either direction.
template <typename Archive>
void take_instrument(Archive& archive, InstrumentData& data) {
  auto& keyed = data.keyed;
  take_all(archive, data.name, data.description, data.license, data.angular_frequencies, data.decays, data.masses,
           data.body_ends, data.place_bodies, data.shapes, data.knots, data.energies, data.forces,
           data.half_curvatures, data.table_ends, data.connections, data.controls, data.targets, data.strikes,
           data.plucks, data.sources, data.parameters, data.events, data.outputs, keyed.ranges, keyed.voices,
           keyed.tension_squares, keyed.far_ends, keyed.damped, keyed.damper_per_s, keyed.sustain, keyed.bend,
           keyed.tuned_with, data.preset_names, data.preset_values, data.wavenumbers, data.memories, data.memory_ends,
           data.pressure_rate_hz, data.pressure_paths, data.pressure_taps, data.holds, data.stretch_forms,
           data.stretch_squares, data.stretch_products, data.bows, data.assistance, data.input_places,
           data.input_scale_n, data.offsets_m);
  take_texts(archive, data.parameters, &Parameter::name, &Parameter::unit);
  take_texts(archive, data.events, &Event::name);
  take_texts(archive, data.outputs, &Output::name, &Output::unit);
  for (const char* const& name : data.preset_names) archive.take(const_cast<const char*&>(name));
}

}  // namespace packing

[[nodiscard]] inline Bytes packed(InstrumentData data) {
  packing::Packer packer;
  packing::take_instrument(packer, data);
  return std::move(packer).bytes();
}

/// An instrument that packed() has written, with the bytes that its views are of.
class UnpackedInstrument {
 public:
  explicit UnpackedInstrument(Bytes bytes) : bytes_(std::make_unique<Bytes>(std::move(bytes))) {
    packing::Unpacker unpacker(bytes_->data());
    packing::take_instrument(unpacker, data_);
    rest_ = std::span(*bytes_).subspan(static_cast<std::size_t>(unpacker.next() - bytes_->data()));
  }
  [[nodiscard]] const InstrumentData& data() const { return data_; }
  /// What follows the instrument.
  [[nodiscard]] std::span<std::byte> rest() const { return rest_; }

 private:
  std::unique_ptr<Bytes> bytes_;
  InstrumentData data_{};
  std::span<std::byte> rest_;
};

}  // namespace contactspline::web
