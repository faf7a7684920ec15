// SPDX-License-Identifier: Apache-2.0
// One writer, log after log.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "support/read_log.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using hal::SessionLogFailure;
using testing_support::make_header;
using testing_support::make_report;

// Each time as if the writer were new, also after failures and with other sources.
TEST(SessionLog, WritesOneLogAfterAnother) {
  const testing_support::TemporaryFolder folder;
  hal::SessionLogWriter log({.ring_reports = 64, .chunk_time_ns = 0});
  for (std::uint32_t part = 0; part < 9; ++part) {
    const std::string path = folder / (std::to_string(part) + ".mcap");
    const hal::SessionHeader header = make_header(1 + part % 3);
    hal::SessionHeader bad = header;
    bad.sources.clear();
    if (part % 2 == 1) {
      EXPECT_EQ(log.open(path, bad), SessionLogFailure::bad_header);
      EXPECT_EQ(log.open(folder / "no/log.mcap", header), SessionLogFailure::not_found);
      EXPECT_EQ(log.close(), SessionLogFailure::not_found);
    }
    if (part % 4 > 1) {
      EXPECT_EQ(log.prepare(header), SessionLogFailure::none);
    }
    ASSERT_EQ(log.open(path, header), SessionLogFailure::none);
    EXPECT_EQ(log.open(folder / "other.mcap", header), SessionLogFailure::already_exists);
    EXPECT_EQ(log.prepare(header), SessionLogFailure::already_exists);
    EXPECT_EQ(log.status().reports_written + log.status().reports_lost, 0U);
    std::uint32_t lost = 0;
    for (std::uint32_t i = 0; i < 500 + part; ++i) {
      lost += log.write(part % 3, make_report(100 * part + i, 29, i)) ? 0U : 1U;
    }
    EXPECT_FALSE(log.write(header.sources.size(), make_report(0, 29, 0)));
    EXPECT_EQ(log.close(), SessionLogFailure::none);
    const auto status = log.status();
    EXPECT_EQ(status.failure, SessionLogFailure::none);
    EXPECT_EQ(status.reports_lost, lost + 1);
    EXPECT_EQ(status.reports_written, 500 + part - lost);
    EXPECT_EQ(status.bytes_written, std::filesystem::file_size(path));
    EXPECT_EQ(status.bytes_synchronised, status.bytes_written);

    const auto read = testing_support::read_log(path);
    EXPECT_EQ(read.condition.outcome, hal::McapRead::end);
    testing_support::expect_same(read.header, header);
    std::uint64_t said = 0;
    for (const auto& event : read.events) said += event.event.count;
    EXPECT_EQ(said, lost);
    ASSERT_EQ(read.reports[part % 3].size(), status.reports_written);
    EXPECT_TRUE(
        testing_support::is_same(read.reports[part % 3][0], make_report(100 * part, 29, 0)));
  }
  EXPECT_EQ(folder.count(), 9);
}

// It comes last, belongs to its log alone, and is not there if the log was not closed.
TEST(SessionLog, KeepsWhatWasLearned) {
  const testing_support::TemporaryFolder folder;
  const std::string first = folder / "first.mcap", second = folder / "second.mcap";
  hal::SessionLogWriter log({.ring_reports = 64, .chunk_time_ns = 0});
  EXPECT_FALSE(log.keep_learned("{}")) << "no log is open";
  const std::string learned(hal::kMaxTextBytes, 'x');
  std::string text = "?";
  for (const std::string& path : {first, second}) {
    ASSERT_EQ(log.open(path, make_header(2)), SessionLogFailure::none);
    for (std::uint32_t i = 0; i < 40; ++i) EXPECT_TRUE(log.write(0, make_report(i, 29, i)));
    EXPECT_FALSE(log.keep_learned(learned + "x"));
    if (path == first) {
      EXPECT_TRUE(log.keep_learned("{\"old\": 1}"));
      EXPECT_TRUE(log.keep_learned(learned));
    }
    EXPECT_EQ(hal::read_learned_text(path, text), hal::Status::ok);
    EXPECT_EQ(text, "") << "the log is not complete";
    ASSERT_EQ(log.close(), SessionLogFailure::none);
    EXPECT_EQ(hal::read_learned_text(path, text), hal::Status::ok);
    EXPECT_EQ(text == (path == first ? learned : ""), true) << text.size();
    const auto read = testing_support::read_log(path);
    EXPECT_EQ(read.condition.outcome, hal::McapRead::end);
    EXPECT_EQ(read.reports[0].size(), 40U);
  }
  EXPECT_EQ(hal::read_learned_text(folder / "none.mcap", text), hal::Status::not_found);
}

}  // namespace
}  // namespace condyle
