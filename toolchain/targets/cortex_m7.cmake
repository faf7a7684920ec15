# SPDX-License-Identifier: Apache-2.0
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(CONDYLE_CORE_FLAGS -mcpu=cortex-m7 -mfpu=fpv5-d16)
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
