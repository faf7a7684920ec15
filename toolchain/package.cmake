# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` installs: find_package(condyle) gives condyle::estimator and condyle::hal; with
# COMPONENTS device_path also condyle::devices, condyle::session_log and condyle::capture, which need
# hidapi, libusb, libzstd, zlib and libpcap.
include(CMakePackageConfigHelpers)

set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/condyle)
install(TARGETS condyle_floating_point condyle_estimator condyle_hal EXPORT condyle_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS condyle_devices condyle_session_log condyle_capture EXPORT condyle_device_path_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY estimator/include/condyle hal/include/condyle
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)
install(EXPORT condyle_targets NAMESPACE condyle:: DESTINATION ${package_directory})
install(EXPORT condyle_device_path_targets NAMESPACE condyle:: DESTINATION ${package_directory})
configure_package_config_file(toolchain/condyle_config.cmake.in
  ${PROJECT_BINARY_DIR}/condyle-config.cmake INSTALL_DESTINATION ${package_directory})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/condyle-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/condyle-config.cmake
  ${PROJECT_BINARY_DIR}/condyle-config-version.cmake DESTINATION ${package_directory})
install(DIRECTORY hal/profiles DESTINATION ${CMAKE_INSTALL_DATADIR}/condyle COMPONENT common)
install(DIRECTORY hal/udev DESTINATION ${CMAKE_INSTALL_DATADIR}/condyle)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
