# SPDX-License-Identifier: Apache-2.0
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CONDYLE_DEBIAN_ARCHITECTURE arm64)
set(CONDYLE_EMULATED aarch64)
include(${CMAKE_CURRENT_LIST_DIR}/debian_cross.cmake)
