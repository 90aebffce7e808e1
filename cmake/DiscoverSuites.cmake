# Writes FILE, which tells ctest the suites of a test program: a process each, since one that has a device ready keeps it
# for all tests of its suite. Called with PROGRAM, FILTER, FILE and TIMEOUT (seconds).
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
  string(APPEND text "add_test([=[${name}.${suite}]=] \"${PROGRAM}\" \"--gtest_filter=${chosen}\")\n"
                     "set_tests_properties([=[${name}.${suite}]=] PROPERTIES TIMEOUT ${TIMEOUT})\n")
endforeach()
file(WRITE "${FILE}" "${text}")
