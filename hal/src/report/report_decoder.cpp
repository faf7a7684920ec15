// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/report_decoder.h"

#include <cmath>
#include <limits>

#include "condyle/hal/report/checksum.h"
#include "condyle/hal/report/layout_check.h"

namespace condyle::hal {
namespace {

constexpr double kMostLengthError = 0.01;  // of a quaternion: far above 8-bit rounding

bool is_intact(const Checksum& checksum, std::span<const std::uint8_t> bytes) {
  const auto covered = bytes.subspan(checksum.first_byte, checksum.end_byte - checksum.first_byte);
  return read_raw(checksum.field, bytes) == checksum_of(checksum, covered);
}

// False if the device cannot produce this count.
bool read_count(const std::optional<CountingField>& counting, std::span<const std::uint8_t> bytes,
                std::optional<std::uint64_t>& count) {
  if (!counting) return true;
  count = read_raw(counting->field, bytes);
  return counting->wraps_at == 0 || *count < counting->wraps_at;
}

// Rounded components are not a unit quaternion; zeros are not a quaternion at all.
bool normalise_quaternion(double* wxyz) {
  const double length =
      std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
  if (!(std::abs(length - 1) <= kMostLengthError)) return false;
  for (int i = 0; i < 4; ++i) wxyz[i] /= length;
  return true;
}

}  // namespace

ReportDecoder::ReportDecoder(const ReportLayout& layout)
    : layout_(layout), is_usable_(!find_layout_problem(layout)) {}

ReportFault ReportDecoder::decode(std::span<const std::uint8_t> bytes,
                                  DecodedReport& report) const {
  if (!is_usable_) return ReportFault::unusable_profile;
  if (bytes.empty()) return ReportFault::too_short;
  if (layout_.report_id && bytes[0] != *layout_.report_id) return ReportFault::other_report;
  if (bytes.size() < layout_.minimum_size_bytes) return ReportFault::too_short;
  if (layout_.checksum && !is_intact(*layout_.checksum, bytes)) {
    return ReportFault::wrong_checksum;
  }
  DecodedReport decoded;
  if (!read_count(layout_.sequence, bytes, decoded.sequence) ||
      !read_count(layout_.device_time, bytes, decoded.device_time)) {
    return ReportFault::counter_out_of_range;
  }
  decoded.kind = layout_.kind;
  decoded.position_valid = !layout_.coordinates.empty();
  if (!decoded.position_valid) {
    decoded.coordinates.fill(std::numeric_limits<double>::quiet_NaN());
  }
  for (const CoordinateField& coordinate : layout_.coordinates) {
    const MeasuredValue measured = read_value(coordinate.field, bytes);
    decoded.coordinates[coordinate.index] = measured.value;
    decoded.position_valid = decoded.position_valid && measured.valid;
  }
  if (is_out_of_range(decoded.kind, decoded.coordinates.data())) decoded.position_valid = false;
  if (decoded.position_valid && decoded.kind == SampleKind::pose) {
    decoded.position_valid = normalise_quaternion(&decoded.coordinates[3]);
  }
  if (layout_.drive_N) {
    const MeasuredValue drive = read_value(*layout_.drive_N, bytes);
    decoded.drive_N = drive.value;
    decoded.drive_valid = drive.valid;
  }
  for (const ReportField& field : layout_.auxiliary) {
    decoded.auxiliary[decoded.auxiliary_count++] = read_value(field, bytes);
  }
  report = decoded;
  return ReportFault::none;
}

}  // namespace condyle::hal
