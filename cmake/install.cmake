# Install rules and the export sets, so that find_package(pneuservo) works from another project.
# Component "estimator": the header-only estimator, which needs no library. Component "library": pneuservo::axis, all that
# runs an axis. Component "program": the program (src/CMakeLists.txt). A header whose body stays behind is not installed.
# Types hold as many lanes as a register has: who links with the library compiles for the same instruction set. Packages
# hold it once for each and the loader takes one, so that nobody can link with it there.
set(PNEUSERVO_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/pneuservo)

foreach(folder core elements estimator)
  install(DIRECTORY include/pneuservo/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pneuservo COMPONENT estimator
    FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(TARGETS pneuservo_estimator EXPORT pneuservo_targets COMPONENT estimator)
install(EXPORT pneuservo_targets NAMESPACE pneuservo:: DESTINATION ${PNEUSERVO_PACKAGE_DIR} COMPONENT estimator)

if(PNEUSERVO_BUILD_PROGRAM AND NOT PNEUSERVO_SHARED_LIBRARY)
  foreach(folder control hal loop record rig)
    install(DIRECTORY include/pneuservo/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pneuservo COMPONENT library
      FILES_MATCHING PATTERN "*.hpp")
  endforeach()
  # Headers that are included as in the sources ("config/read_rig.hpp") stand apart.
  set(PNEUSERVO_HOST_INCLUDES ${CMAKE_INSTALL_INCLUDEDIR}/pneuservo/host)
  foreach(folder config control loop record rig)
    install(DIRECTORY src/${folder} DESTINATION ${PNEUSERVO_HOST_INCLUDES} COMPONENT library FILES_MATCHING PATTERN "*.hpp")
  endforeach()
  install(FILES hal/backends.hpp DESTINATION ${PNEUSERVO_HOST_INCLUDES} COMPONENT library)
  # hal needs core and core nothing of hal, so one name for both is a library that links them in this order.
  add_library(pneuservo_axis INTERFACE)
  add_library(pneuservo::axis ALIAS pneuservo_axis)
  set_target_properties(pneuservo_axis PROPERTIES EXPORT_NAME axis)
  target_link_libraries(pneuservo_axis INTERFACE pneuservo_hal)
  set_target_properties(pneuservo_hal PROPERTIES EXPORT_NAME hal)
  target_include_directories(pneuservo_core INTERFACE $<INSTALL_INTERFACE:${PNEUSERVO_HOST_INCLUDES}>)
  if(PNEUSERVO_ARCHITECTURE)
    target_compile_options(pneuservo_core INTERFACE $<INSTALL_INTERFACE:-march=${PNEUSERVO_ARCHITECTURE}>)
  endif()
  install(TARGETS pneuservo_core pneuservo_hal pneuservo_axis EXPORT pneuservo_axis_targets COMPONENT library)
  install(EXPORT pneuservo_axis_targets NAMESPACE pneuservo:: DESTINATION ${PNEUSERVO_PACKAGE_DIR} COMPONENT library)
endif()

get_property(PNEUSERVO_HAL_MODULES GLOBAL PROPERTY PNEUSERVO_HAL_MODULES)
configure_package_config_file(cmake/pneuservo-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config.cmake
  INSTALL_DESTINATION ${PNEUSERVO_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config-version.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config-version.cmake
  DESTINATION ${PNEUSERVO_PACKAGE_DIR} COMPONENT estimator)
