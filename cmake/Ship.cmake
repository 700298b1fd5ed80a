# contactspline_ship(FOLDER DESTINATION FILE...): files under the same folder in the build tree as once installed, so
# that in-tree use and installed use look alike. A changed file is laid there anew by the next build.
function(contactspline_ship folder destination)
  foreach(file IN LISTS ARGN)
    cmake_path(GET file FILENAME name)
    configure_file("${file}" "${PROJECT_BINARY_DIR}/${folder}/${name}" COPYONLY)
  endforeach()
  if(CONTACTSPLINE_INSTALL)
    install(FILES ${ARGN} DESTINATION "${destination}")
  endif()
endfunction()
