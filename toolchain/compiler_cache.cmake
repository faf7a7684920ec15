# SPDX-License-Identifier: Apache-2.0
# ccache, if present. Paths below the project are relative to it, so that a clone in another folder
# finds the compiled files of this one. The flags are part of the key, so presets stay separate.
option(CONDYLE_COMPILER_CACHE "Compile through ccache if it is present" ON)
find_program(CONDYLE_CCACHE ccache)
if(CONDYLE_COMPILER_CACHE AND CONDYLE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
    CCACHE_DEPEND=1 CCACHE_INODECACHE=1
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    list(APPEND CMAKE_CXX_COMPILER_LAUNCHER CCACHE_PCH_EXTSUM=1
      ${CMAKE_CURRENT_LIST_DIR}/compile_cached)
    # CMake's own options hide the path of the header behind -Xclang, where ccache leaves it absolute.
    set(CMAKE_CXX_COMPILE_OPTIONS_USE_PCH -include-pch <PCH_FILE>)
  else()
    list(APPEND CMAKE_CXX_COMPILER_LAUNCHER ${CONDYLE_CCACHE})
  endif()
endif()
