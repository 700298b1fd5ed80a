# A million steps in each precision, solved once and in two shards, whatever the build type.
set(steps 1000000)
add_executable(step_reference step_reference.cpp)
target_include_directories(step_reference PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(step_reference PRIVATE contactspline_generator contactspline_warnings)
target_compile_options(step_reference PRIVATE -O2)
foreach(precision double float)
  foreach(shard 0 1)
    set(file ${CMAKE_CURRENT_BINARY_DIR}/steps_${precision}_${shard}.bin)
    list(APPEND ${precision}_files ${file})
    add_test(NAME contact_step.reference_${precision}_${shard}
      COMMAND step_reference ${precision} ${steps} ${shard} 2 ${file})
    set_tests_properties(contact_step.reference_${precision}_${shard} PROPERTIES
      FIXTURES_SETUP steps_${precision} LABELS numerics)
  endforeach()
endforeach()

# checker(NAME COMPILER OPTIONS...): step_checker and mass_barrier_checker by a compiler of their own.
set(checkers "")
function(checker name compiler)
  foreach(program step_checker mass_barrier_checker)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/${program}_${name})
    add_custom_command(OUTPUT ${output}
      COMMAND ${compiler} -std=c++20 ${ARGN} -Wall -Wextra -Wpedantic -Wconversion -Wshadow
              -I${PROJECT_SOURCE_DIR}/runtime -I${PROJECT_SOURCE_DIR}/tests -I${emitted} -MMD -MF ${output}.d
              ${CMAKE_CURRENT_SOURCE_DIR}/${program}.cpp -o ${output}
      DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${program}.cpp ${emitted_headers}
      DEPFILE ${output}.d
      VERBATIM)
    list(APPEND checkers ${output})
  endforeach()
  set(checkers ${checkers} PARENT_SCOPE)

  set(step_checker ${CMAKE_CURRENT_BINARY_DIR}/step_checker_${name})
  foreach(precision double float)
    add_test(NAME contact_step.${precision}_${name}
      COMMAND ${step_checker} ${precision} ${steps} none ${${precision}_files})
    set_tests_properties(contact_step.${precision}_${name} PROPERTIES
      FIXTURES_REQUIRED steps_${precision} LABELS numerics)
  endforeach()
  add_test(NAME contact_step.planted_errors_${name}
    COMMAND ${CMAKE_COMMAND} -DCHECKER=${step_checker} -DCASES=${steps} "-DFILES=${double_files}"
            -P ${CMAKE_CURRENT_SOURCE_DIR}/expect_failure.cmake)
  set_tests_properties(contact_step.planted_errors_${name} PROPERTIES
    FIXTURES_REQUIRED steps_double LABELS numerics)
  add_test(NAME mass_barrier.energy_${name} COMMAND ${CMAKE_CURRENT_BINARY_DIR}/mass_barrier_checker_${name})
  set_tests_properties(mass_barrier.energy_${name} PROPERTIES LABELS numerics)
endfunction()

foreach(compiler g++ clang++)
  string(MAKE_C_IDENTIFIER found_${compiler} found)
  find_program(${found} ${compiler})
  if(${found})
    checker(${compiler}_O0 ${${found}} -O0)
    checker(${compiler}_O3 ${${found}} -O3)
    checker(${compiler}_Ofast ${${found}} -Ofast -march=native)
  else()
    message(WARNING "${compiler} is not installed: the contact step will not be checked as it compiles it")
    add_test(NAME contact_step.${compiler} COMMAND ${CMAKE_COMMAND} -E echo "${compiler} is not installed: not checked")
    set_tests_properties(contact_step.${compiler} PROPERTIES SKIP_REGULAR_EXPRESSION "not installed" LABELS numerics)
  endif()
endforeach()
add_custom_target(contact_checkers ALL DEPENDS ${checkers})
