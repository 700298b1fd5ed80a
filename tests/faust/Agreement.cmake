# contactspline.lib against its C++ twin: the same tests on programs compiled strictly and with -Ofast. The emitted
# libraries differ in their numbers alone (tests/emit: Faust.DiffersInNumbersAlone, and HoldsTheBitsOfTheSpline for the
# numbers), so one of each kind is compiled: optimal knots, uniform ones, a single segment, a compensated table, and
# steel, the stiffest. What emits another text (memory, an exponent to move) and the largest table go through the
# compiler only.
set(generated ${CMAKE_CURRENT_BINARY_DIR}/generated)
set(faust_sources ${PROJECT_SOURCE_DIR}/faust)
set(variants felt_c4_n1 felt_c4_n64 felt_c4_n1024 felt_c4_graded felt_c4_optimal felt_c4_compensated)
set(compiled felt_c4 felt_c4_n64 felt_c4_n1 felt_c4_compensated steel_on_steel)
set(kinds ${compiled} felt_c4_n1024 felt_stulov_c4 felt_live)
file(GLOB material_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/data/materials/*.json)
file(GLOB faust_files CONFIGURE_DEPENDS ${faust_sources}/*.lib ${faust_sources}/*.dsp dsp/*.dsp)

# NAME.lib and NAME.hpp of every material and variant.
add_executable(emit_libraries emit_libraries.cpp)
target_link_libraries(emit_libraries PRIVATE contactspline_generator contactspline_warnings)
set(libraries "")
foreach(material IN LISTS material_files variants)
  get_filename_component(name ${material} NAME_WE)
  list(APPEND libraries ${generated}/${name}.lib)
endforeach()
string(REPLACE .lib .hpp headers "${libraries}")
file(MAKE_DIRECTORY ${generated})
add_custom_command(OUTPUT ${libraries} ${headers}
  COMMAND emit_libraries ${generated} ${material_files}
  DEPENDS emit_libraries ${material_files}
  VERBATIM)
add_custom_target(emitted_libraries DEPENDS ${libraries} ${headers})

# faust_program(NAME PROGRAM MATERIAL): NAME.dsp, a program of faust/ or dsp/ on another material.
function(faust_program name program material)
  file(CONFIGURE OUTPUT ${generated}/${name}.dsp
    CONTENT "process = component(\"${program}.dsp\")[material = ${material};];\n")
endfunction()

# compile_faust(OUTPUT PROGRAM OPTIONS...): runs faust on generated/PROGRAM.dsp.
function(compile_faust output program)
  add_custom_command(OUTPUT ${generated}/${output}
    COMMAND ${FAUST} ${ARGN} -I ${faust_sources} -I ${CMAKE_CURRENT_SOURCE_DIR}/dsp -I ${generated}
            ${generated}/${program}.dsp -o ${generated}/${output}
    DEPENDS ${FAUST} ${faust_files} ${libraries} ${generated}/${program}.dsp
    VERBATIM)
endfunction()

# Every program on these materials, as C++.
set(programs "")
set(program_headers "")
foreach(material IN LISTS compiled)
  foreach(program mass_barrier probe)
    set(name ${program}_${material})
    faust_program(${name} ${program} "library(\"${material}.lib\")")
    faust_program(${name}_normalised ${program} "library(\"${material}.lib\").normalised")
    compile_faust(${name}_double.hpp ${name} -double -cn ${name}_double)
    compile_faust(${name}_single.hpp ${name} -single -cn ${name}_single)
    compile_faust(${name}_normalised.hpp ${name}_normalised -double -cn ${name}_normalised)
    list(APPEND program_headers ${generated}/${name}_double.hpp ${generated}/${name}_single.hpp
      ${generated}/${name}_normalised.hpp)
  endforeach()
  set(MATERIAL ${material})
  configure_file(programs.cpp.in ${generated}/programs_${material}.cpp @ONLY)
  list(APPEND programs ${generated}/programs_${material}.cpp)
endforeach()

# faust_programs(NAME OPTIONS...): the C++ programs compiled with these options.
add_custom_target(faust_headers DEPENDS ${program_headers} ${headers})
add_dependencies(faust_headers emitted_libraries)
function(faust_programs name)
  add_library(${name} OBJECT ${programs} material_under_test.cpp)
  add_dependencies(${name} faust_headers)
  target_include_directories(${name} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR} ${generated})
  target_link_libraries(${name} PUBLIC contactspline_runtime)
  target_compile_options(${name} PRIVATE ${ARGN})
endfunction()
faust_programs(faust_cpp $<$<CONFIG:Release>:-O1>)
# In single precision clang divides by estimates of reciprocals: up to 1.5 times the bounds of rounding.
faust_programs(faust_cpp_ofast -Ofast $<$<CXX_COMPILER_ID:Clang>:-mrecip=none>)


# The tests are compiled once and linked twice.
add_library(faust_agreement_cases OBJECT bounce_test.cpp normalised_test.cpp step_test.cpp strike_test.cpp)
add_dependencies(faust_agreement_cases faust_headers)
target_include_directories(faust_agreement_cases PRIVATE ${PROJECT_SOURCE_DIR}/tests ${generated})
target_link_libraries(faust_agreement_cases PRIVATE contactspline_runtime contactspline_warnings GTest::gtest)
target_compile_options(faust_agreement_cases PRIVATE $<$<CONFIG:Release>:-O1>)
target_precompile_headers(faust_agreement_cases REUSE_FROM contactspline_test_headers_O1)
contactspline_test(faust_agreement LABELS faust SOURCES $<TARGET_OBJECTS:faust_agreement_cases>
  LIBRARIES faust_cpp COMPILED_ALONE)
# As faust2jack and its like compile and link: vanishing numbers are flushed to zero too.
contactspline_test(faust_agreement_ofast LABELS faust SOURCES $<TARGET_OBJECTS:faust_agreement_cases>
  LIBRARIES faust_cpp_ofast COMPILED_ALONE)
set_target_properties(faust_agreement faust_agreement_ofast PROPERTIES LINKER_LANGUAGE CXX)
target_link_options(faust_agreement_ofast PRIVATE -Ofast)
contactspline_test(faust_compensation SOURCES compensation_test.cpp LABELS faust LIBRARIES faust_cpp contactspline_spline)
