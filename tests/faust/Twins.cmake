# Faust programs as C++ headers, to run beside their twins on the same emitted tables. What Faust writes is not ours to
# warn about: they lie in a system folder.
set(faust_headers ${CMAKE_CURRENT_BINARY_DIR}/faust_headers)
file(MAKE_DIRECTORY ${faust_headers})
file(GLOB twin_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/faust/*.lib ${PROJECT_SOURCE_DIR}/generated/*.lib
     ${PROJECT_SOURCE_DIR}/bench/baselines/*.lib)
get_property(shipped_libraries GLOBAL PROPERTY CONTACTSPLINE_SHIPPED_LIBRARIES)
function(faust_header class dsp precision)
  set(header ${faust_headers}/${class}.hpp)
  if(dsp IN_LIST shipped_libraries)
    list(APPEND twin_files contactspline_written_libraries)
  endif()
  add_custom_command(OUTPUT ${header}
    COMMAND ${FAUST} -${precision} ${ARGN} -cn ${class} -I ${PROJECT_SOURCE_DIR}/faust -I ${PROJECT_SOURCE_DIR}/generated
            -I ${PROJECT_SOURCE_DIR}/bench/baselines ${dsp} -o ${header}
    DEPENDS ${FAUST} ${twin_files} ${dsp}
    VERBATIM)
endfunction()

# faust_twin_test(NAME [O1] [SOURCES file...] CLASSES class... [LIBRARIES target...] [DEFINITIONS name=value...])
# O1: it runs for seconds. Others run for so short that -O0, which compiles them in a third of the time, is faster.
function(faust_twin_test name)
  cmake_parse_arguments(PARSE_ARGV 1 twin "O1" "" "SOURCES;CLASSES;LIBRARIES;DEFINITIONS")
  set(level O0)
  if(twin_O1)
    set(level)
  endif()
  list(TRANSFORM twin_CLASSES REPLACE "(.+)" "${faust_headers}/\\1.hpp")
  contactspline_test(${name} ${level} LABELS faust SOURCES ${twin_SOURCES} ${twin_CLASSES}
    LIBRARIES contactspline_materials contactspline_player ${twin_LIBRARIES} DEFINITIONS ${twin_DEFINITIONS})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests/faust)
  target_include_directories(${name} SYSTEM PRIVATE ${faust_headers})
endfunction()

set(here ${CMAKE_CURRENT_SOURCE_DIR})
set(programs_folder ${PROJECT_SOURCE_DIR}/faust)
faust_header(hammer_string_double ${programs_folder}/hammer_string.dsp double)
faust_header(hammer_string_single ${programs_folder}/hammer_string.dsp single)
faust_header(slide_string_double ${programs_folder}/slide_string.dsp double)
faust_header(fret_string_double ${programs_folder}/fret_string.dsp double)
faust_header(slide_string_ui ${here}/slide_string_ui.dsp double)
faust_header(fret_string_ui ${here}/fret_string_ui.dsp double)
faust_header(slide_on_bridge ${here}/slide_on_bridge.dsp double)
faust_header(piano_double ${programs_folder}/piano.dsp double)
faust_header(piano_effect_double ${here}/piano_effect.dsp double)
faust_header(slide_string_model ${here}/slide_string_model.dsp double)
faust_header(bowed_string_model ${here}/bowed_string_model.dsp double)
faust_header(fret_string_model ${here}/fret_string_model.dsp double)
faust_header(coefficients_double ${here}/coefficients.dsp double)
faust_header(live_exponent_double ${here}/live_exponent.dsp double)
faust_header(memory_double ${here}/memory.dsp double)
faust_header(power_law_double ${here}/power_law.dsp double)
faust_header(fd_hammer ${PROJECT_SOURCE_DIR}/bench/baselines/fd_hammer_c4.dsp double)

faust_twin_test(faust_hammer_string_test SOURCES hammer_string_test.cpp CLASSES hammer_string_double hammer_string_single)
faust_twin_test(partials_test O1 SOURCES partials_test.cpp CLASSES hammer_string_double hammer_string_single)
faust_twin_test(faust_live_control_test O1 SOURCES live_control_test.cpp
  CLASSES hammer_string_double slide_string_ui fret_string_ui)
faust_twin_test(faust_string_models_test SOURCES string_models_test.cpp CLASSES slide_string_model fret_string_model bowed_string_model)
faust_twin_test(keyboard_test O1 SOURCES keyboard_test.cpp
  LIBRARIES contactspline_emit ${simd} DEFINITIONS SOURCE_FOLDER="${PROJECT_SOURCE_DIR}")
faust_twin_test(faust_piano_test SOURCES piano_test.cpp CLASSES piano_double piano_effect_double
  LIBRARIES contactspline_emit ${simd} DEFINITIONS SOURCE_FOLDER="${PROJECT_SOURCE_DIR}")
faust_twin_test(faust_guitar_body_test SOURCES guitar_body_test.cpp CLASSES slide_string_double slide_on_bridge)
faust_twin_test(faust_coefficients_test SOURCES coefficients_test.cpp CLASSES coefficients_double)
faust_twin_test(live_exponent_test SOURCES live_exponent_test.cpp CLASSES live_exponent_double)
faust_twin_test(faust_memory_test SOURCES memory_test.cpp CLASSES memory_double)
faust_twin_test(power_law_test SOURCES power_law_test.cpp CLASSES power_law_double)
# Every program, scalar and with -vec.
faust_header(mass_barrier_double ${programs_folder}/mass_barrier.dsp double)
set(vector_classes mass_barrier_double hammer_string_double slide_string_double fret_string_double piano_double)
foreach(program mass_barrier hammer_string slide_string fret_string piano)
  faust_header(${program}_vector ${programs_folder}/${program}.dsp double -vec)
  list(APPEND vector_classes ${program}_vector)
endforeach()
faust_twin_test(faust_vector_test SOURCES vector_test.cpp ../support/count_allocations.cpp CLASSES ${vector_classes})
faust_twin_test(stiff_hammer_test SOURCES stiff_hammer_test.cpp CLASSES fd_hammer)

# For scripts/figures.
add_executable(stiff_hammer_data EXCLUDE_FROM_ALL stiff_hammer_data.cpp ${faust_headers}/fd_hammer.hpp)
target_include_directories(stiff_hammer_data PRIVATE ${PROJECT_SOURCE_DIR}/tests ${PROJECT_SOURCE_DIR}/tests/faust)
target_include_directories(stiff_hammer_data SYSTEM PRIVATE ${faust_headers})
target_link_libraries(stiff_hammer_data PRIVATE contactspline_player contactspline_warnings)

# The C++ hammer-string as a class for Faust's architecture files; plot.cpp prints samples.
find_path(FAUST_INCLUDE_DIR faust/dsp/dsp.h REQUIRED)
set(plot ${CMAKE_CURRENT_BINARY_DIR}/plot_hammer_string)
file(WRITE ${plot}.dsp "process = 0.0;\n")  # Faust wants a program, and puts the class in its place
add_custom_command(OUTPUT ${plot}.cpp
  COMMAND ${FAUST} -a plot.cpp -inj ${CMAKE_CURRENT_SOURCE_DIR}/plotted_hammer_string.cpp ${plot}.dsp -o ${plot}.cpp
  DEPENDS ${FAUST} plotted_hammer_string.cpp
  VERBATIM)
add_executable(plot_hammer_string ${plot}.cpp)
target_compile_definitions(plot_hammer_string PRIVATE FAUSTFLOAT=double)
target_compile_options(plot_hammer_string PRIVATE -w)  # Faust's files are not ours to warn about
target_include_directories(plot_hammer_string SYSTEM PRIVATE ${FAUST_INCLUDE_DIR})
target_link_libraries(plot_hammer_string PRIVATE contactspline_materials)
faust_twin_test(faust_dsp_test SOURCES faust_dsp_test.cpp ../support/count_allocations.cpp
  CLASSES hammer_string_double DEFINITIONS PLOT="$<TARGET_FILE:plot_hammer_string>")
target_include_directories(faust_dsp_test SYSTEM PRIVATE ${FAUST_INCLUDE_DIR})
add_dependencies(faust_dsp_test plot_hammer_string)

# Instruments from files behind the same interface, and as Faust programs.
set(programs "")
foreach(instrument trichord_c4 prepared_piano classical_guitar marimba dulcimer)
  faust_header(${instrument}_double ${ContactSpline_FAUST_DIR}/${instrument}.lib double)
  list(APPEND programs ${instrument}_double)
endforeach()
faust_twin_test(instrument_dsp_test SOURCES instrument_dsp_test.cpp ../support/count_allocations.cpp
  CLASSES ${programs})
target_include_directories(instrument_dsp_test SYSTEM PRIVATE ${FAUST_INCLUDE_DIR})
