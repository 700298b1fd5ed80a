// SPDX-License-Identifier: MIT
// What the framework hands to a window is a pointer to its own class: the window is built for this one, which is
// both. An LV2 window is a library of its own, which has nothing of the plug-in's but this.
#pragma once

#include <DistrhoPlugin.hpp>

#include "window/window_source.hpp"

namespace contactspline {

class WindowedPlugin : public DISTRHO_NAMESPACE::Plugin, public WindowSource {
 public:
  using Plugin::Plugin;
};

}  // namespace contactspline
