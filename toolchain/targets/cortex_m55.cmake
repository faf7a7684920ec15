# SPDX-License-Identifier: Apache-2.0
set(CMAKE_SYSTEM_PROCESSOR cortex-m55)
# Without its vectors, which treat the smallest numbers as 0.
set(CONDYLE_CORE_FLAGS -mcpu=cortex-m55+nomve)
include(${CMAKE_CURRENT_LIST_DIR}/cortex_m.cmake)
