// SPDX-License-Identifier: MIT
// Names that emitted files must not have.
#pragma once

#include <string_view>

namespace contactspline {

/// True for a lower-case name that would not compile, or would hide something, as the name of an emitted C++ struct
/// or Faust file: keywords of C++ and Faust, macros of system headers, namespaces, Faust's libraries.
[[nodiscard]] bool is_reserved_name(std::string_view name);

}  // namespace contactspline
