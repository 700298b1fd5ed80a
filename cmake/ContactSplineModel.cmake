# contactspline_model(TARGET name HEADER file CLASS type [MATERIALS target...] [OUTPUT_DIR folder])
#
# Makes OUTPUT_DIR/TARGET.so of a class that meets contactspline::Instrument, for scores and MIDI files:
# `contactspline render SCORE --instrument TARGET.so` plays it. Build it with the compiler and the version of the program.
#
# HEADER      a C++ file, relative to the current source folder
# CLASS       a class in it, built without arguments: "my::Kalimba<float>"
# MATERIALS   targets of contactspline_generate with EMIT cpp, and other libraries that the class needs
# OUTPUT_DIR  relative to the current binary folder; default: that folder

cmake_policy(VERSION 3.25)  # whatever the caller's
include(${CMAKE_CURRENT_LIST_DIR}/ContactSplineArguments.cmake)

# See the top of this file.
function(contactspline_model)
  set(_contactspline_function contactspline_model)
  _contactspline_parse("TARGET;HEADER;CLASS;OUTPUT_DIR" "MATERIALS" "TARGET;HEADER;CLASS" ${ARGV})
  _contactspline_output_dir()
  cmake_path(ABSOLUTE_PATH arg_HEADER BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE OUTPUT_VARIABLE header)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}_model.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT [[
#include "@header@"

#include "contactspline/host/model_module.hpp"

extern "C" const contactspline::ModelModule* contactspline_model_module() {
  static const contactspline::ModelModule module = contactspline::model_module<@arg_CLASS@>();
  return &module;
}
]] @ONLY)
  add_library(${arg_TARGET} MODULE "${source}")
  set_target_properties(${arg_TARGET} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY "${arg_OUTPUT_DIR}")
  target_link_libraries(${arg_TARGET} PRIVATE ContactSpline::materials ${arg_MATERIALS})
  if(TARGET ContactSpline::simd)  # many times as fast
    target_link_libraries(${arg_TARGET} PRIVATE ContactSpline::simd)
  endif()
endfunction()
