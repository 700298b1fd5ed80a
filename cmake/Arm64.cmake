# Toolchain for Linux on 64-bit ARM, by Debian's cross compiler: CMAKE_TOOLCHAIN_FILE of the preset `arm64`. qemu runs
# what the build has made, which writes the descriptions of LV2 plug-ins, and the tests.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
find_program(CONTACTSPLINE_QEMU qemu-aarch64)
if(CONTACTSPLINE_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${CONTACTSPLINE_QEMU}" -L /usr/aarch64-linux-gnu)
endif()

# Nothing of the machine that builds is linked.
set(CMAKE_FIND_ROOT_PATH /usr/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
