// SPDX-License-Identifier: Apache-2.0
// Checks that a report layout is usable. profile_check.h puts the problems into words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "condyle/hal/report/report_layout.h"

namespace condyle::hal {

/// The part of a layout that a problem is in.
enum class ProfilePart : std::uint8_t {
  rate,
  minimum_size,
  coordinates,  ///< `index`: in ReportContent::coordinates, if there is one
  device_time,
  sequence,
  checksum,
  drive,
  auxiliary,  ///< `index`: in the auxiliary fields, if there is one
};

/// What is wrong with a layout.
enum class LayoutFault : std::uint8_t {
  rate_not_usable,  ///< negative or not finite
  size_not_usable,  ///< zero, or above kMaxReportSize
  // The coordinates as a whole
  no_such_coordinate,  ///< in this kind of sample
  coordinate_given_twice,
  coordinate_missing,  ///< `other_index`: which
  // A field
  width_not_usable,            ///< not 1 to 64 bits
  floating_width_not_usable,   ///< not 32 or 64 bits
  big_endian_of_broken_bytes,  ///< not of whole bytes
  on_report_id,
  beyond_report,
  scale_not_usable,  ///< zero or not finite
  offset_not_finite,
  missing_value_impossible,  ///< its bits cannot hold it
  range_impossible,          ///< its bits cannot hold it, or the range is empty
  shares_bits,               ///< with the field at `other_part`, `other_index`
  // A count or clock
  count_not_unsigned,
  wraps_beyond_width,
  wraps_too_soon,  ///< too few values to be useful
  tick_not_usable,
  clock_wraps_too_soon,  ///< before two reports have come
  // A checksum
  checksum_width_not_usable,  ///< not 8 or 16 bits
  checksum_field_differs,     ///< of another width or type
  checksum_parameters_too_wide,
  checksum_covers_nothing,
  checksum_beyond_report,
  checksum_covers_itself,
};

/// Why a layout is unusable.
struct LayoutProblem {
  ProfilePart part = ProfilePart::coordinates;
  std::size_t index = 0;
  LayoutFault fault = LayoutFault::rate_not_usable;
  ProfilePart other_part = ProfilePart::coordinates;
  std::size_t other_index = 0;
};

/// What is given of a report's coordinates and size.
enum class LayoutState : std::uint8_t {
  complete,
  awaits_descriptor,  ///< neither is checked: the report descriptor will supply them
};

/// The first problem of `layout`: a field outside the report or overlapping another, coordinates
/// missing or given twice, a scale of zero, ... A layout without coordinates belongs to another
/// instrument, which has a drive or auxiliary fields instead. No heap, no exceptions.
std::optional<LayoutProblem> find_layout_problem(const ReportLayout& layout,
                                                 LayoutState state = LayoutState::complete);

/// The size in which a field of `content` must lie (bytes): that of any report if the descriptor
/// will supply it.
std::size_t size_to_lie_in(const ReportContent& content, LayoutState state);

/// Raw values that `field` can hold; all of int64 if it is that wide.
RawRange possible_values(const ReportField& field);

}  // namespace condyle::hal
