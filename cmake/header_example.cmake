# The example in a header's comment as text of its own, so that a test compiles exactly what a reader copies.

# pneuservo_header_example(HEADER FILE): writes the lines "//   CODE" before HEADER's #pragma once to FILE, and again
# whenever the header has changed.
function(pneuservo_header_example header file)
  file(READ ${header} text)
  string(FIND "${text}" "\n//   " begin)
  string(FIND "${text}" "\n#pragma once" end)
  if(begin EQUAL -1 OR end LESS begin)
    message(FATAL_ERROR "${header}: no example, expected lines that begin with '//   ' before #pragma once")
  endif()
  math(EXPR length "${end} - ${begin}")
  string(SUBSTRING "${text}" ${begin} ${length} example)
  string(REGEX REPLACE "\n//   " "\n" example "${example}")
  file(CONFIGURE OUTPUT ${file} CONTENT "// The example of ${header}; generated.@example@\n" @ONLY)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header})
endfunction()
