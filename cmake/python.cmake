# The Python package: finds Python and nanobind, or says in one line that it is not built.
# PNEUSERVO_PYTHON_MODULE: a module that another build of these sources has made; a wheel then compiles nothing.
set(PNEUSERVO_PYTHON_MODULE "" CACHE FILEPATH "Module _core and its stub of another build, for a wheel without compiling")
set(PNEUSERVO_HAS_PYTHON OFF)
set(PNEUSERVO_PYTHON_BUILT OFF)
if(NOT PNEUSERVO_BUILD_PYTHON)
  return()
endif()

if(PNEUSERVO_PYTHON_MODULE)
  cmake_path(GET PNEUSERVO_PYTHON_MODULE PARENT_PATH folder)
  add_custom_target(pneuservo_python)  # what pyproject.toml asks for is there
  add_custom_target(pneuservo_python_stub)
  install(FILES ${PNEUSERVO_PYTHON_MODULE} ${folder}/_core.pyi ${folder}/pneuservo_fmu.so.xz DESTINATION pneuservo COMPONENT python)
  set(PNEUSERVO_PYTHON_BUILT ON)
  return()
endif()

# Without pip's own environment: the one that tools/python-env makes.
if(NOT SKBUILD AND NOT Python_EXECUTABLE AND EXISTS ${PROJECT_SOURCE_DIR}/build/python-env/bin/python)
  set(Python_EXECUTABLE ${PROJECT_SOURCE_DIR}/build/python-env/bin/python)
endif()
find_package(Python 3.9 COMPONENTS Interpreter Development.Module OPTIONAL_COMPONENTS Development.SABIModule)
set(reason "Python 3.9 with its headers (python3-dev)")
if(Python_Development.Module_FOUND)
  execute_process(COMMAND ${Python_EXECUTABLE} -m nanobind --cmake_dir OUTPUT_VARIABLE nanobind_ROOT
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  find_package(nanobind CONFIG QUIET)
  set(reason "nanobind (pip install nanobind)")
endif()
if(nanobind_FOUND)
  set(PNEUSERVO_HAS_PYTHON ON)
elseif(SKBUILD)
  message(FATAL_ERROR "the wheel needs ${reason}")
else()
  message(STATUS "without ${reason}: the Python package is not built")
endif()
