# SPDX-License-Identifier: Apache-2.0
set(CMAKE_SYSTEM_PROCESSOR cortex-m33)
set(CONDYLE_CORE_FLAGS -mcpu=cortex-m33 -mfpu=fpv5-sp-d16)  # double is software
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
