// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "condyle/hal/log/session_log_reader.h"

namespace condyle::testing_support {

/// The content of a log.
struct ReadLog {
  hal::Status opened = hal::Status::not_open;
  hal::SessionHeader header;
  std::vector<std::vector<hal::RawReport>> reports;  // by source
  struct Event {
    std::size_t source_index, reports_before;
    hal::SessionEventRecord event;
    std::string text;
  };
  std::vector<Event> events;
  hal::SessionLogCondition condition;
};

inline ReadLog read_log(const std::string& path) {
  ReadLog log;
  hal::SessionLogReader reader;
  log.opened = reader.open(path);
  if (log.opened == hal::Status::ok) {
    log.header = reader.header();
    log.reports.resize(log.header.sources.size());
    hal::SessionEntry entry;
    while (reader.next(entry) == hal::McapRead::record) {
      auto& reports = log.reports.at(entry.source_index);
      if (entry.is_event) {
        log.events.push_back(
            {entry.source_index, reports.size(), entry.event, std::string(entry.event.text)});
      } else {
        reports.push_back(entry.report);
      }
    }
  }
  log.condition = reader.condition();
  return log;
}

inline void expect_same(const hal::SessionHeader& left, const hal::SessionHeader& right) {
  EXPECT_EQ(left.software_version, right.software_version);
  EXPECT_EQ(left.subject_code, right.subject_code);
  EXPECT_EQ(left.parameters_toml, right.parameters_toml);
  EXPECT_EQ(left.begun_with_json, right.begun_with_json);
  EXPECT_EQ(left.start_wall_ns, right.start_wall_ns);
  EXPECT_EQ(left.start_monotonic_ns, right.start_monotonic_ns);
  ASSERT_EQ(left.sources.size(), right.sources.size());
  for (std::size_t i = 0; i < left.sources.size(); ++i) {
    EXPECT_EQ(left.sources[i].name, right.sources[i].name);
    EXPECT_EQ(left.sources[i].vendor_id, right.sources[i].vendor_id);
    EXPECT_EQ(left.sources[i].product_id, right.sources[i].product_id);
    EXPECT_EQ(left.sources[i].profile_toml, right.sources[i].profile_toml);
    EXPECT_EQ(left.sources[i].report_descriptor, right.sources[i].report_descriptor);
  }
}

}  // namespace condyle::testing_support
