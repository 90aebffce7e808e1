# Writes FILE, which tells ctest the suites of a test program: a process each, which keeps a device ready for all tests of
# its suite. Called with PROGRAM, FILTER, FILE and MAY_SKIP; without MAY_SKIP a skipped test fails its suite.
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests "--gtest_filter=${FILTER}" OUTPUT_VARIABLE listed
                COMMAND_ERROR_IS_FATAL ANY)
get_filename_component(name "${PROGRAM}" NAME)
string(REPLACE ";" "," listed "${listed}")
string(REPLACE "\n" ";" lines "${listed}")
set(text "")
foreach(line IN LISTS lines)
  # A suite ends with a dot; a comment may follow. Its tests are indented.
  if(NOT line MATCHES "^([A-Za-z0-9_/]+)[.]")
    continue()
  endif()
  set(suite "${CMAKE_MATCH_1}")
  # What the filter leaves out of the suite stays out.
  set(chosen "${suite}.*")
  if(FILTER MATCHES "^-")
    string(APPEND chosen "${FILTER}")
  endif()
  set(test "[=[${name}.${suite}]=]")
  string(APPEND text "add_test(${test} \"${PROGRAM}\" \"--gtest_filter=${chosen}\")\n"
                     "set_tests_properties(${test} PROPERTIES TIMEOUT 1800)\n")
  if(NOT MAY_SKIP)
    string(APPEND text "set_tests_properties(${test} PROPERTIES FAIL_REGULAR_EXPRESSION \"\\\\[  SKIPPED \\\\]\")\n")
  endif()
endforeach()
file(WRITE "${FILE}" "${text}")
