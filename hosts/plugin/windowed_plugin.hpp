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

  HostNotes notes;  ///< of the next block; run() takes them
};

}  // namespace contactspline
