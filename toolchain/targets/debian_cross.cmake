# SPDX-License-Identifier: Apache-2.0
# Cross-compiles with Debian's g++-aarch64-linux-gnu against the arm64 packages that fetch_guest left
# in CONDYLE_GUEST_ROOT.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
# Without these the cross compiler 12.2.0-14cross1 drops the call of LibusbSource::submit_idle in
# read, as if it did nothing; neither the native GCC nor clang for aarch64 does.
set(CMAKE_CXX_FLAGS_INIT "-fno-ipa-modref -fno-ipa-pure-const")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CONDYLE_GUEST_ROOT)
set(CMAKE_SYSROOT ${CONDYLE_GUEST_ROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)
