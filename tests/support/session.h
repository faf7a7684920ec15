// SPDX-License-Identifier: Apache-2.0
// Sessions for tests: headers and reports.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <string>
#include <thread>

#include "condyle/hal/log/session_log.h"

namespace condyle::testing_support {

inline hal::SessionHeader make_header(std::size_t sources = 1) {
  hal::SessionHeader header;
  header.software_version = "0.1.0";
  header.subject_code = "S-07_b";
  header.parameters_toml = "# parameters\nmass_kg = 0.2\n";
  header.start_wall_ns = 1'790'000'000'000'000'000;
  header.start_monotonic_ns = 5'000'000'000;
  for (std::size_t i = 0; i < sources; ++i) {
    hal::SessionSource source;
    source.name = "device_" + std::to_string(i);
    source.vendor_id = 0x1209;
    source.product_id = static_cast<std::uint16_t>(1 + i);
    source.profile_toml = "name = \"device " + std::to_string(i) + "\"\n";
    for (int byte = 0; byte < 40; ++byte) {
      source.report_descriptor.push_back(static_cast<std::uint8_t>(byte * 7));
    }
    header.sources.push_back(source);
  }
  return header;
}

/// Report `number` of a run: its bytes follow from the number and size alone.
inline hal::RawReport make_report(std::uint32_t number, std::uint16_t size, TimeNs time_ns) {
  hal::RawReport report;
  report.host_time_ns = time_ns;
  report.size = size;
  std::minstd_rand random(number + 1);
  for (std::size_t i = 0; i < size; ++i)
    report.bytes[i] = static_cast<std::uint8_t>(random() >> 8U);
  for (std::size_t i = 0; i < 4 && i < size; ++i) {
    report.bytes[i] = static_cast<std::uint8_t>(number >> (8 * i));
  }
  return report;
}

inline bool is_same(const hal::RawReport& left, const hal::RawReport& right) {
  return left.host_time_ns == right.host_time_ns && left.size == right.size &&
         std::equal(left.data().begin(), left.data().end(), right.data().begin());
}

/// Waits until the writer has written all `reports` that it accepted; false if it fails.
inline bool wait_until_written(const hal::SessionLogWriter& log, std::uint64_t reports) {
  hal::SessionLogStatus status = log.status();
  while (status.reports_written < reports && status.failure == hal::SessionLogFailure::none) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    status = log.status();
  }
  return status.reports_written == reports;
}

}  // namespace condyle::testing_support
