# SPDX-License-Identifier: Apache-2.0
# The zip for Windows, by CPack: condyle.exe, the pages and the data that their commands use, and the
# licences of what the program contains. toolchain/make_packages windows makes it.
install(PROGRAMS $<TARGET_FILE:condyle> DESTINATION . COMPONENT windows)
install(FILES LICENSE DESTINATION licences RENAME condyle.txt COMPONENT windows)
install(FILES toolchain/debian/copyright DESTINATION licences RENAME uPlot.txt COMPONENT windows)
install(DIRECTORY ${CONDYLE_SYSROOT}/../licences/ DESTINATION licences COMPONENT windows)
file(GLOB pages RELATIVE ${PROJECT_SOURCE_DIR} README.md estimator/README.md hal/README.md
  hal/profiles/* host_sim/README.md host_sim/docs/*.md host_sim/docs/*.png host_sim/recordings/*.md
  host_sim/recordings/*.csv host_sim/recordings/*.toml host_sim/scenarios/* host_sim/muscles/*)
foreach(page ${pages})
  get_filename_component(folder ${page} DIRECTORY)
  install(FILES ${page} DESTINATION ./${folder} COMPONENT windows)
endforeach()

set(CPACK_GENERATOR ZIP)
set(CPACK_COMPONENTS_ALL windows)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_INCLUDE_TOPLEVEL_DIRECTORY ON)
set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGE_FILE_NAME condyle_${PROJECT_VERSION}_windows)
include(CPack)
