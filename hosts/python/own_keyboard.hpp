// SPDX-License-Identifier: MIT
#pragma once

#include "generator/player/own_keyboard.hpp"
