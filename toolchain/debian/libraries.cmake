# SPDX-License-Identifier: Apache-2.0
# Read by CPack before it makes the packages: adds the libraries that each program was linked with to
# the dependencies of its package, in the versions that dpkg-shlibdeps finds.
set(work ${CPACK_PACKAGE_DIRECTORY}/libraries)
file(WRITE ${work}/debian/control "Source: condyle\n\nPackage: condyle\nArchitecture: any\n")
set(options -O)
if(CPACK_CONDYLE_SYSROOT)
  list(APPEND options --admindir=${CPACK_CONDYLE_SYSROOT}/../database
    -l${CPACK_CONDYLE_SYSROOT}/lib/${CPACK_CONDYLE_TRIPLET}
    -l${CPACK_CONDYLE_SYSROOT}/usr/lib/${CPACK_CONDYLE_TRIPLET})
endif()
foreach(component program IN ZIP_LISTS CPACK_CONDYLE_COMPONENTS CPACK_CONDYLE_PROGRAMS)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -E env DEB_HOST_ARCH=${CPACK_DEBIAN_PACKAGE_ARCHITECTURE}
      dpkg-shlibdeps ${options} ${program}
    WORKING_DIRECTORY ${work} OUTPUT_VARIABLE found ERROR_VARIABLE error RESULT_VARIABLE result)
  if(NOT result EQUAL 0 OR NOT found MATCHES "shlibs:Depends=([^\n]+)")
    message(FATAL_ERROR "dpkg-shlibdeps lists no dependencies of ${program}: ${found}${error}")
  endif()
  string(APPEND CPACK_DEBIAN_${component}_PACKAGE_DEPENDS ", ${CMAKE_MATCH_1}")
endforeach()
