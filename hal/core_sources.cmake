# SPDX-License-Identifier: Apache-2.0
# Sources for targets without an operating system too: no heap, no exceptions, no strings.
set(condyle_hal_core_sources)
foreach(name
    link/link_archive
    link/link_frame
    link/link_messages
    report/checksum
    report/clock_fit
    report/device_facebow
    report/field_check
    report/layout_check
    report/report_counter
    report/report_decoder
    report/report_field
    report/report_tracker)
  list(APPEND condyle_hal_core_sources ${CMAKE_CURRENT_LIST_DIR}/src/${name}.cpp)
endforeach()
