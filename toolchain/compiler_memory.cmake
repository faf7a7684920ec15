# SPDX-License-Identifier: Apache-2.0
# GCC 12 collects its garbage once it holds 128 MB, repeatedly if templates need more. From
# 512 MB on, compiling takes up to a third less time and about 100 MB more (kB here).
add_compile_options($<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)
