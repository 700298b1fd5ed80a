// SPDX-License-Identifier: MIT
// Empty: CMake wants a source file to compile the common headers for (tests/CMakeLists.txt).
