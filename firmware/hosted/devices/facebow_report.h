// SPDX-License-Identifier: Apache-2.0
// The fake facebow's report, little endian:
//
//   byte 0       report id, 1
//   bytes 1-4    unsigned counter, one more a report
//   bytes 5-8    unsigned device time in microseconds
//   bytes 9-26   nine signed 16-bit coordinates x1 y1 z1 x2 y2 z2 x3 y3 z3 in units of 4 um;
//                -32768: the point is not seen
//   bytes 27-28  CRC-16/CCITT-FALSE over bytes 0-26
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace condyle::host::fake {

inline constexpr std::uint8_t kReportId = 1;
inline constexpr std::size_t kReportSize = 29;
inline constexpr std::size_t kChecksumOffset = kReportSize - 2;
inline constexpr double kCoordinateUnit_m = 4e-6;
inline constexpr std::int16_t kNotSeen = -32768;

using FacebowReport = std::array<std::uint8_t, kReportSize>;
using RawCoordinates = std::array<std::int16_t, 9>;

/// What a report holds.
struct ReportContent {
  std::uint32_t counter = 0;
  std::uint32_t time_us = 0;
  RawCoordinates coordinates{};
};

/// CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xffff, nothing reflected, no final xor.
std::uint16_t crc16(std::span<const std::uint8_t> bytes);

/// Writes the checksum of `report` into it.
void seal(FacebowReport& report);

/// The report that holds `content`.
FacebowReport encode(const ReportContent& content);

}  // namespace condyle::host::fake
