# The Debian package: what it holds and where (tools/package makes it from two builds, for any x86-64 and for AVX2).
#   usr/bin/pneuservo, libpneuservo.so and its AVX2 build under glibc-hwcaps/x86-64-v3, headers and CMake package of the
#   estimator, configs, docs, man pages, systemd units, limits and udev rules; the Python package for Debian's python3.
if(NOT PNEUSERVO_SHARED_LIBRARY)
  return()
endif()

set(PNEUSERVO_SHARE ${CMAKE_INSTALL_DATADIR}/pneuservo)
set(PNEUSERVO_DEBIAN ${CMAKE_CURRENT_SOURCE_DIR}/cmake/debian)
install(DIRECTORY config DESTINATION ${PNEUSERVO_SHARE} COMPONENT program)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
# A CiA 402 master in Python, where a program of one's own begins (docs/your-axis.md).
install(PROGRAMS tools/canopen-master DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT program)
install(FILES tools/local_can.py DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT program)
install(FILES ${PNEUSERVO_DEBIAN}/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES ${PNEUSERVO_DEBIAN}/pneuservo@.service ${PNEUSERVO_DEBIAN}/pneuservo-guard@.service
  DESTINATION /usr/lib/systemd/system COMPONENT program)
install(FILES ${PNEUSERVO_DEBIAN}/60-pneuservo.rules DESTINATION /usr/lib/udev/rules.d COMPONENT program)
install(FILES ${PNEUSERVO_DEBIAN}/pneuservo-limits.conf DESTINATION /etc/security/limits.d RENAME pneuservo.conf
  COMPONENT program)
# One page for each verb from its own --help, and the keys of a config.
install(CODE "execute_process(COMMAND ${PNEUSERVO_DEBIAN}/man-pages ${PROJECT_BINARY_DIR}/pneuservo \
  \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pneuservo)
set(CPACK_PACKAGE_CONTACT "pneuservo developers <pneuservo@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "${PROJECT_DESCRIPTION}
 Fixed-step controller for air cylinders and air-bearing tables whose valve sits
 metres away: a pipeline estimator computes the chamber pressures from those at
 the valve. With a simulated plant, CANopen, recordings, reports, gain design and
 a diagnosis of what a model leaves out.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS adduser)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libeigen3-dev, rt-tests, can-utils, linux-image-rt-amd64")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PNEUSERVO_DEBIAN}/postinst;${PNEUSERVO_DEBIAN}/prerm;${PNEUSERVO_DEBIAN}/postrm;${PNEUSERVO_DEBIAN}/triggers;${PNEUSERVO_DEBIAN}/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};pneuservo;ALL;/")
if(PNEUSERVO_HAS_PYTHON)
  list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};pneuservo;python;/")
  # The controller does without Python. Before 3.12 a module is that of one version alone.
  set(python "${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}")
  set(relation "python3 (>= ${python})")
  if(Python_VERSION VERSION_LESS 3.12)
    math(EXPR next "${Python_VERSION_MINOR} + 1")
    string(APPEND relation ", python3 (<< ${Python_VERSION_MAJOR}.${next})")
  endif()
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "${relation}, python3-numpy (>= 1:1.24)")
  string(APPEND CPACK_DEBIAN_PACKAGE_SUGGESTS ", python3-pandas, python3-scipy")
endif()
set(PNEUSERVO_OTHER_BUILD "" CACHE PATH "Build folder whose shared library goes into the package too")
if(PNEUSERVO_OTHER_BUILD)
  list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${PNEUSERVO_OTHER_BUILD};pneuservo;library;/")
  if(PNEUSERVO_HAS_PYTHON)
    list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${PNEUSERVO_OTHER_BUILD};pneuservo;python-newer;/")
  endif()
endif()
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(CPACK_STRIP_FILES ON)
include(CPack)
