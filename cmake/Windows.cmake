# Toolchain for Windows on 64-bit x86, by Debian's mingw-w64: CMAKE_TOOLCHAIN_FILE of the preset `windows`. Everything
# is linked statically: what is built needs no library but those of Windows. Wine runs what the build has made, which
# writes the descriptions of LV2 plug-ins.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)  # the variant with std::thread
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -s")
set(CMAKE_MODULE_LINKER_FLAGS_INIT "-static -s")
find_program(CONTACTSPLINE_WINE NAMES wine64 wine PATHS /usr/lib/wine)
if(CONTACTSPLINE_WINE)
  # A folder of its own for what Wine thinks is drive C, and no window.
  set(CMAKE_CROSSCOMPILING_EMULATOR
      ${CMAKE_COMMAND} -E env "WINEPREFIX=${CMAKE_BINARY_DIR}/wine" WINEDEBUG=-all DISPLAY= "${CONTACTSPLINE_WINE}")
endif()

# Nothing of the machine that builds is linked.
set(CMAKE_FIND_ROOT_PATH /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
