# Install rules and the export set, so that find_package(pneuservo) works from another project.
install(DIRECTORY include/pneuservo DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS pneuservo_estimator EXPORT pneuservo_targets)
install(EXPORT pneuservo_targets NAMESPACE pneuservo:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pneuservo)
configure_package_config_file(cmake/pneuservo-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pneuservo)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/pneuservo-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pneuservo)
