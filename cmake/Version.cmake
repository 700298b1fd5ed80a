# Sets contactspline_version from runtime/contactspline/step/version.hpp, where the version stands, and checks CITATION.cff,
# which repeats it.
set(version_header ${CMAKE_CURRENT_LIST_DIR}/../runtime/contactspline/step/version.hpp)
set(contactspline_version "")
foreach(part Major Minor Patch)
  file(STRINGS ${version_header} line REGEX "^inline constexpr int kVersion${part} = [0-9]+")
  if(NOT line MATCHES "= ([0-9]+)")
    message(FATAL_ERROR "${version_header}: no line 'inline constexpr int kVersion${part} = NUMBER'")
  endif()
  list(APPEND contactspline_version ${CMAKE_MATCH_1})
endforeach()
list(JOIN contactspline_version . contactspline_version)

file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../CITATION.cff line REGEX "^version: ")
if(NOT line STREQUAL "version: ${contactspline_version}")
  message(FATAL_ERROR "CITATION.cff says '${line}', ${version_header} says ${contactspline_version}: make them agree")
endif()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${version_header} ${CMAKE_CURRENT_LIST_DIR}/../CITATION.cff)
