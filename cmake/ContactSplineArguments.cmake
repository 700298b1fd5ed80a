# What the functions of this package share: their arguments checked, and one line where something is wrong.

cmake_policy(VERSION 3.25)

# Ends the configuration with one line: function (`_contactspline_function` of the caller), what is wrong, what is allowed.
function(_contactspline_fail message)
  string(REGEX REPLACE "[ \n]+" " " message "${message}")
  message(FATAL_ERROR "${_contactspline_function}: ${message}")
endfunction()

# _contactspline_parse(ONE_VALUE SEVERAL_VALUES REQUIRED ARGUMENT...): arg_<KEYWORD> for each keyword given.
function(_contactspline_parse one several required)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "${one}" "${several}")
  if(DEFINED arg_UNPARSED_ARGUMENTS)
    list(GET arg_UNPARSED_ARGUMENTS 0 unknown)
    list(JOIN one ", " allowed)
    list(JOIN several ", " and_these)
    _contactspline_fail("'${unknown}' is unknown; allowed: ${allowed}, ${and_these}")
  endif()
  foreach(keyword IN LISTS arg_KEYWORDS_MISSING_VALUES)
    _contactspline_fail("${keyword}: has no value; allowed: at least one")
  endforeach()
  foreach(keyword IN LISTS required)
    if(NOT DEFINED arg_${keyword})
      list(JOIN required " and " needed)
      _contactspline_fail("${keyword}: missing; needed: ${needed}")
    endif()
  endforeach()
  set(results ${one} ${several})
  list(TRANSFORM results PREPEND arg_)
  return(PROPAGATE ${results})
endfunction()

# Makes arg_OUTPUT_DIR absolute: below the folder of the build, which it is where the caller gave none.
macro(_contactspline_output_dir)
  if(NOT DEFINED arg_OUTPUT_DIR)
    set(arg_OUTPUT_DIR "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  cmake_path(ABSOLUTE_PATH arg_OUTPUT_DIR BASE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}" NORMALIZE)
endmacro()
