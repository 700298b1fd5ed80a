# cmake "-DCOMPILE=compiler;option..." -P format_version.cmake: emitted structs of this runtime's format version compile,
# those of another version are refused with a message that says what to do.
set(source ${CMAKE_CURRENT_LIST_DIR}/format_version.cpp)
foreach(use "segments_of<Material,double>" "LiveExponent<Material,double>(2.5)" "modes_in<Resonator>"
            "felts_of<Keyboard,double>" "string_of<Keyboard>(60)")
  foreach(offset 0 1)
    execute_process(COMMAND ${COMPILE} -DOFFSET=${offset} "-DUSE=(${use})" -fsyntax-only ${source}
                    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(offset EQUAL 0 AND NOT result EQUAL 0)
      message(FATAL_ERROR "${use} does not compile:\n${output}")
    elseif(NOT offset EQUAL 0 AND (result EQUAL 0 OR NOT output MATCHES "run `contactspline generate` again"))
      message(FATAL_ERROR "${use} takes a struct of another format version:\n${output}")
    endif()
  endforeach()
endforeach()
