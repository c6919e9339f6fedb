# Compiler options and the instruction set, shared by all targets.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# On x86-64: v3 (AVX2) where the building machine has it, else the baseline; elsewhere the compiler's default. The
# numbers are the same bit for bit: nothing is contracted into fused operations, and lanes compute what scalars compute.
set(_default_architecture "")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  file(READ /proc/cpuinfo _cpuinfo LIMIT 8192)
  if(_cpuinfo MATCHES " avx2 " AND _cpuinfo MATCHES " bmi2 " AND _cpuinfo MATCHES " fma ")
    set(_default_architecture x86-64-v3)
  else()
    set(_default_architecture x86-64)
  endif()
endif()
set(PNEUSERVO_ARCHITECTURE "${_default_architecture}" CACHE STRING
  "Instruction set: x86-64 | x86-64-v3 | what -march= of another processor takes | empty")
if(PNEUSERVO_ARCHITECTURE)
  add_compile_options(-march=${PNEUSERVO_ARCHITECTURE})
endif()
add_compile_options(-Wall -Wextra -Wshadow -Wno-psabi)
# Of the program besides (src, hal): conversions that lose digits or signs, casts that the reader does not see, conditions
# and branches that stand twice. Tests are left out, whose macros cast.
set(PNEUSERVO_STRICT_WARNINGS -Wconversion -Wsign-conversion -Wdouble-promotion -Wold-style-cast -Wcast-align -Wformat=2
  -Wnon-virtual-dtor -Woverloaded-virtual -Wextra-semi -Wredundant-decls)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  list(APPEND PNEUSERVO_STRICT_WARNINGS -Wlogical-op -Wduplicated-cond -Wduplicated-branches)
endif()
option(PNEUSERVO_WARNINGS_AS_ERRORS "Stop at a warning; on in the preset release, which continuous integration builds" OFF)
if(PNEUSERVO_WARNINGS_AS_ERRORS)
  add_compile_options(-Werror)
endif()

set(PNEUSERVO_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
if(PNEUSERVO_SANITIZE)
  add_compile_options(-fsanitize=${PNEUSERVO_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PNEUSERVO_SANITIZE})
  # The standard library's own checks: an empty optional, an index beyond the end.
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
