// SPDX-License-Identifier: Apache-2.0
// From the bytes of a report to measured values, by a layout. No heap, no exceptions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "condyle/hal/report/report_field.h"
#include "condyle/hal/report/report_layout.h"

namespace condyle::hal {

/// Why a report could not be decoded.
enum class [[nodiscard]] ReportFault : std::uint8_t{
    none,
    other_report,          ///< another report id; not an error
    too_short,             ///< below the layout's minimum size
    wrong_checksum,        ///< damaged on the way
    counter_out_of_range,  ///< sequence or clock at or beyond its `wraps_at`
    unusable_profile,      ///< see find_layout_problem (layout_check.h)
};

/// Name of a fault in messages.
constexpr const char* fault_name(ReportFault fault) {
  constexpr const char* names[] = {"none",           "other report",         "too short",
                                   "wrong checksum", "counter out of range", "unusable profile"};
  return names[static_cast<int>(fault)];
}

/// The content of one report.
struct DecodedReport {
  SampleKind kind = SampleKind::one_point;
  std::array<double, 9> coordinates{};  ///< as in Sample (m); NaN if not measured
  bool position_valid = false;          ///< as in Sample
  double drive_N = 0;
  bool drive_valid = false;
  std::optional<std::uint64_t> device_time;  ///< raw ticks
  std::optional<std::uint64_t> sequence;     ///< raw count
  std::size_t auxiliary_count = 0;
  std::array<MeasuredValue, kMaxAuxiliary> auxiliary{};  ///< in the layout's order, SI
};

/// Decodes the reports of one layout. Decoding allocates nothing and changes nothing here.
class ReportDecoder {
 public:
  /// `layout`: layout_of(profile) (profile_check.h), if there is a profile.
  explicit ReportDecoder(const ReportLayout& layout);

  /// Decodes any `bytes`. `report` is written only with ReportFault::none. A quaternion is
  /// normalised; if its length is off by more than 1 %, the position is not valid.
  ReportFault decode(std::span<const std::uint8_t> bytes, DecodedReport& report) const;

  /// The layout it was built with.
  const ReportLayout& layout() const { return layout_; }

 private:
  ReportLayout layout_;
  bool is_usable_;
};

}  // namespace condyle::hal
