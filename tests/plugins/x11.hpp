// SPDX-License-Identifier: MIT
// The headers of X11 without the macros whose names others use, too.
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#undef Bool
#undef None
#undef Status
