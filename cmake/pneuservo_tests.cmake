# Properties that tests declare themselves: [timing] runs alone, [long] has a full length under PNEUSERVO_LONG=1.

set(PNEUSERVO_FULL_LENGTH_SECONDS 7200)

# pneuservo_tagged_tests(TARGET PREFIX): reads the tags of a Catch2 program when ctest starts (discovery itself loses
# them) and labels its tests: "timing" (runs with nothing beside it) and "long" (tools/long-test).
function(pneuservo_tagged_tests target prefix)
  string(STRIP "${prefix}" prefix)  # as the discovery does: cmake -D drops blanks at the end
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${target}_tags.cmake)
  file(GENERATE OUTPUT ${script} CONTENT "# Labels of the tests of ${target}, by their tags.
foreach(tag timing long)
  if(NOT EXISTS \"$<TARGET_FILE:${target}>\")
    continue()
  endif()
  execute_process(COMMAND \"$<TARGET_FILE:${target}>\" --list-test-names-only \"[\${tag}]\"
    OUTPUT_VARIABLE names ERROR_QUIET)
  string(REPLACE \"\\n\" \";\" names \"\${names}\")
  foreach(name IN LISTS names)
    if(name STREQUAL \"\")
      continue()
    endif()
    set_tests_properties(\"${prefix}\${name}\" PROPERTIES LABELS \"\${tag}\")
    if(tag STREQUAL timing)
      set_tests_properties(\"${prefix}\${name}\" PROPERTIES RUN_SERIAL TRUE)
    elseif(DEFINED ENV{PNEUSERVO_LONG})
      set_tests_properties(\"${prefix}\${name}\" PROPERTIES TIMEOUT ${PNEUSERVO_FULL_LENGTH_SECONDS})
    endif()
  endforeach()
endforeach()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
endfunction()

# pneuservo_tagged_script(TEST SCRIPT): the same for a script, which has the tags in a line "# tags: timing long".
function(pneuservo_tagged_script test script)
  file(STRINGS ${script} line REGEX "^# tags:" LIMIT_COUNT 1)
  if(line MATCHES "timing")
    set_tests_properties(${test} PROPERTIES RUN_SERIAL TRUE)
    set_property(TEST ${test} APPEND PROPERTY LABELS timing)
  endif()
  if(line MATCHES "long")
    set_tests_properties(${test} PROPERTIES TIMEOUT ${PNEUSERVO_FULL_LENGTH_SECONDS})
    set_property(TEST ${test} APPEND PROPERTY LABELS long)
  endif()
endfunction()
