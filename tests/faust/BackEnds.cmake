# The C and LLVM back ends, to be run: each program on felt C4 in a shared library.
execute_process(COMMAND ${FAUST} --version OUTPUT_VARIABLE faust_version)
find_program(CLANG clang)
set(c_library ${generated}/faust_c.so)
set(llvm_library ${generated}/faust_llvm.so)
set(why_no_llvm "")
if(NOT faust_version MATCHES "LLVM IR")
  set(why_no_llvm "${FAUST} was built without it")
elseif(NOT CLANG)
  set(why_no_llvm "clang, which makes code of it, is not installed")
endif()
set(c_programs "")
set(llvm_programs "")
foreach(program mass_barrier probe)
  foreach(precision double single)
    set(name ${program}_${precision})
    compile_faust(c_${name}.c ${program}_felt_c4 -lang c -${precision} -cn c_${name})
    list(APPEND c_programs ${generated}/c_${name}.c)
    string(REPLACE single float real ${precision})
    set_source_files_properties(${generated}/c_${name}.c PROPERTIES COMPILE_DEFINITIONS FAUSTFLOAT=${real})
    if(NOT why_no_llvm)
      compile_faust(llvm_${name}.bc ${program}_felt_c4 -lang llvm -${precision} -cn llvm_${name})
      list(APPEND llvm_programs ${generated}/llvm_${name}.bc)
    endif()
  endforeach()
endforeach()
set(cxx_pch_extension ${CMAKE_PCH_EXTENSION})
enable_language(C)
set(CMAKE_PCH_EXTENSION ${cxx_pch_extension})  # which a C compiler of another make replaces
add_library(faust_c MODULE ${c_programs})
set_target_properties(faust_c PROPERTIES PREFIX "" SUFFIX .so LIBRARY_OUTPUT_DIRECTORY ${generated})
target_compile_options(faust_c PRIVATE -include ${CMAKE_CURRENT_SOURCE_DIR}/c_glue.h)
add_dependencies(faust_c emitted_libraries)
if(why_no_llvm)
  message(WARNING "The LLVM back end of Faust will not be run: ${why_no_llvm}")
  set(llvm_library "")
else()
  add_custom_command(OUTPUT ${llvm_library}
    COMMAND ${CLANG} -O2 -shared -fPIC -Wno-override-module -x ir ${llvm_programs} -o ${llvm_library}
    DEPENDS ${llvm_programs} VERBATIM)
endif()

# The compiler itself: back ends and numbers.
string(REGEX REPLACE "([^;]+)" "\"\\1\"" material_names "${kinds}")
string(REPLACE ";" ", " material_names "${material_names}")
configure_file(paths.hpp.in ${generated}/paths.hpp @ONLY)
foreach(name IN LISTS kinds)
  faust_program(probe_${name} probe "library(\"${name}.lib\")")
endforeach()
contactspline_test(faust_compiler LABELS faust
  SOURCES back_ends_test.cpp literal_test.cpp native_test.cpp ${llvm_library}
  LIBRARIES faust_cpp nlohmann_json::nlohmann_json ${CMAKE_DL_LIBS})
add_dependencies(faust_compiler faust_c)

# Programs of random instruments against the class.
contactspline_test(random_instruments_test LABELS faust
  DEFINITIONS EXAMPLES_FOLDER="${PROJECT_SOURCE_DIR}/examples/instruments"
  LIBRARIES contactspline_engine contactspline_emit nlohmann_json::nlohmann_json ${CMAKE_DL_LIBS} ${simd})
target_include_directories(random_instruments_test PRIVATE ${generated})
