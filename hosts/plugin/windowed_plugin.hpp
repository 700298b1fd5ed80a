// SPDX-License-Identifier: MIT
// What the framework hands to a window, and to the sides of CLAP and VST3, is a pointer to its own class: they are
// built for this one, which is both. An LV2 window is a library of its own, which has nothing of the plug-in's but
// this.
#pragma once

#include <DistrhoPlugin.hpp>

#include "host_notes.hpp"
#include "window/window_source.hpp"

namespace contactspline {

class WindowedPlugin : public DISTRHO_NAMESPACE::Plugin, public WindowSource {
 public:
  using Plugin::Plugin;

  /// Of what the framework gives as a pointer to its class.
  static WindowedPlugin& of(void* plugin) {
    return *static_cast<WindowedPlugin*>(static_cast<DISTRHO_NAMESPACE::Plugin*>(plugin));
  }

  /// Can a host move this parameter, as it counts them, beside its value? That of single notes?
  [[nodiscard]] virtual bool is_modulated(std::uint32_t parameter) const = 0;
  [[nodiscard]] virtual bool is_of_notes(std::uint32_t parameter) const = 0;

  // On the audio thread.

  /// For the next block. Where there are too many, those before it act at once.
  void push(const HostNote& note) {
    if (notes_.is_full()) take_notes();
    notes_.push(note);
  }
  /// Does what they say, at once: where no block follows, which would take them at their samples.
  virtual void take_notes() = 0;

  /// How far a host moves a parameter for a time beside its value, as it shows it. On any thread.
  virtual void modulate(std::uint32_t parameter, double amount) = 0;

 protected:
  HostNotes notes_;  ///< of the next block
};

}  // namespace contactspline
