# contactspline_generate(TARGET name MATERIALS material... [EMIT cpp|faust|json...] [OUTPUT_DIR folder])
#
# Runs `contactspline generate` at build time, whenever a material or the program has changed, and makes TARGET a
# library to link: what links it finds NAME.hpp on its include path, made before it compiles, and the runtime.
#
# MATERIALS   files (.json) of materials, resonators, keyboards or instruments, relative to the current source folder, or
#             names of those that ship
# EMIT        what to write: cpp (NAME.hpp), faust (NAME.lib; of instruments if they have few contacts), json (NAME.json), or several; default cpp
# OUTPUT_DIR  where to, relative to the current binary folder; default: a folder called like TARGET
#
# In a project that takes Contact Spline from source, set(CONTACTSPLINE_BUILD_GENERATOR ON) before add_subdirectory or
# FetchContent_MakeAvailable: the program is then built, for which its libraries are needed (docs/how-to/cmake.md).
#
# For Faust: faust -I ${ContactSpline_FAUST_DIR} -I OUTPUT_DIR; contactspline_lv2 and contactspline_jack do so.

cmake_policy(VERSION 3.25)  # whatever the caller's; CMP0116 is about depfiles
include(${CMAKE_CURRENT_LIST_DIR}/ContactSplineArguments.cmake)

# The `name` of a material file, after which its outputs are called. string(JSON) takes comments, as the program does.
function(_contactspline_name_in file result)
  file(READ "${file}" text)
  string(JSON name ERROR_VARIABLE error GET "${text}" name)
  if(error)
    _contactspline_fail("${file}: name: ${error}; allowed: a JSON object with a name, comments included")
  elseif(NOT name MATCHES "^[a-z][a-z0-9_]*$")
    _contactspline_fail("${file}: name: '${name}' is not usable; allowed: a-z, 0-9 and _, a letter first")
  endif()
  set(${result} ${name} PARENT_SCOPE)
endfunction()

# A MATERIAL as the program reads it: a file where it has a folder or ends in .json, else the name of one that ships.
# Sets `source` to what the program is given, `name`, and `file`, empty for one that ships.
function(_contactspline_resolve material)
  if(material MATCHES "/|\\.json$")
    cmake_path(ABSOLUTE_PATH material BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE OUTPUT_VARIABLE file)
    if(NOT EXISTS "${file}" OR IS_DIRECTORY "${file}")
      _contactspline_fail("MATERIALS: ${file} is not a file; allowed: material files")
    endif()
    _contactspline_name_in("${file}" name)
    set(source "${file}")
  else()
    get_target_property(shipped ContactSpline::contactspline CONTACTSPLINE_MATERIALS)
    if(NOT material IN_LIST shipped)
      list(JOIN shipped ", " shipped)
      _contactspline_fail("MATERIALS: no '${material}' ships; allowed: a .json file, ${shipped}")
    endif()
    set(source ${material})
    set(name ${material})
    set(file "")
  endif()
  return(PROPAGATE source name file)
endfunction()

# Checks the arguments of contactspline_generate and gives them back as arg_<KEYWORD>, defaults filled in.
function(_contactspline_arguments)
  _contactspline_parse("TARGET;OUTPUT_DIR" "MATERIALS;EMIT" "TARGET;MATERIALS" ${ARGV})
  if(NOT DEFINED arg_EMIT)
    set(arg_EMIT cpp)
  endif()
  foreach(format IN LISTS arg_EMIT)
    if(NOT format MATCHES "^(cpp|faust|json)$")
      _contactspline_fail("EMIT: '${format}' is unknown; allowed: cpp, faust, json")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES arg_EMIT)
  if(NOT DEFINED arg_OUTPUT_DIR)
    set(arg_OUTPUT_DIR ${arg_TARGET})
  endif()
  cmake_path(ABSOLUTE_PATH arg_OUTPUT_DIR BASE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}" NORMALIZE)
  return(PROPAGATE arg_TARGET arg_MATERIALS arg_EMIT arg_OUTPUT_DIR)
endfunction()

# The build step that makes the `outputs` of one resolved material. Uses `source`, `name`, `file` and arg_<KEYWORD>.
function(_contactspline_add_step outputs)
  list(TRANSFORM arg_EMIT PREPEND --emit= OUTPUT_VARIABLE formats)
  # The program leaves a file alone whose bytes would not change. Ninja takes note of that; make wants a newer date.
  set(touch "")
  if(NOT CMAKE_GENERATOR MATCHES Ninja)
    set(touch COMMAND ${CMAKE_COMMAND} -E touch ${outputs})
  endif()
  # A file may change, its name included; what ships changes with the program only.
  set(depfile "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}.${name}.d")
  set(write_depfile "")
  set(read_depfile "")
  if(file)
    set(write_depfile --depfile "${depfile}")
    set(read_depfile DEPFILE "${depfile}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  endif()
  add_custom_command(
    OUTPUT ${outputs}
    COMMAND ContactSpline::contactspline generate "${source}" ${formats} --output "${arg_OUTPUT_DIR}" ${write_depfile}
    ${touch}
    DEPENDS ContactSpline::contactspline ${file}
    ${read_depfile}
    COMMENT "Generating material ${name}"
    VERBATIM)
endfunction()

# See the top of this file.
function(contactspline_generate)
  set(_contactspline_function contactspline_generate)
  if(NOT TARGET ContactSpline::contactspline)
    _contactspline_fail("the program is not built; allowed: set(CONTACTSPLINE_BUILD_GENERATOR ON) before Contact Spline is
                         added, or a package that was installed with it")
  endif()
  _contactspline_arguments(${ARGV})
  set(extension_cpp hpp)
  set(extension_faust lib)
  set(extension_json json)
  set(names "")
  set(all_outputs "")
  foreach(material IN LISTS arg_MATERIALS)
    _contactspline_resolve("${material}")
    if(name IN_LIST names)
      _contactspline_fail("MATERIALS: '${name}' is the name of two materials; allowed: once")
    endif()
    set(outputs "")
    foreach(format IN LISTS arg_EMIT)
      list(APPEND outputs "${arg_OUTPUT_DIR}/${name}.${extension_${format}}")
    endforeach()
    _contactspline_add_step("${outputs}")
    list(APPEND names ${name})
    list(APPEND all_outputs ${outputs})
  endforeach()

  # An interface library with sources is a step of the build, and precedes whatever links it.
  add_library(${arg_TARGET} INTERFACE ${all_outputs})
  target_include_directories(${arg_TARGET} INTERFACE "$<BUILD_INTERFACE:${arg_OUTPUT_DIR}>")
  target_link_libraries(${arg_TARGET} INTERFACE ContactSpline::runtime)
  set_target_properties(${arg_TARGET} PROPERTIES
    CONTACTSPLINE_OUTPUT_DIR "${arg_OUTPUT_DIR}" CONTACTSPLINE_OUTPUTS "${all_outputs}")
endfunction()
