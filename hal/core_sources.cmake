# SPDX-License-Identifier: Apache-2.0
# What a target without an operating system uses too: no heap, no exceptions, no strings.
set(condyle_hal_core_sources)
foreach(name
    checksum
    clock_fit
    device_facebow
    field_check
    layout_check
    link_archive
    link_frame
    link_messages
    report_counter
    report_decoder
    report_field
    report_tracker)
  list(APPEND condyle_hal_core_sources ${CMAKE_CURRENT_LIST_DIR}/src/${name}.cpp)
endforeach()
