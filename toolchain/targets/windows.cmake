# SPDX-License-Identifier: Apache-2.0
# Cross-compiles for 64-bit Windows 10 (1903) and later with Debian's mingw-w64, against the libraries
# that toolchain/build_windows_libraries left in CONDYLE_SYSROOT. The program needs no DLL but those
# of Windows.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CONDYLE_SYSROOT)
# 0x0A00: Windows 10.
string(APPEND CMAKE_C_FLAGS_INIT " -D_WIN32_WINNT=0x0A00")
string(APPEND CMAKE_CXX_FLAGS_INIT " -D_WIN32_WINNT=0x0A00 -D_FILE_OFFSET_BITS=64 -D__USE_MINGW_ANSI_STDIO=1")
string(APPEND CMAKE_EXE_LINKER_FLAGS_INIT " -static -Wl,--wrap=mbrtowc")
set(ZLIB_LIBRARY /usr/x86_64-w64-mingw32/lib/libz.a CACHE FILEPATH "not the DLL")
set(CMAKE_FIND_ROOT_PATH ${CONDYLE_SYSROOT} /usr/x86_64-w64-mingw32)
set(CMAKE_PREFIX_PATH ${CONDYLE_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "")
set(ENV{PKG_CONFIG_LIBDIR} ${CONDYLE_SYSROOT}/lib/pkgconfig:${CONDYLE_SYSROOT}/share/pkgconfig)
