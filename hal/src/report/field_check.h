// SPDX-License-Identifier: Apache-2.0
// The checks of one field of a layout, each by itself. Library-private: find_layout_problem calls
// them.
#pragma once

#include <cstdint>
#include <optional>

#include "condyle/hal/report/layout_check.h"

namespace condyle::hal {

/// Place, type and scale of a field of `layout`.
std::optional<LayoutFault> check_field(const ReportField& field, const ReportLayout& layout,
                                       LayoutState state);

/// A count, its field checked already, of at least `fewest` values.
std::optional<LayoutFault> check_counting(const CountingField& counting, std::uint64_t fewest);

/// A clock, checked as a count already. `rate_Hz`: of the reports; 0: not known.
std::optional<LayoutFault> check_clock(const CountingField& clock, double rate_Hz);

/// A checksum, its field checked already, of reports of `size_bytes`; 0: not known.
std::optional<LayoutFault> check_checksum(const Checksum& checksum, std::size_t size_bytes);

}  // namespace condyle::hal
