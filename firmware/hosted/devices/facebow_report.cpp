// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/facebow_report.h"

namespace condyle::host::fake {
namespace {

template <typename Unsigned>
void put(FacebowReport& report, std::size_t offset, Unsigned value) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    report[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  constexpr unsigned polynomial = 0x1021;
  unsigned crc = 0xffff;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<unsigned>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? crc << 1U ^ polynomial : crc << 1U;
    }
    crc &= 0xffffU;
  }
  return static_cast<std::uint16_t>(crc);
}

void seal(FacebowReport& report) {
  put(report, kChecksumOffset, crc16(std::span(report).first(kChecksumOffset)));
}

FacebowReport encode(const ReportContent& content) {
  FacebowReport report{};
  report[0] = kReportId;
  put(report, 1, content.counter);
  put(report, 5, content.time_us);
  for (std::size_t i = 0; i < content.coordinates.size(); ++i) {
    put(report, 9 + 2 * i, static_cast<std::uint16_t>(content.coordinates[i]));
  }
  seal(report);
  return report;
}

}  // namespace condyle::host::fake
