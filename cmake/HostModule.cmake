# contactspline_host_module(NAME HEADER FOLDER): the module of hosts/NAME, contactspline_NAME, if the host's header is found,
# which sets contactspline_NAME_INCLUDE_DIR. FOLDER: where it is installed, below the prefix. Its pieces, examples/NAME, are
# installed beside the instrument files that they play (hosts/c).
function(contactspline_host_module name header folder)
  find_path(CONTACTSPLINE_${name}_INCLUDE_DIR ${header} PATH_SUFFIXES pd SuperCollider/plugin_interface)
  if(NOT CONTACTSPLINE_${name}_INCLUDE_DIR)
    message(STATUS "hosts/${name} is not built: ${header} was not found")
    return()
  endif()
  set(target contactspline_${name})
  add_library(${target} MODULE contactspline.cpp)
  target_include_directories(${target} SYSTEM PRIVATE ${CONTACTSPLINE_${name}_INCLUDE_DIR})
  target_link_libraries(${target} PRIVATE contactspline_c contactspline_runtime contactspline_warnings)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  # From the module to the library for C, wherever both are moved.
  file(RELATIVE_PATH to_library /${folder} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME contactspline CXX_VISIBILITY_PRESET hidden UNITY_BUILD OFF
    INSTALL_RPATH "$ORIGIN/${to_library}")
  if(CONTACTSPLINE_INSTALL)
    install(TARGETS ${target} LIBRARY DESTINATION ${folder} COMPONENT ${name})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/${name}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/contactspline/examples COMPONENT ${name})
  endif()
endfunction()
