// SPDX-License-Identifier: Apache-2.0
// What makes a report layout usable. No words here: profile_check.h has them.
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
  coordinates,  ///< `index`: in ReportContent::coordinates, if it is in there
  device_time,
  sequence,
  checksum,
  drive,
  auxiliary,  ///< `index`: in the auxiliary fields, if it is in there
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
  missing_value_impossible,  ///< its bits never hold it
  range_impossible,          ///< likewise, or the range is empty
  shares_bits,               ///< with the field at `other_part`, `other_index`
  // A count or clock
  count_not_unsigned,
  wraps_beyond_width,
  wraps_too_soon,  ///< nothing can be told from so few values
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

/// Why a layout cannot be used.
struct LayoutProblem {
  ProfilePart part = ProfilePart::coordinates;
  std::size_t index = 0;
  LayoutFault fault = LayoutFault::rate_not_usable;
  ProfilePart other_part = ProfilePart::coordinates;
  std::size_t other_index = 0;
};

/// What is known of a report's coordinates and size.
enum class LayoutState : std::uint8_t {
  complete,
  awaits_descriptor,  ///< neither is asked for: the report descriptor is to supply them
};

/// The first problem of `layout`: a field outside the report or across another one, coordinates
/// missing or given twice, a scale of zero, ... A layout without any coordinate is one of another
/// instrument, which has a drive or auxiliary fields instead. No heap, no exceptions.
std::optional<LayoutProblem> find_layout_problem(const ReportLayout& layout,
                                                 LayoutState state = LayoutState::complete);

/// The size that a field of `content` must lie in (bytes): any report's, where the descriptor is to
/// tell it.
std::size_t size_to_lie_in(const ReportContent& content, LayoutState state);

/// Raw values that `field` can hold; all of int64 where it is as wide.
RawRange possible_values(const ReportField& field);

}  // namespace condyle::hal
