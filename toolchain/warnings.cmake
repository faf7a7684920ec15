# SPDX-License-Identifier: Apache-2.0
# Warnings for our own code. Never exported: a user's build keeps its own.
add_library(condyle_warnings INTERFACE)
target_compile_options(condyle_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
  -Wno-missing-field-initializers  # designated initialisers leave the rest at their defaults
  -Wold-style-cast -Wcast-qual -Wformat=2 -Wnon-virtual-dtor -Woverloaded-virtual -Wundef
  # -Wdouble-promotion is for float on a microcontroller; clang's also warns about long double in tests.
  $<$<CXX_COMPILER_ID:GNU>:-Wdouble-promotion -Wduplicated-cond -Wlogical-op>
  # 32-bit Arm: notes on compilers before GCC 7
  "$<$<IN_LIST:${CMAKE_SYSTEM_PROCESSOR},armv7l;cortex-m4;cortex-m7>:-Wno-psabi>"
  $<$<BOOL:${CONDYLE_WARNINGS_AS_ERRORS}>:-Werror>
  # There, numbers of 64 bits become narrower: an error, even where other warnings are not.
  "$<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},armv7l>:-Werror=conversion;-Werror=sign-conversion>")
