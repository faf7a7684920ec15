# SPDX-License-Identifier: Apache-2.0
# Cross-compiles for a Cortex-M without an operating system, with Debian's gcc-arm-none-eabi and newlib.
# Included by the core's file, which sets CMAKE_SYSTEM_PROCESSOR and CONDYLE_CORE_FLAGS.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # a program needs a board's linker script

string(JOIN " " CMAKE_CXX_FLAGS_INIT
  ${CONDYLE_CORE_FLAGS} -mthumb -mfloat-abi=hard
  -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit
  -fno-unwind-tables -fno-asynchronous-unwind-tables
  -ffunction-sections -fdata-sections)
# Eigen's own assertion prints, which needs malloc; a trap is a fault, and a fault is recorded and reported.
set(CMAKE_CXX_FLAGS_DEBUG_INIT
  "\"-Deigen_assert(condition)=((condition) ? static_cast<void>(0) : __builtin_trap())\"")
string(JOIN " " CMAKE_EXE_LINKER_FLAGS_INIT
  -nostartfiles --specs=nano.specs --specs=nosys.specs -Wl,--gc-sections,--fatal-warnings)

# Eigen has headers only, the same for every machine.
set(CMAKE_PREFIX_PATH /usr)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
