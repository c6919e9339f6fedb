# Install rules and the export set, so that find_package(pneuservo) works from another project.
# Installed is what needs no library of ours: the header-only estimator (component "estimator") and the program
# (component "program", src/CMakeLists.txt). A header whose body stays behind is not installed.
set(PNEUSERVO_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/pneuservo)

foreach(folder core elements estimator)
  install(DIRECTORY include/pneuservo/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pneuservo COMPONENT estimator
    FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(TARGETS pneuservo_estimator EXPORT pneuservo_targets COMPONENT estimator)
install(EXPORT pneuservo_targets NAMESPACE pneuservo:: DESTINATION ${PNEUSERVO_PACKAGE_DIR} COMPONENT estimator)

configure_package_config_file(cmake/pneuservo-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config.cmake
  INSTALL_DESTINATION ${PNEUSERVO_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config-version.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config-version.cmake
  DESTINATION ${PNEUSERVO_PACKAGE_DIR} COMPONENT estimator)
