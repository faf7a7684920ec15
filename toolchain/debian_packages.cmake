# SPDX-License-Identifier: Apache-2.0
# Debian packages, by CPack: condyle (the command), condyle-box (the service), condyle-common (files
# for both), libcondyle0, libcondyle-dev and python3-condyle (the interfaces for other languages).
# toolchain/make_packages makes them.
set(CONDYLE_MAINTAINER "The condyle authors <condyle@example.org>" CACHE STRING
  "Maintainer of the packages: NAME <ADDRESS>; the default is a placeholder")

set(documents share/doc)
set(package_of_command condyle)
set(package_of_box condyle-box)
set(package_of_common condyle-common)
set(package_of_library libcondyle${PROJECT_VERSION_MAJOR})
set(package_of_development libcondyle-dev)
set(package_of_python python3-condyle)
foreach(component command box common library development python)
  set(package ${package_of_${component}})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package})
  install(FILES toolchain/debian/copyright DESTINATION ${documents}/${package}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_BINARY_DIR}/changelog.Debian.gz DESTINATION ${documents}/${package}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
configure_file(toolchain/debian/changelog.in ${PROJECT_BINARY_DIR}/changelog.Debian @ONLY)
find_program(gzip gzip)
if(gzip)
  execute_process(COMMAND ${gzip} -9nfk ${PROJECT_BINARY_DIR}/changelog.Debian)
endif()

# Debian's own folders, whatever the prefix; so not part of a plain `cmake --install`.
if(CONDYLE_BUILD_BOX)
  install(FILES firmware/box/box.toml DESTINATION /etc/condyle COMPONENT box EXCLUDE_FROM_ALL)
  install(FILES firmware/box/condyle-box.service DESTINATION /lib/systemd/system
    COMPONENT box EXCLUDE_FROM_ALL)
  install(FILES firmware/box/condyle-box.sysusers DESTINATION /usr/lib/sysusers.d
    RENAME condyle-box.conf COMPONENT box EXCLUDE_FROM_ALL)
endif()
install(FILES hal/udev/70-condyle-facebow.rules DESTINATION /lib/udev/rules.d
  COMPONENT common EXCLUDE_FROM_ALL)
# The pages, in their folders, so that their links to each other work.
file(GLOB pages RELATIVE ${PROJECT_SOURCE_DIR} README.md estimator/README.md hal/README.md
  hal/profiles/README.md firmware/README.md firmware/*/README.md firmware/box/SECURITY.md
  host_sim/README.md host_sim/docs/*.md host_sim/docs/*.png)
foreach(page ${pages})
  get_filename_component(folder ${page} DIRECTORY)
  install(FILES ${page} DESTINATION ${documents}/condyle-common/${folder}
    COMPONENT common EXCLUDE_FROM_ALL)
endforeach()

# What they hold, without the tests.
add_custom_target(packaged)
foreach(target condyle condyle_api condyle_manual condyle-box)
  if(TARGET ${target})
    add_dependencies(packaged ${target})
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL common)
if(CONDYLE_BUILD_COMMAND)
  list(APPEND CPACK_COMPONENTS_ALL command)
  list(APPEND CPACK_CONDYLE_COMPONENTS COMMAND)
  list(APPEND CPACK_CONDYLE_PROGRAMS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/condyle)
endif()
if(TARGET condyle_api)
  list(APPEND CPACK_COMPONENTS_ALL library development python)
  list(APPEND CPACK_CONDYLE_COMPONENTS LIBRARY)
  list(APPEND CPACK_CONDYLE_PROGRAMS ${PROJECT_BINARY_DIR}/lib/libcondyle.so.${PROJECT_VERSION})
endif()
if(CONDYLE_BUILD_BOX)
  list(APPEND CPACK_COMPONENTS_ALL box)
  list(APPEND CPACK_CONDYLE_COMPONENTS BOX)
  list(APPEND CPACK_CONDYLE_PROGRAMS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/condyle-box)
endif()
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/toolchain/debian/libraries.cmake)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGE_CONTACT ${CONDYLE_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${CONDYLE_DEBIAN_ARCHITECTURE})
  set(CPACK_CONDYLE_SYSROOT ${CONDYLE_SYSROOT})
  set(CPACK_CONDYLE_TRIPLET ${CMAKE_LIBRARY_ARCHITECTURE})
else()
  execute_process(COMMAND dpkg --print-architecture OUTPUT_VARIABLE CPACK_DEBIAN_PACKAGE_ARCHITECTURE
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(same_version "condyle-common (= ${PROJECT_VERSION}-1)")

set(CPACK_DEBIAN_COMMON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_COMMON_DESCRIPTION "virtual sensor for jaw motion: device profiles
Files that the command condyle and the service condyle-box share: what the
reports of facebows (optical jaw trackers) mean, a udev rule for reading them
without being root, and the guide. Research use only.")

set(CPACK_DEBIAN_COMMAND_DESCRIPTION "virtual sensor for jaw motion: the command
Estimates velocity, force, friction and mass of the lower jaw from positions
that a facebow (an optical jaw tracker) measures, in recordings or live, and
says of each value whether it was measured, derived or assumed. Research use
only; not a diagnosis.")
set(CPACK_DEBIAN_COMMAND_PACKAGE_DEPENDS ${same_version})
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS gnuplot-nox)

set(CPACK_DEBIAN_BOX_DESCRIPTION "virtual sensor for jaw motion: the measurement box
A service for a small computer next to a facebow (an optical jaw tracker). It
sends estimates of the jaw's motion as they come, over UDP and HTTP, and
records sessions, unattended. Research use only; not a diagnosis.")
set(CPACK_DEBIAN_BOX_PACKAGE_DEPENDS "${same_version}, systemd | systemd-standalone-sysusers")
set(CPACK_DEBIAN_BOX_PACKAGE_RECOMMENDS condyle)
set(same_library "${package_of_library} (= ${PROJECT_VERSION}-1)")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
configure_file(toolchain/debian/library/shlibs.in ${PROJECT_BINARY_DIR}/debian/shlibs @ONLY)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA
  "${PROJECT_BINARY_DIR}/debian/shlibs;${PROJECT_SOURCE_DIR}/toolchain/debian/library/triggers")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "virtual sensor for jaw motion: the shared library
Reads recordings of jaw motion, estimates velocity, force, friction and mass
of the lower jaw from positions, and reads range of motion and chewing, for
programs in C and in languages that can call C. Research use only.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ${same_version})

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "virtual sensor for jaw motion: C header, MEX file
What a program in C needs to use the library of condyle, and the source of a
MEX file for MATLAB and Octave. Research use only.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ${same_library})

set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "virtual sensor for jaw motion: Python package
Recordings of jaw motion, estimates and readings as numpy arrays. Research use
only; not a diagnosis.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${same_library}, python3 (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_COMMON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/toolchain/debian/common/postinst)
set(control ${PROJECT_SOURCE_DIR}/toolchain/debian/box)
set(CPACK_DEBIAN_BOX_PACKAGE_CONTROL_EXTRA
  "${control}/conffiles;${control}/postinst;${control}/prerm;${control}/postrm")
include(CPack)
