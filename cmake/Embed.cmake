include_guard(GLOBAL)
cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH contactspline_embed_root)

# contactspline_embed(VAR): sources in the current binary folder that embed the templates and all that ships in data/, in
# VAR. The files of each folder are in embedded_FOLDER.
function(contactspline_embed var)
  set(root ${contactspline_embed_root})
  set(sources "")
  foreach(folder templates materials frictions resonators keyboards instruments scores)
    if(folder STREQUAL templates)
      file(GLOB files CONFIGURE_DEPENDS ${root}/templates/*.in)
    else()
      file(GLOB files CONFIGURE_DEPENDS ${root}/data/${folder}/*)
    endif()
    set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${folder}.cpp)
    add_custom_command(OUTPUT ${source}
      COMMAND ${CMAKE_COMMAND} "-DFILES=${files}" -DFOLDER=${folder} -DOUTPUT=${source} -P ${root}/cmake/EmbedFiles.cmake
      DEPENDS ${files} ${root}/cmake/EmbedFiles.cmake
      VERBATIM)
    list(APPEND sources ${source})
    set(embedded_${folder} ${files} PARENT_SCOPE)
  endforeach()
  set(${var} ${sources} PARENT_SCOPE)
endfunction()
