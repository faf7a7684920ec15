// SPDX-License-Identifier: Apache-2.0
// Checks each field of a layout by itself. Library-private: find_layout_problem calls these
// functions.
#pragma once

#include <cstdint>
#include <optional>

#include "condyle/hal/report/layout_check.h"

namespace condyle::hal {

/// Checks place, type and scale of a field of `layout`.
std::optional<LayoutFault> check_field(const ReportField& field, const ReportLayout& layout,
                                       LayoutState state);

/// Checks a count of at least `fewest` values, whose field is already checked.
std::optional<LayoutFault> check_counting(const CountingField& counting, std::uint64_t fewest);

/// Checks a clock, already checked as a count. `rate_Hz`: of the reports; 0: not known.
std::optional<LayoutFault> check_clock(const CountingField& clock, double rate_Hz);

/// Checks a checksum, whose field is already checked, in reports of `size_bytes`; 0: not known.
std::optional<LayoutFault> check_checksum(const Checksum& checksum, std::size_t size_bytes);

}  // namespace condyle::hal
