# SPDX-License-Identifier: Apache-2.0
# Cross-compiles for another architecture of Debian 12 with Debian's cross compiler, against that
# architecture's own packages, which toolchain/fetch_sysroot left in CONDYLE_SYSROOT. Included by the
# architecture's file, which sets CMAKE_SYSTEM_PROCESSOR, CMAKE_LIBRARY_ARCHITECTURE (Debian's
# multi-arch triplet) and CONDYLE_DEBIAN_ARCHITECTURE.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_CXX_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-g++)
# Without these the cross compiler 12.2.0-14cross1 for aarch64 drops the call of
# LibusbSource::submit_idle in read, as if it did nothing; neither the native GCC nor clang for aarch64
# does.
string(APPEND CMAKE_CXX_FLAGS_INIT " -fno-ipa-modref -fno-ipa-pure-const")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CONDYLE_SYSROOT)
set(CMAKE_SYSROOT ${CONDYLE_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR}
  ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)
# The command writes its own manual pages while it is built.
find_program(CONDYLE_EMULATOR qemu-${CONDYLE_EMULATED}-static)
if(CONDYLE_EMULATOR)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${CONDYLE_EMULATOR} -L ${CONDYLE_SYSROOT})
endif()
