# cmake -DCHECKER=... -DCASES=N -DFILES=a;b -P expect_failure.cmake: the checker must find every planted error, say what it
# found, and exit with 1; with 2 where a file is missing.
function(expect plant code message)
  execute_process(COMMAND ${CHECKER} double ${CASES} ${plant} ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output)
  if(NOT result STREQUAL code OR NOT output MATCHES "${message}")
    message(FATAL_ERROR "${CHECKER}, ${plant} planted: exit ${result} instead of ${code} with \"${message}\":\n${output}")
  endif()
  message("${plant}: found")
endfunction()

expect(nan 1 "FAILED: not finite: .*f -?nan" ${FILES})
expect(infinite 1 "FAILED: not finite: .*f inf" ${FILES})
expect(wrong 1 "FAILED: force beyond its bound" ${FILES})
expect(negative 1 "FAILED: negative" ${FILES})
expect(missing 1 "FAILED: missing data" ${FILES})
expect(none 2 "missing data" ${FILES} no_such_file)
list(GET FILES 0 one)
expect(none 1 "FAILED: missing data" ${one})

