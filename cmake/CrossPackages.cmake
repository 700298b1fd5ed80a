# The packages of headers alone, of the machine that builds for another: cross compilers have none of them. Their folders
# are linked into the build folder, because /usr/include beside them is that of this machine. The presets `windows` and
# `arm64` read this file.
set(contactspline_headers "${CMAKE_BINARY_DIR}/headers")
file(MAKE_DIRECTORY "${contactspline_headers}")

# The generator takes headers of Ceres alone, and looks for no package of it.
file(CREATE_LINK /usr/include/ceres "${contactspline_headers}/ceres" SYMBOLIC)
set(CONTACTSPLINE_CERES_HEADERS "${contactspline_headers}")

# A target of a package: its header, for instance boost/version.hpp, is looked for, and the folder of it is linked, with
# the folders beside it that are named behind.
function(_contactspline_package_of_headers target header)
  if(TARGET ${target})
    return()
  endif()
  unset(folder)  # of the caller
  find_path(folder ${header} PATHS /usr/include PATH_SUFFIXES eigen3 NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH NO_CACHE)
  if(NOT folder)
    message(FATAL_ERROR "${header} is not installed: scripts/install-packages windows")
  endif()
  cmake_path(GET header PARENT_PATH name)
  string(REGEX REPLACE "/.*" "" name "${name}")
  foreach(linked IN ITEMS "${name}" ${ARGN})
    file(CREATE_LINK "${folder}/${linked}" "${contactspline_headers}/${linked}" SYMBOLIC)
  endforeach()
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE "${contactspline_headers}")
endfunction()

macro(_contactspline_find_package method package)
  set(${package}_FOUND TRUE)
  if("${package}" STREQUAL "hwy")
    # The instruction set is chosen when compiling: the library that chooses while running is not there. On 64-bit ARM
    # it is NEON.
    _contactspline_package_of_headers(hwy::hwy hwy/highway.h)
    target_compile_definitions(hwy::hwy INTERFACE HWY_COMPILE_ONLY_STATIC)
  elseif("${package}" STREQUAL "GTest")
    if(NOT TARGET gtest_main)  # Debian has its source
      set(INSTALL_GTEST OFF CACHE INTERNAL "")
      set(BUILD_GMOCK OFF CACHE INTERNAL "")
      add_subdirectory(/usr/src/googletest "${CMAKE_BINARY_DIR}/googletest" EXCLUDE_FROM_ALL SYSTEM)
    endif()
  elseif("${package}" STREQUAL "Boost")
    _contactspline_package_of_headers(Boost::headers boost/version.hpp)
  elseif("${package}" STREQUAL "Eigen3")
    _contactspline_package_of_headers(Eigen3::Eigen Eigen/Core unsupported)
  elseif("${package}" STREQUAL "fmt")
    _contactspline_package_of_headers(fmt::fmt fmt/core.h)
    target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
  elseif("${package}" STREQUAL "nlohmann_json")
    _contactspline_package_of_headers(nlohmann_json::nlohmann_json nlohmann/json.hpp)
  elseif("${package}" STREQUAL "CLI11")
    _contactspline_package_of_headers(CLI11::CLI11 CLI/CLI.hpp)
  else()
    unset(${package}_FOUND)  # CMake looks for it
  endif()
endmacro()
cmake_language(SET_DEPENDENCY_PROVIDER _contactspline_find_package SUPPORTED_METHODS FIND_PACKAGE)
