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
# g++ 12 takes the sum of a text and a string for a copy onto itself (GCC bug 105651).
add_compile_options(-Wall -Wextra -Wshadow -Wno-psabi)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  add_compile_options(-Wno-restrict)
  # From precompiled headers it warns of the inside of std::string, too.
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    add_compile_options(-Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
endif()
# Of the program (src, hal) besides, shown and no errors: conversions that lose digits or signs, casts that the reader does
# not see, conditions and branches that stand twice.
set(shown conversion sign-conversion double-promotion old-style-cast cast-align format=2 non-virtual-dtor
  overloaded-virtual extra-semi redundant-decls)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  list(APPEND shown logical-op duplicated-cond duplicated-branches)
endif()
list(TRANSFORM shown PREPEND -W OUTPUT_VARIABLE PNEUSERVO_PROGRAM_WARNINGS)
option(PNEUSERVO_WARNINGS_AS_ERRORS "Stop at a warning in the program; on in the preset release" OFF)
if(PNEUSERVO_WARNINGS_AS_ERRORS)
  list(APPEND shown maybe-uninitialized)  # g++ 12 finds them in std::regex (GCC bug 105562)
  list(TRANSFORM shown PREPEND -Wno-error=)
  list(APPEND PNEUSERVO_PROGRAM_WARNINGS -Werror ${shown})
endif()

# A section for each function, so that the linker leaves out of Python's modules what they do not call.
add_compile_options(-ffunction-sections -fdata-sections)

set(PNEUSERVO_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
if(PNEUSERVO_SANITIZE)
  add_compile_options(-fsanitize=${PNEUSERVO_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PNEUSERVO_SANITIZE})
  # The standard library's own checks: an empty optional, an index beyond the end.
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # It keeps what is compiled from precompiled headers only if told that no source asks for the time or redefines their macros.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_compile_options(-fpch-preprocess)
  endif()
endif()

# g++ tidies its memory from 0.5 GB on in place of 0.13: a twentieth of its time for a tenth more memory.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options(--param=ggc-min-heapsize=524288)
endif()

option(PNEUSERVO_UNITE_FOLDERS "Compile all sources of a folder as one unit; off where single files are edited (preset debug)" ON)
# Where neither a loop nor a diagnosis spends its time, -O2 takes 0.8 of the compiler's time and of the room.
# Without the precompiled header: from one g++ takes over the level of optimisation that the header was compiled with.
set(PNEUSERVO_COLD_FOLDERS "^src_(config|design|service|report|index|improve|program|diagnosis_verdict|diagnosis_doubts)$")
set(PNEUSERVO_COLD_OPTIMISATION -O2)
# A wheel is compiled by whoever installs it, and its laws are called from Python: -O1 takes 0.8 of the time once more, -O2
# for the rest of the libraries 0.85.
if(SKBUILD)
  set(PNEUSERVO_COLD_OPTIMISATION -O1)
endif()
# unite_folders(TARGET...): what the sources of a folder share is parsed and instantiated once, in some 0.6 of the time.
# Names in unnamed namespaces are therefore unique within a folder.
function(unite_folders)
  if(NOT PNEUSERVO_UNITE_FOLDERS)
    return()
  endif()
  foreach(target IN LISTS ARGN)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    if(SKBUILD)
      target_compile_options(${target} PRIVATE -O2)
    endif()
    # A class of one file may hold another of the same file, which g++ takes for a header's.
    if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
      target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
    get_target_property(sources ${target} SOURCES)
    get_target_property(home ${target} SOURCE_DIR)
    get_target_property(built ${target} BINARY_DIR)
    foreach(source IN LISTS sources)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${home})
      cmake_path(GET source PARENT_PATH folder)
      cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE group)
      # The laws are optimised file by file: in one unit g++ inlines otherwise, and the supervised tick takes 5 % longer.
      if(group STREQUAL "src/control" AND NOT SKBUILD)
        set_property(SOURCE ${source} TARGET_DIRECTORY ${target} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
      endif()
      string(MAKE_C_IDENTIFIER "${group}" group)
      set_property(SOURCE ${source} TARGET_DIRECTORY ${target} PROPERTY UNITY_GROUP ${group})
      if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT PNEUSERVO_SANITIZE AND group MATCHES "${PNEUSERVO_COLD_FOLDERS}")
        set_source_files_properties(${built}/CMakeFiles/${target}.dir/Unity/unity_${group}_cxx.cxx TARGET_DIRECTORY ${target}
          PROPERTIES COMPILE_OPTIONS ${PNEUSERVO_COLD_OPTIMISATION} SKIP_PRECOMPILE_HEADERS ON)
      endif()
    endforeach()
  endforeach()
endfunction()
