# SPDX-License-Identifier: Apache-2.0
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CMAKE_LIBRARY_ARCHITECTURE arm-linux-gnueabihf)
set(CONDYLE_DEBIAN_ARCHITECTURE armhf)
set(CONDYLE_EMULATED arm)
include(${CMAKE_CURRENT_LIST_DIR}/debian_cross.cmake)
