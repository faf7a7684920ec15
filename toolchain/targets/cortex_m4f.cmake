# SPDX-License-Identifier: Apache-2.0
set(CMAKE_SYSTEM_PROCESSOR cortex-m4)
set(CONDYLE_CORE_FLAGS -mcpu=cortex-m4 -mfpu=fpv4-sp-d16)  # double is software
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
