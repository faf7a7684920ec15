# SPDX-License-Identifier: Apache-2.0
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CMAKE_LIBRARY_ARCHITECTURE arm-linux-gnueabihf)
set(CONDYLE_DEBIAN_ARCHITECTURE armhf)
set(CMAKE_CXX_FLAGS_INIT "-D_FILE_OFFSET_BITS=64")  # session logs above 2 GB
include(${CMAKE_CURRENT_LIST_DIR}/debian_cross.cmake)
