# WebAssembly, run in Node.
add_executable(write_samples write_samples.cpp)
target_link_libraries(write_samples PRIVATE faust_cpp contactspline_warnings nlohmann_json::nlohmann_json)
target_include_directories(write_samples PRIVATE ${PROJECT_SOURCE_DIR}/tests)
add_custom_command(OUTPUT ${generated}/samples.json COMMAND write_samples ${generated}/samples.json
  DEPENDS write_samples VERBATIM)
set(wasm_programs "")
foreach(program mass_barrier probe)
  foreach(precision double single)
    set(name wasm_${program}_${precision}.wasm)
    compile_faust(${name} ${program}_felt_c4 -lang wasm -${precision})
    list(APPEND wasm_programs ${generated}/${name})
  endforeach()
endforeach()
add_custom_target(faust_wasm ALL DEPENDS ${generated}/samples.json ${wasm_programs})
add_dependencies(faust_wasm emitted_libraries)

# Tests in JavaScript. Without Node they fail and say so: a test that is not run proves nothing.
find_program(NODE node)
find_program(NPM npm)
function(javascript_test name)
  if(NODE AND NPM)
    add_test(NAME ${name} COMMAND ${ARGN})
  else()
    add_test(NAME ${name} COMMAND sh -c "echo 'node or npm is missing: install nodejs and npm'; exit 1")
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "faust;outer")
endfunction()
file(GLOB instruments CONFIGURE_DEPENDS ${faust_sources}/*.dsp)
file(GLOB hand_written CONFIGURE_DEPENDS ${faust_sources}/*.lib)
get_property(shipped GLOBAL PROPERTY CONTACTSPLINE_SHIPPED_LIBRARIES)
set(probes ${kinds})
list(TRANSFORM probes PREPEND ${generated}/probe_)
list(TRANSFORM probes APPEND .dsp)

javascript_test(faust_wasm
  ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/wasm_test.mjs ${generated}/samples.json ${generated})

# The npm package, installed by the build, so that no test needs the network; its lock file names no registry. Where
# that fails, the next build tries again, and the tests fail.
set(npm_folder ${CMAKE_CURRENT_BINARY_DIR}/npm)
configure_file(npm/package.json ${npm_folder}/package.json COPYONLY)
configure_file(npm/package-lock.json ${npm_folder}/package-lock.json COPYONLY)
set(install "${NPM} ci --no-audit --no-fund --ignore-scripts --prefer-offline --loglevel=error && touch installed")
if(NODE AND NPM)
  add_custom_command(OUTPUT ${npm_folder}/installed
    COMMAND sh -c "${install} || echo 'faustwasm cannot be installed: the tests faustwasm, faust_clash and faust_doc will fail'"
    DEPENDS ${npm_folder}/package.json ${npm_folder}/package-lock.json WORKING_DIRECTORY ${npm_folder} VERBATIM)
  add_custom_target(faustwasm_package ALL DEPENDS ${npm_folder}/installed)
endif()
javascript_test(faustwasm
  ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/npm/faustwasm_test.mjs ${npm_folder}/node_modules ${generated}/samples.json
  ${shipped} ${libraries} ${hand_written}
  ${instruments} dsp/probe.dsp ${generated}/mass_barrier_felt_c4.dsp ${probes})
javascript_test(faust_clash
  ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/clash_test.mjs ${npm_folder}/node_modules ${FAUST}
  ${PROJECT_SOURCE_DIR}/generator/support/reserved_names.cpp ${hand_written} -- ${shipped})
javascript_test(faust_doc
  ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/doc_test.mjs ${npm_folder}/node_modules ${FAUST}
  ${PROJECT_SOURCE_DIR}/scripts/faust-functions ${hand_written} ${shipped})
set_tests_properties(faust_clash faust_doc PROPERTIES WORKING_DIRECTORY ${npm_folder})
set_tests_properties(faustwasm PROPERTIES WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
