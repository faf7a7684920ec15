# SPDX-License-Identifier: Apache-2.0
# The floating-point rules of every target, on every machine, also of programs that use the
# installed package: the same sample gives the same estimate, bit for bit.
add_library(condyle_floating_point INTERFACE)
add_library(condyle::floating_point ALIAS condyle_floating_point)
set_target_properties(condyle_floating_point PROPERTIES EXPORT_NAME floating_point)

target_compile_options(condyle_floating_point INTERFACE
  -ffp-contract=off  # no fused multiply-add that one CPU has and another has not
  -fno-math-errno    # sqrt is the instruction; its result is the same
  # 32-bit x86 would keep 80-bit intermediates in the x87 unit.
  $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},i686>:-msse2$<SEMICOLON>-mfpmath=sse>)
target_compile_definitions(condyle_floating_point INTERFACE
  EIGEN_DONT_VECTORIZE        # one order of operations, whatever the vector unit
  EIGEN_DONT_PARALLELIZE
  EIGEN_MAX_STATIC_ALIGN_BYTES=0)
