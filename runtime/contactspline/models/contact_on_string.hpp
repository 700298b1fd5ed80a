// SPDX-License-Identifier: MIT
// A string with one contact at a place that moves: what the slide-string and the fret-string share.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>

#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/string_place.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline::detail {

/// The parts of a plucked string under a contact. Modes: their number, if it is known at compile time: then a model
/// needs no heap (docs/how-to/microcontrollers.md).
template <std::floating_point T, std::size_t Extent, std::size_t Modes>
class ContactOnString {
 public:
  /// pluck_place_m: where the control of the pluck pushes [m], 0 to the length of the string, clamped; 0 if it is not
  /// a number. memories: of the material that touches the string, as memories_of tells them.
  constexpr ContactOnString(SegmentTable<T, Extent> table, std::type_identity_t<std::span<const Mode, Modes>> modes,
                            const StringShapes<T, Modes>& shapes, T pluck_place_m, double sample_rate_hz,
                            std::span<const Memory> memories = {})
      : table_(table),
        string_(modes, sample_rate_hz),
        place_(shapes, pluck_place_m, shapes.longest_step(modes, sample_rate_hz)),
        pluck_(shapes.size()),
        time_step_(T(1 / sample_rate_hz)),
        memory_(memories, sample_rate_hz) {
    pluck_ = place_.after();
  }

  [[nodiscard]] T force() const { return force_; }              ///< contact force over the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }  ///< of the contact, negative while apart [m]
  [[nodiscard]] T place() const { return place_.place(); }      ///< of the contact along the string [m]
  /// What the contact remembers.
  [[nodiscard]] const ContactMemory<T>& memory() const { return memory_; }
  [[nodiscard]] const ModalBank<T, Modes>& string() const { return string_; }

 protected:
  // Energy of string and contact [J].
  [[nodiscard]] double energy_with(const ContactControls<T>& contact) const {
    return string_.energy() + double(contact.stiffness_ratio) * double(memory_.energy(table_, compression_));
  }

  SegmentTable<T, Extent> table_;
  ModalBank<T, Modes> string_;
  MovingPlace<T, Modes> place_;
  ModeShapes<T, Modes> pluck_;
  T time_step_;
  ContactMemory<T> memory_;
  bool is_placed_ = true;  // since the last sample: the next one takes stiffnesses as they are
  T compression_ = 0, force_ = 0;
};

}  // namespace contactspline::detail
