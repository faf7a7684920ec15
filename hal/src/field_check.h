// SPDX-License-Identifier: Apache-2.0
// The checks of one field of a profile, each by itself. Library-private: find_problem calls them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "condyle/hal/device_profile.h"

namespace condyle::hal {

/// What is wrong with a field, and what to do.
struct FieldProblem {
  std::string reason, mend;
};

/// Place, type and scale of a field of `profile`.
std::optional<FieldProblem> check_field(const ReportField& field, const DeviceProfile& profile);

/// A count, its field checked already, of at least `fewest` values.
std::optional<FieldProblem> check_counting(const CountingField& counting, std::uint64_t fewest);

/// A clock, checked as a count already. `rate_Hz`: of the reports; 0: not known.
std::optional<FieldProblem> check_clock(const CountingField& clock, double rate_Hz);

/// A checksum, its field checked already, of reports of `size_bytes`; 0: not known.
std::optional<FieldProblem> check_checksum(const Checksum& checksum, std::size_t size_bytes);

}  // namespace condyle::hal
